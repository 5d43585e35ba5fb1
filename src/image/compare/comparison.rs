//! Two files compared in every way.

use super::metrics::{FLIP, HDR_FLIP};
use super::noise::LUMINANCE;
use super::rule::{Failure, Rule};
use super::{
    Metrics, NoiseVerdict, PictureFile, PictureLayer, VerdictSettings, hdr_flip, ldr_flip,
};
use crate::image::OutputFormat;
use crate::settings::Crop;
use crate::{Error, Result};
use std::collections::BTreeSet;

/// What is asked of a comparison.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ComparisonOptions {
    /// Layers to compare, the empty name being the colour; all by default.
    pub layers: Vec<String>,
    /// Rules that must hold. By default [`Rule::Verdict`] where both files tell of their noise, and
    /// [`Rule::Exact`] elsewhere.
    pub rules: Vec<Rule>,
    /// For the statistical verdict.
    pub verdict: VerdictSettings,
}

/// A pixel's column and row in the window, and the channel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Location {
    /// Column.
    pub x: u32,
    /// Row.
    pub y: u32,
    /// Name of the channel.
    pub channel: String,
}

/// Values of a layer that are infinite or no numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NonFinite {
    /// Values in the layer of the actual picture.
    pub actual: usize,
    /// Values in the layer of the expected picture.
    pub expected: usize,
    /// The first one, in the actual picture if it has one.
    pub first: Location,
}

/// What was found in one layer.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerComparison {
    /// Name of the layer; empty for the colour.
    pub name: String,
    /// Errors.
    pub metrics: Metrics,
    /// Values that are not finite in either picture; with any, no metric is a number.
    pub non_finite: Option<NonFinite>,
    /// Where the difference is largest; `None` where there is none.
    pub worst: Option<Location>,
}

/// What the comparison of two files found.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Layer by layer.
    pub layers: Vec<LayerComparison>,
    /// By the noise that the files tell of.
    pub verdict: Option<NoiseVerdict>,
    /// The rules that were applied.
    pub rules: Vec<Rule>,
    /// The rules that do not hold; none if the pictures pass.
    pub failures: Vec<Failure>,
    /// What the reader should know.
    pub notes: Vec<String>,
}

impl Comparison {
    /// Compares two files.
    ///
    /// # Errors
    /// [`Error::Settings`] if they cannot be compared: kinds, sizes, windows, layers or channels
    /// differ, or a rule asks for what is not there.
    pub fn of(
        actual: &PictureFile,
        expected: &PictureFile,
        options: &ComparisonOptions,
    ) -> Result<Self> {
        check_size(actual, expected)?;
        let pairs = pair_layers(actual, expected, &options.layers)?;
        let compare = |(a, b): &(&PictureLayer, &PictureLayer)| {
            LayerComparison::of(a, b, &actual.window, actual.format)
        };
        let layers: Vec<LayerComparison> = pairs.iter().map(compare).collect();
        let is_finite =
            layers.iter().all(|layer| !layer.name.is_empty() || layer.non_finite.is_none());
        let has_color = layers.iter().any(|layer| layer.name.is_empty());
        let verdict = if is_finite && has_color {
            NoiseVerdict::of(actual, expected, &options.verdict)
        } else {
            None
        };
        let knows_noise = actual.noise.is_some() && expected.noise.is_some() && has_color;
        let rules = match (&options.rules[..], knows_noise) {
            ([], true) => vec![Rule::Verdict],
            ([], false) => vec![Rule::Exact { layer: None }],
            (rules, _) => rules.to_vec(),
        };
        let mut failures = Vec::new();
        for layer in layers.iter().filter(|layer| layer.non_finite.is_some()) {
            failures.push(Failure::non_finite(layer));
        }
        for rule in &rules {
            failures.extend(rule.failures(&layers, verdict.as_ref(), knows_noise)?);
        }
        let notes = notes(actual, expected, verdict.is_some());
        Ok(Self { layers, verdict, rules, failures, notes })
    }

    /// Whether every rule holds.
    pub fn passes(&self) -> bool {
        self.failures.is_empty()
    }

    /// The layer of a name; the empty one is the colour.
    pub fn layer(&self, name: &str) -> Option<&LayerComparison> {
        self.layers.iter().find(|layer| layer.name == name)
    }
}

fn check_size(actual: &PictureFile, expected: &PictureFile) -> Result<()> {
    let settings = |message: String| Err(Error::Settings(message));
    let kind = |file: &PictureFile| match file.format {
        OutputFormat::Png => "a PNG (what a display shows)",
        OutputFormat::Exr => "an EXR (linear radiance)",
    };
    if actual.format != expected.format {
        let (a, b) = (kind(actual), kind(expected));
        return settings(format!("one is {a}, the other {b}: compare like with like"));
    }
    if actual.resolution != expected.resolution {
        let ((w, h), (v, g)) = (actual.resolution, expected.resolution);
        return settings(format!("sizes differ: actual {w}x{h}, expected {v}x{g} pixels"));
    }
    if actual.window != expected.window {
        let [a, b] = [actual.window, expected.window]
            .map(|c| format!("{},{},{},{}", c.x, c.y, c.width, c.height));
        return settings(format!("parts of the picture differ: actual --crop {a}, expected {b}"));
    }
    Ok(())
}

