use super::report::{chance_percentile, difference, low_shares, product, share};
use super::{Coverage, CoverageReport, Truth};
use crate::film::{BlockMean, Film, PixelStop};
use crate::settings::Crop;
use crate::shader::generated::StopReason;
use crate::statistics::{Estimate, normal_quantile, student_t_quantile, wilson_interval};

/// A grey picture of one row, with as many samples for every pixel.
fn film(values: &[f64], samples: u32) -> Film {
    let window = Crop { x: 0, y: 0, width: values.len() as u32, height: 1 };
    let mut film = Film::new(window, samples.max(1));
    for (x, &value) in values.iter().enumerate() {
        let block = BlockMean { mean: [value; 3], sample_count: samples };
        film.add_block(x as u32, 0, block);
    }
    film
}

/// The same, as a rule has stopped it.
fn stopped(values: &[f64], samples: u32, reason: impl Fn(usize) -> StopReason) -> Film {
    let mut film = film(values, samples);
    let stop = |i| PixelStop { reason: reason(i), half_width: 0.0 };
    film.set_stops((0..values.len()).map(stop).collect());
    film
}

/// A truth without error.
fn truth(values: &[f64]) -> Truth {
    let mut truth = Truth::new(values.len(), 2);
    truth.extend(64, |_| Ok::<_, ()>(film(values, 64))).unwrap();
    truth
}

const CONVERGED: fn(usize) -> StopReason = |_| StopReason::Converged;
const TOLERANCE: f64 = 0.05;

/// A report on runs of a picture whose truth is 1, and as many uniform ones that are 2 % off.
fn report(runs: &[Film]) -> CoverageReport {
    let pixels = runs[0].sample_counts().len();
    let mut coverage = Coverage::new(&truth(&vec![1.0; pixels]), TOLERANCE);
    for (k, run) in runs.iter().enumerate() {
        coverage.add_adaptive(run, 1.0, 0.25);
        let value = if k.is_multiple_of(2) { 0.98 } else { 1.02 };
        coverage.add_uniform(&film(&vec![value; pixels], 64), 64, 1.0);
    }
    coverage.report(0.95, 64, 4096)
}

/// Every pixel is off in one of five runs, and one is never stopped.
#[test]
fn planted_coverage_is_found() {
    let value = |run: usize, i: usize| if (run + i).is_multiple_of(5) { 1.2 } else { 1.04 };
    let reason = |i| if i == 7 { StopReason::Limit } else { StopReason::Converged };
    let run = |r| stopped(&(0..101).map(|i| value(r, i)).collect::<Vec<_>>(), 64, reason);
    let report = report(&(0..20).map(run).collect::<Vec<_>>());
    assert_eq!(report.pixels, 100);
    assert!((report.coverage.value - 0.8).abs() < 1e-12, "{report:?}");
    // As many are off in every run: all there is to fear is chance within the runs.
    assert_eq!((report.coverage.low, report.coverage.high), wilson_interval(1600, 2000, 0.95));
    assert_eq!((report.tenth_percentile, report.worst), (0.8, 0.8));
    assert!((report.at_limit - 1.0 / 101.0).abs() < 1e-12);
    assert_eq!((report.samples, report.overhead), ((64, 64.0, 64), 0.25));
    assert_eq!(report.black_stops, 0);
}

#[test]
fn nothing_stopped_is_no_coverage() {
    let run = || stopped(&[1.0; 4], 64, |_| StopReason::Limit);
    let report = report(&[run(), run(), run()]);
    assert!(report.coverage.value.is_nan() && report.tenth_percentile.is_nan(), "{report:?}");
    assert_eq!((report.coverage.low, report.coverage.high, report.at_limit), (0.0, 1.0, 1.0));
}

/// A black stop is one of a pixel that is bright enough to matter.
#[test]
fn black_stops_are_wrong_ones() {
    // The floor is a hundredth of 0.5 or so, the tolerance a twentieth of that.
    let mut coverage = Coverage::new(&truth(&[1.0, 0.0, 2e-4, 1.0]), TOLERANCE);
    for _ in 0..3 {
        coverage.add_adaptive(&stopped(&[1.0, 0.0, 0.0, 0.0], 64, CONVERGED), 1.0, 0.0);
        coverage.add_uniform(&film(&[1.0; 4], 64), 64, 1.0);
    }
    let report = coverage.report(0.95, 64, 4096);
    assert_eq!((report.black_stops, report.worst), (3, 0.0));
    assert!((report.coverage.value - 0.75).abs() < 1e-12, "{report:?}");
}

/// Where all pixels of a run are off together, there are as few trials as there are runs.
#[test]
fn runs_that_fail_as_a_whole_widen_the_interval() {
    let runs: Vec<_> = (0..20).map(|r| (50 * (r % 2), 50)).collect();
    let together = share(&runs);
    // Twenty observations of 0 or 1, of deviation √(20 / 19) / 2.
    let half = student_t_quantile(0.975, 19.0) * 0.5 / 19.0_f64.sqrt();
    assert!((together.high - together.value - half).abs() < 1e-12, "{together:?}");
    assert!((together.value - together.low - half).abs() < 1e-12, "{together:?}");
}

