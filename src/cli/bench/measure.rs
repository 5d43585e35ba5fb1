//! All methods on one scene: references, rounds by turns, and what the scene costs beside.

use super::flags::BenchFlags;
use super::lane::{Lane, Ours, Taken};
use super::mitsuba::{Mitsuba, Server};
use super::variants::{self, Variant};
use crate::cli::job::{Job, default_block_size};
use crate::cli::talk;
use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;
use steradian::bench::{Curve, Difference, PictureErrors, Point, Reference, ReferenceParts, Run};
use steradian::gpu::Device;
use steradian::image::{ChannelData, ExrImage, read_exr};
use steradian::passes::{Extras, Tuning};
use steradian::renderer::{PreparedScene, RenderStatistics};
use steradian::{Error, RenderSettings, Result};

/// Parts of a reference that is rendered.
const PARTS: u32 = 16;
/// Samples of a reference over the most of a curve.
const REFERENCE_FACTOR: u32 = 8;
/// First seeds of the references' parts; those of the runs begin at the asked one.
const REFERENCE_SEEDS: u32 = 1 << 30;
/// Runs that every point has, however long they take, unless fewer are asked for.
const LEAST_RUNS: u32 = 4;
/// Name of the method that stands beside the default everywhere.
pub(super) const PATH_REUSE: &str = "path reuse";
/// Independent runs, unless said otherwise.
pub(super) const RUNS: u32 = 16;

/// What is said of a scene.
pub(super) struct Facts {
    pub(super) load_seconds: f64,
    pub(super) build_seconds: f64,
    pub(super) compile_seconds: f64,
    /// Nodes and primitives tested by the ray through a pixel's centre, means over the pixels.
    pub(super) visits: [f64; 2],
    /// Seconds that the other program took to load it.
    pub(super) rival_load_seconds: Option<f64>,
    pub(super) statistics: RenderStatistics,
}

/// The runs of one method.
pub(super) struct Method {
    pub(super) curve: Curve,
    /// Of every point, every round.
    pub(super) errors: Vec<Vec<PictureErrors>>,
    /// What one render at the last point counted.
    pub(super) counts: Option<RenderStatistics>,
    /// A name of [`Variant`], or of another program.
    pub(super) is_rival: bool,
}

/// A reference in numbers.
pub(super) struct ReferenceFacts {
    /// Whose, and how it was made.
    pub(super) name: String,
    /// What its variance adds to an error.
    pub(super) relmse: Option<f64>,
    pub(super) epsilon: f64,
}

/// What was measured on one scene. The first method is the default one.
pub(super) struct Measured {
    pub(super) name: String,
    pub(super) settings: RenderSettings,
    pub(super) facts: Facts,
    pub(super) references: Vec<ReferenceFacts>,
    /// From our reference to the other program's.
    pub(super) difference: Option<Difference>,
    pub(super) methods: Vec<Method>,
    /// What could not be measured, and why.
    pub(super) notes: Vec<String>,
}

