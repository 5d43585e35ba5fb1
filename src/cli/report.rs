//! What is said about a render on standard error.

use super::destination::Destinations;
use super::job::Job;
use super::picture_layers::PictureLayers;
use super::talk::{self, Verbosity, with_prefix};
use super::{memory, stopping};
use std::time::Duration;
use steradian::bvh::TreeSources;
use steradian::film::{ErrorEstimate, Film, PixelStop};
use steradian::renderer::{FaultLocation, RenderStatistics};
use steradian::scene::{Scene, Treatment};
use steradian::shader::generated::Fault;
use steradian::stopping::StopReason;

/// All that is known when a render has ended.
pub(crate) struct Outcome<'a> {
    pub(crate) job: &'a Job,
    /// What made the picture.
    pub(crate) device: &'a str,
    /// Its driver's name and version; empty for the reference.
    pub(crate) driver: &'a str,
    pub(crate) film: &'a Film,
    pub(crate) statistics: &'a RenderStatistics,
    /// What is traced for the picture's file.
    pub(crate) layers: Option<&'a PictureLayers>,
    /// The exit code of the signal that stopped it, if one did.
    pub(crate) stop_code: Option<u8>,
    /// Whether the render goes on.
    pub(crate) is_snapshot: bool,
}

impl Outcome<'_> {
    /// Whether samples are missing that were asked for.
    pub(crate) fn is_partial(&self) -> bool {
        self.is_snapshot || self.stop_code.is_some()
    }
}

/// Before anything is built.
pub(crate) fn job(verbosity: Verbosity, job: &Job, device: &str) {
    let seconds = talk::duration(job.load_seconds);
    verbosity.detail(&format!("scene {}, read in {seconds}", job.scene.name));
    verbosity.detail(&format!("device {device}"));
}

/// When everything is built and compiled.
pub(crate) fn renderer(verbosity: Verbosity, s: &RenderStatistics) {
    verbosity.detail(&format!(
        "trees of {} triangles, {} spheres, {} instances: {} nodes, depth {}, SAH cost {:.1}, {} in {}",
        s.triangle_count,
        s.sphere_count,
        s.instance_count,
        s.node_count,
        s.tree_depth,
        s.sah_cost,
        tree_sources(s.trees),
        talk::duration(s.bvh_seconds),
    ));
    if let Some(environment) = s.float_environment {
        verbosity.detail(&format!("float environment {environment}"));
    }
    verbosity.detail(&format!("{} of scene on the device", talk::size(s.device_bytes)));
    verbosity.detail(&format!(
        "{} lines of WGSL, compiled in {}: {}",
        s.wgsl_lines,
        talk::duration(s.compile_seconds),
        s.features,
    ));
}

fn tree_sources(TreeSources { built, kept, refitted }: TreeSources) -> String {
    match (kept, refitted) {
        (0, 0) => "built".into(),
        _ => format!("{built} built, {kept} kept, {refitted} refitted"),
    }
}

/// At the end. Warnings are said even when all else is not.
pub(crate) fn outcome(
    verbosity: Verbosity,
    outcome: &Outcome,
    destinations: &Destinations,
    wall: Duration,
) {
    for line in summary(outcome, destinations, wall.as_secs_f64()) {
        verbosity.say(&line);
    }
    if let Some(bytes) = memory::peak() {
        verbosity.detail(&format!("peak memory {}", talk::size(bytes)));
    }
    for notice in &outcome.job.scene.notices {
        match notice.treatment {
            Treatment::Honoured => verbosity.detail(&format!("honoured: {}", notice.message)),
            Treatment::Approximated => verbosity.say(&format!("approximated: {}", notice.message)),
            Treatment::Ignored => verbosity.say(&format!("ignored: {}", notice.message)),
        }
    }
    let scene = &outcome.job.scene;
    let warnings = [empty_warning(outcome.film), fault_warning(outcome.statistics, scene)];
    for warning in warnings.iter().flatten() {
        talk::line(warning);
    }
}

fn summary(outcome: &Outcome, destinations: &Destinations, wall_seconds: f64) -> Vec<String> {
    let (s, window) = (outcome.statistics, outcome.film.window());
    let what = format!("{}x{}, {}", window.width, window.height, sample_range(outcome.film));
    let mut lines = Vec::new();
    if let Some(picture) = &destinations.picture {
        let partial = if outcome.is_partial() { "partial picture " } else { "" };
        lines.push(format!("{partial}{}: {what}", picture.path.display()));
    } else if let Some(film) = &destinations.film {
        let partial = if outcome.is_partial() { "partial film " } else { "" };
        lines.push(format!("{partial}{}: {what}", film.display()));
    } else {
        lines.push(what);
    }
    if let Some(map) = &destinations.sample_map {
        lines.push(format!("sample map {}", map.display()));
    }
    if let Some(stats) = &destinations.stats {
        lines.push(format!("statistics {}", stats.display()));
    }
    let rate = |count: u64| with_prefix(count as f64 / s.render_seconds.max(f64::MIN_POSITIVE));
    lines.push(format!(
        "{} in all, {} of rendering: {} samples/s, {} rays/s",
        talk::duration(wall_seconds),
        talk::duration(s.render_seconds),
        rate(s.samples),
        rate(s.closest_rays + s.shadow_rays),
    ));
    if let Some(rule) = outcome.job.settings.stopping_rule() {
        lines.extend(stopping::lines(&rule, outcome.job.settings.spp, outcome.film));
    }
    lines.extend(ended_by(outcome));
    lines.push(error_line(outcome.film.estimated_error().as_ref()));
    lines
}

