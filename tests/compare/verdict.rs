//! The verdict on synthetic noise: its false alarms, and what it finds.

use crate::common::Random;
use crate::linear;
use steradian::image::Picture;
use steradian::image::compare::{Noise, NoiseVerdict, PictureFile, VerdictSettings};
use steradian::statistics::wilson_interval;

const SIDE: u32 = 16;
const PIXELS: usize = 256;

/// Pieces of a picture, and runs of a reference.
const PIECES: usize = 4;
const RUNS: usize = 64;

/// How samples are distributed around the mean.
#[derive(Debug, Clone, Copy)]
enum Samples {
    /// Exponential.
    Exponential,
    /// Mostly nothing, one time in 100 a hundred times the mean: a light found by chance.
    Rare,
}

impl Samples {
    fn sample(self, random: &mut Random) -> f64 {
        let u = f64::from(random.unit()).max(1e-12);
        match self {
            Self::Exponential => -u.ln(),
            Self::Rare => {
                if u < 0.01 {
                    100.0
                } else {
                    0.0
                }
            }
        }
    }
}

fn unit_mean(_: usize) -> f64 {
    1.0
}

/// A picture of `4 * per_piece` samples with the noise of its pieces. Channels have one noise:
/// they are one path's.
fn pieces(
    random: &mut Random,
    noise: Samples,
    per_piece: usize,
    mean: impl Fn(usize) -> f64,
) -> PictureFile {
    let (mut rgb, mut variance) = (Vec::new(), Vec::new());
    for i in 0..PIXELS {
        let piece = |random: &mut Random| {
            let sum: f64 = (0..per_piece).map(|_| noise.sample(random)).sum();
            mean(i) * sum / per_piece as f64
        };
        let values: Vec<f64> = (0..PIECES).map(|_| piece(random)).collect();
        let m = values.iter().sum::<f64>() / PIECES as f64;
        let squares: f64 = values.iter().map(|v| (v - m).powi(2)).sum();
        rgb.push([m as f32; 3]);
        variance.push(squares / (PIECES as f64 - 1.0) / PIECES as f64);
    }
    let samples = vec![(PIECES * per_piece) as u32; PIXELS];
    let mut file = linear(&Picture::new(SIDE, SIDE, rgb));
    file.noise = Some(Noise::Pieces { variance, pieces: PIECES as u32, samples });
    file
}

/// A reference of runs of `4 * per_piece` samples.
fn reference(random: &mut Random, noise: Samples, per_piece: usize) -> PictureFile {
    let runs: Vec<Vec<f32>> = (0..RUNS)
        .map(|_| {
            let picture = pieces(random, noise, per_piece, unit_mean).picture().unwrap();
            picture.rgb.iter().map(|p| p[0]).collect()
        })
        .collect();
    let (mut rgb, mut variance) = (Vec::new(), Vec::new());
    for i in 0..PIXELS {
        let values = runs.iter().map(|run| f64::from(run[i]));
        let m = values.clone().sum::<f64>() / RUNS as f64;
        let squares: f64 = values.map(|v| (v - m).powi(2)).sum();
        rgb.push([m as f32; 3]);
        variance.push([squares / (RUNS as f64 - 1.0) / RUNS as f64; 3]);
    }
    let mut file = linear(&Picture::new(SIDE, SIDE, rgb));
    let luminance = Some(variance.iter().map(|v| v[0]).collect());
    let spp = Some((PIECES * per_piece) as u32);
    file.noise = Some(Noise::Runs { variance, luminance, runs: RUNS as u32, spp });
    file
}

fn verdict(actual: &PictureFile, expected: &PictureFile, level: f64) -> NoiseVerdict {
    let settings = VerdictSettings { level, tile: 4, ..VerdictSettings::default() };
    NoiseVerdict::of(actual, expected, &settings).unwrap()
}

/// Alarms of 400 clean pictures against references of runs and against long renders, at 5 %.
fn assert_few_alarms(noise: Samples) {
    const PICTURES: usize = 400;
    const LEVEL: f64 = 0.05;
    let mut random = Random(7);
    let reference = reference(&mut random, noise, 16);
    let long = pieces(&mut random, noise, 16 * 32, unit_mean);
    let mut alarms = [0; 2];
    for _ in 0..PICTURES {
        let picture = pieces(&mut random, noise, 16, unit_mean);
        alarms[0] += usize::from(!verdict(&picture, &reference, LEVEL).agrees);
        alarms[1] += usize::from(!verdict(&picture, &long, LEVEL).agrees);
    }
    println!("{noise:?}: {alarms:?} alarms of {PICTURES}");
    for count in alarms {
        // At most the rate: its interval does not lie above it.
        assert!(wilson_interval(count, PICTURES, 0.999).0 <= LEVEL, "{count} alarms");
    }
}

