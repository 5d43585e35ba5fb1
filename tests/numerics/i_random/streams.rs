//! Streams: nothing is drawn twice, and neighbours have nothing in common.

use super::{SAMPLERS, correlation, draws, pcg_step, pixel};
use crate::common::{
    Call, Random, Stage, assert_at_most, assert_naive_fails, harness, lambert, report,
};
use glam::Vec3;
use steradian::RenderSettings;

/// Entries equal to another one, less one for each value.
fn duplicates<T: Ord + Copy>(values: &[T]) -> usize {
    let mut sorted = values.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).filter(|w| w[0] == w[1]).count()
}

/// `sampler_hash` and `sampler_seeds` of 2^20 samples: 256 × 256 pixels, 4 groups, 4 bounces,
/// so that both have 2^20 keys.
fn census() -> [Vec<[u32; 4]>; 2] {
    let key = |i: u32| {
        let (place, group) = (i & 3, i >> 2 & 3);
        [pixel(i >> 4 & 255, i >> 12), i & 15, group, place]
    };
    let keys: Vec<[u32; 4]> = (0..1 << 20).map(key).collect();
    let mut stage = Stage::perspective(Vec3::Y, Vec3::ZERO, 1.0);
    stage.floor(Vec3::ZERO, 1.0, lambert(0.5));
    let settings = RenderSettings::default();
    let words: Vec<[u32; 4]> =
        Call::new(harness!("sampler_bits"), &[]).on(&stage.scene, &settings).run(&keys, 2);
    let every_second = |k: usize| words.iter().skip(k).step_by(2).copied().collect();
    [every_second(0), every_second(1)]
}

/// Equal words are as many as chance has it: n²/2^33 pairs of n, and 5 standard deviations.
#[test]
fn i1_no_stream_is_used_twice() {
    let mut worst = 0.0_f64;
    for words in census() {
        let n = words.len() as f64;
        let expected = n * n / 2.0_f64.powi(33);
        for k in 0..4 {
            let of_word: Vec<u32> = words.iter().map(|w| w[k]).collect();
            let found = duplicates(&of_word) as f64;
            worst = worst.max((found - expected).abs() / expected.sqrt());
        }
    }
    let what = "equal words of 2^20 samples against n²/2^33, worst of 8 words, standard deviations";
    assert_at_most("I1", what, worst, 5.0);

    let seed = |i: u32| {
        let (x, y, s) = (i & 511, i >> 9 & 511, i >> 18);
        (1973 * x + 9277 * y + 26_699 * s) | 1
    };
    let seeds: Vec<u32> = (0..512 * 512 * 16).map(seed).collect();
    let share = duplicates(&seeds) as f64 / seeds.len() as f64;
    assert_naive_fails("I1", "linear seeds, 512 × 512 × 16: share used before", share, 0.3);
}

/// The 128-bit words of different keys differ: the hash is a bijection. Streams of a 32-bit
/// state lie on one cycle of 2^32, and run into each other.
#[test]
fn i3_streams_do_not_overlap() {
    let equal: usize = census().iter().map(|words| duplicates(words)).sum();
    assert_at_most("I3", "equal 128-bit words of 2 × 2^20 keys", equal as f64, 0.0);

    let mut random = Random(3);
    let mut states = Vec::new();
    for _ in 0..1 << 14 {
        let mut state = random.bits() as u32;
        for _ in 0..64 {
            state = pcg_step(state);
            states.push(state);
        }
    }
    let met = duplicates(&states) as f64;
    // 128 expected.
    assert_naive_fails("I3", "32-bit state, 2^14 streams of 64 draws: states met twice", met, 70.0);
}

/// The first eight numbers of neighbouring pixels, 2^20 pixels.
#[test]
fn i2_neighbours_are_not_correlated() {
    const SIDE: u32 = 1024;
    for sampler in SAMPLERS {
        let mut worst = 0.0_f64;
        for slot in 0..2 {
            let place = |i: u32| [pixel(i % SIDE, i / SIDE), 0, slot];
            let numbers = draws(sampler, &(0..SIDE * SIDE).map(place).collect::<Vec<_>>());
            for dimension in 0..4 {
                for lag in [1, SIDE as usize] {
                    let at = |i: usize| f64::from(numbers[i][dimension]);
                    let pairs = (0..numbers.len() - lag).map(|i| (at(i), at(i + lag)));
                    let r = correlation(pairs);
                    worst = worst.max(r.abs() * (numbers.len() as f64).sqrt());
                }
            }
        }
        let what = format!("{sampler:?}: |r| √n of 2^20 neighbours, worst of 8 numbers, 2 ways");
        assert_at_most("I2", &what, worst, 4.0);
    }
    // The seed is the pixel's index, as the state of a linear generator.
    let first = |i: u32| f64::from(pcg_step(i) >> 8) / 16_777_216.0;
    let r = correlation((0..SIDE * SIDE - 1).map(|i| (first(i), first(i + 1))));
    let n = f64::from(SIDE * SIDE);
    report("I2", "linear generator seeded by the pixel's index: correlation", r);
    let what = "linear generator seeded by the pixel's index: |r| √n";
    assert_naive_fails("I2", what, r.abs() * n.sqrt(), 40.0);
}
