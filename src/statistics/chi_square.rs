//! Pearson's chi-square test of counts against expectations.

use super::{Verdict, chi_square_survival};
use std::fmt;

/// Cells that expect fewer counts are pooled: below, the statistic does not follow the
/// chi-square distribution (Cochran 1954).
pub const LEAST_EXPECTED: f64 = 5.0;

/// How well counts fit their expectations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoodnessOfFit {
    /// Sum over pooled cells of (observed - expected)² / expected.
    pub statistic: f64,
    /// Pooled cells less one; 0 when there is nothing to compare.
    pub degrees_of_freedom: usize,
    /// Counts in cells that expect none.
    pub impossible: u64,
    /// All expectations over all counts: the integral of the density that was tested,
    /// over everything that can be drawn. Must be 1.
    pub expected_share: f64,
    /// Chance of so large a statistic, or larger, if the expectations are right; 0 if
    /// something impossible was seen or the shares do not add up to 1.
    pub p_value: f64,
}

/// Error that a quadrature may leave in the sum of all expectations.
const SHARE_TOLERANCE: f64 = 1e-4;

impl GoodnessOfFit {
    /// Compares counts of a fixed number of independent draws with what a hypothesis
    /// without fitted parameters expects, cell by cell. Cells of small expectation are
    /// pooled, smallest first, until a pool expects [`LEAST_EXPECTED`].
    ///
    /// # Panics
    /// If there is not one expectation, at least 0, per cell.
    pub fn of(observed: &[u64], expected: &[f64]) -> Self {
        assert_eq!(observed.len(), expected.len(), "one expectation per cell");
        assert!(expected.iter().all(|&e| e >= 0.0), "an expectation is negative or not a number");
        let total = observed.iter().sum::<u64>() as f64;
        let mut cells: Vec<_> = expected.iter().copied().zip(observed.iter().copied()).collect();
        let impossible = cells.iter().filter(|(e, _)| *e == 0.0).map(|(_, o)| o).sum();
        cells.retain(|(e, _)| *e > 0.0);
        let pools = pool(cells);
        let terms = pools.iter().map(|&(e, o)| (o as f64 - e).powi(2) / e);
        let (statistic, degrees_of_freedom) = (terms.sum(), pools.len().saturating_sub(1));
        let expected_share = expected.iter().sum::<f64>() / total;
        let p_value = if impossible > 0 || (expected_share - 1.0).abs() > SHARE_TOLERANCE {
            0.0
        } else if degrees_of_freedom == 0 {
            1.0
        } else {
            chi_square_survival(statistic, degrees_of_freedom as f64)
        };
        Self { statistic, degrees_of_freedom, impossible, expected_share, p_value }
    }

    /// Judges at the false-alarm rate `level`: [`super::FALSE_ALARM`] for one test,
    /// [`super::sidak`] of it for each of many. Inconclusive without two pools to compare.
    pub fn verdict(&self, level: f64) -> Verdict {
        if self.p_value.is_nan() || self.p_value < level {
            Verdict::Differs
        } else if self.degrees_of_freedom == 0 {
            Verdict::Inconclusive
        } else {
            Verdict::Agrees
        }
    }
}

impl fmt::Display for GoodnessOfFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "chi-square {:.1} with {} degrees of freedom, p = {:.2e}, {} impossible, expected share {:.6}",
            self.statistic,
            self.degrees_of_freedom,
            self.p_value,
            self.impossible,
            self.expected_share
        )
    }
}

/// Merges cells from the smallest expectation up until each expects enough; what is left
/// over joins the last pool.
fn pool(mut cells: Vec<(f64, u64)>) -> Vec<(f64, u64)> {
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut pools: Vec<(f64, u64)> = Vec::new();
    for (expected, observed) in cells {
        match pools.last_mut() {
            Some(last) if last.0 < LEAST_EXPECTED => {
                *last = (last.0 + expected, last.1 + observed);
            }
            _ => pools.push((expected, observed)),
        }
    }
    if let [.., _, last] = pools[..]
        && last.0 < LEAST_EXPECTED
    {
        pools.pop();
        if let Some(previous) = pools.last_mut() {
            *previous = (previous.0 + last.0, previous.1 + last.1);
        }
    }
    pools
}