/// The interval of a share holds it in 95 % of all cases, with runs that differ and without.
#[test]
fn the_interval_of_a_share_keeps_its_confidence() {
    const CASES: usize = 1000;
    let mut state = 1_u64;
    let mut uniform = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for spread in [0.0, 0.09] {
        let held = (0..CASES).filter(|_| {
            let runs: Vec<_> = (0..24)
                .map(|_| {
                    let p = 0.9 + spread * (2.0 * uniform() - 1.0);
                    ((0..100).filter(|_| uniform() < p).count(), 100)
                })
                .collect();
            let interval = share(&runs);
            interval.low <= 0.9 && 0.9 <= interval.high
        });
        let (_, most) = wilson_interval(held.count(), CASES, 0.9999);
        assert!(most >= 0.95, "{spread}: at most {most}");
    }
}

/// The truth's error is part of the interval, at its own degrees of freedom.
#[test]
fn the_truth_widens_the_interval_of_the_bias() {
    let only_truth = difference(&[0.01; 8], 0.002, 16);
    let half = 0.002 * student_t_quantile(0.975, 15.0);
    assert!((only_truth.high - 0.01 - half).abs() < 1e-12, "{only_truth:?}");
    let runs = [0.008, 0.012, 0.008, 0.012];
    let only_runs = difference(&runs, 0.0, 16);
    let half = Estimate::of(&runs).standard_error * student_t_quantile(0.975, 3.0);
    assert!((0.01 - only_runs.low - half).abs() < 1e-12, "{only_runs:?}");
    let both = difference(&runs, 0.002, 16);
    assert!(both.low < only_truth.low && both.high > only_truth.high, "{both:?}");
}

#[test]
fn the_bias_is_in_means_of_the_picture() {
    let mut coverage = Coverage::new(&truth(&[1.0, 3.0]), TOLERANCE);
    for k in 0..4 {
        let error = if k % 2 == 0 { 0.1 } else { 0.3 };
        coverage.add_adaptive(&stopped(&[1.0 + error, 3.0], 64, CONVERGED), 1.0, 0.0);
        coverage.add_uniform(&film(&[1.0, 3.1], 64), 64, 1.0);
    }
    let report = coverage.report(0.95, 64, 4096);
    // 0.2 of one pixel, 0.1 of the mean of two, 0.05 of their mean 2.
    assert!((report.bias.value - 0.05).abs() < 1e-6, "{report:?}");
    assert!(report.bias.low < 0.05 && report.bias.high > 0.05 && report.bias.high < 0.1);
}

#[test]
fn the_interval_of_a_product_is_that_of_its_logarithm() {
    let of = |mean, standard_error| Estimate { mean, standard_error, deviation: 0.0, count: 9 };
    let one = product(2.0, &[of(5.0, 0.5), of(3.0, 0.0)]);
    let half = 0.1 * student_t_quantile(0.975, 8.0);
    assert!((one.high / 2.0 - half.exp()).abs() < 1e-12, "{one:?}");
    assert!((2.0 / one.low - half.exp()).abs() < 1e-12, "{one:?}");
    // Two variances of 8 degrees each, equal, have 16.
    let two = product(2.0, &[of(5.0, 0.5), of(3.0, 0.3)]);
    let half = 0.1 * 2.0_f64.sqrt() * student_t_quantile(0.975, 16.0);
    assert!((two.high / 2.0 - half.exp()).abs() < 1e-12, "{two:?}");
}

/// Errors of 2 % in 10.4 samples and 3 s, of 1 % in 10 samples and 2 s.
#[test]
fn ratios_are_at_equal_samples_and_at_equal_time() {
    let mut coverage = Coverage::new(&truth(&[1.0; 5]), TOLERANCE);
    for _ in 0..4 {
        let mut run = stopped(&[1.02; 5], 10, CONVERGED);
        for _ in 0..2 {
            run.add_block(0, 0, BlockMean { mean: [1.02; 3], sample_count: 1 });
        }
        coverage.add_adaptive(&run, 3.0, 0.0);
    }
    assert_eq!(coverage.equal_spp(), 10);
    for _ in 0..4 {
        coverage.add_uniform(&film(&[1.01; 5], 10), 10, 2.0);
    }
    let report = coverage.report(0.95, 1, 4096);
    // Pictures are f32: the errors are good to 1e-5 of them.
    assert!((report.relmse_ratio.value / (4.0 * 1.04) - 1.0).abs() < 1e-4, "{report:?}");
    assert!((report.relmse_ratio_at_equal_time.value / 6.0 - 1.0).abs() < 1e-4, "{report:?}");
    assert_eq!(report.samples, (10, 10.4, 12));
}

