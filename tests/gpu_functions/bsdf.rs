//! The GGX lobe's samples and densities, and Fresnel's equations.

use crate::common::Estimate;
use crate::{Random, harness, run};
use glam::{DVec3, Vec3, Vec4};
use steradian::shader::Feature;

type Output = [Vec4; 3];

fn outputs(inputs: &[[Vec4; 3]]) -> Vec<Output> {
    run(harness!("bsdf"), &[Feature::Ggx, Feature::Transmission], inputs, 1)
}

/// A unit vector, uniform over the upper hemisphere.
fn upward(random: &mut Random) -> Vec3 {
    let v = random.direction();
    if v.z > 0.0 { v } else { -v }
}

/// Directions `wo` with this cosine to the normal, or random ones, `alpha`, and random rest.
fn inputs(seed: u64, count: usize, alpha: f32, cos_o: Option<f32>) -> Vec<[Vec4; 3]> {
    let mut random = Random(seed);
    let one = |_| {
        let wo = match cos_o {
            Some(z) => Vec3::new((1.0 - z * z).sqrt(), 0.0, z),
            None => upward(&mut random),
        };
        let wi = upward(&mut random);
        let u = Vec4::new(random.unit(), random.unit(), 0.0, 0.0);
        let eta = 0.4 + 2.1 * random.unit();
        [wo.extend(alpha), wi.extend(eta), u]
    };
    (0..count).map(one).collect()
}

/// A sample's value over its density is the share of light that masking leaves: no more than 1.
#[test]
fn no_ggx_sample_weighs_more_than_one() {
    for alpha in [1e-3_f32, 0.01, 0.1, 0.5, 1.0] {
        let inputs = inputs(7, 1 << 15, alpha, None);
        for (input, [sampled, lobe, _]) in inputs.iter().zip(outputs(&inputs)) {
            let (wi, pdf, weight) = (sampled.truncate(), sampled.w, lobe.x);
            assert!((wi.as_dvec3().length() - 1.0).abs() <= 1e-5, "{input:?}: {wi}");
            if wi.z > 0.0 {
                assert!(pdf > 0.0 && pdf.is_finite(), "{input:?}: {pdf}");
                assert!((0.0..=1.0 + 1e-5).contains(&weight), "{input:?}: {weight}");
            }
        }
    }
}

/// Cells in which directions are counted: 4 in z by 8 in azimuth.
const CELLS: usize = 32;

fn cell(w: DVec3) -> usize {
    let azimuth = (w.y.atan2(w.x) / std::f64::consts::TAU + 0.5) * 8.0;
    (w.z * 4.0).clamp(0.0, 3.0) as usize * 8 + (azimuth as usize).min(7)
}

/// As many samples fall into a cell as the density's integral over it says. The integral
/// is estimated with uniform directions: both have an error.
#[test]
fn ggx_samples_follow_their_density() {
    const COUNT: usize = 1 << 18;
    // 3.9 for one comparison; for some 200 of them, 5.
    const CHANCE: f64 = 5.0;
    for (alpha, cos_o) in [(0.3_f32, 0.9_f32), (0.3, 0.3), (0.6, 0.6), (1.0, 0.1), (1.0, 1.0)] {
        let inputs = inputs(8, COUNT, alpha, Some(cos_o));
        let outputs = outputs(&inputs);
        for k in 0..CELLS {
            let sampled: Vec<f64> = outputs
                .iter()
                .map(|[s, ..]| {
                    let w = s.truncate().as_dvec3();
                    f64::from(u8::from(w.z > 0.0 && cell(w) == k))
                })
                .collect();
            let integral: Vec<f64> = inputs
                .iter()
                .zip(&outputs)
                .map(|([_, wi, _], [_, lobe, _])| {
                    let is_inside = cell(wi.truncate().as_dvec3()) == k;
                    if is_inside { std::f64::consts::TAU * f64::from(lobe.y) } else { 0.0 }
                })
                .collect();
            let (a, b) = (Estimate::of(&sampled), Estimate::of(&integral));
            let s = a.standard_error.hypot(b.standard_error);
            let z = (a.mean - b.mean) / s;
            assert!(
                (a.mean - b.mean).abs() <= CHANCE * s + 1e-5,
                "alpha {alpha}, cos {cos_o}, cell {k}: {} and {}, z = {z}",
                a.mean,
                b.mean
            );
        }
    }
}

