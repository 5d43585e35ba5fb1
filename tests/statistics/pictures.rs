//! The comparison of pictures: how often it errs, and what it finds.

use crate::random::Random;
use steradian::image::Picture;
use steradian::image::compare::{ComparisonSettings, NoisyPicture, PictureComparison};
use steradian::statistics::{FALSE_ALARM, Verdict, wilson_interval};

const SIDE: u32 = 16;
const RUNS: usize = 16;

const SETTINGS: ComparisonSettings = ComparisonSettings {
    level: FALSE_ALARM,
    tiles: (4, 4),
    visible_bias: 0.01,
    visible_tile_bias: 0.05,
    rounding: 0.0,
};

/// How the value of a pixel is distributed around its mean in one run.
#[derive(Debug, Clone, Copy)]
enum Noise {
    /// Relative deviation.
    Normal(f64),
    /// Exponential samples, 16 a run: relative deviation 1/4.
    Exponential,
}

impl Noise {
    fn factor(self, random: &mut Random) -> f64 {
        match self {
            Self::Normal(deviation) => 1.0 + deviation * random.normal(),
            Self::Exponential => random.mean_of_exponentials(),
        }
    }
}

/// Runs whose pixels have the means `mean(x, y)`. Channels have noise of their own.
fn picture(random: &mut Random, noise: Noise, mean: impl Fn(u32, u32) -> f64) -> NoisyPicture {
    let mut run = || {
        let mut pixel =
            |i: u32| [0; 3].map(|_| (mean(i % SIDE, i / SIDE) * noise.factor(random)) as f32);
        Picture::new(SIDE, SIDE, (0..SIDE * SIDE).map(&mut pixel).collect())
    };
    NoisyPicture::of_runs(&(0..RUNS).map(|_| run()).collect::<Vec<_>>())
}

/// A picture with structure, one tile of which is off by the share `tile_bias`, and all of
/// which by `bias`, against one that is not.
fn compare(seed: u64, noise: Noise, bias: f64, tile_bias: f64) -> PictureComparison {
    let mut random = Random::new(seed);
    let mean = |x: u32, y: u32| 1.0 + f64::from(x * y) / 225.0;
    let is_in_tile = |x: u32, y: u32| (4..8).contains(&x) && (8..12).contains(&y);
    let reference = picture(&mut random, noise, mean);
    let planted = picture(&mut random, noise, |x, y| {
        mean(x, y) * (1.0 + bias + if is_in_tile(x, y) { tile_bias } else { 0.0 })
    });
    PictureComparison::of(&planted, &reference, &SETTINGS)
}

#[track_caller]
fn assert_rate(what: &str, seen: usize, trials: usize, rate: f64) {
    let (low, high) = wilson_interval(seen, trials, 0.999);
    println!("{what}: {seen} of {trials}, {low:.4} to {high:.4}, expected {rate:.4}");
    assert!(low <= rate && rate <= high, "{what}: {seen} of {trials} is not a rate of {rate}");
}

/// Alarms of 1000 pairs of pictures of the same thing, judged at 5 %: of the whole, and of
/// each of the four tests in 3000 channels at their level of 1 - 0.95^(1/12).
fn count_alarms(noise: Noise) {
    const PAIRS: usize = 1000;
    let loose = ComparisonSettings { level: 0.05, ..SETTINGS };
    let (mut pictures, mut tests) = (0, [("mean", 0), ("tile", 0), ("pixel", 0), ("p-values", 0)]);
    for seed in 0..PAIRS {
        let comparison = compare(seed as u64, noise, 0.0, 0.0);
        let alarms: Vec<_> = comparison.channels.iter().flat_map(|c| c.alarms(&loose)).collect();
        pictures += usize::from(!alarms.is_empty());
        for (name, count) in &mut tests {
            *count += alarms.iter().filter(|alarm| *alarm == name).count();
        }
    }
    assert_rate(&format!("{noise:?}, pictures"), pictures, PAIRS, loose.level);
    for (name, count) in tests {
        assert_rate(name, count, 3 * PAIRS, 1.0 - 0.95_f64.powf(1.0 / 12.0));
    }
}

#[test]
fn alarms_under_normal_noise_come_at_the_stated_rate() {
    count_alarms(Noise::Normal(0.25));
}

#[test]
fn alarms_under_skewed_noise_come_at_the_stated_rate() {
    count_alarms(Noise::Exponential);
}

/// Noise so small that 1 % is visible, and half of that is not.
const FINE: Noise = Noise::Normal(0.05);

