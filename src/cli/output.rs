//! The picture in a file, or one pixel as text.

use super::destination::Picture;
use super::picture_layers::{deliver, denoised_path};
use super::report::Outcome;
use super::talk;
use super::values::{ACCELS, LIGHT_SELECTIONS, SAMPLERS, STRATEGIES, word_for};
use super::{existing, exr_file, reference, stopping};
use std::fmt::Write;
use std::path::Path;
use steradian::Result;
use steradian::film::Film;
use steradian::image::{
    self, Attribute, Layer, MapColors, OutputFormat, PngOptions, sample_map, write_png,
};
use steradian::settings::Crop;

/// Writes the film's picture and what made it.
pub(crate) fn write(picture: &Picture, outcome: &Outcome) -> Result<()> {
    let (layers, window) = (outcome.layers, outcome.film.window());
    let traced = |band| layers.map_or(Ok(Vec::new()), |layers| layers.trace(band));
    let denoised = |noisy: &_| layers.map_or(Ok(None), |layers| layers.denoised(noisy, window));
    let mut metadata = metadata(outcome);
    metadata.push(existing::request(picture, outcome.job, None));
    let developed = Developed {
        film: outcome.film,
        resolution: outcome.job.settings.resolution,
        metadata,
        exr_metadata: exr_file::metadata(outcome),
        render_seconds: outcome.statistics.render_seconds,
        traced: &traced,
        denoised: &denoised,
    };
    developed.write(picture)?;
    layers.inspect(|layers| layers.warn());
    Ok(())
}

/// A film with all that its file says.
pub(super) struct Developed<'a> {
    pub(super) film: &'a Film,
    /// Of the whole picture.
    pub(super) resolution: (u32, u32),
    /// For files of any format.
    pub(super) metadata: Vec<(String, Attribute)>,
    /// For an EXR beside it.
    pub(super) exr_metadata: Vec<(String, Attribute)>,
    pub(super) render_seconds: f64,
    /// Layers of a band of the picture that camera rays tell of.
    pub(super) traced: &'a dyn Fn(Crop) -> Result<Vec<Layer>>,
    /// A picture without its noise, if that is asked for.
    pub(super) denoised: &'a dyn Fn(&image::Picture) -> Result<Option<image::Picture>>,
}

impl Developed<'_> {
    /// Writes the picture.
    pub(super) fn write(&self, picture: &Picture) -> Result<()> {
        deliver(picture, |picture| match picture.format {
            OutputFormat::Png => {
                let entry = |(name, value): &(String, Attribute)| (name.clone(), value.to_string());
                let text = self.metadata.iter().map(entry).collect();
                let Picture { depth, exposure_ev, tone_curve, .. } = *picture;
                let options = PngOptions { depth, exposure_ev, tone_curve, text };
                let noisy = self.film.picture();
                write_png(&picture.path, &noisy, &options)?;
                match (self.denoised)(&noisy)? {
                    Some(denoised) => write_png(&denoised_path(&picture.path), &denoised, &options),
                    None => Ok(()),
                }
            }
            OutputFormat::Exr => exr_file::write(picture, self),
        })
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
        ("settings_hash", text(&format!("{:016x}", settings.content_hash()))),
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
    let entry = |(name, value)| (format!("steradian.{name}"), value);
    let mut all = all.into_iter().map(entry).collect();
    set_result(&mut all, outcome.film, outcome.statistics.faults.iter().sum());
    all
}

/// Corrects the entries that the samples decide.
pub(crate) fn set_result(entries: &mut Vec<(String, Attribute)>, film: &Film, faults: u64) {
    let samples = film.least_samples();
    for (name, value) in entries.iter_mut() {
        match name.as_str() {
            "steradian.spp" => *value = Attribute::Number(samples.into()),
            "samplesPerPixel" => *value = Attribute::Integer(samples.min(i32::MAX as u32) as i32),
            _ => {}
        }
    }
    entries.retain(|(name, _)| name != "steradian.faults");
    // Only a picture that has some is marked.
    if faults > 0 {
        entries.push(("steradian.faults".into(), Attribute::Text(faults.to_string())));
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
