//! Interfaces of dielectrics.

use super::{Input, definition, run, upward};
use crate::common::{Call, Random, assert_at_most, assert_naive_fails, harness, report};
use glam::{Vec3, Vec4};

/// Ratios of indices: index on the side of incidence over the other.
const ETAS: [f32; 7] = [1.0, 1.0001, 1.5, 2.4, 1.0 / 1.0001, 1.0 / 1.5, 1.0 / 2.4];

/// Of `fresnel.wgsl`: reflectance, cosine, refracted x and z; then over 16 neighbours the
/// disagreements, errors of the squared length and of Snell's law.
fn fresnel(inputs: &[Vec4]) -> Vec<[Vec4; 2]> {
    Call::new(harness!("fresnel"), &[]).run(inputs, 1)
}

fn incident(cosine: f32, eta: f32, step: f32) -> Vec4 {
    let sine = (1.0 - f64::from(cosine).powi(2)).sqrt() as f32;
    Vec4::new(sine, cosine, eta, step)
}

/// The cosine beyond which light is reflected totally; 0 if it never is.
fn critical(eta: f32) -> f64 {
    let eta = f64::from(eta);
    (1.0 - 1.0 / (eta * eta)).max(0.0).sqrt()
}

/// Cosines from grazing to normal, and near the critical one by up to 1e-3 of it.
fn cosines(eta: f32) -> Vec<f32> {
    let mut random = Random(11);
    let mut cosines =
        vec![0.0, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.1, 0.5, 0.9, 1.0, 1.0_f32.next_down()];
    let c = critical(eta);
    cosines.extend([1.0 - 1e-3, 1.0 + 1e-3].map(|k| (c * k) as f32));
    while cosines.len() < 2048 {
        let u = f64::from(random.unit());
        cosines.push(u as f32);
        cosines.push((c * (1.0 + (2.0 * u - 1.0) * 1e-3)) as f32);
    }
    cosines
}

/// The usual form, 1 - eta² sin², in f32.
fn usual_reflectance(cos_i: f32, eta: f32) -> f32 {
    let sin2_t = eta * eta * (1.0 - cos_i * cos_i).max(0.0);
    if sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let s = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let p = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    0.5 * (s * s + p * p)
}

#[test]
fn g6_reflectance_at_grazing_and_at_the_critical_angle() {
    // Errors: near the critical angle, for indices that nearly agree, elsewhere. There some
    // eight roundings of numbers up to 1 are left.
    let mut worst = [0.0_f64; 3];
    let mut usual = [0.0_f64; 3];
    for eta in ETAS {
        let cosines = cosines(eta);
        let inputs: Vec<_> = cosines.iter().map(|&c| incident(c, eta, 0.0)).collect();
        let c = critical(eta);
        for (&cosine, [first, _]) in cosines.iter().zip(fresnel(&inputs)) {
            let reflectance = first.x;
            assert!((0.0..=1.0).contains(&reflectance), "eta {eta}, cos {cosine}: {reflectance}");
            let truth = definition::fresnel(cosine.into(), eta.into()).map_or(1.0, |(f, _)| f);
            // Both polarisations are 0/0 there: the limit along grazing incidence is 1.
            let truth = if cosine == 0.0 { 1.0 } else { truth };
            let is_near = c > 0.0 && (f64::from(cosine) / c - 1.0).abs() <= 1e-2;
            let class = match is_near {
                _ if (0.99..1.01).contains(&eta) => 1,
                true => 0,
                false => 2,
            };
            let error = |f: f32| if f.is_nan() { 1.0 } else { (f64::from(f) - truth).abs() };
            worst[class] = worst[class].max(error(reflectance));
            usual[class] = usual[class].max(error(usual_reflectance(cosine, eta)));
        }
    }
    for (k, (place, limit)) in [
        ("within 1e-2 of critical", 3e-4),
        ("eta 1.0001, 1 and inverse", 3e-4),
        ("elsewhere", 5e-7),
    ]
    .into_iter()
    .enumerate()
    {
        assert_at_most("G6", &format!("reflectance, {place}: largest error"), worst[k], limit);
        report("G6", &format!("reflectance by 1 - eta² sin², {place}: largest error"), usual[k]);
    }
    assert_naive_fails("G6", "reflectance by 1 - eta² sin², eta 1.0001: error", usual[1], 1e-2);
}

#[test]
fn g6_equal_indices_reflect_nothing() {
    let cosines: Vec<f32> = (1..=1024_u16).map(|k| f32::from(k) / 1024.0).collect();
    let inputs: Vec<_> = cosines.iter().map(|&c| incident(c, 1.0, 0.0)).collect();
    for (cosine, [first, _]) in cosines.iter().zip(fresnel(&inputs)) {
        assert_eq!([first.x, first.y], [0.0, *cosine], "{first}");
        assert!((first.w + cosine).abs() <= 2.0 * f32::EPSILON, "{first}");
    }
}

/// 1e7 incident directions next to the critical one and everywhere: a refracted direction
/// exists where the reflectance is below 1, and only there.
#[test]
fn g7_refraction_and_total_reflection_agree() {
    const STEPS: usize = 16;
    const COUNT: usize = 10_000_000 / STEPS / 64 * 64 + 64;
    let mut random = Random(12);
    let mut inputs = Vec::with_capacity(COUNT);
    for k in 0..COUNT {
        let eta = if k % 5 == 0 { 0.4 + 2.0 * random.unit() } else { ETAS[k % ETAS.len()] };
        let c = critical(eta) as f32;
        if k % 2 == 0 && c > 0.0 {
            // Sixteen neighbours, from up to 4096 units in the last place below.
            let below = random.bits() as u32 % 8192;
            let first = f32::from_bits((c.to_bits() + 4096).saturating_sub(below));
            inputs.push(incident(first, eta, 1.0));
        } else {
            inputs.push(incident(random.unit() * 0.999, eta, 64.0));
        }
    }
    let (mut disagreements, mut length, mut snell) = (0.0_f64, 0.0_f64, 0.0_f64);
    for [_, all] in fresnel(&inputs) {
        disagreements += f64::from(all.x);
        length = length.max(f64::from(all.y) / 2.0);
        snell = snell.max(all.z.into());
    }
    let what = format!("reflectance and refraction disagree, of {:.1e}", (COUNT * STEPS) as f64);
    assert_at_most("G7", &what, disagreements, 0.0);
    assert_at_most("G7", "refracted direction: largest error of its length", length, 1e-6);
    assert_at_most("G7", "refracted direction: largest error of its sine", snell, 1e-6);
}

