//! F1 to F4 and F8: spheres that emit.

use super::{ALBEDO, check, direction, draw, receiver};
use crate::common::{
    Estimate, Random, Stage, assert_at_most, assert_naive_fails, assert_truth, emitter, lambert,
    render, report, settings,
};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use steradian::RenderSettings;
use steradian::scene::{Material, Scene};

const RATIOS: [f32; 8] = [0.9, 0.3, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];

/// Form factor of a sphere at `distance` radii, its centre at `angle` from the normal. The
/// second form is for a sphere that the horizon cuts.
fn form_factor(distance: f64, angle: f64) -> f64 {
    let (h, cos) = (distance, angle.cos());
    if h * cos >= 1.0 {
        return cos / (h * h);
    }
    let x = ((h - 1.0) * (h + 1.0)).sqrt();
    let y = -x / angle.tan();
    let s = angle.sin() * (1.0 - y * y).sqrt();
    (cos * y.acos() - x * s) / (PI * h * h) + (s / x).atan() / PI
}

/// A sphere that emits, and nothing else.
fn lone(center: Vec3, radius: f32, material: Material) -> Scene {
    let mut stage = Stage::perspective(Vec3::Z * 5.0, Vec3::ZERO, 1.0);
    stage.sphere(center, radius, material);
    stage.scene
}

/// 1 / (2 π (1 - cos)) of the cone that a sphere subtends.
fn cone_density(toward: DVec3, radius: f64) -> f64 {
    let d = toward.length();
    let sin2 = (radius / d).powi(2);
    let cos = ((d - radius) * (d + radius)).sqrt() / d;
    (1.0 + cos) / (2.0 * PI * sin2)
}

/// Largest relative error of the density of samples, and of the density that a ray which finds
/// the light has; and samples whose shadow ray is blocked or whose direction misses.
fn density_errors(center: Vec3, radius: f32, places: &[Vec3]) -> ([f64; 2], [usize; 2]) {
    let scene = lone(center, radius, emitter(1.0));
    let (mut errors, mut counts) = ([0.0_f64; 2], [0; 2]);
    for (place, drawn) in places.iter().zip(draw(&scene, places, &mut Random(20))) {
        let truth = cone_density(center.as_dvec3() - place.as_dvec3(), radius.into());
        let error = |pdf: f32| (f64::from(pdf) / truth - 1.0).abs();
        errors[0] = errors[0].max(error(drawn.pdf));
        counts[0] += usize::from(drawn.is_blocked);
        if drawn.meets_emitter {
            errors[1] = errors[1].max(error(drawn.met_pdf));
        } else {
            counts[1] += 1;
        }
    }
    (errors, counts)
}

/// Places at distance 1 from a centre, in random directions.
fn around(center: Vec3, distance: f32, count: usize) -> Vec<Vec3> {
    let mut random = Random(21);
    (0..count).map(|_| center + distance * random.direction()).collect()
}

/// F1 and F4. The usual form of the cone's density is 1 / (2 π (1 - cos)) with the cosine as the
/// root of 1 - r²/d²; the usual test of visibility is whether a ray meets the light.
#[test]
fn f1_density_of_spheres_of_any_size() {
    const COUNT: usize = 1 << 14;
    let center = Vec3::new(0.3, -0.2, 0.7);
    let places = around(center, 1.0, COUNT);
    let (mut worst, mut blocked, mut usual) = (0.0_f64, 0, 0.0_f64);
    for ratio in RATIOS {
        let (errors, [hidden, missed]) = density_errors(center, ratio, &places);
        worst = worst.max(errors[0]).max(errors[1]);
        blocked += hidden;
        let s2 = ratio * ratio;
        let cone = 2.0 * std::f32::consts::PI * (1.0 - (1.0 - s2).sqrt());
        let error = cone_density(DVec3::Z, ratio.into()) * f64::from(cone) - 1.0;
        println!("r/d {ratio}: {errors:?}, {hidden} hidden, {missed} missed; usual {error:e}");
        usual = usual.max(error.abs());
        let what = format!("rays to samples that miss a sphere of r/d {ratio}, of 16,384");
        if ratio <= 1e-6 {
            assert_naive_fails("F4", &what, missed as f64, 1.0);
        } else {
            report("F4", &what, missed as f64);
        }
    }
    assert_at_most("F1", "cone density, r/d 0.9..1e-6: largest relative error", worst, 1e-6);
    assert_naive_fails("F1", "solid angle by 1 - cos, same: largest relative error", usual, 1.0);
    assert_at_most(
        "F4",
        "blocked shadow rays to spheres in sight, of 131,072",
        blocked as f64,
        0.0,
    );
}

