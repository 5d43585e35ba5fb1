//! When a render stops: flags, and what is said about it afterwards.

use super::values::{self, Parsed};
use clap::Args;
use std::time::Duration;
use steradian::RenderSettings;
use steradian::film::{Film, PixelStop};
use steradian::image::MapColors;
use steradian::stopping::{CalibratedRule, Preset, SeedRule, StopReason, StoppingRule};

/// Samples of a pixel where only the time is limited: no end in practice.
const UNLIMITED_SPP: u32 = 1 << 31;
/// Samples of a pixel at most where pixels stop one by one, and no number is given.
const ADAPTIVE_SPP: u32 = 4096;
/// Share of all cases in which an interval holds, unless said otherwise.
pub(super) const CONFIDENCE: f64 = 0.95;

pub(crate) const PRESETS: &[(&str, Preset, &str)] = &[
    ("default", Preset::Default, "a pixel's evidence, and that of the neighbours of its kind"),
    (
        "strict",
        Preset::Strict,
        "more samples, and all neighbours' evidence: the confidence is kept",
    ),
];

pub(crate) const MAP_COLORS: &[(&str, MapColors, &str)] = &[
    ("viridis", MapColors::Viridis, "dark blue few, yellow many, in even steps"),
    ("rate", MapColors::Rate, "blue few, green half, red all"),
];

/// When to stop. Whatever comes first.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Stopping")]
pub(crate) struct StoppingFlags {
    /// Samples per pixel; 64 by default, no limit with --time alone, at most 4096 where
    /// pixels stop one by one
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) spp: Option<u32>,

    /// Stop after this time, such as 30s, 1.5m or 2h
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    pub(crate) time: Option<Duration>,

    /// Each pixel until the half-width of its interval is this share of its mean, such as 0.05
    #[arg(long, value_name = "TOL", value_parser = values::share, conflicts_with_all = ["reference", "block"])]
    noise: Option<f32>,

    /// Confidence of that interval
    #[arg(long, value_name = "P", requires = "noise", conflicts_with = "adaptive", value_parser = values::confidence)]
    confidence: Option<f64>,

    /// How much evidence a pixel needs
    #[arg(long, requires = "noise", conflicts_with = "adaptive", value_parser = values::one_of(PRESETS))]
    preset: Option<Preset>,

    /// Each pixel until 1.96 standard errors are this share of its mean, tested every BATCH
    /// samples: the rule that this project began with, for comparison
    #[arg(long, value_name = "seed[:BATCH,TOL]", value_parser = seed_rule, conflicts_with_all = ["noise", "reference", "block"])]
    adaptive: Option<SeedRule>,
}

/// `seed`, `seed:BATCH` or `seed:BATCH,TOLERANCE`.
fn seed_rule(text: &str) -> Parsed<SeedRule> {
    let form =
        || "expected seed, seed:BATCH or seed:BATCH,TOLERANCE, such as seed:32,0.05".to_owned();
    let (name, numbers) = text.split_once(':').unwrap_or((text, ""));
    if name != "seed" {
        return Err(form());
    }
    let mut rule = SeedRule::default();
    if text.contains(':') {
        let (batch, tolerance) = numbers.split_once(',').unwrap_or((numbers, "0.05"));
        rule.batch = batch.parse().ok().filter(|b| *b > 0).ok_or_else(form)?;
        rule.tolerance = values::share(tolerance)?;
    }
    Ok(rule)
}

impl StoppingFlags {
    /// So many samples of every pixel.
    pub(crate) fn of_spp(spp: Option<u32>) -> Self {
        Self { spp, time: None, noise: None, confidence: None, preset: None, adaptive: None }
    }

    /// Each pixel until a noise, with so many samples at most.
    pub(crate) fn of_noise(spp: Option<u32>, rule: &CalibratedRule) -> Self {
        let CalibratedRule { tolerance, confidence, preset } = *rule;
        let noise = Some(tolerance);
        let (confidence, preset) = (Some(confidence), Some(preset));
        Self { noise, confidence, preset, ..Self::of_spp(spp) }
    }