/// The choice of a lobe and the refraction rest on one number: no random number leads through a
/// surface that reflects all light.
#[test]
fn g7_samples_of_glass_refract_where_they_can() {
    let mut random = Random(13);
    let mut inputs = Vec::new();
    for eta in ETAS {
        for cosine in cosines(eta).into_iter().filter(|&c| c >= 1e-4) {
            let x =
                if random.bits().is_multiple_of(2) { 1.0_f32.next_down() } else { random.unit() };
            let u = Vec4::new(x, random.unit(), 0.0, 0.0);
            inputs.push(Input { u, ..Input::glass(eta, cosine) });
        }
    }
    inputs.truncate(inputs.len() / 64 * 64);
    let (mut wrong, mut none) = (0, 0);
    for (input, out) in inputs.iter().zip(run(&inputs)) {
        let total = definition::fresnel(input.wo.z.into(), input.eta.into()).is_none();
        let c = critical(input.eta);
        let is_clear = (f64::from(input.wo.z) / c - 1.0).abs() > 1e-6;
        wrong += u32::from(out.wi.z < 0.0 && total && is_clear);
        wrong +=
            u32::from(!out.weight.is_finite() || (out.wi.as_dvec3().length() - 1.0).abs() > 1e-6);
        none += u32::from(out.pdf == 0.0);
    }
    assert_at_most("G7", "samples of glass that refract or end wrongly", wrong.into(), 0.0);
    assert_at_most("G7", "samples of clear glass without a direction", none.into(), 0.0);
}

/// f(wo, wi) = f(wi, wo) for what reflects; eta² times as much radiance one way as the other for
/// what passes (Veach 1997, section 5.2).
#[test]
fn g5_scattering_is_reciprocal() {
    const COUNT: usize = 100_032;
    let mut random = Random(14);
    let mut pairs = Vec::new();
    for k in 0..COUNT {
        let (wo, wi) = (upward(&mut random), upward(&mut random));
        let (wo, wi) = [wo, wi].map(|w| w.with_z(w.z.max(1e-3)).normalize()).into();
        let alpha = [0.1_f32, 0.3, 1.0][k % 3];
        let base = Input { wo, wi, ..Input::mixed(alpha, 1.0) };
        pairs.extend([base, Input { wo: wi, wi: wo, ..base }]);
    }
    let outputs = run(&pairs);
    let mut worst = 0.0_f64;
    let mut usual = 0.0_f64;
    for (pair, out) in pairs.chunks(2).zip(outputs.chunks(2)) {
        let f = |k: usize| out[k].other_value.as_dvec3() / f64::from(pair[k].wi.z);
        worst = worst.max(((f(0) - f(1)) / f(1)).abs().max_element());
        // The usual shortcut: the coat's Fresnel factor at wo's own cosine.
        let below = |w: Vec3| 1.0 - definition::schlick(0.04, 1.0, w.z.into());
        usual = usual.max((below(pair[0].wo) / below(pair[0].wi) - 1.0).abs());
    }
    assert_at_most("G5", "f(wo, wi) and f(wi, wo), 1e5 pairs: largest difference", worst, 1e-5);
    assert_naive_fails("G5", "coat by Fresnel's factor at wo: largest difference", usual, 0.1);
}

#[test]
fn g5_refraction_is_reciprocal_up_to_eta_squared() {
    let mut random = Random(15);
    let mut inputs = Vec::new();
    for k in 0..4096 {
        let eta = ETAS[k % ETAS.len()];
        let (c, u) = (critical(eta), f64::from(random.unit()));
        let cosine = (1.01 * c + (1.0 - 1.01 * c) * u).max(1e-3) as f32;
        let u = Vec4::new(1.0_f32.next_down(), 0.5, 0.0, 0.0);
        inputs.push(Input { u, ..Input::glass(eta, cosine) });
    }
    let forward = run(&inputs);
    let back: Vec<_> = inputs
        .iter()
        .zip(&forward)
        .map(|(i, o)| Input { wo: -o.wi, eta: 1.0 / i.eta, ..*i })
        .collect();
    let mut worst = 0.0_f64;
    for ((i, there), here) in inputs.iter().zip(&forward).zip(run(&back)) {
        assert!(there.wi.z < 0.0 && here.wi.z < 0.0, "{i:?}");
        // The choice has the probability of transmission: what is left of the weight is eta².
        let ratio = f64::from(there.weight.x) / f64::from(here.weight.x);
        let eta = f64::from(i.eta);
        worst = worst.max((ratio / eta.powi(4) - 1.0).abs());
        worst = worst.max((f64::from(there.eta_scale) / (eta * eta) - 1.0).abs());
        // Rounding of 1/eta turns the direction by its inverse cosine.
        worst = worst.max(((here.wi + i.wo).length() * i.wo.z.min(-there.wi.z)).into());
    }
    assert_at_most("G5", "refraction there and back: largest difference", worst, 1e-5);
}
