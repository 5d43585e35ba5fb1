//! `steradian render --reference`: no device, no kernel.

use super::job::Job;
use super::progress::while_busy;
use super::render::Call;
use super::report::{self, Outcome};
use super::talk;
use std::process::ExitCode;
use std::time::Instant;
use steradian::Result;
use steradian::reference::Reference;
use steradian::renderer::RenderStatistics;
use steradian::shader::generated::Fault;

/// Stands in metadata for what only a device has.
pub(super) const WORD: &str = "reference";

/// Renders on the processor.
pub(super) fn run(call: &Call, job: &Job) -> Result<ExitCode> {
    let (verbosity, device) = (call.verbosity, "reference, f64 on the processor");
    report::job(verbosity, job, device);
    let begin = Instant::now();
    let reference =
        while_busy(verbosity, "building the tree", || Reference::new(&job.scene, &job.settings))?;
    let bvh_seconds = begin.elapsed().as_secs_f64();
    verbosity.detail(&format!("tree built in {}", talk::duration(bvh_seconds)));

    let stop = call.session.stop()?;
    let mut progress = call.progress();
    let begin = Instant::now();
    let (film, tally) = reference.render(|done| {
        progress.update(done);
        stop.exit_code().is_none()
    });
    progress.end();
    let mut statistics = RenderStatistics {
        bvh_seconds,
        render_seconds: begin.elapsed().as_secs_f64(),
        samples: film.sample_counts().iter().map(|&n| u64::from(n)).sum(),
        closest_rays: tally.closest_rays,
        shadow_rays: tally.shadow_rays,
        triangle_count: job.scene.primitive_count() - job.scene.spheres.len(),
        sphere_count: job.scene.spheres.len(),
        ..RenderStatistics::default()
    };
    statistics.faults[Fault::NonFinite as usize] = tally.non_finite;
    statistics.faults[Fault::LoopBound as usize] = tally.cut_off;
    call.conclude(&Outcome {
        job,
        device,
        driver: "",
        film: &film,
        statistics: &statistics,
        layers: None,
        stop_code: stop.exit_code(),
        is_snapshot: false,
    })
}
