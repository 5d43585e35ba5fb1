//! What composing the kernel for a scene saves.

use super::child::{self, Rendered, Request};
use super::flags::BenchFlags;
use super::words::number;
use crate::cli::job::Job;
use crate::cli::talk;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use steradian::bench::{Section, Table, median};
use steradian::gpu::{Device, validate};
use steradian::passes::Tuning;
use steradian::renderer::PreparedScene;
use steradian::shader::{Features, compose, generated};
use steradian::{Error, Renderer, Result};

/// Renders of each kernel for the time per sample.
const ROUNDS: usize = 3;

/// A kernel as text and as SPIR-V.
struct Kernel {
    lines: usize,
    words: usize,
    bindings: usize,
}

/// What children measured of a kernel.
struct Timed {
    cold: f64,
    warm: f64,
    nanoseconds: f64,
    picture: steradian::image::Picture,
}

/// Of every scene.
pub(super) fn section(flags: &BenchFlags, device: &Arc<Device>) -> Result<Section> {
    let columns = [
        "scene",
        "kernel",
        "WGSL lines",
        "SPIR-V words",
        "bindings",
        "compile s, cold",
        "compile s, cached",
        "ns/sample",
        "pixels",
    ];
    let mut table = Table::new("", &columns);
    let mut data = Vec::new();
    for scene in flags.scenes.iter().take(flags.specialise.unwrap_or(0)) {
        rows(scene, flags, device, &mut table, &mut data)?;
    }
    Ok(Section {
        title: "Specialisation".into(),
        text: vec![format!(
            "The kernel for the scene, and the one with every feature (`--features all`). SPIR-V is naga's, with \
             its default options. Compile times are of processes of their own, with an empty shader cache of the \
             driver and with the one that this leaves; at most {} s each. Times per sample are wall medians of \
             {ROUNDS} renders by turns.",
            flags.compile_limit
        )],
        tables: vec![table],
        data: json!(data),
        ..Section::default()
    })
}

fn rows(
    path: &Path,
    flags: &BenchFlags,
    device: &Arc<Device>,
    table: &mut Table,
    data: &mut Vec<Value>,
) -> Result<()> {
    let points = flags.points();
    let job = Job::new(path, &flags.job(points[points.len() - 1].min(16)))?;
    let prepared = Arc::new(PreparedScene::new(device.clone(), &job.scene, &job.settings)?);
    let tuning = Tuning::default();
    let renderer = Renderer::of_prepared(prepared, &job.scene, &job.settings, &tuning)?;
    let needed = renderer.statistics().features;
    let kernels = [("specialised", needed), ("every feature", needed.with_all_of_scenes())];
    talk::line(&format!("{}: specialisation", job.scene.name));
    let folder = tempfile::tempdir().map_err(|e| Error::io("temporary folder", e))?;
    let timed = [time(path, flags, &job, &folder, false)?, time(path, flags, &job, &folder, true)?];
    // By turns, both from their caches.
    let mut nanoseconds = [Vec::new(), Vec::new()];
    if timed.iter().all(Option::is_some) {
        for _ in 0..ROUNDS {
            for (all, times) in nanoseconds.iter_mut().enumerate() {
                let request = request(path, flags, &job, &folder, all == 1);
                times.extend(child::render(&request)?.map(|r| per_sample(&r)));
            }
        }
    }
    let same = match &timed {
        [Some(a), Some(b)] => Some(bits(&a.picture) == bits(&b.picture)),
        _ => None,
    };
    for (i, (name, features)) in kernels.iter().enumerate() {
        let kernel = kernel(*features, &renderer)?;
        let (cold, warm, ns) = match &timed[i] {
            Some(t) if nanoseconds[i].is_empty() => (number(t.cold), number(t.warm), t.nanoseconds),
            Some(t) => (number(t.cold), number(t.warm), median(nanoseconds[i].iter().copied())),
            None => (format!("> {}", flags.compile_limit), "–".into(), f64::NAN),
        };
        let pixels = match same {
            Some(true) => "identical",
            Some(false) => "DIFFERENT",
            None => "not compared",
        };
        table.row([
            job.scene.name.clone(),
            (*name).into(),
            kernel.lines.to_string(),
            kernel.words.to_string(),
            kernel.bindings.to_string(),
            cold,
            warm,
            number(ns),
            pixels.into(),
        ]);
        data.push(json!({
            "scene": job.scene.name, "kernel": name, "wgsl_lines": kernel.lines,
            "spirv_words": kernel.words, "bindings": kernel.bindings,
            "compile_seconds_cold": timed[i].as_ref().map(|t| t.cold),
            "compile_seconds_cached": timed[i].as_ref().map(|t| t.warm),
            "nanoseconds_per_sample": timed[i].is_some().then_some(ns), "identical": same,
        }));
    }
    Ok(())
}

/// Composed, and as naga writes it.
fn kernel(features: Features, renderer: &Renderer) -> Result<Kernel> {
    let tuning = Tuning::default();
    let depth = renderer.statistics().tree_depth.max(1);
    let text = generated::wgsl(depth, tuning.workgroup_size);
    let composed = compose(&tuning.library, "path_trace", features, &text)?;
    let module = validate("path_trace", &composed)?;
    let fail = |message: String| Error::Shader { entry: "path_trace".into(), message };
    let capabilities = naga::valid::Capabilities::all();
    let info = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|e| fail(e.to_string()))?;
    let options = naga::back::spv::Options::default();
    let pipeline = naga::back::spv::PipelineOptions {
        shader_stage: naga::ShaderStage::Compute,
        entry_point: "main".into(),
    };
    let words = naga::back::spv::write_vec(&module, &info, &options, Some(&pipeline))
        .map_err(|e| fail(e.to_string()))?;
    let main = info.get_entry_point(0);
    let bindings = module
        .global_variables
        .iter()
        .filter(|(handle, variable)| variable.binding.is_some() && !main[*handle].is_empty())
        .count();
    Ok(Kernel { lines: composed.origins.len(), words: words.len(), bindings })
}

fn request(
    path: &Path,
    flags: &BenchFlags,
    job: &Job,
    folder: &tempfile::TempDir,
    all: bool,
) -> Request {
    let mut request = Request::new(path, flags);
    let (width, height) = job.settings.resolution;
    let size = format!("{width}x{height}");
    let spp = job.settings.spp.to_string();
    request.flags.extend(["--resolution", &size, "--spp", &spp].map(Into::into));
    if all {
        request.flags.extend(["--features", "all"].map(Into::into));
    }
    request.cache = Some(folder.path().join(if all { "all" } else { "needed" }));
    request.limit = Some(Duration::from_secs_f64(flags.compile_limit));
    request
}

fn time(
    path: &Path,
    flags: &BenchFlags,
    job: &Job,
    folder: &tempfile::TempDir,
    all: bool,
) -> Result<Option<Timed>> {
    let request = request(path, flags, job, folder, all);
    let Some(cold) = child::render(&request)? else { return Ok(None) };
    let Some(warm) = child::render(&request)? else { return Ok(None) };
    let nanoseconds = per_sample(&warm);
    let [cold, warm_seconds] = [&cold, &warm].map(|r| r.number("compile_seconds"));
    Ok(Some(Timed { cold, warm: warm_seconds, nanoseconds, picture: warm.picture }))
}

fn per_sample(rendered: &Rendered) -> f64 {
    1e9 * rendered.number("render_seconds") / rendered.number("samples")
}

fn bits(picture: &steradian::image::Picture) -> Vec<[u32; 3]> {
    picture.rgb.iter().map(|p| p.map(f32::to_bits)).collect()
}
