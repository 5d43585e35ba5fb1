//! Adaptive sampling: where the rules stop a pixel, what that saves and what it loses.

use crate::error::{LUMINANCE, epsilon, error};
use crate::page::{commands, sheet, short, table, time};
use crate::renders::{Job, Program, Shot, bundled};
use std::path::Path;
use steradian::image::{ChannelData, ExrImage, MapColors, Picture, read_exr, sample_map};
use steradian::stopping::StopReason;

/// Samples of a pixel at most.
const LIMIT: u32 = 2048;
const REFERENCE_SPP: u32 = 8192;
const FLAGS: &str = "--light-samples 1 --max-bounces 5";
/// Of every rule.
const TOLERANCE: f64 = 0.05;
const RULES: [(&str, &str); 3] = [
    ("the seed's", "--adaptive seed:64,0.05"),
    ("`--noise 0.05`", "--noise 0.05"),
    ("`--noise 0.05 --preset strict`", "--noise 0.05 --preset strict"),
];

/// Luminance of every pixel and what is known of its noise.
struct Pixels {
    luminance: Vec<f64>,
    standard_error: Vec<f32>,
    counts: Vec<u32>,
    /// Those that a rule stopped.
    stopped: Vec<bool>,
}

impl Pixels {
    fn read(path: &Path) -> Result<Self, String> {
        let image = read_exr(path).map_err(|e| e.to_string())?;
        let missing = |name| format!("{}: no {name}", path.display());
        let picture = image.picture().ok_or_else(|| missing("picture"))?;
        let counts = integers(&image, "samples").ok_or_else(|| missing("samples"))?;
        let Some(ChannelData::F32(standard_error)) = image.channel("noise", "standard_error")
        else {
            return Err(missing("standard error"));
        };
        let of = |c: &[f32; 3]| (0..3).map(|i| f64::from(c[i]) * LUMINANCE[i]).sum();
        let is_stopped = |reason: &u32| *reason == StopReason::Converged as u32;
        let reasons = integers(&image, "stop_reason");
        Ok(Self {
            luminance: picture.rgb.iter().map(of).collect(),
            standard_error: standard_error.clone(),
            counts,
            stopped: reasons.map_or(vec![false; picture.rgb.len()], |reasons| {
                reasons.iter().map(is_stopped).collect()
            }),
        })
    }

    fn mean_count(&self) -> f64 {
        self.counts.iter().map(|&n| f64::from(n)).sum::<f64>() / self.counts.len() as f64
    }

    fn map(&self, side: u32, colors: MapColors) -> Picture {
        sample_map(&self.counts, (side, side), LIMIT, colors)
    }

    /// Luminance that dark pixels count as.
    fn floor(&self) -> f64 {
        0.01 * self.luminance.iter().sum::<f64>() / self.luminance.len() as f64
    }

    /// Mean luminance over that of `reference`, less 1, and its standard error.
    fn mean_off(&self, reference: &Self) -> (f64, f64) {
        let sum: f64 = self.luminance.iter().sum();
        let other: f64 = reference.luminance.iter().sum();
        let errors = self.standard_error.iter().chain(&reference.standard_error);
        let square: f64 = errors.map(|&e| f64::from(e).powi(2)).sum();
        (sum / other - 1.0, square.sqrt() / other)
    }

    /// Mean over the stopped pixels of their relative difference from `reference`, and its
    /// standard error.
    fn stopped_off(&self, reference: &Self) -> (f64, f64) {
        let floor = reference.floor();
        let (mut sum, mut square, mut count) = (0.0, 0.0, 0.0);
        for i in (0..self.stopped.len()).filter(|&i| self.stopped[i]) {
            let scale = reference.luminance[i].max(floor);
            sum += (self.luminance[i] - reference.luminance[i]) / scale;
            let errors = [self.standard_error[i], reference.standard_error[i]];
            square += errors.map(|e| (f64::from(e) / scale).powi(2)).iter().sum::<f64>();
            count += 1.0;
        }
        (sum / count, square.sqrt() / count)
    }

    /// Shares of the stopped pixels that are darker and brighter than `reference` by more than
    /// the tolerance.
    fn off(&self, reference: &Self) -> [f64; 2] {
        let floor = reference.floor();
        let mut counts = [0, 0];
        let mut all = 0;
        for i in (0..self.stopped.len()).filter(|&i| self.stopped[i]) {
            let truth = reference.luminance[i];
            let relative = (self.luminance[i] - truth) / truth.max(floor);
            all += 1;
            counts[0] += usize::from(relative < -TOLERANCE);
            counts[1] += usize::from(relative > TOLERANCE);
        }
        counts.map(|count| count as f64 / f64::from(all))
    }
}

fn integers(image: &ExrImage, name: &str) -> Option<Vec<u32>> {
    match image.channel("noise", name)? {
        ChannelData::U32(values) => Some(values.clone()),
        ChannelData::F32(_) => None,
    }
}

/// Part of the rendering time that goes to the rule.
fn overhead(shot: &Shot) -> f64 {
    let of = |name: &str| shot.stats[name].as_f64().unwrap_or(f64::NAN);
    of("stopping_seconds") / of("render_seconds")
}

