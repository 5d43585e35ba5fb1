//! How costs grow.

use super::child::{self, Request};
use super::clock;
use super::flags::{BenchFlags, Scale};
use super::lane::{Lane, Ours};
use super::measure::at;
use super::words::{interval, number};
use crate::cli::job::Job;
use crate::cli::talk;
use serde_json::json;
use std::sync::Arc;
use std::time::Duration;
use steradian::bench::{
    Figure, Plot, PlotPoint, Section, Series, Table, median, power_law, scenes,
};
use steradian::gpu::Device;
use steradian::renderer::PreparedScene;
use steradian::scene::Scene;
use steradian::{Error, RenderSettings, Result};

/// Renders of each size, after one that is not counted.
const ROUNDS: u32 = 3;
/// Samples of a pixel.
const SPP: u32 = 16;
/// Rows and columns where the pixels are not what is scaled.
const SIDE: u32 = 128;

/// One size.
#[derive(serde::Serialize)]
struct Sized {
    size: f64,
    /// Name and value of what is told of it; the first is what the curve is of.
    costs: Vec<(&'static str, f64)>,
}

/// What is asked for.
pub(super) fn sections(flags: &BenchFlags, device: &Arc<Device>) -> Result<Vec<Section>> {
    let mut done: Vec<Scale> = Vec::new();
    let mut sections = Vec::new();
    for &scale in &flags.scale {
        if done.contains(&scale) {
            continue;
        }
        done.push(scale);
        sections.push(match scale {
            Scale::Triangles => triangles(flags, device)?,
            Scale::Lights => lights(flags, device)?,
            Scale::Pixels => pixels(flags, device)?,
            Scale::Bounces => bounces(flags, device)?,
            Scale::Threads => threads(flags)?,
        });
    }
    Ok(sections)
}

fn settings(flags: &BenchFlags) -> RenderSettings {
    let side = flags.resolution.unwrap_or((SIDE, SIDE));
    let base = RenderSettings {
        resolution: side,
        max_bounces: flags.sampling.max_bounces,
        seed: flags.sampling.seed,
        ..RenderSettings::default()
    };
    at(&base, SPP)
}

/// Medians of wall and CPU seconds of a scene, and the costs beside them.
fn cost(
    device: &Arc<Device>,
    scene: &Scene,
    settings: &RenderSettings,
) -> Result<Vec<(&'static str, f64)>> {
    let prepared = Arc::new(PreparedScene::new(device.clone(), scene, settings)?);
    let mut lane = Ours::new("scale", &prepared, scene, std::slice::from_ref(settings))?;
    let (mut wall, mut cpu) = (Vec::new(), Vec::new());
    for round in 0..=ROUNDS {
        let taken = lane.take(0, settings.seed.wrapping_add(round))?;
        if round > 0 {
            wall.push(taken.wall);
            cpu.push(taken.cpu);
        }
    }
    let counts = lane.counts().cloned().unwrap_or_default();
    let samples = counts.samples as f64;
    let per_sample = |seconds: Vec<f64>| 1e9 * median(seconds.into_iter()) / samples;
    let error = lane.estimated_error().unwrap_or(f64::NAN) * f64::from(settings.spp);
    Ok(vec![
        ("CPU ns/sample", per_sample(cpu)),
        ("wall ns/sample", per_sample(wall)),
        ("rays/path", (counts.closest_rays + counts.shadow_rays) as f64 / samples),
        ("relMSE × samples, by its own spread", error),
        ("build s", counts.bvh_seconds),
        ("nodes", counts.node_count as f64),
        ("SAH cost", counts.sah_cost),
        ("MiB on the device", counts.device_bytes as f64 / 1_048_576.0),
    ])
}

/// Powers of ten up to `most`, and `most`.
fn decades(first: u32, most: u32) -> Vec<u32> {
    let mut sizes: Vec<u32> = (0..=8).map(|k| first.saturating_mul(10_u32.pow(k))).collect();
    sizes.retain(|n| *n < most);
    sizes.push(most);
    sizes
}

fn triangles(flags: &BenchFlags, device: &Arc<Device>) -> Result<Section> {
    let mut sizes = Vec::new();
    for n in decades(1000, flags.most_triangles) {
        talk::line(&format!("scale: {n} triangles"));
        let scene = scenes::knot(n as usize);
        let size = scene.primitive_count() as f64;
        sizes.push(Sized { size, costs: cost(device, &scene, &settings(flags))? });
    }
    let text = "A tube along a (2, 3) torus knot in a room with a lamp, made in memory.";
    Ok(section("triangles", text, &sizes))
}

fn lights(flags: &BenchFlags, device: &Arc<Device>) -> Result<Section> {
    let mut sizes = Vec::new();
    for n in decades(1, flags.most_lights) {
        talk::line(&format!("scale: {n} lights"));
        let scene = scenes::lamps(n as usize);
        let costs = cost(device, &scene, &settings(flags))?;
        sizes.push(Sized { size: f64::from(n), costs });
    }
    let text = "Small emissive triangles on a grid below the ceiling of a room, of the same power together, made in \
                memory.";
    Ok(section("lights", text, &sizes))
}

/// The first scene of the command, or a knot.
fn scene(flags: &BenchFlags) -> Result<(Scene, RenderSettings)> {
    match flags.scenes.first() {
        None => Ok((scenes::knot(10_000), settings(flags))),
        Some(path) => {
            let job = Job::new(path, &flags.job(SPP))?;
            let resolution = settings(flags).resolution;
            let settings = at(&RenderSettings { resolution, ..job.settings }, SPP);
            Ok((job.scene, settings))
        }
    }
}

fn pixels(flags: &BenchFlags, device: &Arc<Device>) -> Result<Section> {
    let (scene, settings) = scene(flags)?;
    let mut sizes = Vec::new();
    for k in 0..4 {
        let side = (settings.resolution.0 >> 2 << k).max(1);
        talk::line(&format!("scale: {side}x{side} pixels"));
        let settings = RenderSettings { resolution: (side, side), crop: None, ..settings.clone() };
        let mut costs = cost(device, &scene, &settings)?;
        let count = f64::from(side) * f64::from(side);
        costs.insert(0, ("CPU s of 16 spp", 1e-9 * costs[0].1 * count * f64::from(SPP)));
        sizes.push(Sized { size: count, costs });
    }
    Ok(section("pixels", &format!("{}, square pictures.", scene.name), &sizes))
}

fn bounces(flags: &BenchFlags, device: &Arc<Device>) -> Result<Section> {
    let (scene, settings) = scene(flags)?;
    let mut sizes = Vec::new();
    for n in [1, 2, 4, 8, 16, 32] {
        talk::line(&format!("scale: {n} bounces"));
        let settings =
            RenderSettings { max_bounces: Some(n), only_bounce: None, ..settings.clone() };
        let costs = cost(device, &scene, &settings)?;
        sizes.push(Sized { size: f64::from(n), costs });
    }
    let text = format!(
        "{}, with roulette as by default: rays a path level off, and costs with them.",
        scene.name
    );
    Ok(section("bounces", &text, &sizes))
}

fn threads(flags: &BenchFlags) -> Result<Section> {
    let Some(path) = flags.scenes.first() else {
        return Err(Error::Settings("--scale threads: needs a scene".into()));
    };
    let (width, height) = flags.resolution.unwrap_or((SIDE, SIDE));
    let mut sizes = Vec::new();
    let all = clock::threads();
    let mut counts: Vec<usize> = (0..).map(|k| 1 << k).take_while(|n| *n < all).collect();
    counts.push(all);
    // Above what there is: what that costs.
    counts.push(2 * all);
    for n in counts {
        talk::line(&format!("scale: {n} threads"));
        let mut request = Request::new(path, flags);
        let (size, spp) = (format!("{width}x{height}"), SPP.to_string());
        request.flags.extend(["--resolution", &size, "--spp", &spp].map(Into::into));
        request.variables.push(("LP_NUM_THREADS", n.to_string()));
        request.limit = Some(Duration::from_secs_f64(10.0 * flags.compile_limit));
        let mut times = Vec::new();
        for round in 0..=ROUNDS {
            let rendered = child::render(&request)?;
            let per_sample =
                rendered.map(|r| 1e9 * r.number("render_seconds") / r.number("samples"));
            times.extend(per_sample.filter(|_| round > 0));
        }
        let costs = vec![("wall ns/sample", median(times.into_iter()))];
        sizes.push(Sized { size: n as f64, costs });
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let text = format!(
        "{name}, threads of Mesa's software device (LP_NUM_THREADS), each in processes of its own."
    );
    Ok(section("threads", &text, &sizes))
}

fn section(what: &str, text: &str, sizes: &[Sized]) -> Section {
    let names: Vec<&'static str> = sizes[0].costs.iter().map(|c| c.0).collect();
    let mut columns = vec![what];
    columns.extend(names.iter().copied());
    let mut table = Table::new("", &columns);
    for s in sizes {
        let cells = s.costs.iter().map(|c| number(c.1));
        table.row(std::iter::once(format!("{:.0}", s.size)).chain(cells));
    }
    let of =
        |k: usize| -> Vec<(f64, f64)> { sizes.iter().map(|s| (s.size, s.costs[k].1)).collect() };
    let exponents = (0..names.len()).map(|k| power_law(&of(k)).map(|law| law.exponent));
    let cells = exponents.clone().map(|e| e.as_ref().map_or("–".into(), interval));
    table.row(std::iter::once("exponent".to_owned()).chain(cells));
    let points = of(0).into_iter().map(|(x, y)| PlotPoint { x, y, low: f64::NAN, high: f64::NAN });
    let series = vec![Series { name: names[0].into(), points: points.collect() }];
    let first = exponents.clone().next().flatten();
    let caption = format!("{} against {what}", names[0]);
    Section {
        title: format!("Cost against {what}"),
        text: vec![format!(
            "{text} Exponents are of the power that fits best, over the whole range, with Student's interval at 95 % \
             from the distances to it."
        )],
        tables: vec![table],
        figures: vec![Figure {
            name: format!("scale-{what}"),
            caption: caption.clone(),
            plot: Plot {
                title: caption,
                x_label: what.into(),
                y_label: names[0].into(),
                series,
                guide: first.map(|e| e.value),
            },
        }],
        data: json!({ "scale": what, "sizes": sizes, "exponents": exponents.collect::<Vec<_>>() }),
        sections: Vec::new(),
    }
}
