//! `steradian render`.

use super::destination::Destinations;
use super::flags::RenderFlags;
use super::job::Job;
use super::progress::{Progress, while_busy};
use super::report::{self, DeviceName, Outcome};
use super::signals::StopRequest;
use super::talk::Verbosity;
use super::{output, reference, stats};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;
use steradian::film::Film;
use steradian::gpu::Device;
use steradian::renderer::RenderStatistics;
use steradian::{Error, Renderer, Result};

/// What a render gives.
pub(super) struct Rendered {
    pub(super) device: DeviceName,
    pub(super) film: Film,
    pub(super) statistics: RenderStatistics,
    /// The exit code of the signal that stopped it, if one did.
    pub(super) stop_code: Option<u8>,
}

/// Renders, writes what was asked for, and says what came of it.
pub(super) fn run(flags: &RenderFlags) -> Result<ExitCode> {
    let start = Instant::now();
    let verbosity = flags.verbosity();
    let destinations = Destinations::check(flags)?;
    use_threads(flags.threads)?;
    let job = while_busy(verbosity, "reading the scene", || Job::new(flags))?;
    let rendered = if job.is_reference {
        reference::render(verbosity, &job)?
    } else {
        let device = Arc::new(Device::open(flags.device.as_deref())?);
        render(verbosity, &job, &device)?
    };

    let outcome = Outcome {
        job: &job,
        device: &rendered.device,
        film: &rendered.film,
        statistics: &rendered.statistics,
        stop_code: rendered.stop_code,
    };
    write(flags, &destinations, &outcome)?;
    report::outcome(verbosity, &outcome, &destinations, start.elapsed());
    Ok(outcome.stop_code.map_or(ExitCode::SUCCESS, ExitCode::from))
}

/// Renders on `device`.
fn render(verbosity: Verbosity, job: &Job, device: &Arc<Device>) -> Result<Rendered> {
    let info = device.info();
    report::job(verbosity, job, &format!("{} {} ({})", info.index, info.name, info.driver));
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
    Ok(Rendered {
        device: DeviceName { name: info.name.clone(), driver: info.driver.clone() },
        film: renderer.film().clone(),
        statistics: renderer.statistics().clone(),
        stop_code: stop.exit_code(),
    })
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