/// A scene: its line of the page, and the calls.
fn scene(program: &Program, name: &str, side: u32) -> Result<(String, Vec<String>), String> {
    let job =
        |spp: u32, rule: &str| Job::new(bundled(name), side, spp, format!("{FLAGS} {rule}").trim());
    let reference = program.shot(&job(LIMIT, "").reference(REFERENCE_SPP))?;
    let truth = Pixels::read(&reference.exr)?;
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let signed =
        |(bias, error): (f64, f64)| format!("{:+.2} ± {:.2} %", 100.0 * bias, 100.0 * error);
    let mut calls = vec![reference.command.clone()];
    let mut rows = Vec::new();
    let mut sheets: [Vec<Picture>; 3] = Default::default();
    for (what, rule) in [("uniform", "")].into_iter().chain(RULES) {
        let shot = program.shot(&job(LIMIT, rule))?;
        let pixels = Pixels::read(&shot.exr)?;
        let mean = pixels.mean_count();
        let as_many = program.shot(&job(mean.round() as u32, ""))?;
        calls.extend([&shot, &as_many].map(|shot| shot.command.clone()));
        let is_adaptive = !rule.is_empty();
        let only = |text: String| if is_adaptive { text } else { String::new() };
        let converged = pixels.stopped.iter().filter(|s| **s).count() as f64;
        let [dark, bright] = pixels.off(&truth);
        rows.push(vec![
            what.to_owned(),
            format!("{mean:.0}"),
            percent(mean / f64::from(LIMIT)),
            only(percent(converged / f64::from(side * side))),
            short(error(&shot.picture, &reference.picture)),
            only(short(error(&as_many.picture, &reference.picture))),
            signed(pixels.mean_off(&truth)),
            only(signed(pixels.stopped_off(&truth))),
            only(format!("{} / {}", percent(dark), percent(bright))),
            time(shot.seconds),
            only(percent(overhead(&shot))),
        ]);
        if is_adaptive {
            sheets[0].push(shot.picture);
            sheets[1].push(pixels.map(side, MapColors::Rate));
            sheets[2].push(pixels.map(side, MapColors::Viridis));
        }
    }
    let pictures: Vec<_> = sheets.iter().flatten().map(|picture| (picture, 0.0)).collect();
    let head = [
        "rule",
        "samples per pixel",
        "of uniform's",
        "stopped",
        "error",
        "error of uniform with as many",
        "mean off by",
        "stopped pixels off by",
        "of them too dark / bright",
        "time",
        "for the rule",
    ];
    let picture = sheet(&format!("adaptive-{name}"), name, &pictures, 3, 192 / side as usize)?;
    let text = format!(
        "{picture}\n{}\nReference: {REFERENCE_SPP} samples per pixel, by its own estimate with error {}; ε {}.\n",
        table(&head, rows),
        short(reference.estimate()),
        epsilon(&reference.picture),
    );
    Ok((text, calls))
}

/// Both scenes.
pub(crate) fn run(program: &Program) -> Result<String, String> {
    let (diffuse, mut calls) = scene(program, "cornell-spheres-diffuse", 64)?;
    // Smaller, since nearly every pixel takes all samples.
    let (caustic, more) = scene(program, "cornell-spheres", 40)?;
    calls.extend(more);
    Ok(format!(
        "Three rules, each of which asks for a half-width of 5 % of a pixel's mean at a confidence of\n\
         95 %, with {LIMIT} samples of a pixel at most; 1 light sample, at most 5 bounces. From left to\n\
         right the seed's rule (1.96 σ / √n every 64 samples), `--noise 0.05`, and that with `--preset\n\
         strict`. Below the pictures the samples taken, as `--sample-map FILE.png` writes them: with\n\
         `--sample-map-colors rate` blue for few, green for half of the limit, red for all; then in\n\
         viridis, dark blue for the fewest of that picture, yellow for the most, by the logarithm.\n\n\
         *Stopped* are pixels that a rule ended before the limit; how far they are *off* is the mean of\n\
         their relative differences from the reference, and *too dark / bright* the share of them that\n\
         differs by more than 5 %. ± is one standard error, by the noise of picture and reference as\n\
         they show it themselves. The rule's own share is of the time on the clock.\n\n\
         **Diffuse.** All three save most of the samples, and have less error than uniform sampling with\n\
         as many. The seed's rule takes the samples for independent; ours looks at the spread of\n\
         consecutive runs, which is smaller with Sobol points, so the default stops earlier. The black\n\
         background at the rim stops at once by the seed's rule, and by ours when it may.\n\n\
         {diffuse}\n\
         **Mirror and glass.** The light that glass and mirror throw is found only by chance, and it falls\n\
         on walls and floor as well, faintly. The seed's rule stops pixels that have not met it yet,\n\
         for good: a large part of those it stops are too dark, none too bright, and the whole picture\n\
         lacks light that no longer limit brings back. Ours saves next to nothing here, and took\n\
         longer than uniform sampling: at this limit few pixels can know their mean to 5 %. The picture's\n\
         mean is right within its noise, but of the few pixels that it stops more than one in twenty are\n\
         still too dark, fewer with the strict preset.\n\n\
         {caustic}\n{}",
        commands(calls.iter().map(String::as_str)),
    ))
}
