//! F11: light from infinity.

use super::{ALBEDO, densities, draw, receiver};
use crate::common::{
    Estimate, Random, Stage, assert_at_least, assert_at_most, assert_naive_fails, assert_truth,
    render, report, settings,
};
use glam::{DMat3, DVec3, Mat3, Vec3};
use std::f64::consts::{PI, TAU};
use steradian::RenderSettings;
use steradian::scene::{Environment, Scene};
use steradian::settings::Strategy;
use steradian::statistics::{FALSE_ALARM, GoodnessOfFit, sidak};

/// A grey map with a value for each column and row.
fn map(width: u32, height: u32, turn: Mat3, value: impl Fn(u32, u32) -> f32) -> Environment {
    let texel = |i: u32| Vec3::splat(value(i % width, i / width));
    Environment {
        width,
        height,
        radiance: (0..width * height).map(texel).collect(),
        environment_from_world: turn,
        ..Environment::constant(Vec3::ZERO)
    }
}

fn under(map: Environment) -> Scene {
    let mut stage = receiver(1.0);
    stage.scene.environment = Some(map);
    stage.scene
}

/// Texel of a map, wrapped across, held at the poles.
fn texel(map: &Environment, x: i64, y: i64) -> f64 {
    let (w, h) = (i64::from(map.width), i64::from(map.height));
    let (x, y) = (x.rem_euclid(w), y.clamp(0, h - 1));
    map.radiance[(y * w + x) as usize].x.into()
}

/// The map's position of a direction in its own coordinates, in texels.
fn position(map: &Environment, e: DVec3) -> (f64, f64) {
    let u = e.z.atan2(e.x) / TAU + 0.5;
    let v = e.x.hypot(e.z).atan2(e.y) / PI;
    (u * f64::from(map.width), v * f64::from(map.height))
}

/// Bilinear filtering at a position.
fn filtered(map: &Environment, (u, v): (f64, f64)) -> f64 {
    let (u, v) = (u - 0.5, v - 0.5);
    let (x, y) = (u.floor(), v.floor());
    let at = |i: i64, j: i64| texel(map, x as i64 + i, y as i64 + j);
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let row = |j: i64| mix(at(0, j), at(1, j), u - x);
    mix(row(0), row(1), v - y)
}

/// Probability of every texel, and the solid angle of a texel of each row: its mean filtered
/// value times its solid angle, over the sum.
fn probabilities(map: &Environment) -> (Vec<f64>, Vec<f64>) {
    let (w, h) = (i64::from(map.width), i64::from(map.height));
    let edge = |y: i64| (PI * y as f64 / h as f64).cos();
    let angle: Vec<f64> = (0..h).map(|y| (edge(y) - edge(y + 1)) * TAU / w as f64).collect();
    let tent = [1.0, 6.0, 1.0].map(|k| k / 8.0);
    let mean = |x: i64, y: i64| {
        let row = |j: i64| {
            (-1..=1).map(|i| tent[(i + 1) as usize] * texel(map, x + i, y + j)).sum::<f64>()
        };
        (-1..=1).map(|j| tent[(j + 1) as usize] * row(j)).sum::<f64>()
    };
    let weight = |k: i64| mean(k % w, k / w) * angle[(k / w) as usize];
    let weights: Vec<f64> = (0..w * h).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    (weights.iter().map(|x| x / sum).collect(), angle)
}

fn rotation(map: &Environment) -> DMat3 {
    DMat3::from_cols_array(&map.environment_from_world.to_cols_array().map(f64::from))
}

fn turned() -> Mat3 {
    Mat3::from_rotation_z(0.7) * Mat3::from_rotation_x(-1.1)
}

