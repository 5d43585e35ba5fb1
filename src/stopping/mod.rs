//! Which pixels go on: rules that look at the samples taken so far.
//!
//! A pixel's block means come in rounds. At its points of decision a rule compares the half-width
//! of a confidence interval of its mean luminance with a tolerance. What is here is plain
//! arithmetic; `passes::Adaptive` does the same on the device, for all pixels at once.

mod calibrated;
mod seed;

pub use calibrated::{CalibratedRule, Constants, Evidence, Judgement, Preset};
pub use seed::{RunningSums, SeedRule};

pub use crate::shader::generated::StopReason;

use crate::film::{RUNS, runs};

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

    /// Samples of a block.
    pub fn block_size(&self) -> u32 {
        match self {
            Self::Calibrated(_) => calibrated::BLOCK_SIZE,
            Self::Seed(rule) => rule.block_size(),
        }
    }

    /// Whether a pixel is judged when it has so many samples.
    pub fn decides_at(&self, sample_count: u32) -> bool {
        match self {
            Self::Calibrated(_) => {
                let blocks = sample_count / calibrated::BLOCK_SIZE;
                let (per_run, complete) = runs(blocks);
                complete >= RUNS / 2 && blocks % (per_run * RUNS as u32 / 4) == 0
            }
            Self::Seed(rule) => sample_count % rule.batch == 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decisions_fall_on_eight_and_twelve_runs() {
        let rule = StoppingRule::Calibrated(CalibratedRule::new(0.05, 0.95, Preset::Default));
        let points: Vec<u32> = (1..=128).map(|b| 8 * b).filter(|&n| rule.decides_at(n)).collect();
        assert_eq!(points, [64, 96, 128, 192, 256, 384, 512, 768, 1024]);
        let rule = StoppingRule::Seed(SeedRule { batch: 10, tolerance: 0.05 });
        assert!(rule.decides_at(10) && rule.decides_at(100) && !rule.decides_at(32));
    }
}
