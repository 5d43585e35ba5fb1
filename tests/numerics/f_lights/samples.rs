//! F1, F3, F5: light samples fall where their density says, which integrates to 1.

use super::{densities, draw};
use crate::common::{Estimate, Random, Stage, assert_at_least, assert_at_most, emitter};
use glam::{Affine3A, DVec3, Vec3};
use std::f64::consts::{PI, TAU};
use steradian::scene::{Material, Mesh, Scene};
use steradian::statistics::{FALSE_ALARM, GoodnessOfFit, sidak};

const COUNT: usize = 1 << 15;

/// Cells that a sampler of a square should fill alike: its coordinates, each in [0, 1].
const SIDE: usize = 16;

fn square_cell(x: f64, y: f64) -> usize {
    let at = |x: f64| ((x * SIDE as f64).max(0.0) as usize).min(SIDE - 1);
    at(x) * SIDE + at(y)
}

/// The chi-square test of cells that are equally probable.
fn even(cells: impl Iterator<Item = usize>) -> GoodnessOfFit {
    let mut observed = vec![0; SIDE * SIDE];
    cells.for_each(|k| observed[k] += 1);
    let expected = observed.iter().sum::<u64>() as f64 / (SIDE * SIDE) as f64;
    GoodnessOfFit::of(&observed, &vec![expected; SIDE * SIDE])
}

fn azimuth(v: DVec3) -> f64 {
    let turn = v.y.atan2(v.x) / TAU;
    turn - turn.floor()
}

fn sphere(center: Vec3, radius: f32, double_sided: bool) -> Scene {
    let mut stage = Stage::perspective(Vec3::Z * 5.0, Vec3::ZERO, 1.0);
    stage.sphere(center, radius, Material { double_sided, ..emitter(1.0) });
    stage.scene
}

/// From outside: uniform in the cone. Near the sphere, at ordinary distances, and far.
#[test]
fn f1_samples_of_spheres_from_outside_fill_their_cone() {
    let (radius, ratios) = (0.7_f32, [0.9999_f32, 0.99, 0.9, 0.3, 0.01]);
    let mut least = 1.0_f64;
    for (k, ratio) in ratios.into_iter().enumerate() {
        let place = Vec3::new(0.3, -0.2, 0.7);
        let center = place + (radius / ratio) * Vec3::new(0.6, 0.48, -0.64);
        let scene = sphere(center, radius, false);
        let axis = (center.as_dvec3() - place.as_dvec3()).normalize();
        let (t, b) = axis.any_orthonormal_pair();
        let sin2 = (f64::from(radius) / (center.as_dvec3() - place.as_dvec3()).length()).powi(2);
        let cone = sin2 / (1.0 + (1.0 - sin2).sqrt());
        let drawn = draw(&scene, &vec![place; COUNT], &mut Random(30 + k as u64));
        let cell = |d: &super::Drawn| {
            let wi = d.wi.as_dvec3().normalize();
            // 1 - cos as half the squared chord.
            let height = 0.5 * (wi - axis).length_squared() / cone;
            assert!(d.pdf > 0.0 && height <= 1.0 + 1e-4, "{d:?}");
            square_cell(height, azimuth(DVec3::new(wi.dot(t), wi.dot(b), 0.0)))
        };
        let fit = even(drawn.iter().map(cell));
        println!("r/d {ratio}: {fit}");
        least = least.min(fit.p_value);
    }
    let what = "5 chi-square tests of 32,768 samples of spheres from outside: least p-value";
    assert_at_least("F1", what, least, sidak(FALSE_ALARM, ratios.len()));
}

/// From inside: uniform over the area, with the density d² / (4 π R² cos) per solid angle.
#[test]
fn f3_samples_of_spheres_from_inside_fill_their_area() {
    let mut least = 1.0_f64;
    let mut worst = 0.0_f64;
    let places = [Vec3::ZERO, Vec3::new(0.3, -0.2, 0.09), Vec3::new(0.0, 0.7, -0.7)];
    for (k, offset) in places.into_iter().enumerate() {
        let (center, radius) = (Vec3::new(0.4, 0.1, -0.3), 1.3_f32);
        let place = center + radius * offset;
        let scene = sphere(center, radius, true);
        let drawn = draw(&scene, &vec![place; COUNT], &mut Random(40 + k as u64));
        let (c, r) = (center.as_dvec3() - place.as_dvec3(), f64::from(radius));
        let cell = |d: &super::Drawn| {
            let wi = d.wi.as_dvec3().normalize();
            let along = wi.dot(c);
            let distance = along + (along * along - c.length_squared() + r * r).sqrt();
            let n = (wi * distance - c) / r;
            let cos = n.dot(wi);
            let density = distance * distance / (4.0 * PI * r * r * cos);
            // The cosine at the sphere magnifies the rounding of the direction.
            let units = 16_777_216.0 * cos * cos.min(distance / r);
            worst = worst.max((f64::from(d.pdf) / density - 1.0).abs() * units);
            worst = worst.max((f64::from(d.met_pdf) / density - 1.0).abs() * units);
            square_cell(0.5 - 0.5 * n.z, azimuth(n))
        };
        let fit = even(drawn.iter().map(cell));
        println!("from {offset}: {fit}");
        least = least.min(fit.p_value);
    }
    let what = "3 chi-square tests of 32,768 samples of spheres from inside: least p-value";
    assert_at_least("F3", what, least, sidak(FALSE_ALARM, places.len()));
    let what = "density of spheres from inside: largest error, conditioned units of 2^-24";
    assert_at_most("F3", what, worst, 32.0);
}