/// Which of several limits was reached first.
fn ended_by(outcome: &Outcome) -> Option<String> {
    let settings = &outcome.job.settings;
    let has_choice = settings.time.is_some() || settings.stopping_rule().is_some();
    if outcome.is_partial() || !has_choice {
        return None;
    }
    let has_all_samples = outcome.film.least_samples() >= settings.spp;
    let unfinished = |stop: &PixelStop| stop.reason == StopReason::Unfinished;
    let is_late = match outcome.film.stops() {
        Some(stops) => stops.iter().any(unfinished),
        None => !has_all_samples,
    };
    let limit = if is_late {
        "the time"
    } else if outcome
        .film
        .stops()
        .is_some_and(|s| s.iter().all(|p| p.reason == StopReason::Converged))
    {
        "the noise"
    } else {
        "the samples"
    };
    Some(format!("ended by {limit}"))
}

fn sample_range(film: &Film) -> String {
    match (film.least_samples(), film.most_samples()) {
        (least, most) if least == most => format!("{most} spp"),
        (least, most) => format!("{least} to {most} spp"),
    }
}

pub(crate) fn error_line(estimate: Option<&ErrorEstimate>) -> String {
    match estimate {
        Some(e) if e.relmse == 0.0 => "estimated error 0: every block of samples agrees".into(),
        Some(e) => {
            let percent = 100.0 * e.relmse.sqrt();
            format!("estimated relMSE {:.1e}, about {} % per pixel", e.relmse, with_prefix(percent))
        }
        None => "no error estimate: it takes two whole blocks of samples (--spp, --block)".into(),
    }
}

/// One line about pixels that an early end left without samples.
fn empty_warning(film: &Film) -> Option<String> {
    let empty = film.sample_counts().iter().filter(|n| **n == 0).count();
    (empty > 0).then(|| format!("warning: {empty} pixels have no sample and are black"))
}

/// One line about samples that cannot be right, if there are any.
fn fault_warning(s: &RenderStatistics, scene: &Scene) -> Option<String> {
    let causes = Fault::ALL.iter().filter(|f| s.faults[**f as usize] > 0);
    let causes: Vec<_> =
        causes.map(|f| format!("{} {}", s.faults[*f as usize], f.description())).collect();
    if causes.is_empty() {
        return None;
    }
    let place = s.first_fault.as_ref().map_or(String::new(), |first| fault_place(first, scene));
    Some(format!("warning: faulty samples: {}{place}", causes.join(", ")))
}

fn fault_place(fault: &FaultLocation, scene: &Scene) -> String {
    let (x, y) = fault.pixel;
    let bounce = fault.bounce.map_or(String::new(), |b| format!(", bounce {b}"));
    let material = fault.material.map_or(String::new(), |m| {
        format!(", material {m} {:?}", scene.materials[m as usize].name)
    });
    format!("; the first at pixel {x},{y}, sample {}{bounce}{material}", fault.sample)
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian::film::BlockMean;
    use steradian::scene::Material;
    use steradian::settings::Crop;

    #[test]
    fn the_error_is_told_in_percent() {
        let estimate = ErrorEstimate { relmse: 2.1e-4, mean_luminance: 0.5 };
        let line = error_line(Some(&estimate));
        assert_eq!(line, "estimated relMSE 2.1e-4, about 1.45 % per pixel");
        let exact = ErrorEstimate { relmse: 0.0, ..estimate };
        assert!(error_line(Some(&exact)).starts_with("estimated error 0"));
        assert!(error_line(None).starts_with("no error estimate"));
    }

    #[test]
    fn pixels_without_samples_are_counted() {
        let mut film = Film::new(Crop { x: 0, y: 0, width: 3, height: 1 }, 1);
        film.add_block(1, 0, BlockMean { mean: [0.5; 3], sample_count: 1 });
        let warning = empty_warning(&film);
        assert_eq!(warning.as_deref(), Some("warning: 2 pixels have no sample and are black"));
        film.add_block(0, 0, BlockMean { mean: [0.0; 3], sample_count: 1 });
        film.add_block(2, 0, BlockMean { mean: [0.0; 3], sample_count: 1 });
        assert_eq!(empty_warning(&film), None);
    }

    #[test]
    fn faults_are_counted_and_located() {
        let material = Material { name: "brass".into(), ..Material::default() };
        let scene = Scene { materials: vec![material], ..Scene::default() };
        let mut statistics = RenderStatistics::default();
        assert_eq!(fault_warning(&statistics, &scene), None);
        statistics.faults[Fault::Stack as usize] = 3;
        statistics.faults[Fault::NonFinite as usize] = 12;
        let mut first =
            FaultLocation { pixel: (4, 5), sample: 6, bounce: Some(2), material: Some(0) };
        statistics.first_fault = Some(first);
        assert_eq!(
            fault_warning(&statistics, &scene).unwrap(),
            "warning: faulty samples: 12 not finite, 3 traversal stack overflow; \
             the first at pixel 4,5, sample 6, bounce 2, material 0 \"brass\""
        );
        first.material = None;
        statistics.first_fault = Some(first);
        assert!(fault_warning(&statistics, &scene).unwrap().ends_with("sample 6, bounce 2"));
    }
}