/// A sphere of any size that has the same flux: from one that nearly touches to one that a solid
/// angle computed as a difference in f32 would lose.
#[test]
fn f1_irradiance_of_spheres_from_near_to_tiny() {
    let mut worst = 0.0_f64;
    for radius in RATIOS {
        let mut stage = receiver(1.0);
        let center = direction(30.0).as_vec3();
        stage.sphere(center, radius, emitter(1.0 / (radius * radius)));
        // What the device is given: rounded to f32.
        let (c, r) = (center.as_dvec3(), f64::from(radius));
        let radiance = f64::from(1.0 / (radius * radius));
        let f = form_factor(c.length() / r, (c.y / c.length()).acos()) * radiance;
        // At 0.9 the horizon cuts the sphere: a little noise is left.
        let spp = if radius > 0.2 { 1024 } else { 64 };
        let what = format!("sphere of radius {radius}");
        worst = worst.max(check(&what, &stage.scene, f, spp, 0.001));
    }
    let what = "irradiance of spheres, r/d 0.9..1e-6: largest relative error";
    assert_at_most("F1", what, worst, 1e-3);
}

/// Just outside a sphere, d = r (1 + 10^-k). At places on an axis the distance is exact; at
/// others its rounding, magnified by the inverse cosine, is all that may remain.
#[test]
fn f2_density_just_outside_a_sphere() {
    const COUNT: usize = 1 << 10;
    let (mut worst, mut usual) = (0.0_f64, 0.0_f64);
    for k in 1..=6 {
        let d = (1.0 + 10.0_f64.powi(-k)) as f32;
        let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        let places: Vec<_> = (0..192).map(|i| axes[i % 6] * d).collect();
        // Within 16 units in the last place the receiver is on the sphere: rays alone find it.
        let is_on = d - 1.0 <= 2.0 * 8.0 * f32::EPSILON;
        if is_on {
            let scene = lone(Vec3::ZERO, 1.0, emitter(1.0));
            let drawn = draw(&scene, &places, &mut Random(22));
            assert!(drawn.iter().all(|l| l.pdf == 0.0 && l.met_pdf == 0.0), "{:?}", drawn[0]);
            continue;
        }
        let (errors, [hidden, _]) = density_errors(Vec3::ZERO, 1.0, &places);
        worst = worst.max(errors[0]).max(errors[1]);
        assert_eq!(hidden, 0, "d = {d}");
        for steps in 0..64 {
            // A radius that is no power of two.
            let r = 0.7 + steps as f32 * f32::EPSILON;
            let cosine = f64::from((1.0 - r * r / (d * r * d * r)).sqrt());
            let ratio = f64::from(d * r) / f64::from(r);
            usual = usual.max((cosine / tangent_cosine(ratio) - 1.0).abs());
        }
        let truth = tangent_cosine(d.into());

        let (errors, _) = density_errors(Vec3::ZERO, 1.0, &around(Vec3::ZERO, d, COUNT));
        let units = errors[0] * truth * 16_777_216.0;
        let what = format!("cone density around d = r (1 + 1e-{k}): conditioned units of 2^-24");
        assert_at_most("F2", &what, units, 8.0);
    }
    let what = "cone density on axes, d = r (1 + 10^-k), k 1..5: largest relative error";
    assert_at_most("F2", what, worst, 1e-6);
    assert_naive_fails("F2", "cosine by √(1 - r²/d²): largest relative error", usual, 1e-4);
}

