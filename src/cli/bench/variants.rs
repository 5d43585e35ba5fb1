//! The default method with one thing switched.

use super::child;
use super::flags::BenchFlags;
use super::lane::{Lane, Ours};
use super::measure::at;
use crate::cli::job::Job;
use crate::cli::talk;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use steradian::renderer::PreparedScene;
use steradian::settings::{LightSelection, Sampler, Strategy};
use steradian::stopping::{CalibratedRule, Preset, StoppingRule};
use steradian::{RenderSettings, Result};

/// Renders that look for the tolerance of an adaptive render.
const PILOTS: usize = 4;

/// What is switched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Variant {
    WithoutLightSampling,
    WithoutMis,
    WithoutRoulette,
    IndependentSampler,
    UniformLights,
    Adaptive,
    EveryFeature,
}

impl Variant {
    pub(super) const ALL: [Self; 7] = [
        Self::WithoutLightSampling,
        Self::WithoutMis,
        Self::WithoutRoulette,
        Self::IndependentSampler,
        Self::UniformLights,
        Self::Adaptive,
        Self::EveryFeature,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::WithoutLightSampling => "no light sampling",
            Self::WithoutMis => "no MIS",
            Self::WithoutRoulette => "no roulette",
            Self::IndependentSampler => "independent sampler",
            Self::UniformLights => "lights uniform",
            Self::Adaptive => "adaptive",
            Self::EveryFeature => "not specialised",
        }
    }

    fn settings(self, base: &RenderSettings) -> RenderSettings {
        let mut settings = base.clone();
        match self {
            Self::WithoutLightSampling => settings.strategy = Strategy::Bsdf,
            Self::WithoutMis => settings.strategy = Strategy::Light,
            Self::WithoutRoulette => settings.roulette = false,
            Self::IndependentSampler => settings.sampler = Sampler::Independent,
            Self::UniformLights => settings.light_selection = LightSelection::Uniform,
            Self::EveryFeature => settings.all_features = true,
            Self::Adaptive => {}
        }
        settings
    }
}

/// What a variant is made from.
pub(super) struct Context<'a> {
    pub(super) path: &'a Path,
    pub(super) flags: &'a BenchFlags,
    pub(super) job: &'a Job,
    pub(super) prepared: &'a Arc<PreparedScene>,
    pub(super) points: &'a [u32],
}

/// The method, or why there is none.
pub(super) fn lane(
    variant: Variant,
    context: &Context,
) -> Result<std::result::Result<Box<dyn Lane>, String>> {
    let base = &context.job.settings;
    let settings = variant.settings(base);
    let name = variant.name();
    if settings == *base && variant != Variant::Adaptive {
        return Ok(Err(format!("{name}: the default is as that already.")));
    }
    if variant == Variant::EveryFeature && !fills_cache(context)? {
        let limit = context.flags.compile_limit;
        return Ok(Err(format!("{name}: the kernel was not compiled within {limit} s.")));
    }
    let points: Vec<_> = match variant {
        Variant::Adaptive => {
            let least = rule(1.0).constants().least_samples;
            let enough: Vec<u32> = context.points.iter().copied().filter(|n| *n >= least).collect();
            if enough.is_empty() {
                return Ok(Err(format!(
                    "{name}: takes {least} samples at least, --spp has fewer."
                )));
            }
            let points: Result<Vec<_>> = enough.iter().map(|&spp| adaptive(context, spp)).collect();
            points?
        }
        _ => context.points.iter().map(|&spp| at(&settings, spp)).collect(),
    };
    talk::line(&format!("  compiling: {name}"));
    let (prepared, scene) = (context.prepared, &context.job.scene);
    Ok(Ok(Box::new(Ours::new(name, prepared, scene, &points)?)))
}

/// Compiles every feature in a child, into the driver's cache that this process reads as well: a
/// child can be stopped.
fn fills_cache(context: &Context) -> Result<bool> {
    talk::line("  compiling every feature in a child");
    let mut request = child::Request::new(context.path, context.flags);
    request
        .flags
        .extend(["--features", "all", "--spp", "1", "--resolution", "8x8"].map(Into::into));
    request.limit = Some(Duration::from_secs_f64(context.flags.compile_limit));
    Ok(child::render(&request)?.is_some())
}

fn rule(tolerance: f32) -> CalibratedRule {
    CalibratedRule { tolerance, confidence: 0.95, preset: Preset::Default }
}

/// Settings of a rule whose pixels take about `spp` samples in the mean. It cannot be fewer than
/// its least number of samples.
fn adaptive(context: &Context, spp: u32) -> Result<RenderSettings> {
    let mut tolerance = 0.2_f32;
    let of = |tolerance: f32| RenderSettings {
        stopping: Some(StoppingRule::Calibrated(rule(tolerance))),
        spp: spp.saturating_mul(16),
        ..context.job.settings.clone()
    };
    for pilot in 0..PILOTS {
        let (prepared, scene) = (context.prepared, &context.job.scene);
        let mut lane = Ours::new("pilot", prepared, scene, &[of(tolerance)])?;
        let taken = lane.take(0, u32::MAX - pilot as u32)?.samples;
        // The half-width falls with the root of the samples.
        let next = tolerance * (taken / f64::from(spp)).sqrt() as f32;
        tolerance = next.clamp(1e-4, 1.0);
    }
    Ok(of(tolerance))
}