#[test]
fn alarms_come_at_most_at_the_stated_rate() {
    assert_few_alarms(Samples::Exponential);
}

/// Where most pixels have not met the light that others have.
#[test]
fn rare_light_raises_no_more_alarms() {
    assert_few_alarms(Samples::Rare);
}

fn alarms_of(found: &NoiseVerdict) -> Vec<&'static str> {
    let alarms = found.planes.iter().flat_map(|plane| plane.alarms.iter().copied());
    let mut alarms: Vec<_> = alarms.collect();
    alarms.sort_unstable();
    alarms.dedup();
    alarms
}

/// Each kind of difference is found by the test that is made for it.
#[test]
fn each_test_finds_its_kind() {
    let mut random = Random(3);
    let noise = Samples::Exponential;
    // A pixel's deviation is 1/8, that of the mean 1/128.
    let reference = reference(&mut random, noise, 16);
    let mut alarms = |mean: &dyn Fn(usize) -> f64| {
        let found = verdict(&pieces(&mut random, noise, 16, mean), &reference, 1e-3);
        assert_eq!(found.agrees, alarms_of(&found).is_empty());
        alarms_of(&found)
    };
    assert_eq!(alarms(&unit_mean), [""; 0]);
    // Six deviations of the mean.
    assert!(alarms(&|_| 1.0 - 6.0 / 128.0).contains(&"mean"));
    // Seven of a tile's, which is 1/32: of the mean less than two.
    let in_tile = |i: usize| (i / 16) / 4 == 2 && (i % 16) / 4 == 1;
    assert_eq!(alarms(&|i| if in_tile(i) { 1.0 - 7.0 / 32.0 } else { 1.0 }), ["tile"]);
    // A black pixel is eight deviations of one.
    assert_eq!(alarms(&|i| if i == 100 { 0.0 } else { 1.0 }), ["pixel"]);
    // Two deviations up and down in turns, which cancel in every tile.
    let chequered = |i: usize| if (i / 16 + i).is_multiple_of(2) { 1.25 } else { 0.75 };
    assert!(alarms(&chequered).contains(&"many pixels"));
}

/// A bias of the size that is said to be visible raises an alarm in 84 % of pictures or more.
#[test]
fn a_visible_bias_is_found() {
    const PICTURES: usize = 200;
    let mut random = Random(11);
    let noise = Samples::Exponential;
    let reference = reference(&mut random, noise, 16);
    let clean = verdict(&pieces(&mut random, noise, 16, unit_mean), &reference, 1e-3);
    let bias = clean.visible_bias();
    assert!((0.02..0.06).contains(&bias), "{bias}");
    let found = (0..PICTURES).filter(|_| {
        let biased = pieces(&mut random, noise, 16, |_| 1.0 + bias);
        !verdict(&biased, &reference, 1e-3).agrees
    });
    let found = found.count();
    println!("{found} of {PICTURES} at {:.2} %", 100.0 * bias);
    assert!(wilson_interval(found, PICTURES, 0.999).1 > 0.8413, "{found}");
    assert!(found > PICTURES / 2);
}

/// Equal pictures are no finding, whatever the noise; nor is one picture twice.
#[test]
fn shared_noise_is_no_finding() {
    let mut random = Random(5);
    let picture = pieces(&mut random, Samples::Exponential, 16, unit_mean);
    let found = verdict(&picture, &picture, 0.05);
    assert!(found.agrees && found.p_value > 0.999, "{found:?}");
}

/// Without noise in either, every difference beyond rounding counts.
#[test]
fn pixels_without_noise_are_exact() {
    let constant = |odd: f32| {
        let mut rgb = vec![[2.0; 3]; PIXELS];
        rgb[37] = [odd; 3];
        let mut file = linear(&Picture::new(SIDE, SIDE, rgb));
        let samples = vec![64; PIXELS];
        file.noise = Some(Noise::Pieces { variance: vec![0.0; PIXELS], pieces: 4, samples });
        file
    };
    let agrees = |odd| verdict(&constant(odd), &constant(2.0), 1e-3).agrees;
    assert!(agrees(2.0) && agrees(2.000_01) && !agrees(2.0001));
}

#[test]
fn there_is_no_verdict_without_noise() {
    let mut random = Random(5);
    let picture = pieces(&mut random, Samples::Exponential, 4, unit_mean);
    let silent = PictureFile { noise: None, ..picture.clone() };
    let settings = VerdictSettings::default();
    assert!(NoiseVerdict::of(&picture, &silent, &settings).is_none());
    assert!(NoiseVerdict::of(&silent, &picture, &settings).is_none());
}
