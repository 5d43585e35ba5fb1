//! `steradian render --view`: something else than light.

use super::destination::Picture;
use super::existing;
use super::flags::RenderFlags;
use super::job::Job;
use super::output::metadata;
use super::picture_layers::deliver;
use super::progress::while_busy;
use super::render::Call;
use super::report::{self, Outcome};
use super::talk;
use super::values::{SAMPLERS, VIEWS, word_for};
use std::process::ExitCode;
use steradian::gpu::DeviceInfo;
use steradian::image::{
    Attribute, ExrImage, OutputFormat, PngOptions, Precision, write_exr, write_png,
};
use steradian::passes::{Extras, Tuning};
use steradian::renderer::PreparedScene;
use steradian::settings::Crop;
use steradian::view::{Source, View, ViewPicture, of_film, of_first_hits};
use steradian::{Error, Result};

/// Rays of a pixel, unless `--spp` says otherwise.
pub(crate) const DEFAULT_RAYS: u32 = 16;

/// That the other flags go with the view.
pub(super) fn check(flags: &RenderFlags) -> Result<()> {
    let Some(view) = flags.job.picture.view else { return Ok(()) };
    let word = word_for(VIEWS, &view);
    let stopping = &flags.job.stopping;
    if view == View::StopReason && stopping.rule().is_none() {
        let message = format!("--view {word}: needs --noise or --adaptive, or nothing stops early");
        return Err(Error::Settings(message));
    }
    let of_render = [
        ("--stats", flags.stats.is_some()),
        ("--sample-map", flags.sample_map.is_some()),
        ("--time", stopping.time.is_some()),
        ("--display-server", flags.machine.display_server.is_some()),
        ("--noise and --adaptive", stopping.rule().is_some()),
        ("--reference", flags.job.sampling.reference),
    ];
    match of_render.iter().find(|(_, is_given)| *is_given) {
        Some((flag, _)) if view.source() == Source::FirstHits => Err(Error::Settings(format!(
            "--view {word}: camera rays are traced and nothing is rendered, {flag} has no meaning"
        ))),
        _ => Ok(()),
    }
}

/// Traces camera rays and writes the view of what they meet.
pub(super) fn run(call: &Call, job: &Job, view: View) -> Result<ExitCode> {
    let verbosity = call.verbosity;
    let device = call.session.device()?;
    let info = device.info();
    report::job(verbosity, job, &format!("{} {} ({})", info.index, info.name, info.driver));
    let rays = call.flags.job.stopping.spp.unwrap_or(DEFAULT_RAYS);
    let tuning = Tuning::default();
    let hits = while_busy(verbosity, "building trees, tracing camera rays", || {
        let prepared = PreparedScene::new(device.clone(), &job.scene, &job.settings)?;
        let extras = Extras::visits(view == View::NodeVisits);
        let mut hits = prepared.first_hits(&job.scene, &job.settings, extras, &tuning)?;
        hits.run(&device, rays)?;
        Ok(hits)
    })?;
    let window = hits.window();
    let faulty = hits.hits().iter().filter(|hit| hit.faults != 0).count();
    if faulty > 0 {
        talk::line(&format!("warning: the walk failed for rays of {faulty} pixels"));
    }
    let Some(shown) = of_first_hits(view, hits.hits(), (window.width, window.height)) else {
        return Err(no_numbers(view));
    };
    let Some(picture) = &call.destinations.picture else { return Ok(ExitCode::SUCCESS) };
    let mut entries = of_rays(job, info, rays);
    entries.push(existing::request(picture, job, Some(view)));
    verbosity.say(&shown.legend);
    write(picture, view, shown, entries, (job.settings.resolution, window))?;
    Ok(ExitCode::SUCCESS)
}

/// What a view of first hits follows from.
pub(crate) fn of_rays(job: &Job, info: &DeviceInfo, rays: u32) -> Vec<(String, Attribute)> {
    let text = |value: &str| Attribute::Text(value.into());
    let entries = [
        ("version", text(env!("CARGO_PKG_VERSION"))),
        ("scene", text(&job.scene.name)),
        ("scene_hash", text(&format!("{:016x}", job.scene.content_hash(job.settings.camera)))),
        ("device", text(&info.name)),
        ("driver", text(&info.driver)),
        ("spp", Attribute::Number(rays.into())),
        ("seed", Attribute::Number(job.settings.seed.into())),
        ("sampler", text(word_for(SAMPLERS, &job.settings.sampler))),
        ("camera", text(&job.scene.cameras[job.settings.camera].name)),
    ];
    entries.map(|(name, value)| (format!("steradian.{name}"), value)).into()
}

/// Writes the view of a render; gives its legend.
pub(crate) fn write_of_film(picture: &Picture, view: View, outcome: &Outcome) -> Result<String> {
    let film = outcome.film;
    let limit = outcome.job.requested_spp.unwrap_or(film.most_samples());
    let shown = of_film(view, film, limit).ok_or_else(|| no_numbers(view))?;
    let legend = shown.legend.clone();
    let place = (outcome.job.settings.resolution, film.window());
    let mut entries = metadata(outcome);
    entries.push(existing::request(picture, outcome.job, Some(view)));
    write(picture, view, shown, entries, place)?;
    Ok(legend)
}

fn no_numbers(view: View) -> Error {
    let word = word_for(VIEWS, &view);
    Error::Settings(format!("--view {word}: not known after so few samples; give a larger --spp"))
}

/// Writes a view. `resolution` of the whole picture, and the part that there is.
pub(crate) fn write(
    picture: &Picture,
    view: View,
    shown: ViewPicture,
    mut metadata: Vec<(String, Attribute)>,
    (resolution, window): ((u32, u32), Crop),
) -> Result<()> {
    let entry =
        |name: &str, value: &str| (format!("steradian.{name}"), Attribute::Text(value.into()));
    metadata.push(entry("view", word_for(VIEWS, &view)));
    metadata.push(entry("legend", &shown.legend));
    deliver(picture, |picture| match picture.format {
        OutputFormat::Png => {
            let text =
                metadata.into_iter().map(|(name, value)| (name, value.to_string())).collect();
            let options = PngOptions { depth: picture.depth, text, ..PngOptions::default() };
            write_png(&picture.path, &shown.picture, &options)
        }
        OutputFormat::Exr => {
            let mut image = ExrImage::from_crop(&shown.picture, resolution, window);
            image.layers = vec![shown.layer];
            image.metadata = metadata.into_iter().collect();
            write_exr(&picture.path, &image, Precision::Float)
        }
    })
}
