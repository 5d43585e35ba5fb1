//! Sobol points: evenness along the sequence, independence of how work is cut, and what the
//! spread of runs of them says of their mean's error.

use super::warps::scrambled;
use super::{SAMPLERS, draws, pixel};
use crate::common::{Random, assert_at_least, assert_at_most, assert_naive_fails, report};
use steradian::film::{BlockMean, Film};
use steradian::settings::{Crop, Sampler};

const RUN: u32 = 1024;

/// Where the sequence is looked at: at its beginning, far along, and where f32 holds no odd
/// number any more.
const STARTS: [u32; 4] = [0, 1 << 20, 1 << 24, 1 << 31];

/// Cells of `columns` × `RUN / columns` that do not hold exactly one point.
fn uneven_cells(points: &[[f32; 2]], columns: u32) -> usize {
    let rows = RUN / columns;
    let mut cells = vec![0_u32; RUN as usize];
    for [x, y] in points {
        cells[((x * columns as f32) as u32 * rows + (y * rows as f32) as u32) as usize] += 1;
    }
    cells.iter().filter(|&&count| count != 1).count()
}

/// Every elementary interval of the pairs, every stratum of each of the eight dimensions of
/// the first two vertices.
#[test]
fn i5_every_elementary_interval_holds_one_point() {
    let mut uneven = 0;
    for start in STARTS {
        for slot in 0..3 {
            let places: Vec<_> = (0..RUN).map(|i| [pixel(300, 7), start + i, slot]).collect();
            let points = draws(Sampler::Sobol, &places);
            for dimension in 0..4 {
                let along: Vec<_> = points.iter().map(|p| [p[dimension], 0.0]).collect();
                uneven += uneven_cells(&along, RUN);
            }
            // The pairs of film and lens, and the first pair of the eight dimensions.
            let pairs: &[usize] = if slot == 0 { &[0, 2] } else { &[0] };
            if slot < 2 {
                for first in pairs {
                    let pair: Vec<_> = points.iter().map(|p| [p[*first], p[first + 1]]).collect();
                    uneven += (0..=10).map(|k| uneven_cells(&pair, 1 << k)).sum::<usize>();
                }
            }
        }
    }
    let what = "cells without exactly one of 1024 points, from 0, 2^20, 2^24, 2^31";
    assert_at_most("I5", what, uneven as f64, 0.0);

    // The index in f32.
    let index = |i: u32| ((1_u32 << 24) + i) as f32 as u32;
    let points: Vec<_> = (0..RUN).map(|i| scrambled(0, index(i), &[1, 2])).collect();
    let pair: Vec<_> = points.iter().map(|p| [p[0], p[1]]).collect();
    let uneven = uneven_cells(&pair, RUN) as f64;
    assert_naive_fails("I5", "index in f32, from 2^24: strata without one point", uneven, 500.0);
}

/// A number depends on pixel, sample and place alone: not on which thread draws it, nor on
/// what is drawn beside it.
#[test]
fn i7_numbers_do_not_depend_on_the_batch() {
    let place = |i: u32| [pixel(i & 7, 3), i >> 3 & 63, i >> 9];
    let forwards: Vec<_> = (0..1 << 13).map(place).collect();
    for sampler in SAMPLERS {
        let whole = draws(sampler, &forwards);
        let backwards: Vec<_> = forwards.iter().rev().copied().collect();
        let mut turned = draws(sampler, &backwards);
        turned.reverse();
        assert_eq!(whole, turned, "{sampler:?}");
        for (piece, expected) in forwards.chunks(1 << 11).zip(whole.chunks(1 << 11)) {
            assert_eq!(draws(sampler, piece), expected, "{sampler:?}");
        }
        assert!(whole.windows(2).filter(|w| w[0] == w[1]).count() == 0);
    }
}

/// An integrand on the unit cube of four dimensions, and its integral.
struct Integrand {
    name: &'static str,
    f: fn([f64; 4]) -> f64,
    integral: f64,
    has_edge: bool,
}

