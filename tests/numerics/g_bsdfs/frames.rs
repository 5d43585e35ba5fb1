//! GGX's D, frames of normals, and cosine-weighted directions.

use super::{Input, definition, run};
use crate::common::{Call, Random, assert_at_most, assert_naive_fails, harness, report};
use glam::{DVec3, Vec3, Vec4};
use steradian::shader::Feature;

/// `Output` of `bsdf_parts.wgsl`.
pub(super) struct Parts {
    pub(super) tangent: Vec3,
    pub(super) bitangent: Vec3,
    pub(super) cosine: Vec3,
    pub(super) d: f32,
    pub(super) reflected: Vec3,
}

/// Calls `bsdf_parts.wgsl` with normals, alpha and u.
pub(super) fn parts(inputs: &[(Vec3, f32, [f32; 2])]) -> Vec<Parts> {
    let words = |(n, alpha, [u, v]): &(Vec3, f32, [f32; 2])| {
        [n.extend(*alpha), Vec4::new(*u, *v, 0.0, 0.0)]
    };
    let words: Vec<[Vec4; 2]> = inputs.iter().map(words).collect();
    let outputs: Vec<[Vec4; 4]> = Call::new(harness!("bsdf_parts"), &[Feature::Ggx]).run(&words, 1);
    let part = |[t, b, c, r]: [Vec4; 4]| Parts {
        tangent: t.truncate(),
        bitangent: b.truncate(),
        cosine: c.truncate(),
        d: c.w,
        reflected: r.truncate(),
    };
    outputs.into_iter().map(part).collect()
}

/// D over half vectors up to five widths from the normal. The usual form adds cos² (α² - 1)
/// to 1, which cancels.
#[test]
fn g1_ggx_density_keeps_its_digits() {
    const COUNT: usize = 1 << 14;
    for alpha in [1.0_f32, 0.3, 0.1, 1e-2, 3e-3, 1e-3, 1e-4] {
        let mut random = Random(1);
        let normal = |_| {
            let tan = 5.0 * f64::from(alpha) * f64::from(random.unit());
            let (sin, cos) = (std::f64::consts::TAU * f64::from(random.unit())).sin_cos();
            (DVec3::new(tan * cos, tan * sin, 1.0).normalize().as_vec3(), alpha, [0.5; 2])
        };
        let inputs: Vec<_> = (0..COUNT).map(normal).collect();
        let (mut error, mut naive_error) = (0.0_f64, 0.0_f64);
        for ((h, ..), out) in inputs.iter().zip(parts(&inputs)) {
            let truth = definition::d(alpha.into(), h.as_dvec3());
            let e = h.z * h.z * (alpha * alpha - 1.0) + 1.0;
            let naive = alpha * alpha / (std::f32::consts::PI * e * e);
            error = error.max((f64::from(out.d) / truth - 1.0).abs());
            naive_error = naive_error.max((f64::from(naive) / truth - 1.0).abs());
        }
        assert_at_most("G1", &format!("D at alpha {alpha}: largest relative error"), error, 2e-6);
        if alpha <= 1e-2 {
            let what = format!("D at alpha {alpha} by cos²(α² - 1) + 1: largest relative error");
            assert_naive_fails("G1", &what, naive_error, 1e-4);
        }
    }
}

/// Random normals, and those around the poles and the axes where bases change over.
fn normals(count: usize) -> Vec<Vec3> {
    let mut random = Random(2);
    let mut normals: Vec<Vec3> = (0..count - 2048).map(|_| random.direction()).collect();
    for k in 0..1024_u32 {
        // -1 and the values next to it, with the rest of the length in x, y, or both.
        let z = f64::from(f32::from_bits(1.0_f32.to_bits() - k % 256));
        let rest = (1.0 - z * z).sqrt();
        let (sin, cos) = (std::f64::consts::FRAC_PI_4 * f64::from(k / 256)).sin_cos();
        for side in [1.0, -1.0] {
            normals.push(DVec3::new(rest * cos, rest * sin, side * z).as_vec3());
        }
    }
    normals[0] = Vec3::new(0.0, 0.0, -1.0);
    normals[1] = Vec3::new(0.6, -0.8, -0.0);
    normals[2] = Vec3::new(-0.0, -0.0, 1.0);
    normals[3] = Vec3::NEG_X;
    normals
}

