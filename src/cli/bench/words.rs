//! Numbers in cells.

use steradian::bench::{Interval, Reading};

/// Three significant digits; a dash for what is not known.
pub(super) fn number(value: f64) -> String {
    let digits = match value.abs() {
        v if !v.is_finite() => return "–".into(),
        0.0 => return "0".into(),
        v => 2 - v.log10().floor() as i32,
    };
    match digits {
        -2..=6 => format!("{value:.*}", digits.max(0) as usize),
        _ => format!("{value:.2e}"),
    }
}

/// A number and its interval.
pub(super) fn interval(i: &Interval) -> String {
    match i.low.is_nan() || i.high.is_nan() {
        true => number(i.value),
        false => format!("{} ({} to {})", number(i.value), number(i.low), number(i.high)),
    }
}

/// With a mark where it lies beyond the measured points.
pub(super) fn reading(reading: &Reading) -> String {
    let mark = if reading.is_extrapolated && reading.interval.value.is_finite() { "~" } else { "" };
    format!("{mark}{}", interval(&reading.interval))
}

/// As a short power of ten.
pub(super) fn target(value: f64) -> String {
    format!("{value:e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let cases = [
            (0.0, "0"),
            (1.0, "1.00"),
            (12.345, "12.3"),
            (123.456, "123"),
            (1234.5, "1234"),
            (0.001_234, "0.00123"),
            (-0.5, "-0.500"),
            (1.5e-9, "1.50e-9"),
            (2.5e7, "2.50e7"),
            (f64::NAN, "–"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn intervals_without_ends_are_numbers() {
        let with = Interval { value: 1.0, low: 0.5, high: 2.0 };
        assert_eq!(interval(&with), "1.00 (0.500 to 2.00)");
        assert_eq!(interval(&Interval { low: f64::NAN, ..with }), "1.00");
        let beyond = Reading { interval: with, is_extrapolated: true };
        assert_eq!(reading(&beyond), "~1.00 (0.500 to 2.00)");
    }
}
