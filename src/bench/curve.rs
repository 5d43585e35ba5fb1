//! A method's runs, and what is read off them.

use super::resample::{median, resample};
use super::{Interval, growth};
use serde::Serialize;

/// One render.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Run {
    /// relMSE, the reference's own variance taken off.
    pub error: f64,
    /// Seconds of sampling by the clock: from before the first dispatch until the picture is read.
    pub wall: f64,
    /// Seconds of the process on all cores meanwhile; NaN where that is not known.
    pub cpu: f64,
}

/// Runs with as many samples.
#[derive(Debug, Clone, Serialize)]
pub struct Point {
    /// Samples of a pixel that were taken.
    pub samples: f64,
    /// One for each round.
    pub runs: Vec<Run>,
}

/// Which seconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Clock {
    /// Of the wall.
    Wall,
    /// Of the process on all cores.
    Cpu,
}

impl Clock {
    /// The seconds of a run.
    pub fn of(self, run: &Run) -> f64 {
        match self {
            Self::Wall => run.wall,
            Self::Cpu => run.cpu,
        }
    }

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wall => "wall seconds",
            Self::Cpu => "CPU seconds",
        }
    }
}

/// What a method did.
#[derive(Debug, Clone, Serialize)]
pub struct Curve {
    /// The method.
    pub name: String,
    /// In the order of their samples; all have as many runs, those of a round next to each other
    /// in time.
    pub points: Vec<Point>,
}

/// A number off a curve.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Reading {
    /// With its interval over the rounds.
    pub interval: Interval,
    /// Whether it lies beyond the measured points, from where error × seconds is taken as constant.
    pub is_extrapolated: bool,
}

impl Curve {
    /// Rounds.
    pub fn rounds(&self) -> usize {
        self.points.iter().map(|p| p.runs.len()).min().unwrap_or(0)
    }

    /// Mean error of the runs of these rounds at a point.
    pub fn mean_error(&self, point: usize, rounds: &[usize]) -> f64 {
        let runs = &self.points[point].runs;
        rounds.iter().map(|&r| runs[r].error).sum::<f64>() / rounds.len() as f64
    }

    /// Median time of the runs of these rounds at a point.
    pub fn seconds(&self, point: usize, clock: Clock, rounds: &[usize]) -> f64 {
        let runs = &self.points[point].runs;
        median(rounds.iter().map(|&r| clock.of(&runs[r])))
    }

    /// [`Curve::mean_error`] of all rounds.
    pub fn error_interval(&self, point: usize) -> Interval {
        resample(self.rounds(), |rounds| self.mean_error(point, rounds))
    }

    /// Least, median and largest time at a point.
    pub fn time_range(&self, point: usize, clock: Clock) -> [f64; 3] {
        let times = || self.points[point].runs.iter().map(|r| clock.of(r));
        [times().fold(f64::INFINITY, f64::min), median(times()), times().fold(0.0, f64::max)]
    }

    /// Exponent of the error's growth with the samples: -1 where it falls as 1/n.
    pub fn slope(&self) -> Interval {
        resample(self.rounds(), |rounds| {
            let of = |p: usize| (self.points[p].samples, self.mean_error(p, rounds));
            growth::exponent(&(0..self.points.len()).map(of).collect::<Vec<_>>())
        })
    }

    /// Variance of one sample: relMSE × samples, at a point.
    pub fn variance_per_sample(&self, point: usize) -> Interval {
        let samples = self.points[point].samples;
        resample(self.rounds(), |rounds| samples * self.mean_error(point, rounds))
    }

    /// Seconds until the mean error is `error`, in a straight line between the logarithms.
    pub fn seconds_to(&self, error: f64, clock: Clock) -> Reading {
        let all: Vec<usize> = (0..self.rounds()).collect();
        Reading {
            interval: resample(self.rounds(), |rounds| self.seconds_of(error, clock, rounds).0),
            is_extrapolated: self.seconds_of(error, clock, &all).1,
        }
    }

    /// Mean error after `seconds`, likewise.
    pub fn error_after(&self, seconds: f64, clock: Clock) -> Reading {
        let all: Vec<usize> = (0..self.rounds()).collect();
        let of = |rounds: &[usize]| {
            let pairs = self.pairs(clock, rounds).map(|(time, error)| (error, time));
            interpolate(&pairs.collect::<Vec<_>>(), seconds)
        };
        Reading {
            interval: resample(self.rounds(), |rounds| of(rounds).0),
            is_extrapolated: of(&all).1,
        }
    }

    fn pairs(&self, clock: Clock, rounds: &[usize]) -> impl Iterator<Item = (f64, f64)> {
        (0..self.points.len())
            .map(move |p| (self.seconds(p, clock, rounds), self.mean_error(p, rounds)))
    }

    /// Seconds to an error, and whether that is beyond the points.
    fn seconds_of(&self, error: f64, clock: Clock, rounds: &[usize]) -> (f64, bool) {
        interpolate(&self.pairs(clock, rounds).collect::<Vec<_>>(), error)
    }
}

/// Seconds to `error` of `a` over those of `b`, of the same rounds. `None` where the numbers of
/// rounds differ.
pub fn ratio(a: &Curve, b: &Curve, error: f64, clock: Clock) -> Option<Reading> {
    if a.rounds() != b.rounds() {
        return None;
    }
    let of = |rounds: &[usize]| {
        let [(x, x_is), (y, y_is)] = [a, b].map(|curve| curve.seconds_of(error, clock, rounds));
        (x / y, x_is || y_is)
    };
    let all: Vec<usize> = (0..a.rounds()).collect();
    let interval = resample(a.rounds(), |rounds| of(rounds).0);
    Some(Reading { interval, is_extrapolated: of(&all).1 })
}

