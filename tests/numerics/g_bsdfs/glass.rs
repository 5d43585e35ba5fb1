//! Glass in uniform light, and smooth normals on a coarse mesh.

use crate::common::{
    Estimate, Stage, assert_at_most, assert_naive_fails, assert_truth, emitter, grey, lambert,
    quad_mesh, report, settings, with_device,
};
use glam::{Affine3A, Vec3};
use steradian::passes::Tuning;
use steradian::scene::{LightKind, Material, Mesh, Scene};
use steradian::settings::Strategy;
use steradian::{RenderSettings, Renderer};

const INDEX: f32 = 1.5;

fn glass() -> Material {
    Material {
        metallic: 0.0,
        roughness: 0.0,
        transmission: 1.0,
        volume: true,
        ior: INDEX,
        ..Material::default()
    }
}

/// Pixels of a picture, with a part of a shader replaced.
fn render_with(scene: &Scene, settings: &RenderSettings, edit: Option<[&str; 3]>) -> Vec<f64> {
    let mut tuning = Tuning::default();
    if let Some([module, from, to]) = edit {
        let text = tuning.library.get_mut(module).unwrap();
        assert!(text.contains(from), "{module} has no {from:?}");
        *text = text.replace(from, to).into();
    }
    with_device(|device| {
        let mut renderer = Renderer::with_tuning(device, scene, settings, &tuning).unwrap();
        while renderer.step().unwrap() {}
        renderer.finish().unwrap();
        assert_eq!(renderer.statistics().faults, [0; 4]);
        grey(renderer.film())
    })
}

/// A ball of glass under a white sky cannot be seen.
#[test]
fn g9_a_glass_ball_vanishes_in_uniform_light() {
    let mut stage = Stage::perspective(Vec3::Z * 3.0, Vec3::ZERO, 0.6);
    stage.sphere(Vec3::ZERO, 1.0, glass());
    stage.sky(1.0);
    for roulette in [false, true] {
        // Light that was reflected more than 64 times within is some 1e-3 at the rim alone.
        let settings = RenderSettings { roulette, ..settings(16, 16, 64) };
        let estimate = Estimate::of(&render_with(&stage.scene, &settings, None));
        assert_truth(&format!("ball, roulette {roulette}"), estimate, 1.0, 2e-3);
        report(
            "G9",
            &format!("glass ball, roulette {roulette}: radiance less 1"),
            estimate.mean - 1.0,
        );
    }
}

/// A camera within a ball of glass, in a box whose walls emit.
fn inside_glass(eye: Vec3) -> Scene {
    let mut stage = Stage::perspective(eye, eye + Vec3::new(0.3, 0.2, -1.0), 0.5);
    stage.sphere(Vec3::ZERO, 1.0, glass());
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for side in [3.0, -3.0] {
            let u = axis.any_orthonormal_vector();
            // u × v points back to the middle.
            let v = -(axis * side).normalize().cross(u);
            stage.quad(axis * side, u * 3.0, v * 3.0, emitter(1.0));
        }
    }
    stage.scene
}

/// Radiance over the index squared is what stays along a ray: within glass there is n² as much.
#[test]
fn g9_radiance_within_glass_is_eta_squared() {
    let truth = f64::from(INDEX).powi(2);
    for eye in [Vec3::ZERO, Vec3::new(0.2, -0.1, 0.3)] {
        for roulette in [false, true] {
            let settings = RenderSettings { roulette, ..settings(16, 16, 64) };
            let scene = inside_glass(eye);
            let estimate = Estimate::of(&render_with(&scene, &settings, None));
            assert_truth(&format!("from {eye}, roulette {roulette}"), estimate, truth, 1e-3);
            let error = (estimate.mean / truth - 1.0).abs();
            let what = format!("within glass from {eye}, roulette {roulette}: relative error");
            assert_at_most("G9", &what, error, 1e-3);
        }
    }
    let forgotten = Some(["bsdf/scatter", "weight * scale", "weight"]);
    let pixels = render_with(&inside_glass(Vec3::ZERO), &settings(8, 8, 4), forgotten);
    let error = (Estimate::of(&pixels).mean / truth - 1.0).abs();
    assert_naive_fails("G9", "eta² forgotten: relative error", error, 0.5);
}

