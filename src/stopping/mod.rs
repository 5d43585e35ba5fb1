//! Which pixels go on: rules that look at the samples taken so far.
//!
//! A pixel's block means come in rounds. At its points of decision a rule compares the half-width
//! of a confidence interval of its mean luminance with a tolerance. What is here is plain
//! arithmetic; `passes::Adaptive` does the same on the device, for all pixels at once.

mod calibrated;
pub mod coverage;
mod seed;

pub use calibrated::{CalibratedRule, Constants, Evidence, Judgement, Preset};
pub use seed::{RunningSums, SeedRule};

pub use crate::shader::generated::StopReason;

use crate::film::{RUNS, runs};
use crate::shader::generated::MOST_BLOCK_SAMPLES;

/// What a pixel's half-width is compared with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StoppingRule {
    /// The interval holds the mean as often as it says.
    Calibrated(CalibratedRule),
    /// The rule that this project began with.
    Seed(SeedRule),
}

impl StoppingRule {
    /// Relative half-width that is asked for; 0 never stops a pixel.
    pub fn tolerance(&self) -> f32 {
        match self {
            Self::Calibrated(rule) => rule.tolerance,
            Self::Seed(rule) => rule.tolerance,
        }
    }

    /// What is wrong with it, if anything is.
    pub(crate) fn fault(&self) -> Option<String> {
        let tolerance = self.tolerance();
        if !(0.0..=1.0).contains(&tolerance) {
            return Some(format!("tolerance {tolerance}: must be a share of the mean, 0 to 1"));
        }
        match self {
            Self::Calibrated(rule) if !(0.5..1.0).contains(&rule.confidence) => {
                Some(format!("confidence {}: must be at least 0.5 and below 1", rule.confidence))
            }
            Self::Seed(rule) if rule.batch == 0 => Some("batch: must be at least 1".into()),
            _ => None,
        }
    }

    /// Samples of a unit, the smallest block.
    pub fn unit(&self) -> u32 {
        match self {
            Self::Calibrated(_) => calibrated::UNIT,
            Self::Seed(rule) => rule.unit(),
        }
    }

    /// Samples of the largest block.
    pub fn largest_block(&self) -> u32 {
        match self {
            Self::Calibrated(_) => MOST_BLOCK_SAMPLES,
            Self::Seed(rule) => rule.largest_block(),
        }
    }

    /// Samples of the block that a pixel takes when it has `sample_count`: its runs' length, so
    /// that the more samples it has, the less it is looked at.
    pub fn block_at(&self, sample_count: u32) -> u32 {
        let (units_per_run, _) = runs(sample_count / self.unit());
        (units_per_run * self.unit()).min(self.largest_block())
    }

    /// Whether a pixel is judged when it has so many samples.
    pub fn decides_at(&self, sample_count: u32) -> bool {
        match self {
            Self::Calibrated(_) => {
                let (per_run, complete) = runs(sample_count / calibrated::UNIT);
                let run = per_run * calibrated::UNIT;
                complete >= RUNS / 2 && sample_count.is_multiple_of(run * RUNS as u32 / 4)
            }
            Self::Seed(rule) => sample_count.is_multiple_of(rule.batch),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decisions_fall_on_eight_and_twelve_runs() {
        let rule = StoppingRule::Calibrated(CalibratedRule::new(0.05, 0.95, Preset::Default));
        let points: Vec<u32> = (1..=1024).filter(|&n| rule.decides_at(n)).collect();
        assert_eq!(points, [64, 96, 128, 192, 256, 384, 512, 768, 1024]);
        let blocks = [0, 64, 120, 128, 256, 512, 1024, 4096].map(|n| rule.block_at(n));
        assert_eq!(blocks, [8, 8, 8, 16, 32, 64, 128, 128]);
        let rule = StoppingRule::Seed(SeedRule { batch: 10, tolerance: 0.05 });
        assert_eq!([0, 64, 4096].map(|n| rule.block_at(n)), [2; 3]);
        assert!(rule.decides_at(10) && rule.decides_at(100) && !rule.decides_at(32));
    }
}