/// Maps that a sampler may trip over: one texel bright at a pole or the equator, black but for a
/// few, uneven, one texel in all, one row, one column.
fn maps() -> [(&'static str, Environment); 7] {
    let uneven = |x: u32, y: u32| ((x * 7 + y * 13) % 11) as f32 + 0.1;
    let few = |x: u32, y: u32| if (x, y) == (3, 2) || (x, y) == (11, 5) { 9.0 } else { 0.0 };
    [
        ("pole", map(16, 8, turned(), |x, y| if (x, y) == (5, 0) { 1e4 } else { 0.0 })),
        ("equator", map(16, 8, turned(), |x, y| if (x, y) == (15, 4) { 1e4 } else { 0.0 })),
        ("few", map(16, 8, turned(), few)),
        ("uneven", map(16, 8, turned(), uneven)),
        ("constant", Environment::constant(Vec3::ONE)),
        ("row", map(8, 1, turned(), |x, _| x as f32)),
        ("column", map(1, 8, turned(), |_, y| y as f32)),
    ]
}

/// Samples against the probability of every quarter of a texel, equal in solid angle; and the
/// density that a ray finds against its definition.
#[test]
fn f11_samples_of_the_environment_follow_their_density() {
    const COUNT: usize = 1 << 15;
    let (mut least, mut worst, mut seams) = (1.0_f64, 0.0_f64, 0);
    for (k, (name, map)) in maps().iter().enumerate() {
        let scene = under(map.clone());
        let (pmf, angle) = probabilities(map);
        let rotation =
            DMat3::from_cols_array(&map.environment_from_world.to_cols_array().map(f64::from));
        let (w, h) = (map.width as usize, map.height as usize);
        let mut observed = vec![0; 4 * w * h];
        let drawn = draw(&scene, &vec![Vec3::Y * 0.5; COUNT], &mut Random(90 + k as u64));
        let up = drawn.iter().filter(|d| d.pdf > 0.0);
        for d in up {
            let e = (rotation * d.wi.as_dvec3()).normalize();
            let (u, v) = position(map, e);
            let (x, y) = ((u as usize).min(w - 1), (v as usize).min(h - 1));
            let top = (PI * y as f64 / h as f64).cos();
            let height = top - e.y;
            let row_height = angle[y] * w as f64 / TAU;
            let (i, j) =
                ((2.0 * u.fract()) as usize, (2.0 * height / row_height).clamp(0.0, 1.0) as usize);
            observed[(y * w + x) * 4 + 2 * j + i] += 1;
            let density = pmf[y * w + x] / angle[y];
            // Within the rounding of a direction of a texel's edge either side is right.
            let to_edge = |t: f64, n: usize| t.fract().min(1.0 - t.fract()) / n as f64;
            let is_seam = to_edge(u, w) * e.x.hypot(e.z) < 1e-6 || to_edge(v, h) < 1e-6;
            if is_seam {
                seams += 1;
                continue;
            }
            worst = worst.max((f64::from(d.pdf) / density - 1.0).abs());
            // The receiver hides what is below it.
            if !d.is_blocked {
                worst = worst.max((f64::from(d.met_pdf) / density - 1.0).abs());
            }
        }
        assert_eq!(observed.iter().sum::<u64>(), COUNT as u64, "{name}");
        let expected: Vec<f64> = pmf.iter().flat_map(|p| [p * COUNT as f64 / 4.0; 4]).collect();
        let fit = GoodnessOfFit::of(&observed, &expected);
        println!("{name}: {fit}");
        least = least.min(fit.p_value);
    }
    let what = "7 chi-square tests of 32,768 samples of environments: least p-value";
    assert_at_least("F11", what, least, sidak(FALSE_ALARM, 7));
    assert_at_most("F11", "density of environments: largest relative error", worst, 1e-5);
    report("F11", "samples within 1e-6 of a texel's edge, of 229,376", f64::from(seams));

    // The usual density has the sine of the polar angle below the line: on the pole it is 0.
    let pole = f64::from(1.0_f32 / (2.0 * std::f32::consts::PI.powi(2) * 0.0_f32.sin()));
    assert_naive_fails("F11", "density with 1/sin at the pole", pole, f64::INFINITY);
}

/// Over all directions; radiance is the filtered map's.
#[test]
fn f11_densities_of_the_environment_integrate_to_one() {
    const SIDE: usize = 64;
    const REPEATS: usize = 8;
    let mut radiance_error = 0.0_f64;
    for (name, map) in maps() {
        let rotation = rotation(&map);
        let mut random = Random(100);
        let most = map.radiance.iter().map(|r| f64::from(r.x)).fold(0.0, f64::max);
        let mut stage = Stage::perspective(Vec3::Z, Vec3::ZERO, 1.0);
        stage.scene.environment = Some(map.clone());
        let mut directions = Vec::new();
        for k in 0..SIDE * SIDE * REPEATS {
            // Strata of equal angles lie within texels.
            let at = |k: usize, u: f32| (k as f64 + f64::from(u)) / SIDE as f64;
            let theta = PI * at(k / SIDE % SIDE, random.unit());
            let phi = TAU * at(k % SIDE, random.unit());
            let e = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
            directions.push((rotation.transpose() * e).as_vec3());
        }
        let mut sums = [0.0; REPEATS];
        let outputs = densities(&stage.scene, Vec3::ZERO, &directions);
        for (k, (d, out)) in directions.iter().zip(outputs).enumerate() {
            let e = rotation * d.as_dvec3().normalize();
            // The measure of the strata: dω = sin θ dθ dφ.
            let sine = e.x.hypot(e.z);
            sums[k / (SIDE * SIDE)] += f64::from(out.w) * sine;
            // Near a pole the azimuth has the rounding of the direction over the sine.
            let error = (f64::from(out.x) - filtered(&map, position(&map, e))).abs() / most;
            radiance_error = radiance_error.max(error * sine.max(1e-3));
        }
        let scale = PI * TAU / (SIDE * SIDE) as f64;
        let e = Estimate::of(&sums.map(|sum| sum * scale));
        println!("{name}: {e:?}");
        assert!(e.standard_error <= 0.02 / 4.0, "{name}: {e:?}");
        let what = format!("density of environment '{name}': integral less 1");
        assert_at_most("F11", &what, (e.mean - 1.0).abs(), 3.9 * e.standard_error + 1e-5);
    }
    let what = "radiance of environments: largest error times sine, of the largest texel";
    assert_at_most("F11", what, radiance_error, 1e-5);
}

/// π a + (2π/3) b n_z under radiance a + b w_z: seen with the map as it is and turned; by light
/// samples and without.
#[test]
fn f11_irradiance_of_an_environment_with_a_gradient() {
    const ROWS: u32 = 128;
    let (a, b) = (1.0, 0.5);
    // A row's radiance is that of its centre: filtering flattens the cosine by (π/ROWS)²/8,
    // 8e-5 of b.
    let row = |y: u32| (a + b * (PI * (f64::from(y) + 0.5) / f64::from(ROWS)).cos()) as f32;
    let steep = Mat3::from_rotation_z(0.6_f32.acos());
    let mut worst = 0.0_f64;
    for (turn, cos) in [(Mat3::IDENTITY, 1.0), (steep, 0.6)] {
        for strategy in [Strategy::Mis, Strategy::Bsdf] {
            let scene = under(map(4, ROWS, turn, |_, y| row(y)));
            let settings = RenderSettings { strategy, ..settings(16, 16, 256) };
            let estimate = Estimate::of_pixels(&render(&scene, &settings));
            let truth = f64::from(ALBEDO) * (a + 2.0 / 3.0 * b * cos);
            assert_truth(&format!("{strategy:?}, cos {cos}"), estimate, truth, 0.001);
            worst = worst.max((estimate.mean / truth - 1.0).abs());
        }
    }
    assert_at_most("F11", "irradiance of a + b w_z: largest relative error", worst, 1e-3);
}

/// Irradiance on a surface whose normal is `n` in the map's coordinates, by the midpoints of a
/// grid in angles.
fn irradiance(map: &Environment, n: DVec3) -> f64 {
    const ROWS: usize = 512;
    const COLUMNS: usize = 1024;
    let mut sum = 0.0;
    for i in 0..ROWS {
        let theta = PI * (i as f64 + 0.5) / ROWS as f64;
        for j in 0..COLUMNS {
            let phi = TAU * (j as f64 + 0.5) / COLUMNS as f64 - PI;
            let e = DVec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
            sum += filtered(map, position(map, e)) * n.dot(e).max(0.0) * theta.sin();
        }
    }
    sum * PI * TAU / (ROWS * COLUMNS) as f64
}

/// One bright texel, at the pole and at the equator, where the receiver sees it.
#[test]
fn f11_irradiance_of_one_bright_texel() {
    let mut worst = 0.0_f64;
    for (name, row) in [("pole", 0), ("equator", 8)] {
        let turn = if row == 0 { Mat3::from_rotation_z(0.4) } else { Mat3::from_rotation_z(1.2) };
        let map = map(32, 16, turn, |x, y| if (x, y) == (16, row) { 100.0 } else { 0.0 });
        let n = (turn * Vec3::Y).as_dvec3();
        let truth = f64::from(ALBEDO) / PI * irradiance(&map, n);
        let estimate = Estimate::of_pixels(&render(&under(map), &settings(16, 16, 4096)));
        assert_truth(name, estimate, truth, 1e-3);
        worst = worst.max((estimate.mean / truth - 1.0).abs());
    }
    assert_at_most("F11", "irradiance of one bright texel: largest relative error", worst, 1e-3);
}
