//! Samples against densities, densities against values, over the whole sphere.

use super::{Input, list, plain, run, scene_of};
use crate::common::{Random, assert_at_least, assert_at_most};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;
use steradian::RenderSettings;
use steradian::scene::Scene;
use steradian::settings::Strategy;
use steradian::statistics::{FALSE_ALARM, GoodnessOfFit, sidak};

/// Cells of the sphere: bands of equal solid angle by columns of azimuth; the horizon is an edge.
const ROWS: usize = 32;
const COLUMNS: usize = 24;
/// Midpoints along a cell's side.
const STEPS: usize = 8;
const COUNT: usize = 1 << 15;

fn cell(wi: Vec3) -> usize {
    let row = (0.5 * (1.0 - f64::from(wi.z)) * ROWS as f64) as usize;
    let turn = f64::from(wi.y).atan2(f64::from(wi.x)) / TAU;
    let column = ((turn - turn.floor()) * COLUMNS as f64) as usize;
    row.min(ROWS - 1) * COLUMNS + column.min(COLUMNS - 1)
}

/// Integrals of the device's density over the cells.
fn probabilities(scene: &Scene, settings: &RenderSettings, seen: Input) -> Vec<f64> {
    let (rows, columns) = (ROWS * STEPS, COLUMNS * STEPS);
    let mut inputs = Vec::with_capacity(rows * columns);
    for i in 0..rows {
        let z = 1.0 - 2.0 * (i as f64 + 0.5) / rows as f64;
        let r = (1.0 - z * z).sqrt();
        for j in 0..columns {
            let (sin, cos) = (TAU * (j as f64 + 0.5) / columns as f64).sin_cos();
            inputs.push(Input { wi: DVec3::new(r * cos, r * sin, z).as_vec3(), ..seen });
        }
    }
    let solid_angle = 2.0 * TAU / (rows * columns) as f64;
    let mut cells = vec![0.0; ROWS * COLUMNS];
    for (k, out) in run(scene, settings, &inputs).iter().enumerate() {
        let (i, j) = (k / columns, k % columns);
        cells[i / STEPS * COLUMNS + j / STEPS] += f64::from(out.other_pdf) * solid_angle;
    }
    cells
}

/// The least p-value over all materials, sides and two angles; what no cell has is the
/// probability of no sample or of one without a density.
fn least_p_value(settings: &RenderSettings) -> (f64, usize) {
    let all = list::all();
    let scene = scene_of(&list::materials());
    let (mut least, mut tests) = (1.0_f64, 0);
    for (k, (name, _, _)) in all.iter().enumerate() {
        for (side, is_front) in [true, false].into_iter().enumerate() {
            for (a, cos_o) in [0.9_f32, 0.35].into_iter().enumerate() {
                let tilt = Vec3::new(0.2, -0.1, 1.0).normalize();
                let seen = Input { normal: tilt, ..Input::new(k, is_front, cos_o) };
                let mut random = Random(1000 + (k * 4 + side * 2 + a) as u64);
                let mut observed = vec![0; ROWS * COLUMNS + 1];
                for out in run(&scene, settings, &seen.sampled(COUNT, &mut random)) {
                    let at = if out.pdf > 0.0 { cell(out.wi) } else { ROWS * COLUMNS };
                    observed[at] += 1;
                }
                let mut expected = probabilities(&scene, settings, seen);
                let covered: f64 = expected.iter().sum();
                assert!(covered <= 1.0 + 2e-3, "{name}: the density integrates to {covered}");
                expected.push((1.0 - covered).max(0.0));
                expected.iter_mut().for_each(|e| *e *= COUNT as f64);
                // A remainder smaller than the quadrature's error is no remainder.
                if expected[ROWS * COLUMNS] < 2e-3 * COUNT as f64 && observed[ROWS * COLUMNS] == 0 {
                    expected.pop();
                    observed.pop();
                }
                let fit = GoodnessOfFit::of(&observed, &expected);
                println!("{name}, front {is_front}, cos {cos_o}: covered {covered:.4}, {fit}");
                least = least.min(fit.p_value);
                tests += 1;
            }
        }
    }
    (least, tests)
}

#[test]
fn g3_samples_of_every_lobe_follow_their_density() {
    let (p, tests) = least_p_value(&RenderSettings { strategy: Strategy::Bsdf, ..plain() });
    let what = format!(
        "{tests} chi-square tests of 32,768 samples of extensions' lobes over the sphere: least p-value"
    );
    assert_at_least("G3", &what, p, sidak(FALSE_ALARM, tests));
}

#[test]
fn g3_uniform_samples_cover_every_lobe() {
    let (p, tests) = least_p_value(&RenderSettings { strategy: Strategy::Hemisphere, ..plain() });
    let what = format!("{tests} chi-square tests of the strategy hemisphere: least p-value");
    assert_at_least("G3", &what, p, sidak(FALSE_ALARM, tests));
}

/// Where a sample has a density, its weight is value over density, for the same directions asked
/// again, and it is bounded.
#[test]
fn g3_weights_are_value_over_density() {
    let all = list::all();
    let scene = scene_of(&list::materials());
    let (mut worst, mut heaviest) = (0.0_f64, 0.0_f64);
    for (k, (name, _, _)) in all.iter().enumerate() {
        let mut heaviest_here = 0.0_f64;
        for (is_front, cos_o) in
            [(true, 0.99_f32), (true, 0.5), (true, 0.05), (false, 0.7), (false, 0.1)]
        {
            let mut random = Random(7000 + k as u64);
            let seen = Input::new(k, is_front, cos_o).sampled(1 << 13, &mut random);
            let outputs = run(&scene, &plain(), &seen);
            let again: Vec<Input> =
                seen.iter().zip(&outputs).map(|(i, o)| Input { wi: o.wi, ..*i }).collect();
            for (out, other) in outputs.iter().zip(run(&scene, &plain(), &again)) {
                heaviest_here = heaviest_here.max(f64::from(out.share().max_element()));
                assert!((0.0..1.0).contains(&out.choice), "{name}: {out:?}");
                if out.pdf > 0.0 {
                    assert_eq!(out.pdf, other.other_pdf, "{name}");
                    let value = out.weight.as_dvec3() * f64::from(out.pdf);
                    let error = (value - other.other_value.as_dvec3()).abs().max_element();
                    worst = worst.max(error / value.max_element().max(1e-20));
                }
            }
        }
        println!("{name}: heaviest {heaviest_here:.3}");
        heaviest = heaviest.max(heaviest_here);
    }
    assert_at_most(
        "G3",
        "weight of a sample against value over density: largest error",
        worst,
        1e-6,
    );
    // Fine velvet alone weighs more than 4: its lobe is thin, and drawn from the whole hemisphere.
    assert_at_most("G3", "samples of extensions' lobes: largest weight", heaviest, 40.0);
}
