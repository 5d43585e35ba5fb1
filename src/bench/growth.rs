//! Powers: how a cost grows with what is scaled.

use super::Interval;
use crate::statistics::student_t_quantile;
use serde::Serialize;

/// y = factor × x^exponent, by least squares of the logarithms.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PowerLaw {
    /// With Student's interval at 95 % from the points' distances to the line; its ends are NaN
    /// with two points.
    pub exponent: Interval,
    /// y at x = 1.
    pub factor: f64,
}

/// The power that fits points of positive x and y. `None` with fewer than two of different x.
pub fn power_law(points: &[(f64, f64)]) -> Option<PowerLaw> {
    let logs: Vec<_> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let mean_x = logs.iter().map(|p| p.0).sum::<f64>() / n;
    let mean_y = logs.iter().map(|p| p.1).sum::<f64>() / n;
    let xx: f64 = logs.iter().map(|p| (p.0 - mean_x).powi(2)).sum();
    let xy: f64 = logs.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    let value = xy / xx;
    if !value.is_finite() {
        return None;
    }
    let squares: f64 = logs.iter().map(|p| (p.1 - mean_y - value * (p.0 - mean_x)).powi(2)).sum();
    let half = match logs.len() {
        0..=2 => f64::NAN,
        _ => student_t_quantile(0.975, n - 2.0) * (squares / (n - 2.0) / xx).sqrt(),
    };
    let exponent = Interval { value, low: value - half, high: value + half };
    Some(PowerLaw { exponent, factor: (mean_y - value * mean_x).exp() })
}

/// The exponent alone; NaN where there is none.
pub(super) fn exponent(points: &[(f64, f64)]) -> f64 {
    power_law(points).map_or(f64::NAN, |law| law.exponent.value)
}

#[cfg(test)]
mod tests {
    use super::super::resample::tests::{coverage, normal};
    use super::*;

    #[test]
    fn an_exact_power_is_found() {
        let points: Vec<_> = [1.0_f64, 10.0, 100.0].map(|x| (x, 3.0 * x.powf(0.5))).into();
        let law = power_law(&points).unwrap();
        assert!((law.exponent.value - 0.5).abs() < 1e-12 && (law.factor - 3.0).abs() < 1e-12);
        assert!(law.exponent.high - law.exponent.low < 1e-6);
        assert!(power_law(&points[..2]).unwrap().exponent.low.is_nan());
        assert_eq!(power_law(&points[..1]), None);
        assert_eq!(power_law(&[(1.0, 2.0), (1.0, 3.0)]), None);
        assert_eq!(power_law(&[(1.0, 2.0), (2.0, -3.0)]), None);
    }

    #[test]
    fn the_interval_keeps_its_confidence() {
        let (low, high) = coverage(2000, |seed| {
            let mut draw = normal(seed);
            let points: Vec<_> = (0..5)
                .map(|k| 10f64.powi(k))
                .map(|x| (x, x.powf(0.3) * (0.1 * draw()).exp()))
                .collect();
            let law = power_law(&points).unwrap();
            law.exponent.low <= 0.3 && 0.3 <= law.exponent.high
        });
        assert!(low < 0.95 && 0.95 < high && low > 0.92, "{low} {high}");
    }
}
