//! `steradian render`.

use super::checkpoint::Checkpoint;
use super::destination::{Destinations, Picture};
use super::device_render::DeviceRender;
use super::display::Display;
use super::flags::RenderFlags;
use super::job::Job;
use super::layer_flags::STANDARD_OUTPUT;
use super::progress::{FramePlace, Progress};
use super::report::{self, Outcome};
use super::rescue::or_elsewhere;
use super::session::Session;
use super::shard::Shard;
use super::talk::Verbosity;
use super::{batch, film_output, output, reference, stats, talk, view};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use steradian::Result;
use steradian::view::Source;

/// One call of `steradian render`.
pub(super) struct Call<'a> {
    pub(super) start: Instant,
    pub(super) session: &'a Session<'a>,
    pub(super) flags: &'a RenderFlags,
    /// Of the frame, seconds, at which animations are sampled.
    pub(super) time: Option<f64>,
    /// The part of the frame that is rendered.
    pub(super) shard: Option<Shard>,
    pub(super) destinations: Destinations,
    pub(super) verbosity: Verbosity,
    pub(super) place: FramePlace,
}

/// Renders the frames that are asked for.
pub(super) fn run(flags: &RenderFlags) -> Result<ExitCode> {
    if flags.machine.dump_settings {
        talk::data(&flags.machine.dumped)?;
        return Ok(ExitCode::SUCCESS);
    }
    flags.machine.set_up(&flags.scene, flags.output.as_deref())?;
    view::check(flags)?;
    let mut frames = flags.frames.list(flags.job.scene.frame_time);
    let shard = flags.farm.shard;
    if frames.len() == 1 {
        return batch::run(flags, &frames, shard);
    }
    // Many frames are shared out whole.
    if let Some(shard) = shard {
        frames = shard.of_list(&frames);
    }
    batch::run(flags, &frames, None)
}

/// Renders, writes what was asked for, and says what came of it.
pub(super) fn run_frame(call: &Call, job: &Job) -> Result<ExitCode> {
    if let Some(view) = call.flags.job.picture.view.filter(|v| v.source() == Source::FirstHits) {
        return view::run(call, job, view);
    }
    if job.is_reference { reference::run(call, job) } else { run_on_device(call, job) }
}

fn run_on_device(call: &Call, job: &Job) -> Result<ExitCode> {
    let mut render = DeviceRender::open(call, job)?;
    let mut checkpoint = Checkpoint::begin(call, job, render.device.info(), &mut render.renderer)?;
    let stop = call.session.stop()?;
    report::renderer(call.verbosity, render.renderer.statistics());
    let mut progress = call.progress();
    let mut display = call.display(job);
    // At least one step, so that there is a picture however early the signal comes.
    while render.step(&mut checkpoint)? && stop.exit_code().is_none() {
        progress.update(render.renderer.progress());
        display.update(&render.renderer);
        if stop.wants_snapshot() {
            progress = progress.break_for(|| render.write_snapshot())?;
        }
        if let Some(checkpoint) = &mut checkpoint {
            checkpoint.keep_if_due(&render.renderer)?;
        }
    }
    display.finish(&render.renderer);
    progress.end();
    call.session.traced_for(render.renderer.statistics().render_seconds);
    render.conclude(checkpoint, stop.exit_code())
}

impl Call<'_> {
    /// Progress of this frame.
    pub(super) fn progress(&self) -> Progress {
        Progress::start(self.flags.machine.progress, self.verbosity, self.place)
    }

    /// The viewer that is to show this frame, if one is.
    fn display(&self, job: &Job) -> Display<'_> {
        let picture = self.destinations.picture.as_ref();
        let name = picture.map_or(job.scene.name.clone(), |p| p.path.display().to_string());
        Display::new(self.flags.machine.display_server.as_deref(), &name)
    }

    /// Writes the files and says what came of it.
    pub(super) fn conclude(&self, outcome: &Outcome) -> Result<ExitCode> {
        self.write(outcome)?;
        report::outcome(self.verbosity, outcome, &self.destinations, self.start.elapsed());
        Ok(outcome.stop_code.map_or(ExitCode::SUCCESS, ExitCode::from))
    }

    /// The picture is written last: where it is there, the others are.
    pub(super) fn write(&self, outcome: &Outcome) -> Result<()> {
        let (flags, destinations) = (self.flags, &self.destinations);
        if let Some(path) = &destinations.sample_map {
            output::write_sample_map(path, flags.sample_map_colors, outcome)?;
        }
        if let Some(path) = &destinations.stats {
            stats::write(path, outcome)?;
        }
        if let Some(picture) = &destinations.picture {
            match flags.job.picture.view {
                Some(view) => {
                    self.verbosity.say(&view::write_of_film(picture, view, outcome)?);
                }
                None if picture.path == Path::new(STANDARD_OUTPUT) => {
                    output::write(picture, outcome)?
                }
                None => or_elsewhere(&picture.path, |path| {
                    output::write(&Picture { path: path.to_owned(), ..picture.clone() }, outcome)
                })?,
            }
        }
        if let Some(path) = &destinations.film {
            or_elsewhere(path, |path| film_output::write(path, self, outcome))?;
        }
        match flags.job.picture.pixel {
            Some(pixel) => output::print_pixel((pixel.x, pixel.y), outcome),
            None => Ok(()),
        }
    }
}