    /// These, or, where nothing says when to stop, each pixel until this noise.
    #[cfg(feature = "viewer")]
    pub(crate) fn or_noise(mut self, tolerance: f32) -> Self {
        let is_given = self.spp.is_some() || self.time.is_some() || self.adaptive.is_some();
        if !is_given && self.noise.is_none() {
            self.noise = Some(tolerance);
        }
        self
    }

    /// The rule that is asked for.
    pub(crate) fn rule(&self) -> Option<StoppingRule> {
        if let Some(rule) = self.adaptive {
            return Some(StoppingRule::Seed(rule));
        }
        let confidence = self.confidence.unwrap_or(CONFIDENCE);
        let preset = self.preset.unwrap_or(Preset::Default);
        self.noise.map(|tolerance| {
            StoppingRule::Calibrated(CalibratedRule { tolerance, confidence, preset })
        })
    }

    /// Samples per pixel that are asked for, as a limit or by default; `None` if only the time
    /// is limited.
    pub(crate) fn requested_spp(&self) -> Option<u32> {
        let is_adaptive = self.rule().is_some_and(|rule| rule.tolerance() > 0.0);
        match (self.spp, self.time) {
            (Some(spp), _) => Some(spp),
            (None, Some(_)) => None,
            (None, None) if is_adaptive => Some(ADAPTIVE_SPP),
            (None, None) => Some(RenderSettings::default().spp),
        }
    }

    /// The limit that follows.
    pub(crate) fn spp_limit(&self) -> u32 {
        self.requested_spp().unwrap_or(UNLIMITED_SPP)
    }
}

/// A rule in words, for reports and metadata.
pub(crate) fn describe(rule: &StoppingRule) -> String {
    match rule {
        StoppingRule::Seed(rule) => format!("seed:{},{}", rule.batch, rule.tolerance),
        StoppingRule::Calibrated(rule) => format!(
            "noise {}, confidence {}, preset {}",
            rule.tolerance,
            rule.confidence,
            values::word_for(PRESETS, &rule.preset),
        ),
    }
}

/// Pixels by what ended them, in the order of [`StopReason::ALL`].
pub(crate) fn tally(stops: &[PixelStop]) -> [usize; 3] {
    StopReason::ALL.map(|reason| stops.iter().filter(|stop| stop.reason == reason).count())
}

/// What the rule made of the picture, in lines.
pub(crate) fn lines(rule: &StoppingRule, limit: u32, film: &Film) -> Vec<String> {
    let Some(stops) = film.stops() else { return Vec::new() };
    let [unfinished, converged, at_limit] = tally(stops);
    let percent = |count: usize| format!("{:.1} %", 100.0 * count as f64 / stops.len() as f64);
    let mut first = format!("{}: {} of the pixels converged", describe(rule), percent(converged));
    if at_limit > 0 {
        first += &format!(", {} not within {limit} samples", percent(at_limit));
    }
    if unfinished > 0 {
        first += &format!(", {} unfinished", percent(unfinished));
    }
    let counts = film.sample_counts();
    let mean = counts.iter().map(|&n| f64::from(n)).sum::<f64>() / counts.len() as f64;
    let mut sorted = counts.to_vec();
    sorted.sort_unstable();
    let [least, median, most] = [0, sorted.len() / 2, sorted.len() - 1].map(|i| sorted[i]);
    vec![first, format!("samples per pixel: {least} to {most}, median {median}, mean {mean:.0}")]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_seeds_rule_has_two_numbers() {
        let rule = |batch, tolerance| Ok(SeedRule { batch, tolerance });
        assert_eq!(seed_rule("seed"), rule(32, 0.05));
        assert_eq!(seed_rule("seed:64"), rule(64, 0.05));
        assert_eq!(seed_rule("seed:10,0.1"), rule(10, 0.1));
        assert_eq!(seed_rule("seed:10,0"), rule(10, 0.0));
        for bad in ["", "sead", "seed:", "seed:0", "seed:1.5", "seed:8,", "seed:8,-1", "seed:8,2"] {
            assert!(seed_rule(bad).is_err(), "{bad}");
        }
    }
}