/// Measures one scene.
pub(super) fn measure(
    path: &Path,
    flags: &BenchFlags,
    device: &Arc<Device>,
    server: Option<&Rc<RefCell<Server>>>,
    with_variants: bool,
) -> Result<Measured> {
    let begin = Instant::now();
    let points = flags.points();
    let most = points[points.len() - 1];
    let job = Job::new(path, &flags.job(most))?;
    let base = &job.settings;
    talk::line(&format!("{}: {}x{}", job.scene.name, base.resolution.0, base.resolution.1));
    let prepared = Arc::new(PreparedScene::new(device.clone(), &job.scene, base)?);
    let settings: Vec<_> = points.iter().map(|&spp| at(base, spp)).collect();
    let default = Ours::new("default", &prepared, &job.scene, &settings)?;
    let mut facts = facts(&job, &prepared, device, default.compile_seconds())?;
    let mut notes = Vec::new();

    let spp = flags.reference_spp.unwrap_or(REFERENCE_FACTOR.saturating_mul(most)) / PARTS;
    let spp = spp.max(1);
    let (own, own_name) = match &flags.reference_file {
        Some(file) => (from_file(file, base)?, file.display().to_string()),
        None => {
            let mut lane = Ours::new("reference", &prepared, &job.scene, &[at(base, spp)])?;
            reference(&mut lane, base, flags)?
        }
    };
    let own = Rc::new(own);
    let mut lanes: Vec<(Box<dyn Lane>, Rc<Reference>, bool)> =
        vec![(Box::new(default), own.clone(), false)];
    if let Some(settings) = sharing(base) {
        let settings: Vec<_> = points.iter().map(|&spp| at(&settings, spp)).collect();
        talk::line(&format!("  compiling: {PATH_REUSE}"));
        let lane = Ours::new(PATH_REUSE, &prepared, &job.scene, &settings)?;
        lanes.push((Box::new(lane), own.clone(), false));
    }
    if with_variants {
        let context =
            variants::Context { path, flags, job: &job, prepared: &prepared, points: &points };
        for variant in Variant::ALL {
            match variants::lane(variant, &context)? {
                Ok(lane) => lanes.push((lane, own.clone(), false)),
                Err(note) => notes.push(note),
            }
        }
    }
    let mut references = vec![(own_name, own.clone())];
    let mut difference = None;
    if let Some(server) = server {
        let seconds = server.borrow_mut().load(path, &flags.mitsuba_sampler, base)?;
        facts.rival_load_seconds = Some(seconds);
        // With one reference from a file, both are measured against it.
        let theirs = match flags.reference_file {
            Some(_) => own.clone(),
            None => {
                let mut lane = Mitsuba::new(server.clone(), base, &[spp]);
                let (theirs, name) = reference(&mut lane, base, flags)?;
                difference = own.difference(&theirs);
                let theirs = Rc::new(theirs);
                references.push((name, theirs.clone()));
                theirs
            }
        };
        let lane = Mitsuba::new(server.clone(), base, &points);
        lanes.push((Box::new(lane), theirs, true));
    }
    let methods = rounds(&mut lanes, points.len(), flags, begin)?;
    if let Some(default) = &methods[0].counts {
        facts.statistics = default.clone();
    }
    let name = |(name, r): &(String, Rc<Reference>)| ReferenceFacts {
        name: name.clone(),
        relmse: r.relmse(),
        epsilon: r.epsilon,
    };
    let references = references.iter().map(name).collect();
    Ok(Measured {
        name: job.scene.name.clone(),
        settings: base.clone(),
        facts,
        references,
        difference,
        methods,
        notes,
    })
}

/// The same with paths shared, where that is something else.
fn sharing(base: &RenderSettings) -> Option<RenderSettings> {
    let settings = RenderSettings { path_reuse: true, ..base.clone() };
    (settings.shares_paths() && !base.shares_paths()).then_some(settings)
}

/// Settings of a point: with the blocks that `render` would take.
pub(super) fn at(base: &RenderSettings, spp: u32) -> RenderSettings {
    RenderSettings { spp, block_size: default_block_size(Some(spp)), ..base.clone() }
}

fn facts(
    job: &Job,
    prepared: &Arc<PreparedScene>,
    device: &Device,
    compile_seconds: f64,
) -> Result<Facts> {
    Ok(Facts {
        load_seconds: job.load_seconds,
        build_seconds: prepared.build_seconds(),
        compile_seconds,
        visits: visits(job, prepared, device)?,
        rival_load_seconds: None,
        statistics: RenderStatistics::default(),
    })
}

/// Nodes and primitives that the rays through the pixels' centres test, in the mean.
fn visits(job: &Job, prepared: &PreparedScene, device: &Device) -> Result<[f64; 2]> {
    let mut hits =
        prepared.first_hits(&job.scene, &job.settings, Extras::visits(true), &Tuning::default())?;
    hits.run(device, 1)?;
    let n = hits.hits().len() as f64;
    let mean = |of: fn(&steradian::gpu::GpuFirstHit) -> u32| {
        hits.hits().iter().map(|h| f64::from(of(h))).sum::<f64>() / n
    };
    Ok([mean(|h| h.node_visits), mean(|h| h.primitive_visits)])
}

