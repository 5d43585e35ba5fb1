//! `steradian render`.

use super::destination::Destinations;
use super::flags::RenderFlags;
use super::job::Job;
use super::progress::{Progress, while_busy};
use super::report::{self, Outcome};
use super::signals::StopRequest;
use super::{output, stats};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;
use steradian::gpu::Device;
use steradian::{Error, Renderer, Result};

/// Renders, writes what was asked for, and says what came of it.
pub(super) fn run(flags: &RenderFlags) -> Result<ExitCode> {
    let start = Instant::now();
    let verbosity = flags.verbosity();
    let destinations = Destinations::check(flags)?;
    use_threads(flags.threads)?;
    let job = while_busy(verbosity, "reading the scene", || Job::new(flags))?;
    let device = Arc::new(Device::open(flags.device.as_deref())?);
    report::job(verbosity, &job, device.info());

    let mut renderer = while_busy(verbosity, "building trees, compiling shaders", || {
        Renderer::new(device.clone(), &job.scene, &job.settings)
    })?;
    let stop = StopRequest::listen()?;
    report::renderer(verbosity, renderer.statistics());
    let mut progress = Progress::start(verbosity);
    // At least one step, so that there is a picture however early the signal comes.
    while renderer.step()? && stop.exit_code().is_none() {
        progress.update(renderer.progress());
    }
    renderer.finish()?;
    progress.end();

    let outcome = Outcome {
        job: &job,
        device: device.info(),
        film: renderer.film(),
        statistics: renderer.statistics(),
        stop_code: stop.exit_code(),
    };
    write(flags, &destinations, &outcome)?;
    report::outcome(verbosity, &outcome, &destinations, start.elapsed());
    Ok(outcome.stop_code.map_or(ExitCode::SUCCESS, ExitCode::from))
}

fn write(flags: &RenderFlags, destinations: &Destinations, outcome: &Outcome) -> Result<()> {
    if let Some(picture) = &destinations.picture {
        output::write(picture, outcome)?;
    }
    if let Some(path) = &destinations.stats {
        stats::write(path, outcome)?;
    }
    match flags.picture.pixel {
        Some(pixel) => output::print_pixel((pixel.x, pixel.y), outcome),
        None => Ok(()),
    }
}

/// Sets the size of the pool that the library's parallel loops run on.
fn use_threads(count: Option<u16>) -> Result<()> {
    let Some(count) = count else { return Ok(()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count.into());
    pool.build_global().map_err(|e| Error::Settings(format!("--threads {count}: {e}")))
}
