//! Sunflowers: thousands of placements of six small meshes. Floret n of a head
//! stands at n times the golden angle, at a distance that grows with the root of n
//! (Vogel 1979, "A better way to construct the sunflower head").

use crate::document::{Document, Lens, Light, MeshId};
use crate::material::Material;
use crate::shapes::{Ends, Mesh, lathe, parametric};
use glam::{DMat3, DQuat, DVec3, dvec3};
use serde_json::json;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Placements of one head: with petals, leaves and base 471.
const FLORET_COUNT: u32 = 400;
const PETALS_OF_RING: [u32; 3] = [23, 21, 21];
const LEAVES_OF_HEAD: u32 = 5;

/// Radius of the disc of florets of a head of size 1, and how much it bulges.
const DISC_RADIUS: f64 = 0.5;
const DISC_BULGE: f64 = 0.13;

/// Centre, size, and where the head looks (x, z, with y = 1).
const HEADS: [(DVec3, f64, [f64; 2]); 16] = [
    (dvec3(-0.10, 1.22, 0.38), 1.10, [0.05, 0.38]),
    (dvec3(1.72, 0.72, 0.42), 0.98, [0.30, 0.42]),
    (dvec3(-1.84, 0.78, 0.10), 0.94, [-0.34, 0.40]),
    (dvec3(1.02, 0.56, -1.38), 0.92, [0.16, 0.26]),
    (dvec3(-1.00, 0.46, -1.62), 0.90, [-0.16, 0.30]),
    (dvec3(2.75, 0.38, -1.35), 0.84, [0.40, 0.20]),
    (dvec3(-2.75, 0.32, -1.60), 0.82, [-0.36, 0.26]),
    (dvec3(0.05, 0.55, -2.85), 0.88, [0.06, 0.34]),
    (dvec3(1.88, 0.50, -2.75), 0.92, [0.20, 0.30]),
    (dvec3(-1.90, 0.52, -3.00), 0.90, [-0.22, 0.36]),
    (dvec3(3.75, 0.45, -2.95), 0.88, [0.30, 0.28]),
    (dvec3(-3.75, 0.40, -3.05), 0.90, [-0.28, 0.30]),
    (dvec3(1.00, 0.50, -4.35), 0.90, [0.08, 0.40]),
    (dvec3(-0.95, 0.52, -4.50), 0.92, [-0.10, 0.38]),
    (dvec3(2.90, 0.48, -4.45), 0.92, [0.20, 0.36]),
    (dvec3(-2.95, 0.50, -4.60), 0.90, [-0.22, 0.40]),
];

/// Height of the disc at the distance `r` from its middle, of 1: a ring around a
/// hollow.
fn bulge(r: f64) -> f64 {
    DISC_BULGE * (1.0 - r * r) * (0.35 + 1.6 * r * r)
}

/// What the florets stand on.
fn base() -> Mesh {
    const RINGS: i32 = 10;
    // Below the florets' feet, which lean and are not exactly on it.
    const SINK: f64 = 0.006;
    let profile: Vec<(f64, f64)> = (0..=RINGS)
        .map(|k| f64::from(RINGS - k) / f64::from(RINGS))
        .map(|r| (r * DISC_RADIUS, bulge(r) - SINK))
        .collect();
    lathe(&profile, 48)
}

/// The shared meshes.
struct Parts {
    base: MeshId,
    bud: MeshId,
    seed: MeshId,
    floret: MeshId,
    petal: MeshId,
    leaf: MeshId,
}

/// A leaf-like surface of length 1 from the origin along +Z, hollow towards +Y.
/// `breadth` is half its width and `cup` the bend across it in radians.
fn blade(cells: [u32; 2], breadth: f64, cup: f64) -> Mesh {
    parametric(cells, [Ends::Open, Ends::Open], |u, v| {
        // Narrow at the root, broadest before the middle, and pointed at the tip,
        // but not so much that its triangles lose their area.
        const TIP: f64 = 0.012;
        let along = u.clamp(0.0, 1.0);
        let outline = (PI * along.powf(0.8)).sin().max(0.0).powf(0.75) + 0.10 * (1.0 - along) + TIP;
        let angle = cup * (2.0 * v - 1.0);
        let width = breadth * outline;
        let crease = 0.05 * (1.0 - (2.0 * v - 1.0).abs()).powi(2);
        let rise = 0.30 * along - 0.34 * along * along;
        let hollow = width * (1.0 - angle.cos()) / cup;
        dvec3(width * angle.sin() / cup.sin(), hollow + rise - crease * outline, u)
    })
    .inside_out()
}

/// A drop of length 1 along +Y, broadest at `waist`; closed at both ends.
fn drop(cells: [u32; 2], radius: f64, waist: f64) -> Mesh {
    // The ends stay a little open: a point has no normal of its own.
    const TIP: f64 = 1e-3;
    let power = 0.5_f64.ln() / waist.ln();
    parametric(cells, [Ends::Open, Ends::Closed], |u, v| {
        let y = TIP + (1.0 - 2.0 * TIP) * u;
        let (sin, cos) = (TAU * v).sin_cos();
        let r = radius * (PI * y.powf(power)).sin();
        dvec3(r * cos, y, r * sin)
    })
}

