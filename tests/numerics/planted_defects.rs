//! Defects planted in a copy of the shaders: the criterion by which scenes of known radiance
//! pass must turn each of them down.

use crate::common::{Estimate, bundled, bundled_truth, settings, with_device};
use steradian::passes::Tuning;
use steradian::statistics::{Criterion, Verdict};
use steradian::{RenderSettings, Renderer};

/// The verdict on a bundled scene, rendered with `from` in the text of `module` replaced by `to`.
fn verdict_with(scene: &str, (module, from, to): (&str, &str, &str)) -> Verdict {
    let mut tuning = Tuning::default();
    let text = tuning.library.get_mut(module).unwrap();
    assert_eq!(text.matches(from).count(), 1, "{module} has changed: {from}");
    *text = text.replace(from, to).into();
    let settings = RenderSettings { max_bounces: Some(32), ..settings(16, 16, 256) };
    let estimate = with_device(|device| {
        let mut renderer =
            Renderer::with_tuning(device, &bundled(scene), &settings, &tuning).unwrap();
        while renderer.step().unwrap() {}
        renderer.finish().unwrap();
        Estimate::of_pixels(renderer.film())
    });
    let truth = bundled_truth(scene);
    println!("{module}: {to:?}: z = {:.1} of {scene}", estimate.z(truth));
    estimate.judge(truth, &Criterion { visible_bias: 0.01, rounding: 1e-5 })
}

#[test]
fn the_shaders_as_they_are_pass() {
    for scene in ["tests/furnace-sphere", "tests/sphere-light", "tests/quad-light"] {
        let nothing =
            ("path/path", "p.throughput *= scattered.weight;", "p.throughput *= scattered.weight;");
        assert_eq!(verdict_with(scene, nothing), Verdict::Agrees, "{scene}");
    }
}

#[test]
fn a_missing_cosine_is_seen() {
    let defect = (
        "bsdf/bsdf",
        "bsdf_below_coat(b, cos_h) * lambert_pdf(wi)",
        "bsdf_below_coat(b, cos_h) * INV_PI",
    );
    assert_eq!(verdict_with("tests/quad-light", defect), Verdict::Differs);
    assert_eq!(verdict_with("tests/sphere-light", defect), Verdict::Differs);
}

#[test]
fn densities_off_by_two_percent_are_seen() {
    let lobe = ("bsdf/smooth", "    return pdf;", "    return 1.02 * pdf;");
    assert_eq!(verdict_with("tests/furnace-sphere", lobe), Verdict::Differs);
    let light = (
        "light/triangle",
        "select(l.pmf * d2 / projected,",
        "select(1.02 * l.pmf * d2 / projected,",
    );
    assert_eq!(verdict_with("tests/quad-light", light), Verdict::Differs);
    let light = (
        "light/sphere",
        "return l.pmf / (2.0 * PI * v.one_minus_cos);",
        "return l.pmf / (1.96 * PI * v.one_minus_cos);",
    );
    assert_eq!(verdict_with("tests/sphere-light", light), Verdict::Differs);
}

/// A light sample that is not weighted against what the surface would have found by itself.
#[test]
fn light_that_counts_twice_is_seen() {
    let defect = (
        "light/direct",
        "let w = strategy_light_weight(l.pdf, bsdf_pdf(b, wo, wi)) /",
        "let w = 1.0 /",
    );
    assert_eq!(verdict_with("tests/sphere-light", defect), Verdict::Differs);
}
