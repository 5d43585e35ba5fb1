//! The environment map as the device reads it, with its sampling tables.

use crate::scene::Environment;
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// `environment`, and what its power depends on.
pub(super) struct EnvironmentMap {
    /// Texels, then tables: `light/environment.wgsl` says in which order.
    pub(super) words: Vec<u32>,
    /// Integral of the luminance over all directions, W/m².
    pub(super) luminous_integral: f64,
}

pub(super) fn luminance(c: Vec3) -> f64 {
    c.as_dvec3().dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// Most cells of a sampling table. A map with more texels has several of them to a cell.
const MAX_CELLS: usize = 1 << 21;

/// Side of a cell of the sampling table, texels.
pub(super) fn block(map: &Environment) -> u32 {
    let cells =
        |block: u32| map.width.div_ceil(block) as usize * map.height.div_ceil(block) as usize;
    (1..).find(|&block| cells(block) <= MAX_CELLS).unwrap_or(1)
}

pub(super) fn build(map: &Environment) -> EnvironmentMap {
    let (w, h, block) = (map.width as usize, map.height as usize, block(map) as usize);
    let texels: Vec<Vec3> = map.radiance.iter().map(|&r| r * map.intensity).collect();
    let mut words: Vec<u32> = texels.iter().flat_map(|t| t.to_array().map(f32::to_bits)).collect();
    let value: Vec<f64> = texels.iter().map(|&t| luminance(t)).collect();
    drop(texels);
    let mean = filtered_means(&value, w, h);

    // How much the cosine falls over rows; by a product of sines: no cancellation at the poles.
    let height = |rows: &Range<usize>| {
        let step = PI / h as f64;
        let (middle, half) = (0.5 * (rows.start + rows.end) as f64, 0.5 * rows.len() as f64);
        2.0 * (middle * step).sin() * (half * step).sin()
    };
    let bands: Vec<Range<usize>> = (0..h).step_by(block).map(|y| y..(y + block).min(h)).collect();
    // Integrals over cells, but for the band's height and a column's angle.
    let cells = |band: &Range<usize>| -> Vec<f64> {
        let mut sums = vec![0.0; w.div_ceil(block)];
        for y in band.clone() {
            let share = height(&(y..y + 1)) / height(band);
            for (x, mean) in mean[y * w..(y + 1) * w].iter().enumerate() {
                sums[x / block] += mean * share;
            }
        }
        sums
    };
    let columns: Vec<Vec<f64>> = bands.iter().map(cells).collect();
    let rows: Vec<f64> = (columns.iter().zip(&bands))
        .map(|(columns, band)| columns.iter().sum::<f64>() * height(band))
        .collect();
    let luminous_integral = rows.iter().sum::<f64>() * TAU / w as f64;

    let mut tables = cumulative(&rows);
    tables.extend(columns.iter().flat_map(|columns| cumulative(columns)));
    let top = |band: &Range<usize>| (band.start as f64 * PI / h as f64).cos();
    tables.extend(bands.iter().flat_map(|band| [top(band), height(band)]).map(|x| x as f32));
    words.extend(tables.into_iter().map(f32::to_bits));
    EnvironmentMap { words, luminous_integral }
}

/// Mean over each texel of the bilinearly filtered map: weights 1/8, 6/8, 1/8 along each axis.
fn filtered_means(value: &[f64], w: usize, h: usize) -> Vec<f64> {
    let tent = |a: f64, b: f64, c: f64| (a + 6.0 * b + c) / 8.0;
    let mut across = vec![0.0; w * h];
    for y in 0..h {
        for x in 0..w {
            let at = |x: usize| value[y * w + x];
            across[y * w + x] = tent(at((x + w - 1) % w), at(x), at((x + 1) % w));
        }
    }
    let mut mean = vec![0.0; w * h];
    for y in 0..h {
        for x in 0..w {
            let at = |y: usize| across[y * w + x];
            mean[y * w + x] = tent(at(y.saturating_sub(1)), at(y), at((y + 1).min(h - 1)));
        }
    }
    mean
}

/// Cumulative probabilities, beginning with 0 and ending with 1; uniform if all weights are 0.
pub(super) fn cumulative(weights: &[f64]) -> Vec<f32> {
    let sum: f64 = weights.iter().sum();
    let n = weights.len() as f64;
    let mut total = 0.0;
    let mut cdf = Vec::with_capacity(weights.len() + 1);
    cdf.push(0.0);
    for w in weights {
        total += if sum > 0.0 { w / sum } else { 1.0 / n };
        cdf.push(total as f32);
    }
    // Rounding must not leave a gap before 1, nor a width to a texel of weight 0 at the end.
    let last = cdf[weights.len()];
    cdf.iter_mut().filter(|c| **c == last).for_each(|c| *c = 1.0);
    cdf
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_map_integrates_to_four_pi() {
        for (width, height) in [(1, 1), (4, 2), (64, 32)] {
            let mut map = Environment::constant(Vec3::ONE);
            map.radiance = vec![Vec3::ONE; (width * height) as usize];
            (map.width, map.height) = (width, height);
            let built = build(&map);
            assert!((built.luminous_integral - 4.0 * PI).abs() < 1e-9, "{width}x{height}");
        }
    }

    #[test]
    fn cells_of_several_texels_have_the_integral_of_all() {
        // 2 × 2 texels to a cell, and less at the right and lower edge.
        let (width, height) = (2049, 1025);
        let radiance =
            (0..width * height).map(|i| Vec3::splat((i % 1013 * 7919 % 101) as f32)).collect();
        let mut map = Environment::constant(Vec3::ONE);
        (map.width, map.height, map.radiance) = (width, height, radiance);
        assert_eq!(block(&map), 2);
        let built = build(&map);
        let value: Vec<f64> = map.radiance.iter().map(|&r| luminance(r)).collect();
        let mean = filtered_means(&value, width as usize, height as usize);
        let (step, turn) = (PI / f64::from(height), TAU / f64::from(width));
        let edge = |y: usize| (y as f64 * step).cos();
        let texel = |(i, m): (usize, &f64)| {
            let y = i / width as usize;
            m * (edge(y) - edge(y + 1)) * turn
        };
        let expected: f64 = mean.iter().enumerate().map(texel).sum();
        assert!((built.luminous_integral / expected - 1.0).abs() < 1e-9);
        // Texels of three words; tables of 513 rows and 1025 columns, and of the rows' form.
        let tables = 514 + 513 * 1026 + 2 * 513;
        assert_eq!(built.words.len(), (3 * width * height) as usize + tables);
    }

    #[test]
    fn zero_weights_have_no_width() {
        assert_eq!(cumulative(&[0.0, 1.0, 0.0]), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(cumulative(&[0.0, 0.0]), [0.0, 0.5, 1.0]);
    }
}
