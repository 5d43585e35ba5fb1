//! G3: samples of whole BSDFs, lobes chosen at random, against the density of the mixture.

use super::{Input, definition, run, upward};
use crate::common::{Random, assert_at_least, assert_at_most};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use steradian::statistics::{DirectionGrid, FALSE_ALARM, GoodnessOfFit, sidak};

fn luminance(c: Vec3) -> f64 {
    c.as_dvec3().dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// Probabilities of the Lambert, the specular and the transmitting lobe.
fn lobes(b: &Input) -> [f64; 3] {
    let cos_o = f64::from(b.wo.z);
    let schlick = |f0: f32, f90: f32| definition::schlick(f0.into(), f90.into(), cos_o);
    let specular =
        Vec3::from(b.specular_f0.to_array().map(|f0| schlick(f0, b.specular_f90) as f32));
    let mut diffuse = luminance(b.diffuse) * (1.0 - schlick(b.diffuse_f0, b.diffuse_f90));
    let [mut specular, mut transmitted] = [luminance(specular), 0.0];
    if b.transmitted.max_element() > 0.0 {
        let f = definition::fresnel(cos_o, b.eta.into()).map_or(1.0, |(f, _)| f);
        (specular, transmitted) = (f, luminance(b.transmitted) * (1.0 - f));
        let under =
            |cosine: f64| 1.0 - definition::fresnel(cosine, b.eta.into()).map_or(1.0, |(f, _)| f);
        diffuse = luminance(b.diffuse) * 0.5 * (under(1.0) + under((0.5 + 0.5 * cos_o).sqrt()));
    }
    let sum = diffuse + specular + transmitted;
    [diffuse / sum, specular / sum, transmitted / sum]
}

/// Density of wi above the surface, per steradian.
fn pdf(b: &Input, [diffuse, specular, _]: [f64; 3], wi: DVec3) -> f64 {
    if wi.z <= 0.0 {
        return 0.0;
    }
    let ggx = || definition::ggx_pdf(b.alpha.into(), b.wo.as_dvec3(), wi);
    diffuse * wi.z / PI + if b.alpha > 0.0 { specular * ggx() } else { 0.0 }
}

/// Reflected radiance for unit radiance from wi, times its cosine.
fn value(b: &Input, wi: DVec3) -> DVec3 {
    let wo = b.wo.as_dvec3();
    let cos_h = wo.dot((wo + wi).normalize());
    let schlick = |f0: f64, f90: f32| definition::schlick(f0, f90.into(), cos_h);
    let below = 1.0 - schlick(b.diffuse_f0.into(), b.diffuse_f90);
    let specular = b.specular_f0.as_dvec3().to_array().map(|f0| schlick(f0, b.specular_f90));
    let ggx = definition::ggx_value(b.alpha.into(), wo, wi);
    b.diffuse.as_dvec3() * (below * wi.z / PI) + DVec3::from(specular) * ggx
}

#[test]
fn g3_samples_of_mixed_lobes_follow_their_density() {
    const COUNT: usize = 1 << 16;
    let cases: Vec<(f32, f32)> =
        [0.1, 0.3, 1.0].into_iter().flat_map(|a| [1.0, 0.5, 0.1].map(|c| (a, c))).collect();
    let mut least = 1.0_f64;
    for (k, &(alpha, cos_o)) in cases.iter().enumerate() {
        let b = Input::mixed(alpha, cos_o);
        let outputs = run(&b.sampled(COUNT, &mut Random(400 + k as u64)));
        let draws = outputs.iter().map(|o| (o.pdf != 0.0).then(|| o.wi.as_dvec3().to_array()));
        let lobes = lobes(&b);
        let grid = DirectionGrid::hemisphere([0.0, 0.0, 1.0], 16, 32);
        let fit = grid.test(draws, |wi| pdf(&b, lobes, wi.into()));
        println!("alpha {alpha}, cos {cos_o}: {fit}");
        least = least.min(fit.p_value);
    }
    let what = "9 chi-square tests of 65,536 samples of metal, coat and base: least p-value";
    assert_at_least("G3", what, least, sidak(FALSE_ALARM, cases.len()));
}

/// Lobes without a density are chosen as often as they should be: a mirror over a Lambert base,
/// clear glass from both sides, and coloured glass over a base.
#[test]
fn g3_lobes_are_chosen_by_their_probability() {
    const COUNT: usize = 1 << 16;
    let lacquer = |cos_o| Input::mixed(0.0, cos_o);
    let stained = |cos_o| Input {
        diffuse: Vec3::splat(0.3),
        transmitted: Vec3::new(0.6, 0.2, 0.4),
        ..Input::glass(1.0 / 1.5, cos_o)
    };
    let cases = [
        lacquer(0.9),
        lacquer(0.1),
        Input::glass(1.5, 0.9),
        Input::glass(1.0 / 1.5, 0.3),
        Input::glass(1.0 / 1.5, 0.01),
        stained(0.5),
    ];
    let mut least = 1.0_f64;
    for (k, b) in cases.iter().enumerate() {
        let mut observed = [0, 0, 0, 0];
        for out in run(&b.sampled(COUNT, &mut Random(500 + k as u64))) {
            let is_delta = out.pdf < 0.0;
            let lobe = match (is_delta, out.wi.z > 0.0) {
                (false, true) => 0,
                (true, true) => 1,
                (true, false) => 2,
                (false, false) => 3,
            };
            observed[lobe] += 1;
        }
        let [diffuse, specular, transmitted] = lobes(b).map(|p| p * COUNT as f64);
        let fit = GoodnessOfFit::of(&observed, &[diffuse, specular, transmitted, 0.0]);
        println!("case {k}: {fit}");
        least = least.min(fit.p_value);
    }
    let what = "6 chi-square tests of 65,536 choices of lobes: least p-value";
    assert_at_least("G3", what, least, sidak(FALSE_ALARM, cases.len()));
}

/// What a sample weighs is its value over its density, and both are the mixture's.
#[test]
fn g3_mixed_lobes_are_their_definition() {
    const COUNT: usize = 1 << 14;
    let mut random = Random(6);
    let mut inputs = Vec::new();
    for k in 0..COUNT {
        let b = Input::mixed([0.1, 0.3, 1.0][k % 3], 1.0);
        inputs.push(Input { wo: upward(&mut random), wi: upward(&mut random), ..b });
    }
    let mut worst = 0.0_f64;
    for (b, out) in inputs.iter().zip(run(&inputs)) {
        let (wo, wi) = (b.wo.as_dvec3(), b.wi.as_dvec3());
        let units = (1.0 + 2.0 / f64::from(b.alpha)) / (wo + wi).length().min(1.0) / 16_777_216.0;
        let density = pdf(b, lobes(b), wi);
        worst = worst.max((f64::from(out.other_pdf) / density - 1.0).abs() / units);
        let error = out.other_value.as_dvec3() / value(b, wi) - 1.0;
        worst = worst.max(error.abs().max_element() / units);
    }
    let what = "density and value of mixed lobes: largest error, conditioned units of 2^-24";
    assert_at_most("G3", what, worst, 16.0);
}
