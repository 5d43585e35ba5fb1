//! Accumulation: the device's means of blocks of samples, and the film that folds them in f64.

use crate::common::{Call, Random, assert_at_most, assert_naive_fails, harness, report};
use std::f64::consts::TAU;
use steradian::film::{BlockMean, Film};

use steradian::image::{ExrImage, Picture, Precision, read_exr, write_exr};
use steradian::settings::Crop;

/// Samples of a block, as `film.wgsl` of the tests has them.
const BLOCK: usize = 16;

const CONSTANTS: [f32; 4] = [0.1, 12.5, 1e4, 1e-4];

/// A stream of samples: its name, and its next value.
type Stream = (&'static str, fn(&mut Random) -> f64);

fn normal(random: &mut Random) -> f64 {
    let radius = (-2.0 * (1.0 - f64::from(random.unit())).ln()).sqrt();
    radius * (TAU * f64::from(random.unit())).cos()
}

const STREAMS: [Stream; 5] = [
    ("normal, 1 ± 1e-2", |r| 1.0 + 1e-2 * normal(r)),
    ("normal, 1 ± 1e-3", |r| 1.0 + 1e-3 * normal(r)),
    ("lognormal, sigma 1", |r| normal(r).exp()),
    ("lognormal, sigma 2", |r| (2.0 * normal(r)).exp()),
    ("one in 1e4 is 1e4", |r| if r.unit() < 1e-4 { 1e4 } else { 0.5 + f64::from(r.unit()) }),
];

fn samples((_, next): Stream, count: usize) -> Vec<f32> {
    let mut random = Random(count as u64);
    (0..count).map(|_| next(&mut random) as f32).collect()
}

/// The device's means of the samples' blocks, in order. What is left over is padding.
fn device_blocks(samples: &[f32]) -> Vec<BlockMean> {
    let mut blocks: Vec<[f32; BLOCK]> =
        samples.chunks_exact(BLOCK).map(|b| b.try_into().unwrap()).collect();
    let count = blocks.len();
    blocks.resize(count.next_multiple_of(64), [0.0; BLOCK]);
    let sums: Vec<[u32; 4]> = Call::new(harness!("film"), &[]).run(&blocks, 1);
    let block = |&[first, difference, sample_count, faults]: &[u32; 4]| {
        assert_eq!((sample_count, faults), (BLOCK as u32, 0));
        let [first, difference] = [first, difference].map(|b| f64::from(f32::from_bits(b)));
        BlockMean { mean: [first + difference / BLOCK as f64; 3], sample_count }
    };
    sums[..count].iter().map(block).collect()
}

/// A film of one pixel with these blocks.
fn film<'a>(blocks: impl IntoIterator<Item = &'a BlockMean>) -> Film {
    let mut film = Film::new(Crop { x: 0, y: 0, width: 1, height: 1 }, BLOCK as u32);
    for &block in blocks {
        film.add_block(0, 0, block);
    }
    film
}

fn mean_of(film: &Film) -> f64 {
    f64::from(film.picture().rgb[0][0])
}

fn variance_of(film: &Film) -> f64 {
    f64::from(film.standard_error().unwrap()[0]).powi(2)
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len() as f64
}

/// Variance of the mean from the means of 8 to 15 runs of blocks, the shortest of a power of
/// two that are no more: what the film says that it estimates, in f64 from the samples.
fn variance_by_runs(samples: &[f32]) -> f64 {
    let blocks = samples.len() / BLOCK;
    let mut run = 1;
    while blocks / run >= 16 {
        run *= 2;
    }
    let means: Vec<f64> = samples.chunks_exact(run * BLOCK).map(mean).collect();
    let n = means.len() as f64;
    let whole = means.iter().sum::<f64>() / n;
    means.iter().map(|m| (m - whole).powi(2)).sum::<f64>() / (n - 1.0) / n
}

fn relative(value: f64, truth: f64) -> f64 {
    ((value - truth) / truth).abs()
}

/// Mean and variance of one sample by a sum and a sum of squares in f32.
fn by_sums(samples: &[f32]) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0_f32, 0.0_f32);
    for &s in samples {
        sum += s;
        squares += s * s;
    }
    let n = samples.len() as f32;
    let mean = sum / n;
    (f64::from(mean), f64::from(squares / n - mean * mean))
}

fn variance(samples: &[f32]) -> f64 {
    let mean = mean(samples);
    samples.iter().map(|&s| (f64::from(s) - mean).powi(2)).sum::<f64>() / samples.len() as f64
}

