//! Samples of GGX alone: as many as there should be in every direction, none too heavy, and
//! densities as defined.

use super::frames::parts;
use super::{Input, definition, run, upward};
use crate::common::{Random, assert_at_least, assert_at_most, assert_naive_fails, report};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;
use steradian::statistics::{FALSE_ALARM, GoodnessOfFit, sidak};

const ALPHAS: [f32; 6] = [1e-3, 0.01, 0.1, 0.3, 0.5, 1.0];
const COSINES: [f32; 6] = [1.0, 0.7, 0.3, 0.1, 0.02, 1e-4];

/// Cells over microfacet normals, stretched by 1/alpha so that the lobe fills the hemisphere:
/// rows of equal solid angle by columns of azimuth.
const ROWS: usize = 16;
const COLUMNS: usize = 32;

/// The same unit vector with its largest component found from the others: in f32 that one has
/// the largest rounding, and near grazing it hides the half vector.
fn unit(v: Vec3) -> DVec3 {
    let mut v = v.as_dvec3();
    let a = v.abs();
    let k = if a.x >= a.y && a.x >= a.z {
        0
    } else if a.y >= a.z {
        1
    } else {
        2
    };
    let rest = v.length_squared() - v[k] * v[k];
    v[k] = (1.0 - rest).max(0.0).sqrt().copysign(v[k]);
    v
}

fn cell(alpha: f64, wo: DVec3, wi: DVec3) -> Option<usize> {
    let h = wo + wi;
    let n = DVec3::new(h.x / alpha, h.y / alpha, h.z).normalize();
    if n.z.is_nan() || n.z < 0.0 {
        return None;
    }
    let row = ((n.z * ROWS as f64) as usize).min(ROWS - 1);
    let turn = n.y.atan2(n.x) / TAU;
    let column = ((turn - turn.floor()) * COLUMNS as f64) as usize;
    Some(row * COLUMNS + column.min(COLUMNS - 1))
}

/// Integral of the density of visible normals over every cell, by `steps` midpoints along each
/// of its sides. The density ends at the horizon of the visible normals with an edge, where the
/// midpoints' error must stay below the noise of the counts.
fn probabilities(alpha: f64, wo: DVec3, steps: usize) -> Vec<f64> {
    let mut cells = vec![0.0; ROWS * COLUMNS];
    let (rows, columns) = (ROWS * steps, COLUMNS * steps);
    let solid_angle = TAU / (rows * columns) as f64;
    for i in 0..rows {
        let z = (i as f64 + 0.5) / rows as f64;
        let r = (1.0 - z * z).sqrt();
        for j in 0..columns {
            let (sin, cos) = (TAU * (j as f64 + 0.5) / columns as f64).sin_cos();
            let h = DVec3::new(alpha * r * cos, alpha * r * sin, z);
            // A solid angle around the stretched normal is one of alpha² / |h|³ around h.
            let density =
                definition::visible(alpha, wo, h.normalize()) * alpha * alpha / h.length().powi(3);
            cells[i / steps * COLUMNS + j / steps] += density * solid_angle;
        }
    }
    // Cells that the horizon of the visible normals only just reaches are not impossible.
    let v = DVec3::new(alpha * wo.x, alpha * wo.y, wo.z);
    for (k, p) in cells.iter_mut().enumerate().filter(|(_, p)| **p == 0.0) {
        let is_reached = (0..=steps).any(|i| {
            (0..=steps).any(|j| {
                let at = |k: usize, i: usize| (k * steps + i) as f64 / steps as f64;
                let z = at(k / COLUMNS, i) / ROWS as f64;
                let (sin, cos) = (TAU * at(k % COLUMNS, j) / COLUMNS as f64).sin_cos();
                let r = (1.0 - z * z).sqrt();
                v.dot(DVec3::new(r * cos, r * sin, z)) > 0.0
            })
        });
        *p = if is_reached { f64::MIN_POSITIVE } else { 0.0 };
    }
    cells
}

/// The chi-square test of `count` samples in each of the 36 cases; the least p-value.
fn least_p_value(count: usize, steps: usize) -> f64 {
    let mut least = 1.0_f64;
    for (case, alpha, cos_o) in cases() {
        let mut random = Random(100 + case);
        let wo = Input::black(cos_o).wo;
        let inputs: Vec<_> =
            (0..count).map(|_| (wo, alpha, [random.unit(), random.unit()])).collect();
        let alpha = f64::from(alpha);
        let wo = unit(wo);
        let mut observed = vec![0; ROWS * COLUMNS];
        for out in parts(&inputs) {
            let cell = cell(alpha, wo, unit(out.reflected));
            observed[cell.unwrap_or_else(|| panic!("{alpha} {cos_o}: {}", out.reflected))] += 1;
        }
        let expected: Vec<f64> =
            probabilities(alpha, wo, steps).iter().map(|p| p * count as f64).collect();
        let fit = GoodnessOfFit::of(&observed, &expected);
        println!("alpha {alpha}, cos {cos_o}: {fit}");
        least = least.min(fit.p_value);
    }
    least
}

fn cases() -> impl Iterator<Item = (u64, f32, f32)> {
    let all = ALPHAS.into_iter().flat_map(|a| COSINES.map(|c| (a, c)));
    (0..).zip(all).map(|(k, (a, c))| (k, a, c))
}

#[test]
fn g3_ggx_samples_follow_the_visible_normals() {
    let p = least_p_value(1 << 16, 12);
    let what = "36 chi-square tests of 65,536 samples, alpha 1e-3..1, cos 1..1e-4: least p-value";
    assert_at_least("G3", what, p, sidak(FALSE_ALARM, 36));
}

