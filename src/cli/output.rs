//! The picture in a file, or one pixel as text.

use super::destination::Picture;
use super::report::Outcome;
use super::talk;
use super::values::{ACCELS, LIGHT_SELECTIONS, SAMPLERS, STRATEGIES, word_for};
use super::{existing, reference, stopping};
use std::fmt::Write;
use std::path::Path;
use steradian::Result;
use steradian::film::Film;
use steradian::image::{
    Attribute, ChannelData, ExrImage, Layer, MapColors, OutputFormat, PngOptions, Precision,
    sample_map, write_exr, write_png,
};

/// Writes the film's picture and what made it.
pub(crate) fn write(picture: &Picture, outcome: &Outcome) -> Result<()> {
    let mut metadata = metadata(outcome);
    metadata.push(existing::request(picture, outcome.job, None));
    match picture.format {
        OutputFormat::Png => {
            let text = metadata.into_iter().map(|(name, value)| (name, as_text(value))).collect();
            let Picture { depth, exposure_ev, tone_curve, .. } = *picture;
            let options = PngOptions { depth, exposure_ev, tone_curve, text };
            write_png(&picture.path, &outcome.film.picture(), &options)
        }
        OutputFormat::Exr => {
            let film = outcome.film;
            let resolution = outcome.job.settings.resolution;
            let mut image = ExrImage::from_crop(&film.picture(), resolution, film.window());
            image.layers.push(noise_layer(film));
            image.metadata = metadata.into_iter().collect();
            write_exr(&picture.path, &image, Precision::Float)
        }
    }
}

/// Writes the map of the samples taken.
pub(crate) fn write_sample_map(path: &Path, colors: MapColors, outcome: &Outcome) -> Result<()> {
    let film = outcome.film;
    let (width, height) = (film.window().width, film.window().height);
    let limit = outcome.job.requested_spp.unwrap_or(film.most_samples());
    let map = sample_map(film.sample_counts(), (width, height), limit, colors);
    write_png(path, &map, &PngOptions::default())
}

/// Sample counts, and where it is known the standard error of the luminance.
fn noise_layer(film: &Film) -> Layer {
    let mut channels = vec![("samples".into(), ChannelData::U32(film.sample_counts().to_vec()))];
    if let Some(error) = film.standard_error() {
        channels.push(("standard_error".into(), ChannelData::F32(error)));
    }
    if let Some(stops) = film.stops() {
        let half_widths = stops.iter().map(|stop| stop.half_width).collect();
        channels.push(("half_width".into(), ChannelData::F32(half_widths)));
        let reasons = stops.iter().map(|stop| stop.reason as u32).collect();
        channels.push(("stop_reason".into(), ChannelData::U32(reasons)));
    }
    Layer { name: "noise".into(), channels }
}

/// What the picture follows from. Nothing in it differs between two runs of the
/// same render, so that their files are equal.
pub(crate) fn metadata(outcome: &Outcome) -> Vec<(String, Attribute)> {
    let settings = &outcome.job.settings;
    let number = |value: u32| Attribute::Number(value.into());
    let text = |value: &str| Attribute::Text(value.into());
    let limit = |value: Option<u32>| value.map_or(text("none"), number);
    // The reference has one way to sample, its own.
    let choice = |of_device: Attribute| match outcome.job.is_reference {
        true => text(reference::WORD),
        false => of_device,
    };
    let entries = [
        ("version", text(env!("CARGO_PKG_VERSION"))),
        ("scene", text(&outcome.job.scene.name)),
        ("scene_hash", text(&format!("{:016x}", outcome.job.scene.content_hash(settings.camera)))),
        ("device", text(outcome.device)),
        ("driver", text(outcome.driver)),
        ("spp", number(outcome.film.least_samples())),
        ("block", number(settings.samples_per_block())),
        ("seed", number(settings.seed)),
        ("strategy", choice(text(word_for(STRATEGIES, &settings.strategy)))),
        ("sampler", choice(text(word_for(SAMPLERS, &settings.sampler)))),
        ("accel", choice(text(word_for(ACCELS, &settings.accel)))),
        ("light_samples", choice(number(settings.light_samples))),
        ("light_selection", choice(text(word_for(LIGHT_SELECTIONS, &settings.light_selection)))),
        ("light_candidates", choice(number(settings.light_candidates))),
        ("max_bounces", limit(settings.max_bounces)),
        ("only_bounce", limit(settings.only_bounce)),
        ("roulette", choice(text(if settings.roulette { "true" } else { "false" }))),
        ("path_reuse", choice(text(if settings.shares_paths() { "true" } else { "false" }))),
        ("camera", text(&outcome.job.scene.cameras[settings.camera].name)),
        ("partial", text(if outcome.is_partial() { "true" } else { "false" })),
    ];
    let mut all: Vec<_> = entries.into();
    if let Some(rule) = settings.stopping_rule() {
        all.push(("stopping", text(&stopping::describe(&rule))));
        all.push(("spp_limit", number(settings.spp)));
        all.push(("most_samples", number(outcome.film.most_samples())));
    }
    // Only a picture that has some is marked.
    let faults: u64 = outcome.statistics.faults.iter().sum();
    if faults > 0 {
        all.push(("faults", text(&faults.to_string())));
    }
    all.into_iter().map(|(name, value)| (format!("steradian.{name}"), value)).collect()
}

pub(crate) fn as_text(value: Attribute) -> String {
    match value {
        Attribute::Text(text) => text,
        Attribute::Number(number) => number.to_string(),
    }
}

/// Prints the only pixel of the film. `position`: column and row in the whole picture.
pub(crate) fn print_pixel((x, y): (u32, u32), outcome: &Outcome) -> Result<()> {
    let [r, g, b] = outcome.film.picture().rgb[0];
    let mut text = String::new();
    let error = match outcome.film.standard_error() {
        Some(error) => format!("{:?}", error[0]),
        None => "unknown".into(),
    };
    // Writing to a string cannot fail. `{:?}` gives the shortest text that reads
    // back as the same number.
    let _ = writeln!(text, "pixel {x} {y}");
    let _ = writeln!(text, "radiance {r:?} {g:?} {b:?}");
    let _ = writeln!(text, "samples {}", outcome.film.least_samples());
    let _ = writeln!(text, "standard_error_of_luminance {error}");
    talk::data(&text)
}
