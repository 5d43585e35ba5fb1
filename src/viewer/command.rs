//! What the window shows as a command line that renders it.

use super::wish::{SceneInfo, Wish};
use crate::cli::job::default_block_size;
use crate::cli::stopping::PRESETS;
use crate::cli::values::{
    ACCELS, LIGHT_SELECTIONS, SAMPLERS, STRATEGIES, TONE_CURVES, VIEWS, word_for,
};
use steradian::image::ToneCurve;
use steradian::scene::Camera;
use steradian::settings::{Accel, LightSelection, Sampler, Strategy};
use steradian::stopping::StoppingRule;
use steradian::view::Source;

/// The command, for a shell; `output` is the picture's name.
pub(super) fn render(info: &SceneInfo, wish: &Wish, output: &str) -> String {
    let words = arguments(info, wish, output);
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

/// A camera as `--camera` takes it.
pub(super) fn camera(camera: &Camera) -> String {
    // In one line; the numbers keep all their digits.
    let json = camera.to_json();
    json.lines().map(str::trim).collect::<Vec<_>>().join(" ")
}

/// The same, word by word. What has its default is left out.
fn arguments(info: &SceneInfo, wish: &Wish, output: &str) -> Vec<String> {
    let s = &wish.settings;
    let mut words: Vec<String> = ["steradian", "render"].map(String::from).into();
    words.push(info.path.display().to_string());
    let mut flag = |name: &str, value: String| words.extend([name.to_owned(), value]);
    flag("-o", output.into());
    flag("--resolution", format!("{}x{}", s.resolution.0, s.resolution.1));
    if let Some(c) = s.crop {
        flag("--crop", format!("{},{},{},{}", c.x, c.y, c.width, c.height));
    }
    let is_of_hits = wish.view.is_some_and(|view| view.source() == Source::FirstHits);
    if !is_of_hits {
        flag("--spp", s.spp.to_string());
    }
    match s.stopping_rule().filter(|_| !is_of_hits) {
        Some(StoppingRule::Calibrated(rule)) => {
            flag("--noise", rule.tolerance.to_string());
            flag("--confidence", rule.confidence.to_string());
            flag("--preset", word_for(PRESETS, &rule.preset).into());
        }
        Some(StoppingRule::Seed(rule)) => {
            flag("--adaptive", format!("seed:{},{}", rule.batch, rule.tolerance));
        }
        None if is_of_hits => {}
        None if s.block_size != default_block_size(Some(s.spp)) => {
            flag("--block", s.block_size.to_string());
        }
        None => {}
    }
    if s.seed != 0 {
        flag("--seed", s.seed.to_string());
    }
    if s.strategy != Strategy::Mis {
        flag("--strategy", word_for(STRATEGIES, &s.strategy).into());
    }
    if s.light_samples != 1 {
        flag("--light-samples", s.light_samples.to_string());
    }
    if s.light_selection != LightSelection::Tree {
        flag("--light-selection", word_for(LIGHT_SELECTIONS, &s.light_selection).into());
    }
    if s.light_candidates != 2 {
        flag("--light-candidates", s.light_candidates.to_string());
    }
    if let Some(n) = s.max_bounces {
        flag("--max-bounces", n.to_string());
    }
    if let Some(n) = s.only_bounce {
        flag("--only-bounce", n.to_string());
    }
    if s.sampler != Sampler::Sobol {
        flag("--sampler", word_for(SAMPLERS, &s.sampler).into());
    }
    if s.accel != Accel::Bvh {
        flag("--accel", word_for(ACCELS, &s.accel).into());
    }
    if s.all_features {
        flag("--features", "all".into());
    }
    // The file's own camera by its index, any other whole.
    let is_of_file = info.cameras[..info.own_camera_count].get(wish.base) == Some(&wish.camera);
    if !is_of_file || info.has_lens_flags {
        flag("--camera", camera(&wish.camera));
    } else if wish.base != 0 {
        flag("--camera", wish.base.to_string());
    }
    for (name, value) in ["--frame-time", "--animation"].into_iter().zip(&info.animation) {
        if let Some(value) = value {
            flag(name, value.clone());
        }
    }
    let e = &wish.environment;
    if let Some(path) = &e.environment {
        flag("--environment", path.display().to_string());
    }
    if let Some(r) = e.environment_radiance {
        flag("--environment-radiance", format!("{},{},{}", r.x, r.y, r.z));
    }
    if let Some(degrees) = e.environment_rotation {
        flag("--environment-rotation", degrees.to_string());
    }
    if let Some(intensity) = e.environment_intensity {
        flag("--environment-intensity", intensity.to_string());
    }
    if let Some(width) = e.max_environment_size {
        flag("--max-environment-size", width.to_string());
    }
    if let Some(view) = wish.view {
        flag("--view", word_for(VIEWS, &view).into());
    }
    let is_png = !output.ends_with(".exr") && wish.view.is_none();
    if wish.display.exposure_ev != 0.0 && is_png {
        flag("--exposure", wish.display.exposure_ev.to_string());
    }
    if wish.display.tone_curve != ToneCurve::None && is_png {
        flag("--tone-map", word_for(TONE_CURVES, &wish.display.tone_curve).into());
    }
    if !s.roulette {
        words.push("--no-roulette".into());
    }
    if s.energy_compensation {
        words.push("--energy-compensation".into());
    }
    words
}

/// A word for a POSIX shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,=%+@".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}