fn integrands() -> [Integrand; 4] {
    use std::f64::consts::{E, PI};
    [
        Integrand {
            name: "slanted edge, 2 dimensions",
            f: |u| step(u[0] + 0.3 * u[1] < 0.55),
            integral: 0.4,
            has_edge: true,
        },
        Integrand {
            name: "quarter disk, 2 dimensions",
            f: |u| step(u[0].hypot(u[1]) < 1.0),
            integral: PI / 4.0,
            has_edge: true,
        },
        Integrand {
            name: "ramps behind an edge, 4 dimensions",
            f: |u| 4.0 * u[0] * u[2] * step(u[1] + u[3] < 1.0),
            integral: 0.5,
            has_edge: true,
        },
        Integrand {
            name: "smooth, 2 dimensions",
            f: |u| (u[0] + u[1]).exp(),
            integral: (E - 1.0) * (E - 1.0),
            has_edge: false,
        },
    ]
}

fn step(b: bool) -> f64 {
    if b { 1.0 } else { 0.0 }
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

const PIXELS: u32 = 1024;
const SPP: u32 = 256;
const BLOCK: u32 = 16;

/// Standard errors that the film gives for the values of 1024 pixels, root mean square.
fn film_error(values: &[Vec<f64>]) -> f64 {
    let window = Crop { x: 0, y: 0, width: PIXELS, height: 1 };
    let mut film = Film::new(window, BLOCK);
    for block in 0..(SPP / BLOCK) as usize {
        let range = block * BLOCK as usize..(block + 1) * BLOCK as usize;
        for (x, of_pixel) in (0..).zip(values) {
            let mean = mean(&of_pixel[range.clone()]);
            film.add_block(x, 0, BlockMean { mean: [mean; 3], sample_count: BLOCK });
        }
    }
    let errors = film.standard_error().unwrap();
    root_mean_square(&errors.iter().map(|&e| f64::from(e)).collect::<Vec<_>>())
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// |I - A| of the whole and its even-numbered points, over the true error, root mean squares:
/// of a scrambled sequence whose order is not shuffled.
fn unshuffled_halves(integrand: &Integrand) -> f64 {
    let mut random = Random(8);
    let (mut differences, mut errors) = (Vec::new(), Vec::new());
    for _ in 0..PIXELS {
        let seeds: Vec<u32> = (0..4).map(|_| random.bits() as u32).collect();
        let point = |i| scrambled(0, i, &seeds).try_into().map(|u: [f32; 4]| u.map(f64::from));
        let values: Vec<f64> = (0..SPP).map(|i| (integrand.f)(point(i).unwrap())).collect();
        let even: Vec<f64> = values.iter().step_by(2).copied().collect();
        differences.push(mean(&values) - mean(&even));
        errors.push(mean(&values) - integrand.integral);
    }
    root_mean_square(&differences) / root_mean_square(&errors)
}

/// The film's standard error, from 8 to 16 consecutive runs, over the true one. Runs of a
/// sequence share the evenness that the whole gains, so that the estimate errs to the large
/// side, the more so the smoother the integrand.
#[test]
fn i8_runs_of_a_sequence_tell_the_error_of_its_mean() {
    let places: Vec<_> = (0..PIXELS * SPP).map(|i| [pixel(i / SPP, 11), i % SPP, 1]).collect();
    for sampler in SAMPLERS {
        let numbers = draws(sampler, &places);
        for integrand in integrands() {
            let value = |u: &[f32; 4]| (integrand.f)(u.map(f64::from));
            let values: Vec<Vec<f64>> = numbers
                .chunks(SPP as usize)
                .map(|of_pixel| of_pixel.iter().map(value).collect())
                .collect();
            let errors: Vec<f64> = values.iter().map(|v| mean(v) - integrand.integral).collect();
            let error = root_mean_square(&errors);
            let ratio = film_error(&values) / error;
            let halves: Vec<f64> =
                values.iter().map(|v| mean(v) - mean(&v[..SPP as usize / 2])).collect();
            let name = integrand.name;
            let of_halves = root_mean_square(&halves) / error;
            report(
                "I8",
                &format!("{sampler:?}, {name}: two halves over the true error"),
                of_halves,
            );
            let what = format!("{sampler:?}, {name}: the film's standard error over the true one");
            assert_at_least("I8", &what, ratio, 0.5);
            if integrand.has_edge || sampler == Sampler::Independent {
                assert_at_most("I8", &what, ratio, 2.0);
            } else {
                report("I8", &what, ratio);
            }
        }
    }
    let worst = integrands().iter().map(unshuffled_halves).fold(0.0, f64::max);
    let what = "even half of an unshuffled sequence, |I - A| over the true error, worst of 4";
    assert_naive_fails("I8", what, worst, 16.0);
}