/// A ball of 16 by 8 quads about the origin, with the true ball's normals.
fn coarse_ball() -> Mesh {
    const COLUMNS: u32 = 16;
    const ROWS: u32 = 8;
    let point = |i: u32, j: u32| {
        let theta = std::f32::consts::PI * i as f32 / ROWS as f32;
        let phi = std::f32::consts::TAU * (j % COLUMNS) as f32 / COLUMNS as f32;
        Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin())
    };
    let mut mesh = Mesh::default();
    for i in 0..=ROWS {
        for j in 0..=COLUMNS {
            mesh.positions.push(point(i, j));
            mesh.normals.push(point(i, j));
        }
    }
    let index = |i: u32, j: u32| i * (COLUMNS + 1) + j;
    for i in 0..ROWS {
        for j in 0..COLUMNS {
            let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            // Triangles at the poles would have no area.
            if i + 1 < ROWS {
                mesh.triangles.push([a, c, b]);
            }
            if i > 0 {
                mesh.triangles.push([a, d, c]);
            }
        }
    }
    mesh
}

fn ball_stage(material: Material) -> Stage {
    let mut stage = Stage::orthographic(Vec3::Z * 3.0, Vec3::ZERO, 0.9);
    let ball = stage.mesh(coarse_ball(), material);
    stage.place(ball, Affine3A::IDENTITY);
    stage
}

/// Smooth normals on a coarse white ball in a white sky: no pixel is brighter than the sky, and
/// what is lost where a direction passes the shading normal but not the surface is told.
#[test]
fn g10_smooth_normals_make_no_light() {
    let mirror = Material { roughness: 0.0, ..Material::default() };
    for (name, material) in [("Lambert", lambert(1.0)), ("mirror", mirror)] {
        let mut stage = ball_stage(material);
        stage.sky(1.0);
        // Without light samples a path brings the sky's radiance or, lost on the way, nothing.
        let settings = RenderSettings {
            strategy: Strategy::Bsdf,
            roulette: false,
            max_bounces: Some(64),
            ..settings(16, 16, 64)
        };
        let pixels = render_with(&stage.scene, &settings, None);
        let most = pixels.iter().copied().fold(0.0, f64::max);
        let what = format!("16x8 ball, {name}, in a furnace: brightest pixel less 1");
        assert_at_most("G10", &what, most - 1.0, 2e-6);
        let paths = Estimate::of(&pixels);
        let what = format!("16x8 ball, {name}: light lost");
        if name == "mirror" {
            // Shading normals are turned until every reflection leaves the surface.
            assert_at_most("G10", &what, (1.0 - paths.mean).abs(), 2e-6);
            continue;
        }
        report("G10", &what, 1.0 - paths.mean);

        let with_light_samples = RenderSettings { strategy: Strategy::Mis, ..settings };
        let mis = Estimate::of(&render_with(&stage.scene, &with_light_samples, None));
        let z = (mis.mean - paths.mean) / mis.standard_error.hypot(paths.standard_error);
        assert_at_most("G10", &format!("{name}: light samples against none, |z|"), z.abs(), 3.9);
    }
}

/// Parallel light that sinks below the horizon of a sheet whose shading normals lean towards it by
/// 45°: from behind the true surface there is none, although nothing else is in the way.
#[test]
fn g10_no_light_leaks_through_a_surface_that_turns_away() {
    let mut leaked = 0.0_f64;
    for degrees in [60.0_f64, 89.0, 91.0, 120.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let to_light = Vec3::new(sin as f32, cos as f32, 0.0);
        let mut stage = Stage::orthographic(Vec3::Y, Vec3::ZERO, 0.1);
        let mut sheet = quad_mesh(Vec3::new(0.1, 0.0, 0.2), Vec3::Z, Vec3::X);
        sheet.normals = vec![Vec3::new(1.0, 1.0, 0.0).normalize(); 4];
        let sheet = stage.mesh(sheet, lambert(1.0));
        stage.place(sheet, Affine3A::IDENTITY);
        stage.light(LightKind::Directional { direction: -to_light }, 1.0);
        let settings = RenderSettings { max_bounces: Some(1), ..settings(8, 8, 1) };
        let lit = render_with(&stage.scene, &settings, None);
        let most = lit.iter().copied().fold(0.0, f64::max);
        if degrees < 90.0 {
            assert!(most > 0.0, "dark under light from {degrees}°");
        } else {
            leaked = leaked.max(most);
        }
    }
    assert_at_most("G10", "radiance lit from behind, 1° and 30° below the horizon", leaked, 0.0);
}
