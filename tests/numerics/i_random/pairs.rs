//! Any two of the first 64 numbers of a path are independent.

use super::warps::scrambled;
use super::{SAMPLERS, correlation, draws, pixel};
use crate::common::{Random, assert_at_least, assert_at_most, assert_naive_fails};
use steradian::settings::Sampler;
use steradian::statistics::{FALSE_ALARM, GoodnessOfFit, sidak};

const DIMENSIONS: usize = 64;
const COUNT: u32 = 1 << 14;
const PAIRS: usize = DIMENSIONS * (DIMENSIONS - 1) / 2;

/// The 64 numbers of samples given as pixel and index, one list a dimension.
fn dimensions(sampler: Sampler, samples: &[(u32, u32)]) -> Vec<Vec<f32>> {
    let mut all = Vec::new();
    for slot in 0..DIMENSIONS as u32 / 4 {
        let places: Vec<_> = samples.iter().map(|&(pixel, index)| [pixel, index, slot]).collect();
        let numbers = draws(sampler, &places);
        all.extend((0..4).map(|k| numbers.iter().map(|n| n[k]).collect::<Vec<f32>>()));
    }
    all
}

/// Largest |r| √n, and least p of a chi-square test on 8 × 8 cells, over all pairs.
fn worst_pair(dimensions: &[Vec<f32>]) -> (f64, f64) {
    const CELLS: usize = 8;
    let (mut worst, mut least) = (0.0_f64, 1.0_f64);
    for (i, a) in dimensions.iter().enumerate() {
        for b in &dimensions[..i] {
            let r = correlation(a.iter().zip(b).map(|(&a, &b)| (f64::from(a), f64::from(b))));
            worst = worst.max(r.abs() * (a.len() as f64).sqrt());
            let mut counts = [0_u64; CELLS * CELLS];
            for (&a, &b) in a.iter().zip(b) {
                counts[(a * CELLS as f32) as usize * CELLS + (b * CELLS as f32) as usize] += 1;
            }
            let expected = [a.len() as f64 / (CELLS * CELLS) as f64; CELLS * CELLS];
            least = least.min(GoodnessOfFit::of(&counts, &expected).p_value);
        }
    }
    (worst, least)
}

/// Over pixels every number is a fresh draw with both samplers; over the samples of a few
/// pixels those of Sobol points are more even than chance, never less.
#[test]
fn i6_no_two_numbers_of_a_path_are_related() {
    let over_pixels: Vec<_> = (0..COUNT).map(|i| (pixel(i & 127, i >> 7), 5)).collect();
    let over_samples: Vec<_> = (0..COUNT).map(|i| (pixel(i >> 10, 3), i & 1023)).collect();
    for sampler in SAMPLERS {
        for (over, samples) in [("pixels", &over_pixels), ("samples", &over_samples)] {
            let (worst, least) = worst_pair(&dimensions(sampler, samples));
            let what = format!("{sampler:?}, 2016 pairs of numbers over 2^14 {over}");
            // 5 is 6e-7: 1e-3 for all pairs.
            assert_at_most("I6", &format!("{what}: largest |r| √n"), worst, 5.0);
            let level = sidak(FALSE_ALARM, PAIRS);
            assert_at_least("I6", &format!("{what}: least p of χ² on 8 × 8"), least, level);
        }
    }
    // The same point for the light and for the BSDF.
    let mut random = Random(6);
    let reused: Vec<[f32; 4]> = (0..COUNT)
        .map(|_| {
            let point = scrambled(0, 5, &[random.bits() as u32, random.bits() as u32]);
            [point[0], point[1], point[0], point[1]]
        })
        .collect();
    let columns: Vec<Vec<f32>> = (0..4).map(|k| reused.iter().map(|p| p[k]).collect()).collect();
    let (worst, _) = worst_pair(&columns);
    assert_naive_fails("I6", "one pair for light and BSDF: largest |r| √n", worst, 100.0);
}
