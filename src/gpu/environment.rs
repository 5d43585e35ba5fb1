//! The environment map as the device reads it, with its sampling tables.

use crate::scene::Environment;
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

/// `environment`, and what its power depends on.
pub(super) struct EnvironmentMap {
    /// Texels, then tables: `light/environment.wgsl` says in which order.
    pub(super) words: Vec<[u32; 4]>,
    /// Integral of the luminance over all directions, W/m².
    pub(super) luminous_integral: f64,
}

pub(super) fn luminance(c: Vec3) -> f64 {
    c.as_dvec3().dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

pub(super) fn build(map: &Environment) -> EnvironmentMap {
    let (w, h) = (map.width as usize, map.height as usize);
    let texels: Vec<Vec3> = map.radiance.iter().map(|&r| r * map.intensity).collect();
    let mut words: Vec<[u32; 4]> =
        texels.iter().map(|t| [t.x, t.y, t.z, 0.0].map(f32::to_bits)).collect();
    let value: Vec<f64> = texels.iter().map(|&t| luminance(t)).collect();
    let mean = filtered_means(&value, w, h);

    // By a product of sines: no cancellation at the poles.
    let row_height = |row: usize| {
        let step = PI / h as f64;
        2.0 * ((row as f64 + 0.5) * step).sin() * (0.5 * step).sin()
    };
    let rows: Vec<f64> =
        (0..h).map(|y| mean[y * w..(y + 1) * w].iter().sum::<f64>() * row_height(y)).collect();
    let luminous_integral = rows.iter().sum::<f64>() * TAU / w as f64;

    let mut tables = cumulative(&rows);
    for y in 0..h {
        tables.extend(cumulative(&mean[y * w..(y + 1) * w]));
    }
    let top = |row: usize| (row as f64 * PI / h as f64).cos();
    tables.extend((0..h).flat_map(|y| [top(y), row_height(y)]).map(|x| x as f32));
    words.extend(
        tables
            .chunks(4)
            .map(|four| std::array::from_fn(|k| four.get(k).copied().unwrap_or(0.0_f32).to_bits())),
    );
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
    fn zero_weights_have_no_width() {
        assert_eq!(cumulative(&[0.0, 1.0, 0.0]), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(cumulative(&[0.0, 0.0]), [0.0, 0.5, 1.0]);
    }
}