/// Uniform runs of 100 samples vary by nothing, by 5 % and by 200 %.
#[test]
fn the_oracle_takes_what_the_variance_asks_for() {
    let needed = |first: u32, limit: u32| {
        let mut coverage = Coverage::new(&truth(&[1.0; 3]), TOLERANCE);
        for k in 0..8 {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            coverage.add_adaptive(&stopped(&[1.0; 3], 100, CONVERGED), 1.0, 0.0);
            let values = [1.0, 1.0 + 0.05 * sign, 1.0 + 2.0 * sign];
            coverage.add_uniform(&film(&values, 100), 100, 1.0);
        }
        100.0 / coverage.report(0.95, first, limit).samples_over_oracle
    };
    // A variance of 8/7 of the squared tolerance in 100 samples.
    let middle = 100.0 * 8.0 / 7.0 * normal_quantile(0.975).powi(2);
    let expected = (64.0 + middle + 4096.0) / 3.0;
    assert!((needed(64, 4096) / expected - 1.0).abs() < 1e-5, "{}", needed(64, 4096));
    // A rule that asks for more samples than there may be gets those that there are.
    assert!((needed(128, 50) - 50.0).abs() < 1e-9);
}

#[test]
fn the_tenth_percentile_is_the_least_that_a_tenth_do_not_exceed() {
    let pixels: Vec<_> = (0..20).map(|k| (k, 20)).collect();
    assert_eq!(low_shares(&pixels), (0.05, 0.0));
    assert_eq!(low_shares(&pixels[..10]), (0.0, 0.0));
    assert_eq!(low_shares(&[(1, 2)]), (0.5, 0.5));
}

#[test]
fn the_percentile_by_chance_is_that_of_the_binomial() {
    let of = |p, trials: &[u32]| chance_percentile(p, trials.iter().copied());
    // 0 to 2 of 10 have 0.055, 0 to 3 have 0.172.
    assert_eq!(of(0.5, &[10]), 0.3);
    assert_eq!([of(1.0, &[10]), of(0.0, &[10])], [1.0, 0.0]);
    // 1.2816 deviations of 0.0069 below 0.95; 0.05^1000 is no f64.
    assert!((of(0.95, &[1000]) - 0.941).abs() < 1e-12, "{}", of(0.95, &[1000]));
    // Of every second pixel one trial, of which three in ten fail.
    assert_eq!(of(0.7, &[1, 1000]), 0.0);
    assert!(of(0.7, &[]).is_nan());
}

/// 16 streams that differ by ± `spread` have a mean of known error.
fn streams(pixels: [(f64, f64); 3]) -> Truth {
    let mut truth = Truth::new(3, 16);
    let of = |k: usize| pixels.map(|(mean, d)| mean + if k.is_multiple_of(2) { d } else { -d });
    truth.extend(64, |k| Ok::<_, ()>(film(&of(k), 64))).unwrap();
    truth
}

#[test]
fn the_truth_knows_what_it_knows() {
    // The picture's mean is 1: the third pixel counts as one of 0.01.
    let truth = streams([(1.0, 0.0), (1.9999, 0.02), (1e-4, 5e-5)]);
    let per_deviation = (16.0_f64 / 15.0).sqrt() / 4.0;
    let errors = truth.estimates();
    assert!((errors[1].standard_error - 0.02 * per_deviation).abs() < 1e-7);
    assert!((truth.picture_mean().standard_error - 0.02005 / 3.0 * per_deviation).abs() < 1e-7);
    let of_second = errors[1].standard_error / errors[1].mean;
    assert_eq!(truth.resolved(1.01 * of_second), 1.0);
    assert_eq!(truth.resolved(0.99 * of_second), 2.0 / 3.0);
    // The third: 5e-5 of 0.01.
    assert_eq!(truth.resolved(0.99 * 5e-3 * per_deviation), 2.0 / 3.0 - 1.0 / 3.0);
}

/// Runs without any spread: what is uncertain of their bias is the truth.
#[test]
fn the_bias_is_no_better_known_than_the_truth() {
    let values = [(1.0, 0.0), (1.9999, 0.02), (1e-4, 5e-5)];
    let truth = streams(values);
    let mut coverage = Coverage::new(&truth, TOLERANCE);
    for _ in 0..3 {
        coverage.add_adaptive(&stopped(&values.map(|v| v.0), 64, CONVERGED), 1.0, 0.0);
        coverage.add_uniform(&film(&[0.9; 3], 64), 64, 1.0);
    }
    let bias = coverage.report(0.95, 64, 4096).bias;
    let half = truth.picture_mean().standard_error * student_t_quantile(0.975, 15.0);
    assert!(bias.value.abs() < 1e-6 && (bias.high / half - 1.0).abs() < 1e-3, "{bias:?} {half}");
}

#[test]
fn parts_of_the_truth_count_by_their_samples() {
    let mut truth = Truth::new(1, 2);
    for (spp, value) in [(100, 1.0), (300, 2.0)] {
        truth.extend(spp, |_| Ok::<_, ()>(film(&[value], spp))).unwrap();
    }
    assert_eq!(truth.samples(), 800.0);
    assert!((truth.estimates()[0].mean - 1.75).abs() < 1e-9);
}