const CORNERS: [[f32; 3]; 3] = [[0.2, 1.1, 0.1], [1.4, 0.8, -0.3], [0.3, 1.5, 1.2]];

fn triangle(corners: [[f32; 3]; 3]) -> Scene {
    let mut stage = Stage::perspective(Vec3::Z * 5.0, Vec3::ZERO, 1.0);
    let positions = corners.map(Vec3::from).into();
    let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let mesh = stage.mesh(mesh, Material { double_sided: true, ..emitter(1.0) });
    stage.place(mesh, Affine3A::IDENTITY);
    stage.scene
}

/// Uniform over the area: the 256 like parts of the triangle, as where a ray of the sampled
/// direction meets its plane. Density d² / (A cos).
#[test]
fn f5_samples_of_triangles_fill_their_area() {
    let [a, b, c] = CORNERS.map(|c| Vec3::from(c).as_dvec3());
    let (e1, e2) = (b - a, c - a);
    let n = e1.cross(e2);
    let mut least = 1.0_f64;
    let mut worst = 0.0_f64;
    let places = [Vec3::ZERO, Vec3::new(0.5, 1.0, 0.3), Vec3::new(-30.0, 4.0, 9.0)];
    for (k, place) in places.into_iter().enumerate() {
        let drawn = draw(&triangle(CORNERS), &vec![place; COUNT], &mut Random(50 + k as u64));
        let o = place.as_dvec3();
        let cell = |d: &super::Drawn| {
            let wi = d.wi.as_dvec3().normalize();
            let distance = n.dot(a - o) / n.dot(wi);
            let q = (o + wi * distance - a).cross(e2).dot(n) / n.length_squared();
            let w = e1.cross(o + wi * distance - a).dot(n) / n.length_squared();
            let density = distance * distance / (0.5 * n.dot(wi).abs());
            let cos = (n.dot(wi) / n.length()).abs();
            let extent = f64::from(place.abs().max_element()).max(1.5);
            let units = 16_777_216.0 * cos * distance / (distance + extent);
            worst = worst.max((f64::from(d.pdf) / density - 1.0).abs() * units);
            if d.meets_emitter {
                worst = worst.max((f64::from(d.met_pdf) / density - 1.0).abs() * units);
            }
            // Row by row from the corner a; the upper half of each little square is its own part.
            let (x, y) = (q * SIDE as f64, w * SIDE as f64);
            let is_upper = x.fract() + y.fract() > 1.0;
            let at = |x: f64| (x.max(0.0) as usize).min(SIDE - 1);
            // Parts (i, j) with i + j < SIDE below the diagonals, the rest above them.
            match is_upper && at(x) + at(y) + 2 <= SIDE {
                true => (SIDE - 1 - at(x)) * SIDE + SIDE - 1 - at(y),
                false => at(x) * SIDE + at(y).min(SIDE - 1 - at(x)),
            }
        };
        let fit = even(drawn.iter().map(cell));
        println!("from {place}: {fit}");
        least = least.min(fit.p_value);
    }
    let what = "3 chi-square tests of 32,768 samples of a triangle: least p-value";
    assert_at_least("F5", what, least, sidak(FALSE_ALARM, places.len()));
    let what = "density of a triangle: largest error, conditioned units of 2^-24";
    assert_at_most("F5", what, worst, 32.0);
}

/// Directions within `height` = 1 - cos of an axis, one in each cell of a grid; `solid_angle`
/// is theirs.
fn stratified(axis: DVec3, height: f64, side: usize, random: &mut Random) -> (Vec<Vec3>, f64) {
    let (t, b) = axis.any_orthonormal_pair();
    let mut directions = Vec::with_capacity(side * side);
    for i in 0..side {
        for j in 0..side {
            let h = height * (i as f64 + f64::from(random.unit())) / side as f64;
            let (sin, cos) = (TAU * (j as f64 + f64::from(random.unit())) / side as f64).sin_cos();
            let r = (h * (2.0 - h)).sqrt();
            directions.push((axis * (1.0 - h) + (t * cos + b * sin) * r).as_vec3());
        }
    }
    (directions, TAU * height)
}

/// The density that rays find, over all directions from which they find it.
#[test]
fn f3_densities_of_light_samples_integrate_to_one() {
    const SIDE: usize = 64;
    let origin = Vec3::ZERO;
    let middle = CORNERS.map(|c| Vec3::from(c).as_dvec3()).iter().sum::<DVec3>().normalize();
    let cases = [
        ("triangle", triangle(CORNERS), middle, 0.5),
        ("sphere far", sphere(Vec3::Y * 10.0, 0.5, false), DVec3::Y, 0.002),
        ("sphere near", sphere(Vec3::Y * 1.01, 1.0, false), DVec3::Y, 1.0),
        ("sphere from inside", sphere(Vec3::new(0.3, 0.5, 0.2), 1.0, true), DVec3::Y, 2.0),
    ];
    for (name, scene, axis, height) in &cases {
        let mut random = Random(60);
        let integrals: Vec<f64> = (0..16)
            .map(|_| {
                let (directions, solid_angle) = stratified(*axis, *height, SIDE, &mut random);
                let sum: f64 =
                    densities(scene, origin, &directions).iter().map(|d| f64::from(d.w)).sum();
                sum * solid_angle / directions.len() as f64
            })
            .collect();
        let e = Estimate::of(&integrals);
        assert!(e.standard_error <= 0.02 / 4.0, "{name}: {e:?}");
        let error = (e.mean - 1.0).abs();
        println!("{name}: {e:?}");
        let what = format!("{name}: integral of the density of light samples less 1");
        assert_at_most("F3", &what, error, 3.9 * e.standard_error + 1e-6);
    }
}
