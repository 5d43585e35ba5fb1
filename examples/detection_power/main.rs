//! Which defects a comparison finds, and how often it raises a false alarm: writes the measured part
//! of docs/compare.md.
//!
//!     cargo run --release --example detection_power -- [--small] [--one-spp N] [FILE]
//!
//! One scene is rendered with defects planted in shaders, scene and picture, and each picture is
//! judged by the methods that are in use. `--small` takes few runs, to see that it works;
//! `--one-spp` one number of samples alone.

mod defects;
mod methods;
mod page;
mod scene;

use defects::Defect;
use methods::{Evidence, METHODS, Rates};
use std::path::Path;
use std::sync::Arc;
use steradian::gpu::Device;
use steradian::image::compare::PictureFile;
use steradian::passes::Tuning;
use steradian::scene::Scene;
use steradian::testing::{Rendered, write_reference};
use steradian::{RenderSettings, Renderer};

/// Columns and rows.
const SIDE: u32 = 32;

/// Runs of the reference, with seeds from 1.
const REFERENCE_RUNS: u32 = 64;

/// How many times the samples of a picture one long render has.
const LONG: u32 = 16;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// How much is rendered.
struct Amount {
    clean: u32,
    defective: u32,
}

/// Findings at one number of samples.
pub(crate) struct Study {
    spp: u32,
    /// Rates of the clean pictures, by method.
    clean: Rates,
    /// Per level: clean pictures whose p-value is below it.
    levels: Vec<(f64, [usize; 2])>,
    rows: Vec<Row>,
    /// Limits that no clean picture passes, of FLIP, SSIM and RMS.
    limits: [f64; 3],
    relative_noise: f64,
}

/// One defect.
pub(crate) struct Row {
    defect: Defect,
    /// Change of the mean luminance.
    bias: f64,
    /// How many standard deviations an observer would see who knows the defect.
    visibility: f64,
    rates: Rates,
}

fn main() -> Result<()> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_small = arguments.iter().position(|a| a == "--small").map(|k| arguments.remove(k));
    let amount = match is_small {
        Some(_) => Amount { clean: 6, defective: 2 },
        None => Amount { clean: 200, defective: 20 },
    };
    let mut numbers = vec![16, 256];
    if let Some(k) = arguments.iter().position(|a| a == "--one-spp") {
        numbers = vec![arguments.get(k + 1).ok_or("--one-spp needs a number")?.parse()?];
        arguments.drain(k..=k + 1);
    }
    let path = arguments.first().map_or("docs/compare.md", String::as_str);
    let device = Arc::new(Device::open(None)?);
    let mut studies = Vec::new();
    for spp in numbers {
        studies.push(study(&device, spp, &amount)?);
        page::write(Path::new(path), &studies, &amount, device.info())?;
    }
    Ok(())
}

/// Renders one scene with many seeds by one kernel.
struct Shots<'a> {
    scene: &'a Scene,
    settings: RenderSettings,
    renderer: Renderer,
    device: Arc<Device>,
}

impl<'a> Shots<'a> {
    fn new(device: &Arc<Device>, scene: &'a Scene, spp: u32, tuning: &Tuning) -> Result<Self> {
        let settings = RenderSettings {
            resolution: (SIDE, SIDE),
            spp,
            // Four pieces of a picture at least tell of its noise.
            block_size: (spp / 4).min(16),
            ..RenderSettings::default()
        };
        let renderer = Renderer::with_tuning(device.clone(), scene, &settings, tuning)?;
        Ok(Self { scene, settings, renderer, device: device.clone() })
    }

    fn shot(&mut self, seed: u32) -> Result<Rendered> {
        self.renderer.restart(seed)?;
        while self.renderer.step()? {}
        self.renderer.finish()?;
        if self.renderer.statistics().faults != [0; 4] {
            return Err("faulty samples".into());
        }
        let settings = RenderSettings { seed, ..self.settings.clone() };
        Ok(Rendered::from_film(self.renderer.film(), self.device.info(), self.scene, &settings))
    }

    fn file(&mut self, seed: u32) -> Result<PictureFile> {
        Ok(self.shot(seed)?.file(Path::new("rendered"))?)
    }
}

fn study(device: &Arc<Device>, spp: u32, amount: &Amount) -> Result<Study> {
    let scene = scene::scene();
    let mut clean = Shots::new(device, &scene, spp, &Tuning::default())?;
    eprintln!("{spp} spp: reference");
    let runs: Vec<Rendered> = (1..=REFERENCE_RUNS).map(|s| clean.shot(s)).collect::<Result<_>>()?;
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("reference.exr");
    write_reference(&path, &runs)?;
    let reference = PictureFile::read(&path)?;
    let long =
        Shots::new(device, &scene, spp * LONG, &Tuning::default())?.file(REFERENCE_RUNS + 1)?;
    let evidence = Evidence { golden: clean.file(0)?, reference, long };
    let mut clean_files = Vec::new();
    for k in 0..amount.clean {
        eprint!("\r{spp} spp: clean {k}    ");
        clean_files.push(clean.file(1000 + k)?);
    }
    eprintln!();
    let found: Vec<_> = clean_files.iter().map(|file| evidence.judge(file, true)).collect();
    let limits = methods::limits(&found);
    let same_seed = evidence.judge(&clean.file(0)?, false);
    let rates = Rates::of(&same_seed, &found, &limits);
    let levels = [0.05, 0.01, 0.001].map(|level| (level, methods::alarms(&found, level)));

    let mut rows = Vec::new();
    for defect in Defect::ALL {
        eprintln!("{spp} spp: {}", defect.name());
        let count = amount.defective as usize;
        let (golden, mut files) = if defect.is_of_picture() {
            (evidence.golden.clone(), clean_files[..count].to_vec())
        } else {
            let (changed, tuning) = (defect.scene(&scene), defect.tuning());
            let mut shots = Shots::new(device, &changed, spp, &tuning)?;
            let seeds = 2000..2000 + amount.defective;
            let files = seeds.map(|seed| shots.file(seed)).collect::<Result<Vec<_>>>()?;
            (shots.file(0)?, files)
        };
        let mut same_seed = golden;
        defect.spoil(&mut same_seed, 0);
        files.iter_mut().zip(1..).for_each(|(file, seed)| defect.spoil(file, seed));
        let same_seed = evidence.judge(&same_seed, false);
        let found: Vec<_> = files.iter().map(|file| evidence.judge(file, false)).collect();
        let (bias, visibility) = evidence.visibility(&files);
        let rates = Rates::of(&same_seed, &found, &limits);
        let shown: Vec<_> = METHODS.iter().zip(&rates.found).collect();
        eprintln!("  bias {:.2} %, visibility {visibility:.1}: {shown:?}", 100.0 * bias);
        rows.push(Row { defect, bias, visibility, rates });
    }
    let relative_noise = evidence.relative_noise();
    Ok(Study { spp, clean: rates, levels: levels.to_vec(), rows, limits, relative_noise })
}
