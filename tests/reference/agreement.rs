//! Two pictures with their own noise: when they are of the same radiance.

use crate::common::render;
use steradian::RenderSettings;
use steradian::film::Film;
use steradian::reference;
use steradian::scene::Scene;
use steradian::settings::Sampler;

/// Share of comparisons of equal pictures that may fail: 3.9 standard errors.
const CHANCE: f64 = 1e-4;
/// Pixels on the side of a tile.
const TILE: usize = 4;
/// Relative error of f32 shading that is no noise: as in the tests of known radiance.
const ROUNDING: f64 = 128.0 / 16_777_216.0;

/// Relative bias that the comparison would show: of the picture's mean, and of every tile's,
/// relative to the picture's mean.
#[derive(Clone, Copy)]
pub(crate) struct Visible {
    pub(crate) mean: f64,
    pub(crate) tile: f64,
}

/// Mean luminance of a region and its standard error.
struct Region {
    mean: f64,
    standard_error: f64,
}

/// Of the pixels of `film` with these indices. Pixels are independent of each other.
fn region(film: &Film, pixels: &[usize]) -> Region {
    let picture = film.picture();
    let errors = film.standard_error().unwrap();
    let n = pixels.len() as f64;
    let luminance = |i: &usize| {
        let [r, g, b] = picture.rgb[*i].map(f64::from);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let variance: f64 = pixels.iter().map(|&i| f64::from(errors[i]).powi(2)).sum();
    Region {
        mean: pixels.iter().map(luminance).sum::<f64>() / n,
        standard_error: variance.sqrt() / n,
    }
}

/// Standard errors by which one of `count` comparisons goes too far in [`CHANCE`] of all cases:
/// Šidák's share of each, and the normal distribution's tail by bisection.
fn threshold(count: usize) -> f64 {
    let share = -(-CHANCE).ln_1p() / count as f64;
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if two_sided_tail(middle) > share {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// Probability that a normal number is farther from 0 than `z`, by Simpson's rule.
fn two_sided_tail(z: f64) -> f64 {
    let density = |x: f64| (-0.5 * x * x).exp() * (2.0 / std::f64::consts::PI).sqrt();
    let step = 0.005;
    let of_pair = |k: i32| {
        let x = z + 2.0 * step * f64::from(k);
        step / 3.0 * (density(x) + 4.0 * density(x + step) + density(x + 2.0 * step))
    };
    (0..1200).map(of_pair).sum()
}

/// Renders with both and asserts that they agree: in the picture's mean, and in all tiles.
#[track_caller]
pub(crate) fn compare(what: &str, scene: &Scene, settings: &RenderSettings, visible: Visible) {
    // Only independent samples have blocks whose spread is that of their mean.
    let settings = RenderSettings { sampler: Sampler::Independent, ..settings.clone() };
    let film = render(scene, &settings);
    let (truth, tally) = reference::render(scene, &settings, |_| true).unwrap();
    assert_eq!((tally.cut_off, tally.non_finite), (0, 0));

    let (width, height) = (settings.window().width as usize, settings.window().height as usize);
    assert!(width % TILE == 0 && height % TILE == 0);
    let all: Vec<_> = (0..width * height).collect();
    let scale = region(&truth, &all).mean;
    assert_region(what, (&film, &truth), &all, (1, scale), visible.mean);
    let tiles = width * height / (TILE * TILE);
    for tile in 0..tiles {
        let (column, row) = (tile % (width / TILE) * TILE, tile / (width / TILE) * TILE);
        let pixels = (0..TILE * TILE).map(|k| (row + k / TILE) * width + column + k % TILE);
        let what = format!("{what}, tile {column},{row}");
        assert_region(
            &what,
            (&film, &truth),
            &pixels.collect::<Vec<_>>(),
            (tiles, scale),
            visible.tile,
        );
    }
}

#[track_caller]
fn assert_region(
    what: &str,
    (film, truth): (&Film, &Film),
    pixels: &[usize],
    (count, scale): (usize, f64),
    visible: f64,
) {
    let (got, expected) = (region(film, pixels), region(truth, pixels));
    let error = got.mean - expected.mean;
    let s = got.standard_error.hypot(expected.standard_error);
    let limit = threshold(count) * s + ROUNDING * expected.mean;
    println!(
        "{what}: {:.5} ± {:.5} for {:.5} ± {:.5}, z = {:.2}, s/scale {:.4}",
        got.mean,
        got.standard_error,
        expected.mean,
        expected.standard_error,
        error / s,
        s / scale,
    );
    assert!(s <= visible * scale / 4.0, "{what}: {s:e} of {scale:e} is too coarse to decide");
    assert!(
        error.abs() <= limit,
        "{what}: {} for {}, {:.1} standard errors apart",
        got.mean,
        expected.mean,
        error / s
    );
}

#[test]
fn the_threshold_is_that_of_so_many_comparisons() {
    // Quantiles from tables of the normal distribution: 5e-5 and, for 100, 5e-7 on each side.
    assert!((threshold(1) - 3.8906).abs() < 1e-3, "{}", threshold(1));
    assert!((threshold(100) - 4.8916).abs() < 1e-3, "{}", threshold(100));
}