#[test]
fn one_percent_everywhere_is_found() {
    for seed in 0..50 {
        let comparison = compare(seed, FINE, 0.01, 0.0);
        assert_eq!(comparison.verdict(), Verdict::Differs, "{comparison}");
        for channel in &comparison.channels {
            assert!(channel.alarms(&SETTINGS).contains(&"mean"), "{comparison}");
        }
        let comparison = compare(seed, FINE, 0.0, 0.0);
        assert_eq!(comparison.verdict(), Verdict::Agrees, "{comparison}");
    }
}

/// One per cent in one tile of sixteen is 0.06 % of the whole, which the mean does not show.
#[test]
fn one_percent_in_a_tile_is_found() {
    let mut means = 0;
    for seed in 0..50 {
        let comparison = compare(seed, Noise::Normal(0.01), 0.0, 0.01);
        assert_eq!(comparison.verdict(), Verdict::Differs, "{comparison}");
        for channel in &comparison.channels {
            let alarms = channel.alarms(&SETTINGS);
            assert!(alarms.contains(&"tile"), "{comparison}");
            assert_eq!(channel.worst_tile().0, 4 * 2 + 1, "{comparison}");
            means += usize::from(alarms.contains(&"mean"));
        }
    }
    println!("the mean alone finds {means} of 150");
    assert!(means < 75);
}

/// A bias of the size that is said to be visible is found in 84 % of channels.
#[test]
fn a_bias_of_the_visible_size_is_found_as_often_as_stated() {
    let visible = compare(0, FINE, 0.0, 0.0).channels[0].visible_bias(&SETTINGS);
    assert!(visible < SETTINGS.visible_bias, "{visible}");
    let found = |seed| {
        let comparison = compare(seed, FINE, visible, 0.0);
        let alarms = comparison.channels.map(|channel| channel.alarms(&SETTINGS));
        alarms.iter().filter(|alarms| alarms.contains(&"mean")).count()
    };
    assert_rate("visible bias", (0..300).map(found).sum(), 900, 0.8413);
}

/// Biases of either sign cancel in every tile and every mean; the p-values show them.
#[test]
fn many_small_biases_are_found_by_their_p_values() {
    for seed in 0..20 {
        let mut random = Random::new(seed);
        let reference = picture(&mut random, FINE, |_, _| 1.0);
        let sign = |x: u32, y: u32| if (x + y) % 2 == 0 { 1.0 } else { -1.0 };
        let planted = picture(&mut random, FINE, |x, y| 1.0 + 0.02 * sign(x, y));
        let comparison = PictureComparison::of(&planted, &reference, &SETTINGS);
        for channel in &comparison.channels {
            let alarms = channel.alarms(&SETTINGS);
            assert!(alarms.contains(&"p-values"), "{comparison}");
            assert!(!alarms.contains(&"mean") && !alarms.contains(&"tile"), "{comparison}");
        }
    }
}

/// What the module says of shared noise: two pictures of the same runs are too alike.
#[test]
fn pictures_that_share_their_noise_are_found() {
    let mut random = Random::new(1);
    let reference = picture(&mut random, FINE, |_, _| 1.0);
    let comparison = PictureComparison::of(&reference, &reference, &SETTINGS);
    assert!(comparison.channels[0].alarms(&SETTINGS).contains(&"p-values"), "{comparison}");
}

#[test]
fn noise_without_power_is_inconclusive() {
    let comparison = compare(3, Noise::Normal(0.25), 0.0, 0.0);
    assert_eq!(comparison.verdict(), Verdict::Inconclusive, "{comparison}");
}

/// Pixels without noise must be equal to rounding; NaN is equal to nothing.
#[test]
fn pixels_without_noise_are_compared_exactly() {
    let constant = |value: f32, odd: f32| {
        let pixel = |i: u32| if i == 37 { [odd; 3] } else { [value; 3] };
        let picture = Picture::new(SIDE, SIDE, (0..SIDE * SIDE).map(pixel).collect());
        NoisyPicture::of_runs(&vec![picture; RUNS])
    };
    let settings = ComparisonSettings { rounding: 1e-6, ..SETTINGS };
    let verdict = |odd| {
        let comparison = PictureComparison::of(&constant(2.0, odd), &constant(2.0, 2.0), &settings);
        comparison.verdict()
    };
    assert_eq!(verdict(2.0), Verdict::Agrees);
    assert_eq!(verdict(2.000_001), Verdict::Agrees);
    assert_eq!(verdict(2.000_01), Verdict::Differs);
    assert_eq!(verdict(f32::NAN), Verdict::Differs);
}