/// Cosine of the half angle of the cone that a sphere of radius 1 subtends.
fn tangent_cosine(distance: f64) -> f64 {
    ((distance - 1.0) * (distance + 1.0)).sqrt() / distance
}

#[test]
fn f2_irradiance_just_outside_a_sphere() {
    let mut worst = 0.0_f64;
    for k in 1..=6 {
        let gap = 10.0_f64.powi(-k);
        // Overhead hardly anything depends on the distance.
        let cases: &[(f64, u32)] =
            if k % 3 == 0 { &[(0.0, 256), (90.0, 1024)] } else { &[(90.0, 1024)] };
        for &(degrees, spp) in cases {
            let mut stage = receiver(gap as f32);
            let center = (direction(degrees) * (1.0 + gap)).as_vec3();
            stage.sphere(center, 1.0, emitter(1.0));
            let c = center.as_dvec3();
            let f = form_factor(c.length(), (c.y / c.length()).acos());
            let what = format!("sphere at 1 + 1e-{k}, {degrees}°");
            worst = worst.max(check(&what, &stage.scene, f, spp, 0.001));
        }
    }
    let what = "irradiance at d = r (1 + 10^-k), k 1..6: largest relative error";
    assert_at_most("F2", what, worst, 1e-3);
}

/// A closed sphere that emits and reflects one half, seen from inside: the light of k scatterings
/// adds up to 1. Paths end after 24 of them, where 3e-8 is missing: without roulette hardly
/// anything is left to chance.
#[test]
fn f3_an_emissive_reflecting_sphere_from_inside() {
    let (mut worst, mut worst_error) = (0.0_f64, 0.0_f64);
    for radius in [1.0_f32, 100.0, 1e4] {
        for center in [Vec3::ZERO, Vec3::splat(1e3)] {
            for eye in [Vec3::ZERO, Vec3::new(0.3, -0.2, 0.09)] {
                let eye = center + eye * radius;
                let target = eye + Vec3::new(0.3, 0.5, -1.0);
                let mut stage = Stage::perspective(eye, target, 1.5);
                let glow =
                    Material { emission: Vec3::splat(0.5), double_sided: true, ..lambert(0.5) };
                stage.sphere(center, radius, glow);
                let settings = RenderSettings {
                    roulette: false,
                    max_bounces: Some(24),
                    ..settings(16, 16, 16)
                };
                let estimate = Estimate::of_pixels(&render(&stage.scene, &settings));
                let truth = 1.0 - 0.5_f64.powi(25);
                println!("R {radius} at {center} from {eye}: {estimate:?}");
                worst = worst.max((estimate.mean - truth).abs());
                worst_error = worst_error.max(estimate.standard_error);
            }
        }
    }
    let what = "emissive sphere from inside, R 1..1e4 at 0 and 1e3: largest |L - 1|";
    assert_at_most("F3", what, worst, 2e-4);
    assert_at_most("F3", "the same: largest standard error", worst_error, 5e-5);
}

/// The sun: E = π L (r/d)² cos. The usual area form has d⁴, which f32 does not hold.
#[test]
fn f8_the_sun() {
    let (radius, distance) = (6.96e8_f64, 1.496e11_f64);
    let center = (direction(40.0) * distance).as_vec3();
    let mut stage = receiver(1.0);
    stage.sphere(center, radius as f32, emitter(2e7));
    let c = center.as_dvec3();
    let truth = f64::from(ALBEDO) * 2e7 * (f64::from(radius as f32) / c.length()).powi(2) * c.y
        / c.length();
    let film = render(&stage.scene, &settings(16, 16, 64));
    let estimate = Estimate::of_pixels(&film);
    assert_truth("sun", estimate, truth, 1e-3);
    let error = (estimate.mean / truth - 1.0).abs();
    assert_at_most("F8", "irradiance of the sun: relative error", error, 1e-3);
    let d2 = (distance * distance) as f32;
    assert_naive_fails("F8", "d⁴ in f32", f64::from(d2 * d2), f64::INFINITY);
}
