//! `steradian render`.

use super::destination::Destinations;
use super::flags::RenderFlags;
use super::job::Job;
use super::progress::{Progress, while_busy};
use super::report::{self, Outcome};
use super::session::Session;
use super::talk::Verbosity;
use super::{batch, output, reference, stats, view};
use std::process::ExitCode;
use std::time::Instant;
use steradian::Result;
use steradian::view::Source;

/// One call of `steradian render`.
pub(super) struct Call<'a> {
    pub(super) start: Instant,
    pub(super) session: &'a Session<'a>,
    pub(super) flags: &'a RenderFlags,
    pub(super) destinations: Destinations,
    pub(super) verbosity: Verbosity,
}

/// Renders the frames that are asked for.
pub(super) fn run(flags: &RenderFlags) -> Result<ExitCode> {
    view::check(flags)?;
    let frames = flags.frames.list(flags.job.scene.frame_time);
    batch::run(flags, &frames)
}

/// Renders, writes what was asked for, and says what came of it.
pub(super) fn run_frame(call: &Call, job: &Job) -> Result<ExitCode> {
    if let Some(view) = call.flags.job.picture.view.filter(|v| v.source() == Source::FirstHits) {
        return view::run(call, job, view);
    }
    if job.is_reference { reference::run(call, job) } else { run_on_device(call, job) }
}

fn run_on_device(call: &Call, job: &Job) -> Result<ExitCode> {
    let verbosity = call.verbosity;
    let device = call.session.device()?;
    let info = device.info();
    report::job(verbosity, job, &format!("{} {} ({})", info.index, info.name, info.driver));
    let mut renderer =
        while_busy(verbosity, "building trees, compiling shaders", || call.session.renderer(job))?;
    let stop = call.session.stop()?;
    report::renderer(verbosity, renderer.statistics());
    let mut progress = Progress::start(verbosity);
    // At least one step, so that there is a picture however early the signal comes.
    while renderer.step()? && stop.exit_code().is_none() {
        progress.update(renderer.progress());
    }
    renderer.finish()?;
    progress.end();
    call.conclude(&Outcome {
        job,
        device: &info.name,
        driver: &info.driver,
        film: renderer.film(),
        statistics: renderer.statistics(),
        stop_code: stop.exit_code(),
    })
}

impl Call<'_> {
    /// Writes the files and says what came of it.
    pub(super) fn conclude(&self, outcome: &Outcome) -> Result<ExitCode> {
        self.write(outcome)?;
        report::outcome(self.verbosity, outcome, &self.destinations, self.start.elapsed());
        Ok(outcome.stop_code.map_or(ExitCode::SUCCESS, ExitCode::from))
    }

    /// The picture is written last: where it is there, the others are.
    fn write(&self, outcome: &Outcome) -> Result<()> {
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
                None => output::write(picture, outcome)?,
            }
        }
        match flags.job.picture.pixel {
            Some(pixel) => output::print_pixel((pixel.x, pixel.y), outcome),
            None => Ok(()),
        }
    }
}
