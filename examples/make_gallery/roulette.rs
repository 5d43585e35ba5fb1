//! Russian roulette: the renderer's own, none, and constant probabilities, which the
//! program does not have and this study puts into the shader.

use crate::clock::own_seconds;
use crate::error::{LUMINANCE, epsilon, error, luminance};
use crate::page::{sheet, short, table, time};
use crate::renders::bundled;
use std::path::Path;
use std::sync::Arc;
use steradian::gpu::Device;
use steradian::image::{ChannelData, Picture, read_exr};
use steradian::passes::Tuning;
use steradian::scene::gltf::{LoadOptions, load_with};
use steradian::shader::{Library, library};
use steradian::{RenderSettings, Renderer};

use crate::renders::Program;

const SPP: u32 = 1024;
/// Bounces after which a path ends whatever roulette says: fewer than 1e-15 of the light
/// of this scene is beyond.
const LIMIT: u32 = 100;
const MODULE: &str = "path/path";
const OWN: &str = "clamp(sqrt(2.0 * kept), ROULETTE_LEAST, 1.0)";
const START: &str = "const ROULETTE_START: u32 = 3u;";

/// The program's shaders with a constant probability of going on, from the first bounce.
fn constant(probability: f32) -> Result<Library, String> {
    let mut library = library();
    let module = library.get_mut(MODULE).ok_or("no module of paths")?;
    let mut text = module.to_string();
    let places =
        [(OWN, format!("{probability:?}")), (START, "const ROULETTE_START: u32 = 1u;".to_owned())];
    for (from, to) in places {
        if text.matches(from).count() != 1 {
            return Err(format!("{MODULE}: `{from}` is not there once; change this study"));
        }
        text = text.replace(from, &to);
    }
    *module = text.into();
    Ok(library)
}

struct Outcome {
    picture: Picture,
    seconds: f64,
    /// Rays of a path, shadow rays among them.
    rays: f64,
    /// Standard error of the mean luminance of the picture.
    standard_error: f64,
}

fn render(device: &Arc<Device>, library: Library, roulette: bool) -> Result<Outcome, String> {
    let failure = |e: steradian::Error| e.to_string();
    let path = bundled("cornell-box");
    let scene = load_with(Path::new(&path), &LoadOptions::default()).map_err(failure)?;
    let settings = RenderSettings {
        resolution: (32, 32),
        spp: SPP,
        max_bounces: Some(LIMIT),
        roulette,
        ..RenderSettings::default()
    };
    let tuning = Tuning { library, ..Tuning::default() };
    let mut renderer =
        Renderer::with_tuning(device.clone(), &scene, &settings, &tuning).map_err(failure)?;
    let begin = own_seconds();
    while renderer.step().map_err(failure)? {}
    renderer.finish().map_err(failure)?;
    let seconds = own_seconds() - begin;
    let statistics = renderer.statistics();
    if statistics.faults.iter().sum::<u64>() > 0 {
        return Err("faulty samples".into());
    }
    let errors = renderer.film().standard_error().ok_or("no standard error")?;
    let square: f64 = errors.iter().map(|&e| f64::from(e).powi(2)).sum();
    Ok(Outcome {
        picture: renderer.film().picture(),
        seconds,
        rays: (statistics.closest_rays + statistics.shadow_rays) as f64 / statistics.samples as f64,
        standard_error: square.sqrt() / errors.len() as f64,
    })
}

/// The picture of a reference, and the standard error of its mean luminance, where the channels
/// of a pixel err alike.
fn read_reference(path: &Path) -> Result<(Picture, f64), String> {
    let image = read_exr(path).map_err(|e| e.to_string())?;
    let variances = |name| match image.channel("variance", name) {
        Some(ChannelData::F32(values)) => Ok(values),
        _ => Err(format!("{}: no variances of {name}", path.display())),
    };
    let [r, g, b] = [variances("R")?, variances("G")?, variances("B")?];
    let of_pixel = |i: usize| {
        let errors = [r[i], g[i], b[i]].map(|v| f64::from(v).sqrt());
        errors.iter().zip(LUMINANCE).map(|(e, weight)| e * weight).sum::<f64>()
    };
    let square: f64 = (0..r.len()).map(|i| of_pixel(i).powi(2)).sum();
    let picture = image.picture().ok_or("no picture")?;
    Ok((picture, square.sqrt() / r.len() as f64))
}

/// Every way, against a reference by another renderer.
pub(crate) fn run(_: &Program) -> Result<String, String> {
    let path = Path::new("tests/references/cornell-box.exr");
    let (reference, reference_error) = read_reference(path)?;
    let device = Arc::new(Device::open(None).map_err(|e| e.to_string())?);
    let mut ways = vec![
        ("the program's own".to_owned(), library(), true),
        ("none".to_owned(), library(), false),
    ];
    for probability in [0.9, 0.7, 0.5, 0.3] {
        ways.push((format!("{probability}, from the first bounce"), constant(probability)?, true));
    }
    let mut outcomes = Vec::new();
    let mut rows = Vec::new();
    for (name, library, roulette) in ways {
        eprintln!("roulette: {name}");
        let outcome = render(&device, library, roulette)?;
        let e = error(&outcome.picture, &reference);
        let off = luminance(&outcome.picture) - luminance(&reference);
        rows.push(vec![
            name,
            format!("{:.2}", outcome.rays),
            time(outcome.seconds),
            short(e),
            format!("{:.2}", e * outcome.rays * 1e3),
            format!("{:+.2}", off / outcome.standard_error.hypot(reference_error)),
        ]);
        outcomes.push(outcome);
    }
    let pictures: Vec<_> = outcomes.iter().map(|o| (&o.picture, 0.0)).collect();
    let head = ["roulette", "rays per path", "time", "error", "error × rays × 1000", "mean, σ off"];
    Ok(format!(
        "{}\n\
         The program's own, none, then probabilities 0.9, 0.7, 0.5, 0.3 of going on. 32x32 pixels, {SPP}\n\
         samples per pixel, at most {LIMIT} bounces. Roulette shortens paths and adds noise; what counts is\n\
         error × rays. All have the same mean: the last column is the difference of the mean luminance\n\
         from the reference's in standard errors of both (one seed for all, so they are alike). The\n\
         program's own begins at bounce 3 and goes on with the root of twice the path's throughput; a\n\
         constant probability is no option of the program: the study puts it into the shader.\n\n{}\n\
         Reference: by Mitsuba 3, 131,072 samples per pixel (`tests/references`); ε {}.\n\n\
         The first two are `steradian render scenes/cornell-box/cornell-box.gltf --resolution 32x32\n\
         --spp {SPP} --max-bounces {LIMIT} -o roulette.exr`, the second with `--no-roulette`.\n",
        sheet("roulette", "Own, none, 0.9, 0.7, 0.5, 0.3", &pictures, 6, 4)?,
        table(&head, rows),
        epsilon(&reference),
    ))
}