/// The basis by a cross product with an axis, and the one of Frisvad 2012 that divides by 1 + z.
fn frisvad(n: Vec3) -> (Vec3, Vec3) {
    let a = 1.0 / (1.0 + n.z);
    let b = -n.x * n.y * a;
    (Vec3::new(1.0 - n.x * n.x * a, b, -n.x), Vec3::new(b, 1.0 - n.y * n.y * a, -n.y))
}

/// Largest of the products and length errors of a frame.
fn frame_error(n: Vec3, tangent: Vec3, bitangent: Vec3) -> f64 {
    let [n, t, b] = [n, tangent, bitangent].map(|v| v.as_dvec3());
    let errors = [t.dot(b), t.dot(n), b.dot(n), t.length() - 1.0, b.length() - 1.0];
    errors.into_iter().fold(0.0, |worst: f64, e| if e.is_nan() { 1.0 } else { worst.max(e.abs()) })
}

#[test]
fn g11_frames_are_orthonormal_at_every_normal() {
    const COUNT: usize = 1 << 20;
    let normals = normals(COUNT);
    let inputs: Vec<_> = normals.iter().map(|&n| (n, 1.0, [0.5; 2])).collect();
    let (mut error, mut naive_error, mut left_handed) = (0.0_f64, 0.0_f64, 0);
    for (&n, out) in normals.iter().zip(parts(&inputs)) {
        error = error.max(frame_error(n, out.tangent, out.bitangent));
        left_handed += usize::from(out.tangent.cross(out.bitangent).dot(n) < 0.5);
        let (t, b) = frisvad(n);
        naive_error = naive_error.max(frame_error(n, t, b));
    }
    assert_at_most("G11", "frames of 2^20 normals: largest product or length error", error, 3e-7);
    assert_at_most("G11", "left-handed frames of 2^20", left_handed as f64, 0.0);
    assert_naive_fails("G11", "frames that divide by 1 + z: largest error", naive_error, 1e-2);
}

/// Cosine-weighted directions for random numbers in the corners, on the edges and in the middle
/// of the square, where a cosine of 0 has the density 0.
#[test]
fn g12_no_random_number_makes_a_lambert_sample_infinite() {
    let one_below = 1.0_f32.next_down();
    let half = 0.5_f32;
    let edges = [
        0.0,
        f32::MIN_POSITIVE,
        1.0 / 16_777_216.0,
        half.next_down(),
        half,
        half.next_up(),
        one_below,
        0.25,
    ];
    let mut random = Random(3);
    let mut us: Vec<[f32; 2]> = edges.iter().flat_map(|&a| edges.map(|b| [a, b])).collect();
    for _ in 0..1 << 14 {
        let edge = edges[random.bits() as usize % edges.len()];
        us.push([edge, random.unit()]);
        us.push([random.unit(), edge]);
    }
    let albedo = 0.75_f32;
    let lambert = Input { diffuse: Vec3::splat(albedo), ..Input::black(0.5) };
    let inputs: Vec<_> =
        us.iter().map(|[x, y]| Input { u: Vec4::new(*x, *y, 0.0, 0.0), ..lambert }).collect();
    let (mut error, mut none) = (0.0_f64, 0);
    for (out, part) in
        run(&inputs).iter().zip(parts(&us.iter().map(|&u| (Vec3::Z, 1.0, u)).collect::<Vec<_>>()))
    {
        assert!(
            part.cosine.z >= 0.0 && (part.cosine.length() - 1.0).abs() <= 1e-6,
            "{}",
            part.cosine
        );
        if out.pdf == 0.0 {
            assert_eq!(out.weight, Vec3::ZERO);
            none += 1;
            continue;
        }
        assert!(out.pdf > 0.0 && out.weight.is_finite() && out.wi.z > 0.0, "{out:?}");
        error = error.max(f64::from((out.weight.x / albedo - 1.0).abs()));
    }
    // Of directions in the horizon plane there may be one for each u on the square's rim.
    assert_at_most("G12", "weight of Lambert samples: largest relative error", error, 1e-6);
    report("G12", &format!("samples without a direction, of {}", us.len()), f64::from(none));
}
