//! Defects planted in a copy of the shaders: the criterion by which scenes of known radiance
//! pass must turn each of them down.

use crate::common::{Estimate, bundled, bundled_truth, settings, with_device};
use steradian::passes::Tuning;
use steradian::statistics::{Criterion, Verdict};
use steradian::{RenderSettings, Renderer};

/// Module, text in it, and the same with a defect where `DEFECT` is true.
type Defect = (&'static str, &'static str, &'static str);

const COSINE: Defect = (
    "bsdf/bsdf",
    "b.diffuse * (r.under * lambert_pdf(wi))",
    "b.diffuse * (r.under * select(lambert_pdf(wi), INV_PI, DEFECT))",
);
const LOBE: Defect = (
    "bsdf/smooth",
    "coat_pdf(b, wo, wi);\n#endif\n    return pdf;",
    "coat_pdf(b, wo, wi);\n#endif\n    return select(1.0, 1.02, DEFECT) * pdf;",
);
const TRIANGLE: Defect = (
    "light/triangle",
    "select(probability * d * d / projected,",
    "select(select(1.0, 1.02, DEFECT) * probability * d * d / projected,",
);
const SPHERE: Defect = (
    "light/sphere",
    "return l.pmf / (2.0 * PI * v.one_minus_cos);",
    "return l.pmf / (select(2.0, 1.96, DEFECT) * PI * v.one_minus_cos);",
);
/// A light sample that is not weighted against what the surface would have found by itself.
const DOUBLE: Defect = (
    "light/direct",
    "(strategy_light_weight(l.pdf, bsdf_pdf(b, wo, wi)) /",
    "(select(strategy_light_weight(l.pdf, bsdf_pdf(b, wo, wi)), 1.0, DEFECT) /",
);

/// In a shader that holds them all, the picture's seed is the index of the one that is there:
/// each scene needs one kernel.
const DEFECTS: [Defect; 5] = [COSINE, LOBE, TRIANGLE, SPHERE, DOUBLE];

/// The verdict on a bundled scene.
fn verdict(scene: &str, defect: Option<Defect>) -> Verdict {
    let mut tuning = Tuning::default();
    for (k, (module, from, to)) in DEFECTS.into_iter().enumerate() {
        let text = tuning.library.get_mut(module).unwrap();
        assert_eq!(text.matches(from).count(), 1, "{module} has changed: {from}");
        let to = to.replace("DEFECT", &format!("frame.seed == {k}u"));
        *text = text.replace(from, &to).into();
    }
    let seed = DEFECTS.iter().position(|d| Some(*d) == defect).unwrap_or(DEFECTS.len());
    let settings =
        RenderSettings { max_bounces: Some(32), seed: seed as u32, ..settings(16, 16, 256) };
    let estimate = with_device(|device| {
        let mut renderer =
            Renderer::with_tuning(device, &bundled(scene), &settings, &tuning).unwrap();
        while renderer.step().unwrap() {}
        renderer.finish().unwrap();
        Estimate::of_pixels(renderer.film())
    });
    let truth = bundled_truth(scene);
    let name = defect.map_or("no defect", |(_, _, to)| to);
    println!("{name}: z = {:.1} of {scene}", estimate.z(truth));
    estimate.judge(truth, &Criterion { visible_bias: 0.01, rounding: 1e-5 })
}

#[test]
fn the_shaders_as_they_are_pass() {
    for scene in ["tests/furnace-sphere", "tests/sphere-light", "tests/quad-light"] {
        assert_eq!(verdict(scene, None), Verdict::Agrees, "{scene}");
    }
}

#[test]
fn a_missing_cosine_is_seen() {
    assert_eq!(verdict("tests/quad-light", Some(COSINE)), Verdict::Differs);
    assert_eq!(verdict("tests/sphere-light", Some(COSINE)), Verdict::Differs);
}

#[test]
fn densities_off_by_two_percent_are_seen() {
    assert_eq!(verdict("tests/furnace-sphere", Some(LOBE)), Verdict::Differs);
    assert_eq!(verdict("tests/quad-light", Some(TRIANGLE)), Verdict::Differs);
    assert_eq!(verdict("tests/sphere-light", Some(SPHERE)), Verdict::Differs);
}

#[test]
fn light_that_counts_twice_is_seen() {
    assert_eq!(verdict("tests/sphere-light", Some(DOUBLE)), Verdict::Differs);
}
