//! Means with standard errors, and when they agree.

use super::{CHANCE, Verdict, student_t_survival};

/// A mean and its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Mean of the observations.
    pub mean: f64,
    /// Standard deviation of the mean.
    pub standard_error: f64,
    /// Standard deviation of one observation.
    pub deviation: f64,
    /// Observations.
    pub count: usize,
}

/// What an estimate has to show of a truth T: |mean - T| ≤ 3.9 s, where s is the standard
/// error, and s ≤ e T / 4, without which a bias of e T would more often than not be missed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criterion {
    /// The relative bias e that must be visible.
    pub visible_bias: f64,
    /// Relative error that rounding adds to the mean beside chance.
    pub rounding: f64,
}

impl Estimate {
    /// From independent observations of the same number. With few, its spread is uncertain:
    /// of eight, 6 in 1000 lie beyond 3.9 standard errors, of 1000 one in 10,000.
    ///
    /// # Panics
    /// With fewer than two observations.
    pub fn of(observations: &[f64]) -> Self {
        assert!(observations.len() > 1, "one observation has no spread");
        let n = observations.len() as f64;
        let mean = observations.iter().sum::<f64>() / n;
        let squares: f64 = observations.iter().map(|x| (x - mean).powi(2)).sum();
        let deviation = (squares / (n - 1.0)).sqrt();
        Self { mean, standard_error: deviation / n.sqrt(), deviation, count: observations.len() }
    }

    /// Signed difference to `truth` in standard errors.
    pub fn z(&self, truth: f64) -> f64 {
        (self.mean - truth) / self.standard_error
    }

    /// Judges the estimate of `truth`. A difference beyond chance and rounding counts even
    /// where the estimate is coarse.
    pub fn judge(&self, truth: f64, criterion: &Criterion) -> Verdict {
        let allowed = CHANCE * self.standard_error + criterion.rounding * truth.abs();
        let within = (self.mean - truth).abs() <= allowed;
        let decides = self.standard_error <= criterion.visible_bias * truth.abs() / 4.0;
        match (within, decides) {
            (true, true) => Verdict::Agrees,
            (true, false) => Verdict::Inconclusive,
            (false, _) => Verdict::Differs,
        }
    }

    /// Judges whether two independent estimates are of one number, in the same sense:
    /// `other` is the truth, and the standard errors add in square.
    pub fn judge_against(&self, other: &Self, criterion: &Criterion) -> Verdict {
        let standard_error = self.standard_error.hypot(other.standard_error);
        Self { standard_error, ..*self }.judge(other.mean, criterion)
    }
}

/// A difference of two means of unequal variance (Welch 1947).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Welch {
    /// First mean less second.
    pub difference: f64,
    /// Standard error of the difference.
    pub standard_error: f64,
    /// Degrees of freedom that fit the variance of the standard error.
    pub degrees_of_freedom: f64,
}

impl Welch {
    /// From the difference and the estimated variances whose sum is its variance, each
    /// with its degrees of freedom.
    pub fn new(difference: f64, variances: impl Iterator<Item = (f64, f64)>) -> Self {
        let (mut sum, mut squares) = (0.0, 0.0);
        for (variance, degrees) in variances {
            sum += variance;
            squares += variance * variance / degrees;
        }
        let degrees_of_freedom = if squares > 0.0 { sum * sum / squares } else { f64::INFINITY };
        Self { difference, standard_error: sum.sqrt(), degrees_of_freedom }
    }

    /// Chance of so large a difference, or larger, of either sign, between equal means of
    /// normal observations. 1 for no difference, 0 for one without any spread.
    pub fn p_value(&self) -> f64 {
        if self.difference == 0.0 {
            return 1.0;
        }
        let t = self.difference.abs() / self.standard_error;
        if t.is_infinite() { 0.0 } else { 2.0 * student_t_survival(t, self.degrees_of_freedom) }
    }

    /// The standard normal value of the same sign and p-value, at most 38 either way.
    pub fn z(&self) -> f64 {
        let tail = (0.5 * self.p_value()).max(f64::MIN_POSITIVE);
        -super::normal_quantile(tail) * self.difference.signum()
    }
}