/// The layers of both, by name.
fn pair_layers<'a>(
    actual: &'a PictureFile,
    expected: &'a PictureFile,
    asked: &[String],
) -> Result<Vec<(&'a PictureLayer, &'a PictureLayer)>> {
    let names = |file: &'a PictureFile| file.layers.iter().map(|layer| layer.name.as_str());
    let titles = |file: &'a PictureFile| {
        file.layers.iter().map(PictureLayer::title).collect::<Vec<_>>().join(", ")
    };
    let all: BTreeSet<&str> = match asked {
        [] => names(actual).chain(names(expected)).collect(),
        asked => asked.iter().map(String::as_str).collect(),
    };
    let mut pairs = Vec::new();
    for name in all {
        let title = if name.is_empty() { "colour" } else { name };
        let find = |file: &'a PictureFile, which: &str| {
            let missing = || {
                let has = titles(file);
                let remedy = if asked.is_empty() { "; choose layers with --layer" } else { "" };
                Error::Settings(format!("{which} has no layer {title}, only: {has}{remedy}"))
            };
            file.layer(name).ok_or_else(missing)
        };
        let (a, b) = (find(actual, "actual")?, find(expected, "expected")?);
        let channels = |layer: &PictureLayer| {
            layer.channels.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>().join(" ")
        };
        let (of_a, of_b) = (channels(a), channels(b));
        if of_a != of_b {
            return Err(Error::Settings(format!(
                "channels of layer {title} differ: actual {of_a}, expected {of_b}"
            )));
        }
        pairs.push((a, b));
    }
    if pairs.is_empty() {
        return Err(Error::Settings("the files have no layers to compare".into()));
    }
    Ok(pairs)
}

impl LayerComparison {
    fn of(a: &PictureLayer, b: &PictureLayer, window: &Crop, format: OutputFormat) -> Self {
        let (view_a, view_b) = (planes(a), planes(b));
        let colors = a.picture(window).zip(b.picture(window)).filter(|_| a.channels.len() == 3);
        let weights = match colors {
            Some(_) => LUMINANCE.to_vec(),
            None => vec![1.0 / view_a.len() as f64; view_a.len()],
        };
        let location = |channel: usize, pixel: usize| Location {
            x: pixel as u32 % window.width,
            y: pixel as u32 / window.width,
            channel: a.channels[channel].0.clone(),
        };
        let non_finite = non_finite(&view_a, &view_b, location);
        let mut metrics = Metrics::of(&view_a, &view_b, &weights);
        if non_finite.is_some() {
            let flips: &[_] = match (&colors, format) {
                (None, _) => &[],
                (Some(_), OutputFormat::Png) => &[FLIP],
                (Some(_), OutputFormat::Exr) => &[FLIP, HDR_FLIP],
            };
            let metrics = metrics.failed(flips);
            return Self { name: a.name.clone(), metrics, non_finite, worst: None };
        }
        if let Some((a, b)) = &colors {
            metrics.add_flip(&ldr_flip(a, b));
            if format == OutputFormat::Exr {
                metrics.add_flip(&hdr_flip(a, b));
            }
        }
        Self { name: a.name.clone(), metrics, non_finite, worst: worst(&view_a, &view_b, location) }
    }

    /// The name for people: "colour" for the main layer.
    pub fn title(&self) -> &str {
        if self.name.is_empty() { "colour" } else { &self.name }
    }
}

fn planes(layer: &PictureLayer) -> Vec<&[f32]> {
    layer.channels.iter().map(|(_, values)| values.as_slice()).collect()
}

fn non_finite(
    a: &[&[f32]],
    b: &[&[f32]],
    location: impl Fn(usize, usize) -> Location,
) -> Option<NonFinite> {
    let count =
        |planes: &[&[f32]]| planes.iter().flat_map(|p| p.iter()).filter(|v| !v.is_finite()).count();
    let first = |planes: &[&[f32]]| {
        let places = planes.iter().enumerate();
        let places = places.filter_map(|(c, p)| Some((p.iter().position(|v| !v.is_finite())?, c)));
        places.min()
    };
    let (pixel, channel) = first(a).or_else(|| first(b))?;
    Some(NonFinite { actual: count(a), expected: count(b), first: location(channel, pixel) })
}

fn worst(
    a: &[&[f32]],
    b: &[&[f32]],
    location: impl Fn(usize, usize) -> Location,
) -> Option<Location> {
    let mut worst = (0.0, None);
    for (c, (a, b)) in a.iter().zip(b).enumerate() {
        for (i, (a, b)) in a.iter().zip(*b).enumerate() {
            let error = (a - b).abs();
            if error > worst.0 {
                worst = (error, Some((c, i)));
            }
        }
    }
    worst.1.map(|(c, i)| location(c, i))
}

/// Settings under which the two pictures cannot be the same, or are the same by construction.
fn notes(actual: &PictureFile, expected: &PictureFile, has_verdict: bool) -> Vec<String> {
    let pair = |name| actual.setting(name).zip(expected.setting(name));
    let mut notes = Vec::new();
    let compared = [
        "scene",
        "scene_hash",
        "device",
        "driver",
        "version",
        "spp",
        "strategy",
        "sampler",
        "max_bounces",
        "only_bounce",
        "light_samples",
        "light_selection",
        "light_candidates",
        "roulette",
        "path_reuse",
        "camera",
        "faults",
        "partial",
        "exposure",
        "tone",
    ];
    for name in compared {
        if let Some((a, b)) = pair(name)
            && a != b
        {
            notes.push(format!("{name}: actual {a}, expected {b}"));
        }
    }
    if has_verdict && pair("seed").is_some_and(|(a, b)| a == b) {
        notes.push(
            "both have the same seed: they may share their noise, which raises no false alarms, but hides \
             differences that other noise would show"
                .into(),
        );
    }
    notes
}
