//! `steradian bench --coverage`.

use super::BenchFlags;
use crate::cli::destination::check_place;
use crate::cli::job::Job;
use crate::cli::{talk, values};
use serde::Serialize;
use std::fmt::Write;
use std::process::ExitCode;
use std::sync::Arc;
use steradian::film::Film;
use steradian::gpu::Device;
use steradian::image::write_atomically;
use steradian::stopping::coverage::{Coverage, CoverageReport, Interval, Truth};
use steradian::stopping::{CalibratedRule, Preset, SeedRule, StoppingRule};
use steradian::{Error, RenderSettings, Renderer, Result};

/// Independent streams that the truth is the mean of.
const TRUTH_STREAMS: usize = 16;
/// The truth's standard error is to be at most this share of the tolerance,
const TRUTH_SHARE: f64 = 0.1;
/// in this share of the pixels.
const TRUTH_PIXELS: f64 = 0.99;
/// Samples of a stream's first part; each part after it doubles what there is.
const TRUTH_FIRST: u32 = 256;
/// Runs of each rule, unless said otherwise, and at least.
const RUNS: u32 = 64;
const LEAST_RUNS: u32 = 8;
/// Runs of a rule that tell how many samples it takes.
const PILOT: u32 = 4;
/// First seeds of runs, of their uniform counterparts, and of the truth's parts.
const SEEDS: [u32; 3] = [1, 1 << 20, 1 << 21];

/// Rules whose coverage is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rule {
    /// The seed's, with batches of 32.
    Seed,
    /// The calibrated one.
    Calibrated(Preset),
}

pub(super) const RULES: &[(&str, Rule, &str)] = &[
    ("seed", Rule::Seed, "1.96 standard errors, tested every 32 samples"),
    ("default", Rule::Calibrated(Preset::Default), "--noise"),
    ("strict", Rule::Calibrated(Preset::Strict), "--noise with --preset strict"),
];

/// Figures of one rule on one scene.
#[derive(Serialize)]
struct Row<'a> {
    scene: &'a str,
    device: &'a str,
    driver: &'a str,
    rule: &'a str,
    tolerance: f32,
    confidence: f64,
    runs: u32,
    limit: u32,
    truth_spp: f64,
    truth_resolved: f64,
    #[serde(flatten)]
    report: Figures,
}

#[derive(Serialize)]
struct Figures {
    coverage: [f64; 3],
    tenth_percentile: f64,
    tenth_percentile_by_chance: f64,
    worst: f64,
    pixels: usize,
    black_stops: usize,
    at_limit: f64,
    bias: [f64; 3],
    samples: (u32, f64, u32),
    samples_over_oracle: f64,
    relmse_ratio: [f64; 3],
    relmse_ratio_at_equal_time: [f64; 3],
    overhead: f64,
}

impl From<&CoverageReport> for Figures {
    fn from(r: &CoverageReport) -> Self {
        let numbers = |i: &Interval| [i.value, i.low, i.high];
        Self {
            coverage: numbers(&r.coverage),
            tenth_percentile: r.tenth_percentile,
            tenth_percentile_by_chance: r.tenth_percentile_by_chance,
            worst: r.worst,
            pixels: r.pixels,
            black_stops: r.black_stops,
            at_limit: r.at_limit,
            bias: numbers(&r.bias),
            samples: r.samples,
            samples_over_oracle: r.samples_over_oracle,
            relmse_ratio: numbers(&r.relmse_ratio),
            relmse_ratio_at_equal_time: numbers(&r.relmse_ratio_at_equal_time),
            overhead: r.overhead,
        }
    }
}

/// Measures, and prints a table.
pub(super) fn run(flags: &BenchFlags) -> Result<ExitCode> {
    if let Some(path) = &flags.json {
        check_place(path)?;
    }
    let runs = flags.runs.unwrap_or(RUNS);
    if runs < LEAST_RUNS {
        return Err(Error::Settings(format!(
            "--runs {runs}: --coverage takes {LEAST_RUNS} at least"
        )));
    }
    let [scene] = &flags.scenes[..] else {
        return Err(Error::Settings("--coverage: one scene at a time".into()));
    };
    let job = Job::new(scene, &flags.coverage_job()?)?;
    let Some(StoppingRule::Calibrated(asked)) = job.settings.stopping_rule() else {
        let message = "--coverage: the tolerance of --noise must be more than 0";
        return Err(Error::Settings(message.into()));
    };
    let device = Arc::new(Device::open(flags.device.as_deref())?);
    let bench = Bench { job: &job, device: device.clone(), asked, runs };
    let truth = bench.truth(flags.truth_spp)?;
    let resolved = truth.resolved(TRUTH_SHARE * f64::from(asked.tolerance));
    let mut rows = Vec::new();
    for rule in &flags.rules {
        let name = values::word_for(RULES, rule);
        let report = bench.coverage(*rule, name, &truth)?;
        rows.push(Row {
            scene: &job.scene.name,
            device: &device.info().name,
            driver: &device.info().driver,
            rule: name,
            tolerance: asked.tolerance,
            confidence: asked.confidence,
            runs,
            limit: job.settings.spp,
            truth_spp: truth.samples(),
            truth_resolved: resolved,
            report: (&report).into(),
        });
    }
    talk::data(&table(&rows))?;
    if let Some(path) = &flags.json {
        let json = serde_json::to_string_pretty(&rows).map_err(|e| Error::io(path, e.into()))?;
        write_atomically(path, |file| {
            use std::io::Write;
            file.write_all(json.as_bytes()).map_err(|e| Error::io(path, e))
        })?;
    }
    Ok(ExitCode::SUCCESS)
}