/// The mean of a lane's parts with seeds of their own, and what it is.
fn reference(
    lane: &mut dyn Lane,
    base: &RenderSettings,
    flags: &BenchFlags,
) -> Result<(Reference, String)> {
    let window = base.window();
    let mut parts = ReferenceParts::new((window.width, window.height));
    let mut samples = 0.0;
    for k in 0..PARTS {
        let taken =
            lane.take(0, REFERENCE_SEEDS.wrapping_add(flags.sampling.seed).wrapping_add(k))?;
        samples += taken.samples;
        parts.add(&taken.picture);
    }
    let whose = if lane.name() == "reference" { "ours" } else { lane.name() };
    Ok((parts.mean(), format!("{whose}, {PARTS} parts, {samples:.0} spp in all")))
}

fn from_file(path: &Path, settings: &RenderSettings) -> Result<Reference> {
    let image = read_exr(path)?;
    let wrong = |message: String| Error::Settings(format!("{}: {message}", path.display()));
    let picture = image
        .picture()
        .ok_or_else(|| wrong("has no channels R, G and B that hold numbers".into()))?;
    let window = settings.window();
    if (picture.width, picture.height) != (window.width, window.height) {
        let (w, h) = (window.width, window.height);
        let (width, height) = (picture.width, picture.height);
        return Err(wrong(format!("has {width}x{height} pixels, the renders have {w}x{h}")));
    }
    Ok(Reference::of_file(&picture, standard_error(&image)))
}

/// The layer that `render` writes.
fn standard_error(image: &ExrImage) -> Option<&[f32]> {
    let layer = image.layers.iter().find(|layer| layer.name == "noise")?;
    let channel = layer.channels.iter().find(|(name, _)| name == "standard_error")?;
    match &channel.1 {
        ChannelData::F32(values) => Some(values),
        _ => None,
    }
}

/// Every lane at every point, once to warm up, then by turns, forwards and backwards.
fn rounds(
    lanes: &mut [(Box<dyn Lane>, Rc<Reference>, bool)],
    points: usize,
    flags: &BenchFlags,
    begin: Instant,
) -> Result<Vec<Method>> {
    let runs = flags.runs.unwrap_or(RUNS);
    let empty = |(lane, _, is_rival): &(Box<dyn Lane>, Rc<Reference>, bool)| Method {
        curve: Curve {
            name: lane.name().into(),
            points: vec![Point { samples: 0.0, runs: Vec::new() }; lane.points()],
        },
        errors: vec![Vec::new(); lane.points()],
        counts: None,
        is_rival: *is_rival,
    };
    let mut methods: Vec<Method> = lanes.iter().map(empty).collect();
    let mut seed = flags.sampling.seed;
    for round in 0..=runs {
        for point in 0..points {
            for turn in 0..lanes.len() {
                let i = if round % 2 == 0 { turn } else { lanes.len() - 1 - turn };
                let (lane, reference, _) = &mut lanes[i];
                if point >= lane.points() {
                    continue;
                }
                seed = seed.wrapping_add(1);
                let taken = lane.take(point, seed)?;
                // The first is for caches, and for how work is cut.
                if round > 0 {
                    add(&mut methods[i], point, &taken, reference);
                }
            }
        }
        talk::line(&format!("  round {round} of {runs}"));
        if round >= LEAST_RUNS && flags.scene_time.is_some_and(|time| begin.elapsed() >= time) {
            break;
        }
    }
    for (method, (lane, ..)) in methods.iter_mut().zip(lanes.iter()) {
        method.counts = lane.counts().cloned();
    }
    Ok(methods)
}

fn add(method: &mut Method, point: usize, taken: &Taken, reference: &Reference) {
    let errors = PictureErrors::of(&taken.picture, reference);
    let at = &mut method.curve.points[point];
    // Pixels that stop one by one take other numbers in every run.
    let n = at.runs.len() as f64;
    at.samples = (at.samples * n + taken.samples) / (n + 1.0);
    at.runs.push(Run { error: errors.relmse, wall: taken.wall, cpu: taken.cpu });
    method.errors[point].push(errors);
}

/// Most memory held so far, in words.
pub(super) fn peak_memory() -> String {
    crate::cli::memory::peak().map_or("not known here".into(), talk::size)
}
