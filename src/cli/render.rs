//! `steradian render`.

use super::destination::Destinations;
use super::flags::RenderFlags;
use super::job::Job;
use super::picture_layers::PictureLayers;
use super::progress::{Progress, while_busy};
use super::report::{self, Outcome};
use super::signals::StopRequest;
use super::talk::Verbosity;
use super::{output, reference, stats, view};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;
use steradian::gpu::Device;
use steradian::view::Source;
use steradian::{Error, Renderer, Result};

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
    if job.is_reference { reference::run(&call, &job) } else { run_on_device(&call, &job) }
}

fn run_on_device(call: &Call, job: &Job) -> Result<ExitCode> {
    let verbosity = call.verbosity;
    let device = Arc::new(Device::open(call.flags.device.as_deref())?);
    let info = device.info();
    report::job(verbosity, job, &format!("{} {} ({})", info.index, info.name, info.driver));
    let mut renderer = while_busy(verbosity, "building trees, compiling shaders", || {
        Renderer::new(device.clone(), &job.scene, &job.settings)
    })?;
    let layers = PictureLayers::new(call.flags, job, renderer.prepared())?;
    let stop = StopRequest::listen()?;
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
        layers: Some(&layers),
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

    fn write(&self, outcome: &Outcome) -> Result<()> {
        let (flags, destinations) = (self.flags, &self.destinations);
        if let Some(picture) = &destinations.picture {
            match flags.job.picture.view {
                Some(view) => {
                    self.verbosity.say(&view::write_of_film(picture, view, outcome)?);
                }
                None => output::write(picture, outcome)?,
            }
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