struct Bench<'a> {
    job: &'a Job,
    device: Arc<Device>,
    asked: CalibratedRule,
    runs: u32,
}

impl Bench<'_> {
    fn renderer(&self, settings: &RenderSettings) -> Result<Renderer> {
        Renderer::new(self.device.clone(), &self.job.scene, settings)
    }

    /// Renders until nearly all pixels are known, or have `most` samples.
    fn truth(&self, most: u32) -> Result<Truth> {
        let window = self.job.settings.window();
        let pixels = window.width as usize * window.height as usize;
        let mut truth = Truth::new(pixels, TRUTH_STREAMS);
        let needed = TRUTH_SHARE * f64::from(self.asked.tolerance);
        let mut seed = SEEDS[2];
        loop {
            // Twice as many samples as before.
            let spp = ((truth.samples() / TRUTH_STREAMS as f64) as u32).max(TRUTH_FIRST);
            let settings = RenderSettings { stopping: None, spp, ..self.job.settings.clone() };
            let mut renderer = self.renderer(&settings)?;
            truth.extend(spp, |_| {
                seed += 1;
                Ok::<_, Error>(render(&mut renderer, seed)?.clone())
            })?;
            let resolved = truth.resolved(needed);
            let percent = 100.0 * resolved;
            talk::line(&format!("truth: {} spp, {percent:.1} % of the pixels", truth.samples()));
            if resolved >= TRUTH_PIXELS || 2.0 * truth.samples() > f64::from(most) {
                return Ok(truth);
            }
        }
    }

    fn coverage(&self, rule: Rule, name: &str, truth: &Truth) -> Result<CoverageReport> {
        let tolerance = self.asked.tolerance;
        let (rule, first) = match rule {
            Rule::Seed => {
                let rule = SeedRule { tolerance, ..SeedRule::default() };
                (StoppingRule::Seed(rule), rule.batch)
            }
            Rule::Calibrated(preset) => {
                let rule = CalibratedRule { preset, ..self.asked };
                (StoppingRule::Calibrated(rule), rule.constants().least_samples)
            }
        };
        let mut coverage = Coverage::new(truth, tolerance.into());
        let adaptive = RenderSettings { stopping: Some(rule), ..self.job.settings.clone() };
        let mut adaptive = self.renderer(&adaptive)?;
        let mut run_adaptive = |coverage: &mut Coverage, k| {
            render(&mut adaptive, SEEDS[0] + k)?;
            let s = adaptive.statistics();
            coverage.add_adaptive(adaptive.film(), s.render_seconds, s.stopping_seconds);
            Ok::<_, Error>(())
        };
        for k in 0..PILOT {
            run_adaptive(&mut coverage, k)?;
        }
        let spp = coverage.equal_spp();
        talk::line(&format!("{name}: {spp} spp on average"));
        let uniform = RenderSettings { stopping: None, spp, ..self.job.settings.clone() };
        let mut uniform = self.renderer(&uniform)?;
        // By turns, so that what else the machine does falls on both.
        for k in 0..self.runs {
            if k + PILOT < self.runs {
                run_adaptive(&mut coverage, k + PILOT)?;
            }
            render(&mut uniform, SEEDS[1] + k)?;
            coverage.add_uniform(uniform.film(), spp, uniform.statistics().render_seconds);
        }
        Ok(coverage.report(self.asked.confidence, first, self.job.settings.spp))
    }
}

/// Renders with another seed.
fn render(renderer: &mut Renderer, seed: u32) -> Result<&Film> {
    renderer.restart(seed)?;
    while renderer.step()? {}
    renderer.finish()?;
    Ok(renderer.film())
}

/// As it was given: 7 and not 7.000000029802322.
fn percent(share: f32) -> f64 {
    (f64::from(share) * 1e8).round() / 1e6
}

/// Markdown.
fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "| scene | rule | coverage | 10th percentile (by chance) | worst | black | at limit | bias | \
         samples least/mean/most | of oracle | relMSE, equal samples | equal time | overhead |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let interval = |[value, low, high]: [f64; 3]| format!("{value:.3} ({low:.3}-{high:.3})");
    for row in rows {
        let r = &row.report;
        let (least, mean, most) = r.samples;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {} | {} {} % | {} | {:.3} ({:.3}) | {:.2} | {} | {:.1} % | {:+.2} % ({:+.2} to {:+.2}) \
             | {least}/{mean:.0}/{most} | {:.2} | {} | {} | {:.1} % |",
            row.scene,
            row.rule,
            percent(row.tolerance),
            interval(r.coverage),
            r.tenth_percentile,
            r.tenth_percentile_by_chance,
            r.worst,
            r.black_stops,
            100.0 * r.at_limit,
            100.0 * r.bias[0],
            100.0 * r.bias[1],
            100.0 * r.bias[2],
            r.samples_over_oracle,
            interval(r.relmse_ratio),
            interval(r.relmse_ratio_at_equal_time),
            100.0 * r.overhead,
        );
    }
    if let Some(row) = rows.first() {
        let _ = writeln!(
            text,
            "\n{} runs of a picture, at most {} samples of a pixel. Truth: {} samples of a pixel, \
             known to a tenth of the tolerance in {:.1} % of the pixels. {}, {}",
            row.runs,
            row.limit,
            row.truth_spp,
            100.0 * row.truth_resolved,
            row.device,
            row.driver,
        );
    }
    text
}