fn add_parts(document: &mut Document) -> Parts {
    let mut part = |name: &'static str, mesh: Mesh, base_color: [f64; 3], roughness: f64| {
        let material = document.material(Material {
            name,
            base_color,
            roughness,
            specular: 0.6,
            double_sided: true,
            ..Default::default()
        });
        document.mesh(name, &mesh, material)
    };
    Parts {
        base: part("base", base(), [0.035, 0.022, 0.008], 0.8),
        bud: part("bud", drop([8, 12], 0.36, 0.45), [0.16, 0.15, 0.025], 0.5),
        seed: part("seed", drop([8, 12], 0.33, 0.55), [0.055, 0.020, 0.010], 0.4),
        floret: part("floret", drop([10, 12], 0.27, 0.72), [0.62, 0.20, 0.015], 0.5),
        petal: part("petal", blade([18, 10], 0.17, 0.9), [0.93, 0.50, 0.012], 0.55),
        leaf: part("leaf", blade([24, 12], 0.34, 0.6), [0.055, 0.17, 0.030], 0.5),
    }
}

/// Evenly spread numbers in [-1, 1] instead of random ones: no two neighbours are
/// alike, and the file is always the same.
fn wobble(n: u32) -> f64 {
    2.0 * (f64::from(n) * 0.754_877_666_246_692_7).fract() - 1.0
}

/// Turns +Y to `up`, and then +Z as near to `forward` as that allows.
fn upright(up: DVec3, forward: DVec3) -> DQuat {
    let right = up.cross(forward).normalize();
    DQuat::from_mat3(&DMat3::from_cols(right, up, right.cross(up)))
}

/// One sunflower; `world` turns its axis +Y to where it looks.
fn add_head(document: &mut Document, parts: &Parts, center: DVec3, size: f64, world: DQuat) {
    let mut put = |mesh: MeshId, at: DVec3, rotation: DQuat, scale: f64| {
        document.scatter(mesh, center + world * at * size, world * rotation, scale * size);
    };
    put(parts.base, DVec3::ZERO, DQuat::IDENTITY, 1.0);
    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
    for n in 0..FLORET_COUNT {
        let share = (f64::from(n) + 0.5) / f64::from(FLORET_COUNT);
        let r = share.sqrt();
        let (sin, cos) = (f64::from(n) * golden_angle).sin_cos();
        let outward = dvec3(cos, 0.0, sin);
        let height = bulge(r);
        let lean = 0.75 * r * r - 0.25 * (1.0 - r);
        let up = (DVec3::Y * lean.cos() + outward * lean.sin()).normalize();
        let (mesh, scale) = match r {
            r if r < 0.42 => (parts.bud, 0.064),
            r if r < 0.76 => (parts.seed, 0.077),
            _ => (parts.floret, 0.115),
        };
        let at = outward * (r * DISC_RADIUS) + DVec3::Y * height;
        put(mesh, at, upright(up, outward), scale * (1.0 + 0.08 * wobble(n)));
    }
    for (ring, &count) in PETALS_OF_RING.iter().enumerate() {
        for k in 0..count {
            let n = 100 * ring as u32 + k;
            let turn =
                TAU * (f64::from(k) + 0.37 * ring as f64 + 0.16 * wobble(n)) / f64::from(count);
            let (sin, cos) = turn.sin_cos();
            let outward = dvec3(cos, 0.0, sin);
            let lift = 0.50 - 0.26 * ring as f64 + 0.12 * wobble(n + 31);
            let along = outward * lift.cos() + DVec3::Y * lift.sin();
            let up = DVec3::Y * lift.cos() - outward * lift.sin();
            let length = 0.46 + 0.07 * ring as f64 + 0.05 * wobble(n + 57);
            let root = outward * (DISC_RADIUS * 0.95) - DVec3::Y * (0.02 + 0.02 * ring as f64);
            put(parts.petal, root, upright(up, along), length);
        }
    }
    for k in 0..LEAVES_OF_HEAD {
        let turn =
            TAU * (f64::from(k) + 0.3 * wobble(k + 5)) / f64::from(LEAVES_OF_HEAD) + center.x;
        let (sin, cos) = turn.sin_cos();
        let outward = dvec3(cos, 0.0, sin);
        let droop = -0.30 + 0.15 * wobble(k);
        let along = outward * droop.cos() + DVec3::Y * droop.sin();
        let up = DVec3::Y * droop.cos() - outward * droop.sin();
        put(parts.leaf, outward * 0.25 - DVec3::Y * 0.22, upright(up, along), 1.15);
    }
}

/// Builds the scene.
pub(crate) fn build(document: &mut Document) {
    let parts = add_parts(document);
    for (center, size, [x, z]) in HEADS {
        let axis = dvec3(x, 1.0, z).normalize();
        let lean = DQuat::from_rotation_arc(DVec3::Y, axis);
        add_head(
            document,
            &parts,
            center,
            size,
            lean * DQuat::from_rotation_y(center.x * FRAC_PI_2),
        );
    }
    let ground = document.material(Material {
        name: "ground",
        base_color: [0.045, 0.085, 0.035],
        ..Default::default()
    });
    let mesh = document.mesh("ground", &lathe(&[(12.0, 0.0), (0.0, 0.0)], 96), ground);
    document.place("ground", mesh, DVec3::ZERO);
    document.extra("environment", json!({ "radiance": [0.40, 0.52, 0.70] }));
    document.light(
        "sun",
        Light::Directional { color: [1.0, 0.89, 0.70], irradiance: 4.2 },
        dvec3(0.0, 4.0, 0.0),
        dvec3(0.80, -0.95, -0.30),
    );
    document.camera(
        dvec3(0.0, 4.2, 4.1),
        dvec3(0.0, 0.62, -0.22),
        Lens::Perspective { yfov: 36.0_f64.to_radians(), aspect_ratio: 1.5 },
    );
}
