//! Statistics of a render as JSON, for programs.

use super::report::Outcome;
use super::values::{STRATEGIES, word_for};
use super::{memory, reference, stopping};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;
use steradian::bvh::TreeSources;
use steradian::image::write_atomically;
use steradian::renderer::FaultLocation;
use steradian::scene::Scene;
use steradian::shader::Feature;
use steradian::shader::generated::Fault;
use steradian::{Error, Result};

/// Raised when a member changes its meaning or goes.
const SCHEMA: u32 = 1;

#[derive(Serialize)]
struct Stats<'a> {
    schema: u32,
    version: &'a str,
    scene: &'a str,
    device: &'a str,
    driver: &'a str,
    /// How the device computes, in one line.
    float_environment: Option<String>,
    /// Of the whole picture, pixels.
    width: u32,
    height: u32,
    /// x, y, width, height of the part that was rendered.
    window: [u32; 4],
    strategy: &'a str,
    seed: u32,
    block: u32,
    /// Of every pixel at least.
    spp: u32,
    requested_spp: Option<u32>,
    /// The rule by which pixels stop, and what came of it.
    stopping: Option<Stopping>,
    /// Of all pixels together.
    samples: u64,
    load_seconds: f64,
    bvh_seconds: f64,
    compile_seconds: f64,
    render_seconds: f64,
    /// Of that, keeping account of which pixels go on.
    stopping_seconds: f64,
    rays_closest: u64,
    rays_any: u64,
    estimated_relmse: Option<f64>,
    mean_luminance: Option<f64>,
    faults: BTreeMap<&'a str, u64>,
    first_fault: Option<FirstFault<'a>>,
    features: Vec<&'a str>,
    triangles: usize,
    spheres: usize,
    instances: usize,
    nodes: usize,
    tree_depth: u32,
    trees: TreeSources,
    sah_cost: f64,
    device_bytes: u64,
    /// The most of the host's memory that the program has used so far.
    peak_memory_bytes: Option<u64>,
    wgsl_lines: usize,
    /// Stopped by a signal.
    partial: bool,
}

/// Pixels that stop one by one.
#[derive(Serialize)]
struct Stopping {
    rule: String,
    most_samples: u32,
    /// Times that pixels were judged.
    decisions: u32,
    converged_pixels: usize,
    pixels_at_limit: usize,
    unfinished_pixels: usize,
}

impl Stopping {
    fn new(outcome: &Outcome) -> Option<Self> {
        let rule = outcome.job.settings.stopping_rule()?;
        let [unfinished_pixels, converged_pixels, pixels_at_limit] =
            stopping::tally(outcome.film.stops()?);
        Some(Self {
            rule: stopping::describe(&rule),
            most_samples: outcome.film.most_samples(),
            decisions: outcome.statistics.decisions,
            converged_pixels,
            pixels_at_limit,
            unfinished_pixels,
        })
    }
}

/// Where the first faulty sample is.
#[derive(Serialize)]
struct FirstFault<'a> {
    /// Column and row in the whole picture.
    pixel: (u32, u32),
    sample: u32,
    bounce: Option<u32>,
    /// Name of the material last met.
    material: Option<&'a str>,
}

impl<'a> FirstFault<'a> {
    fn new(fault: &FaultLocation, scene: &'a Scene) -> Self {
        let material = fault.material.map(|m| scene.materials[m as usize].name.as_str());
        Self { pixel: fault.pixel, sample: fault.sample, bounce: fault.bounce, material }
    }
}

/// Writes the statistics of a render.
pub(super) fn write(path: &Path, outcome: &Outcome) -> Result<()> {
    let failure = |e: std::io::Error| Error::io(path, e);
    let mut json = serde_json::to_string_pretty(&stats(outcome)).map_err(|e| failure(e.into()))?;
    json.push('\n');
    write_atomically(path, |file| file.write_all(json.as_bytes()).map_err(failure))
}

fn stats<'a>(outcome: &Outcome<'a>) -> Stats<'a> {
    let settings = &outcome.job.settings;
    let counts = outcome.statistics;
    let window = outcome.film.window();
    let error = outcome.film.estimated_error();
    Stats {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        scene: &outcome.job.scene.name,
        device: outcome.device,
        driver: outcome.driver,
        float_environment: counts.float_environment.map(|f| f.to_string()),
        width: settings.resolution.0,
        height: settings.resolution.1,
        window: [window.x, window.y, window.width, window.height],
        strategy: match outcome.job.is_reference {
            true => reference::WORD,
            false => word_for(STRATEGIES, &settings.strategy),
        },
        seed: settings.seed,
        block: settings.samples_per_block(),
        spp: outcome.film.least_samples(),
        requested_spp: outcome.job.requested_spp,
        stopping: Stopping::new(outcome),
        samples: counts.samples,
        load_seconds: outcome.job.load_seconds,
        bvh_seconds: counts.bvh_seconds,
        compile_seconds: counts.compile_seconds,
        render_seconds: counts.render_seconds,
        stopping_seconds: counts.stopping_seconds,
        rays_closest: counts.closest_rays,
        rays_any: counts.shadow_rays,
        estimated_relmse: error.as_ref().map(|e| e.relmse),
        mean_luminance: error.as_ref().map(|e| e.mean_luminance),
        faults: Fault::ALL.iter().map(|f| (key(*f), counts.faults[*f as usize])).collect(),
        first_fault: counts.first_fault.map(|f| FirstFault::new(&f, &outcome.job.scene)),
        features: Feature::ALL
            .iter()
            .filter(|f| counts.features.has(**f))
            .map(|f| f.name())
            .collect(),
        triangles: counts.triangle_count,
        spheres: counts.sphere_count,
        instances: counts.instance_count,
        nodes: counts.node_count,
        tree_depth: counts.tree_depth,
        trees: counts.trees,
        sah_cost: counts.sah_cost,
        device_bytes: counts.device_bytes,
        peak_memory_bytes: memory::peak(),
        wgsl_lines: counts.wgsl_lines,
        partial: outcome.is_partial(),
    }
}

fn key(fault: Fault) -> &'static str {
    match fault {
        Fault::NonFinite => "non_finite",
        Fault::Negative => "negative",
        Fault::LoopBound => "loop_bound",
        Fault::Stack => "stack",
    }
}