/// Worst relative errors of the mean and of the variance of the mean over all streams.
fn worst_errors(count: usize) -> (f64, f64) {
    let (mut of_mean, mut of_variance) = (0.0_f64, 0.0_f64);
    for stream in STREAMS {
        let samples = samples(stream, count);
        let film = film(&device_blocks(&samples));
        let error = relative(mean_of(&film), mean(&samples));
        let claimed = relative(variance_of(&film), variance_by_runs(&samples));
        println!("{}, {count}: mean {error:.1e}, variance {claimed:.1e}", stream.0);
        of_mean = of_mean.max(error);
        of_variance = of_variance.max(claimed);
    }
    (of_mean, of_variance)
}

#[test]
fn j1_means_and_variances_of_streams() {
    for count in [1 << 10, 1_000_000] {
        let (of_mean, of_variance) = worst_errors(count);
        let what = format!("{count} samples, worst of 5 streams: relative error of the");
        assert_at_most("J1", &format!("{what} mean"), of_mean, 5e-6);
        assert_at_most("J1", &format!("{what} variance of the mean"), of_variance, 2e-4);
    }
    let few = samples(STREAMS[1], 1000);
    let error = relative(by_sums(&few).1, variance(&few));
    assert_naive_fails("J1", "f32 sum of squares, 1000 of 1 ± 1e-3: variance", error, 0.1);
    let many = samples(STREAMS[0], 1_000_000);
    let error = relative(by_sums(&many).1, variance(&many));
    assert_naive_fails("J1", "f32 sum of squares, 1e6 of 1 ± 1e-2: variance", error, 0.1);
    report("J1", "the same: the variance itself", by_sums(&many).1);
}

#[test]
#[ignore = "tier N: about 1 minute"]
fn j1_means_and_variances_of_long_streams() {
    let (of_mean, of_variance) = worst_errors(10_000_000);
    let what = "1e7 samples, worst of 5 streams: relative error of the";
    assert_at_most("J1", &format!("{what} mean"), of_mean, 5e-6);
    assert_at_most("J1", &format!("{what} variance of the mean"), of_variance, 2e-4);
}

#[test]
fn j2_constant_pixels_stay_constant() {
    let (mut ulps, mut spread, mut naive) = (0.0_f64, 0.0_f64, 0.0_f64);
    for value in CONSTANTS {
        let samples = vec![value; 1_000_000];
        let film = film(&device_blocks(&samples));
        let bits = film.picture().rgb[0].map(f32::to_bits);
        ulps = bits.iter().fold(ulps, |w, b| w.max(f64::from(b.abs_diff(value.to_bits()))));
        spread = spread.max(variance_of(&film));
        naive = naive.max(relative(by_sums(&samples).0, f64::from(value)));
    }
    let what = "1e6 samples of 0.1, 12.5, 1e4, 1e-4";
    assert_at_most("J2", &format!("{what}: units in the last place of the mean"), ulps, 2.0);
    assert_at_most("J2", &format!("{what}: variance"), spread, 0.0);
    assert_naive_fails("J2", &format!("{what}, f32 sum: relative error"), naive, 5e-3);
}

/// Blocks in the order of the samples, backwards, and every seventh.
#[test]
fn j3_the_order_of_blocks_does_not_matter() {
    let mut worst = 0.0_f64;
    for stream in STREAMS {
        let blocks = device_blocks(&samples(stream, 1 << 17));
        let forwards = mean_of(&film(&blocks));
        let backwards = mean_of(&film(blocks.iter().rev()));
        let strided = (0..7).flat_map(|k| blocks.iter().skip(k).step_by(7));
        let strided = mean_of(&film(strided));
        worst = worst.max(relative(backwards, forwards)).max(relative(strided, forwards));
    }
    assert_at_most("J3", "means of 8192 blocks in 3 orders: relative difference", worst, 1e-6);
}

/// What the film has is what a file gives back: far beyond what a display shows, and below.
#[test]
fn j4_stored_pictures_are_linear_and_exact() {
    let mut random = Random(4);
    let mut value = || f32::from_bits(random.bits() as u32 & 0x7FFF_FFFF);
    let finite = |v: f32| if v.is_finite() { v } else { 1.5 };
    let rgb: Vec<[f32; 3]> = (0..64 * 64).map(|_| [(); 3].map(|()| finite(value()))).collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.exr");
    let picture = Picture::new(64, 64, rgb);
    write_exr(&path, &ExrImage::from_picture(&picture), Precision::Float).unwrap();
    let back = read_exr(&path).unwrap().picture().unwrap();
    let changed = picture.rgb.iter().flatten().zip(back.rgb.iter().flatten());
    let changed = changed.filter(|(a, b)| a.to_bits() != b.to_bits()).count();
    assert_at_most("J4", "EXR, 12,288 floats of any exponent: changed", changed as f64, 0.0);
}
