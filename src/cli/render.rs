//! `steradian render`.

use super::checkpoint::Checkpoint;
use super::destination::{Destinations, Picture};
use super::device_render::DeviceRender;
use super::flags::RenderFlags;
use super::job::Job;
use super::layer_flags::STANDARD_OUTPUT;
use super::progress::{Progress, while_busy};
use super::report::{self, Outcome};
use super::rescue::or_elsewhere;
use super::signals::StopRequest;
use super::talk::Verbosity;
use super::{film_output, output, reference, shard, stats, view};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use steradian::view::Source;
use steradian::{Error, Result};

/// One call of `steradian render`.
pub(super) struct Call<'a> {
    start: Instant,
    pub(super) flags: &'a RenderFlags,
    pub(super) destinations: Destinations,
    pub(super) verbosity: Verbosity,
}

/// Renders, writes what was asked for, and says what came of it.
pub(super) fn run(flags: &RenderFlags) -> Result<ExitCode> {
    let start = Instant::now();
    let verbosity = flags.verbosity();
    let destinations = Destinations::check(flags)?;
    let call = Call { start, flags, destinations, verbosity };
    view::check(flags)?;
    use_threads(flags.threads)?;
    let job = while_busy(verbosity, "reading the scene", || Job::new(&flags.scene, &flags.job))?;
    if let Some(view) = flags.job.picture.view.filter(|view| view.source() == Source::FirstHits) {
        return view::run(&call, &job, view);
    }
    if job.is_reference { reference::run(&call, &job) } else { run_on_device(&call, job) }
}

fn run_on_device(call: &Call, mut job: Job) -> Result<ExitCode> {
    if let Some(shard) = call.flags.farm.shard {
        shard::apply(&mut job, shard)?;
    }
    film_output::check(call, &job)?;
    let mut render = DeviceRender::open(call, &job)?;
    let mut checkpoint = Checkpoint::begin(call, &job, render.device.info(), &mut render.renderer)?;
    let stop = StopRequest::listen()?;
    report::renderer(call.verbosity, render.renderer.statistics());
    let mut progress = Progress::start(call.verbosity);
    // At least one step, so that there is a picture however early the signal comes.
    while render.step(&mut checkpoint)? && stop.exit_code().is_none() {
        progress.update(render.renderer.progress());
        if stop.wants_snapshot() {
            progress = progress.break_for(|| render.write_snapshot())?;
        }
        if let Some(checkpoint) = &mut checkpoint {
            checkpoint.keep_if_due(&render.renderer)?;
        }
    }
    progress.end();
    render.conclude(checkpoint, stop.exit_code())
}

impl Call<'_> {
    /// Writes the files and says what came of it.
    pub(super) fn conclude(&self, outcome: &Outcome) -> Result<ExitCode> {
        self.write(outcome)?;
        report::outcome(self.verbosity, outcome, &self.destinations, self.start.elapsed());
        Ok(outcome.stop_code.map_or(ExitCode::SUCCESS, ExitCode::from))
    }

    pub(super) fn write(&self, outcome: &Outcome) -> Result<()> {
        let (flags, destinations) = (self.flags, &self.destinations);
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
        if let Some(path) = &destinations.sample_map {
            output::write_sample_map(path, flags.sample_map_colors, outcome)?;
        }
        if let Some(path) = &destinations.stats {
            stats::write(path, outcome)?;
        }
        match flags.job.picture.pixel {
            Some(pixel) => output::print_pixel((pixel.x, pixel.y), outcome),
            None => Ok(()),
        }
    }
}

/// Sets the size of the pool that the library's parallel loops run on.
fn use_threads(count: Option<u16>) -> Result<()> {
    let Some(count) = count else { return Ok(()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count.into());
    pool.build_global().map_err(|e| Error::Settings(format!("--threads {count}: {e}")))
}