/// GGX in f64 by its definition: D (Trowbridge and Reitz 1975), height-correlated G2 and G1
/// (Heitz 2014): value D G2 / (4 cos wo), density D G1 / (4 cos wo).
fn ggx(alpha: f64, wo: DVec3, wi: DVec3) -> (f64, f64) {
    let h = (wo + wi).normalize();
    let lambda = |w: DVec3| {
        let tan2 = (1.0 - w.z * w.z) / (w.z * w.z);
        ((1.0 + alpha * alpha * tan2).sqrt() - 1.0) / 2.0
    };
    let e = h.z * h.z * (alpha * alpha - 1.0) + 1.0;
    let d = alpha * alpha / (std::f64::consts::PI * e * e);
    let value = d / (1.0 + lambda(wo) + lambda(wi)) / (4.0 * wo.z);
    (d / (1.0 + lambda(wo)) / (4.0 * wo.z), value)
}

#[test]
fn ggx_is_its_definition() {
    for alpha in [0.1_f32, 0.5, 1.0] {
        let inputs = inputs(9, 1 << 14, alpha, None);
        for ([wo, wi, _], [_, lobe, _]) in inputs.iter().zip(outputs(&inputs)) {
            let (pdf, value) =
                ggx(alpha.into(), wo.truncate().as_dvec3(), wi.truncate().as_dvec3());
            // D falls by 1/alpha⁴ over an angle of alpha: it magnifies a direction's rounding.
            let tolerance = 1e-6 * (1.0 + 1.0 / f64::from(alpha).powi(2));
            for (device, host) in [(lobe.y, pdf), (lobe.z, value)] {
                let error = (f64::from(device) - host).abs();
                assert!(error <= tolerance * host + 1e-12, "{alpha} {wo} {wi}: {device} {host}");
            }
        }
    }
}

#[test]
fn fresnel_is_exact_on_both_sides_of_the_critical_angle() {
    let inputs = inputs(10, 1 << 16, 1.0, None);
    let mut total = 0;
    for ([wo, wi, _], [_, _, fresnel]) in inputs.iter().zip(outputs(&inputs)) {
        let (cos_i, eta) = (f64::from(wo.z), f64::from(wi.w));
        let sin2_t = eta * eta * (1.0 - cos_i * cos_i);
        // The angle itself is rounded: within a few units of the critical one either is right.
        if (sin2_t - 1.0).abs() <= 1e-6 {
            continue;
        }
        if sin2_t > 1.0 {
            total += 1;
            assert_eq!(fresnel.x, 1.0, "cos {cos_i}, eta {eta}");
            continue;
        }
        let cos_t = (1.0 - sin2_t).sqrt();
        let s = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
        let p = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
        let reflectance = 0.5 * (s * s + p * p);
        // Rounding of sin² by a few 2^-24 changes cos_t by that over cos_t; the reflectance
        // falls with slopes up to 4 eta over the cosine of the incident direction.
        let cos_error = 3e-7 * (1.0 + eta * eta) / cos_t;
        assert!((f64::from(fresnel.y) - cos_t).abs() <= cos_error, "{cos_i} {eta}: {fresnel}");
        let error = (f64::from(fresnel.x) - reflectance).abs();
        let slope = 4.0 * (eta + 1.0 / eta) / cos_i;
        assert!(error <= 1e-6 + slope * cos_error, "{cos_i} {eta}: {fresnel} {reflectance}");
    }
    assert!(total > 1000);
}