#[test]
#[ignore = "tier N: about 1 minute"]
fn g3_a_million_ggx_samples_follow_the_visible_normals() {
    let p = least_p_value(1 << 20, 64);
    let what = "36 chi-square tests of 2^20 samples, alpha 1e-3..1, cos 1..1e-4: least p-value";
    assert_at_least("G3", what, p, sidak(FALSE_ALARM, 36));
}

/// The weight of a sample is the share of its light that masking leaves. As value over density
/// with the textbook's D it is Inf/Inf for small alpha.
#[test]
fn g3_no_ggx_sample_weighs_more_than_one() {
    const COUNT: usize = 1 << 14;
    let (mut most, mut worst_length) = (0.0_f64, 0.0_f64);
    for (case, alpha, cos_o) in cases() {
        let inputs = Input::white_metal(alpha, cos_o).sampled(COUNT, &mut Random(200 + case));
        for out in run(&inputs) {
            if out.pdf == 0.0 {
                assert_eq!(out.weight, Vec3::ZERO);
                continue;
            }
            assert!(out.pdf > 0.0 && out.pdf.is_finite() && out.weight.is_finite(), "{out:?}");
            assert!(out.wi.z > 0.0 && out.weight.min_element() >= 0.0, "{out:?}");
            most = most.max(out.weight.max_element().into());
            worst_length = worst_length.max((out.wi.as_dvec3().length() - 1.0).abs());
        }
    }
    assert_at_most("G3", "GGX samples: largest weight less 1", most - 1.0, 1e-6);
    assert_at_most("G3", "GGX samples: largest error of a direction's length", worst_length, 1e-6);

    let inputs = Input::white_metal(1e-4, 0.7).sampled(COUNT, &mut Random(7));
    let is_lost = |(input, out): &(&Input, super::Output)| {
        out.pdf > 0.0 && !value_over_density(input.alpha, input.wo, out.wi).is_finite()
    };
    let lost = inputs.iter().zip(run(&inputs)).filter(is_lost).count();
    let what = "weights as f cos / pdf, alpha 1e-4, of 16,384: not finite";
    assert_naive_fails("G3", what, lost as f64, 100.0);
}

/// f cos / pdf in f32 with the textbook's forms of D, G1 and G2.
fn value_over_density(alpha: f32, wo: Vec3, wi: Vec3) -> f32 {
    let h = (wo + wi).normalize();
    let a2 = alpha * alpha;
    let e = h.z * h.z * (a2 - 1.0) + 1.0;
    let d = a2 / (std::f32::consts::PI * e * e);
    let lambda = |w: Vec3| {
        let tan2 = (1.0 - w.z * w.z) / (w.z * w.z);
        ((1.0 + a2 * tan2).sqrt() - 1.0) / 2.0
    };
    let f = d / (1.0 + lambda(wo) + lambda(wi)) / (4.0 * wo.z * wi.z);
    let pdf = d / (1.0 + lambda(wo)) * wo.dot(h) / wo.z / (4.0 * wo.dot(h));
    f * wi.z / pdf
}

/// Density and value for unrelated directions. D magnifies the rounding of the half vector by up
/// to 2/alpha, and rounding of wo + wi by its inverse length.
#[test]
fn g3_ggx_is_its_definition() {
    const COUNT: usize = 1 << 14;
    let mut worst = 0.0_f64;
    for alpha in [0.03_f32, 0.1, 0.3, 0.5, 1.0] {
        let mut random = Random(5);
        let mut input = |_| {
            let (wo, wi) = (upward(&mut random), upward(&mut random));
            Input { wo, wi, ..Input::white_metal(alpha, 1.0) }
        };
        let inputs: Vec<_> = (0..COUNT).map(&mut input).collect();
        for (input, out) in inputs.iter().zip(run(&inputs)) {
            let (wo, wi) = (input.wo.as_dvec3(), input.wi.as_dvec3());
            let pdf = definition::ggx_pdf(alpha.into(), wo, wi);
            let value = definition::ggx_value(alpha.into(), wo, wi);
            let units = (1.0 + 2.0 / f64::from(alpha)) / (wo + wi).length().min(1.0) / 16_777_216.0;
            for (device, host) in [(out.other_pdf, pdf), (out.other_value.x, value)] {
                worst = worst.max((f64::from(device) / host - 1.0).abs() / units);
            }
        }
    }
    let what = "GGX's density and value: largest error, conditioned units of 2^-24";
    assert_at_most("G3", what, worst, 16.0);
}

/// What the f32 half vector costs the density where samples fall: told, not judged. Value and
/// density share the error, so a sample's weight does not have it.
#[test]
fn g3_error_of_the_density_at_samples() {
    const COUNT: usize = 1 << 13;
    for alpha in ALPHAS {
        let mut errors = Vec::new();
        for cos_o in [1.0_f32, 0.3, 0.02] {
            let inputs = Input::white_metal(alpha, cos_o).sampled(COUNT, &mut Random(300));
            for (input, out) in inputs.iter().zip(run(&inputs)) {
                if out.pdf > 0.0 {
                    let host = definition::ggx_pdf(alpha.into(), unit(input.wo), unit(out.wi));
                    errors.push((f64::from(out.pdf) / host - 1.0).abs());
                }
            }
        }
        errors.sort_by(f64::total_cmp);
        let what = format!("GGX density at samples, alpha {alpha}: 99th percentile of the error");
        report("G3", &what, errors[errors.len() * 99 / 100]);
        // A lobe of width 1e-3 is still resolved.
        assert!(errors[errors.len() / 2] < 1e-2, "alpha {alpha}");
    }
}