/// The first coordinate at which the second is `y`, straight between the logarithms of the points.
/// Beyond them their product is taken as constant. NaN where a point is not positive.
fn interpolate(points: &[(f64, f64)], y: f64) -> (f64, bool) {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return (f64::NAN, true);
    };
    if points.iter().any(|p| !(p.0 > 0.0 && p.1 > 0.0)) {
        return (f64::NAN, true);
    }
    for pair in points.windows(2) {
        let [a, b] = [pair[0], pair[1]].map(|(x, y)| (x.ln(), y.ln()));
        let y = y.ln();
        if (a.1 - y) * (b.1 - y) <= 0.0 && a.1 != b.1 {
            let share = (y - a.1) / (b.1 - a.1);
            return ((a.0 + share * (b.0 - a.0)).exp(), false);
        }
    }
    let is_beyond_first = (y - first.1) * (first.1 - last.1) > 0.0;
    let end = if is_beyond_first { first } else { last };
    (end.0 * end.1 / y, end.1 != y)
}

#[cfg(test)]
mod tests {
    use super::super::resample::tests::{coverage, normal};
    use super::*;

    const ALL: [f64; 4] = [4.0, 16.0, 64.0, 256.0];

    /// Errors c/n with a relative spread, at `cost` seconds a sample with a spread of its own.
    fn curve(seed: u64, c: f64, cost: f64, spread: f64, runs: usize) -> Curve {
        let mut draw = normal(seed);
        let mut run = |n: f64| {
            let error = c / n * (1.0 + spread * draw());
            Run { error, wall: cost * n * (1.0 + 0.1 * spread * draw()), cpu: f64::NAN }
        };
        let points =
            ALL.map(|samples| Point { samples, runs: (0..runs).map(|_| run(samples)).collect() });
        Curve { name: "1/n".into(), points: points.into() }
    }

    #[test]
    fn an_exact_curve_is_read_exactly() {
        let curve = curve(1, 0.4, 0.01, 0.0, 4);
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs();
        assert!(near(curve.slope().value, -1.0), "{:?}", curve.slope());
        // 40 samples of 0.01 s, between two points; 1 sample and 4000 beyond them.
        for (error, seconds, is_beyond) in
            [(0.01, 0.4, false), (0.4, 0.01, true), (1e-4, 40.0, true)]
        {
            let to = curve.seconds_to(error, Clock::Wall);
            assert!(near(to.interval.value, seconds), "{error}: {to:?}");
            assert_eq!(to.is_extrapolated, is_beyond, "{error}");
            let after = curve.error_after(seconds, Clock::Wall);
            assert!(near(after.interval.value, error), "{seconds}: {after:?}");
            assert_eq!(after.is_extrapolated, is_beyond, "{seconds}");
        }
        assert!(curve.seconds_to(0.01, Clock::Cpu).interval.value.is_nan());
        assert!(near(curve.variance_per_sample(2).value, 0.4));
    }

    /// The ends themselves are measured.
    #[test]
    fn the_ends_are_not_extrapolated() {
        let points = [(1.0, 1.0), (4.0, 0.25)];
        assert_eq!(interpolate(&points, 1.0), (1.0, false));
        assert!(!interpolate(&points, 0.25).1 && interpolate(&points, 0.2).1);
        assert!(interpolate(&[(1.0, -1.0), (4.0, 0.25)], 0.5).0.is_nan());
        assert!(interpolate(&[], 0.5).0.is_nan());
        assert_eq!(interpolate(&[(2.0, 0.5)], 0.25), (4.0, true));
    }

    /// The slope of noisy 1/n is -1 in 95 % of the cases, and that of a curve that falls more
    /// slowly is not.
    #[test]
    fn slopes_keep_their_confidence() {
        let holds = |interval: &Interval, truth| interval.low <= truth && truth <= interval.high;
        let (low, high) =
            coverage(400, |seed| holds(&curve(seed, 0.4, 0.01, 0.1, 16).slope(), -1.0));
        assert!(low < 0.95 && 0.95 < high && low > 0.88, "{low} {high}");
        let mut flat = curve(7, 0.4, 0.01, 0.1, 16);
        for point in &mut flat.points {
            point.runs.iter_mut().for_each(|r| r.error += 0.002);
        }
        assert!(flat.slope().low > -1.0, "{:?}", flat.slope());
    }

    /// The ratio of seconds to an error, of methods of which one costs half and has 1.2 of the
    /// variance: 0.6 in 95 % of the cases.
    #[test]
    fn ratios_keep_their_confidence() {
        let (low, high) = coverage(400, |seed| {
            let a = curve(2 * seed, 0.48, 0.005, 0.1, 16);
            let b = curve(2 * seed + 1, 0.4, 0.01, 0.1, 16);
            let reading = ratio(&a, &b, 0.01, Clock::Wall).unwrap();
            reading.interval.low <= 0.6 && 0.6 <= reading.interval.high
        });
        assert!(low < 0.95 && 0.95 < high && low > 0.88, "{low} {high}");
        let short = curve(1, 0.4, 0.01, 0.1, 8);
        assert!(ratio(&short, &curve(2, 0.4, 0.01, 0.1, 16), 0.01, Clock::Wall).is_none());
    }
}
