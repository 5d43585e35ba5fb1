//! The same bits however work is cut, and as without a rule where no pixel stops.

use super::{calibrated, render, render_with, scene, seed, with_rule};
use crate::common::settings;
use steradian::RenderSettings;
use steradian::film::Film;
use steradian::passes::Tuning;
use steradian::stopping::{Preset, StopReason, StoppingRule};

fn bits(film: &Film) -> Vec<[u32; 3]> {
    film.picture().rgb.iter().map(|c| c.map(f32::to_bits)).collect()
}

/// A tolerance that no pixel of the scene keeps.
const NEVER: f32 = 1e-9;

#[test]
fn a_rule_that_never_stops_changes_nothing() {
    // 100 samples end within a block of 8.
    let fixed = RenderSettings { block_size: 8, ..settings(38, 21, 100) };
    let (expected, _) = render(&scene(), &fixed);
    for rule in [calibrated(NEVER, Preset::Default), seed(32, NEVER)] {
        let (film, statistics) = render(&scene(), &with_rule(rule, 100));
        // A pixel whose samples are equal so far stops all the same.
        let all: Vec<_> = (0..38 * 21).filter(|&i| film.sample_counts()[i] == 100).collect();
        assert!(all.len() > 400, "{} pixels have all samples: no test", all.len());
        // Up to 128 samples the blocks are the same: so are the bits.
        for i in all {
            assert_eq!(bits(&film)[i], bits(&expected)[i], "pixel {i}");
        }
        let counted: u64 = film.sample_counts().iter().map(|&n| u64::from(n)).sum();
        assert_eq!(statistics.samples, counted);
    }
}

/// The same samples in blocks that grow: the sums differ by rounding alone.
#[test]
fn long_blocks_have_the_same_samples() {
    const SPP: u32 = 1100;
    let fixed = RenderSettings { block_size: 8, ..settings(16, 8, SPP) };
    let (expected, _) = render(&scene(), &fixed);
    let rule = calibrated(NEVER, Preset::Default);
    let settings = RenderSettings { resolution: (16, 8), ..with_rule(rule, SPP) };
    let (film, _) = render(&scene(), &settings);
    // A block's sum of 128 differences loses half a unit of 2^-24 at each addition at most, of
    // a sum that is no larger than that of all radiance, which is not negative.
    let rounding = 128.0 * 0.5_f32.powi(24);
    for i in (0..16 * 8).filter(|&i| film.sample_counts()[i] == SPP) {
        let (a, b) = (film.picture().rgb[i], expected.picture().rgb[i]);
        for c in 0..3 {
            assert!((a[c] - b[c]).abs() <= rounding * b[c], "pixel {i}: {a:?} {b:?}");
        }
    }
    assert!(film.sample_counts().iter().filter(|&&n| n == SPP).count() > 64);
}

#[test]
fn a_tolerance_of_zero_is_no_rule() {
    let (expected, _) = render(&scene(), &settings(38, 21, 48));
    for rule in [calibrated(0.0, Preset::Strict), seed(32, 0.0)] {
        let (film, statistics) = render(&scene(), &with_rule(rule, 48));
        assert_eq!(bits(&film), bits(&expected));
        assert!(film.stops().is_none());
        assert_eq!(statistics.decisions, 0);
    }
}

fn check_cuts(rule: StoppingRule) {
    let settings = with_rule(rule, 136);
    let (expected, statistics) = render(&scene(), &settings);
    let stops = expected.stops().unwrap();
    let is_converged = |reason| reason == StopReason::Converged;
    let converged = stops.iter().filter(|s| is_converged(s.reason)).count();
    assert!(converged > 0 && converged < stops.len(), "{converged} converged: no test");
    let cuts = [
        Tuning { submit_seconds: 1e-9, ..Tuning::default() },
        Tuning { submit_samples: 1, submit_seconds: 10.0, ..Tuning::default() },
        Tuning { workgroup_size: 256, ..Tuning::default() },
        Tuning { workgroup_size: 8, ..Tuning::default() },
        // Rows that are filled up reach beyond the end of the list.
        Tuning { row_groups: 4, ..Tuning::default() },
    ];
    for tuning in cuts {
        let (film, other) = render_with(&scene(), &settings, &tuning);
        assert_eq!(film.sample_counts(), expected.sample_counts());
        assert_eq!(bits(&film), bits(&expected));
        assert_eq!(film.stops(), expected.stops());
        assert_eq!(other.closest_rays, statistics.closest_rays);
    }
}

#[test]
fn the_calibrated_rule_gives_the_same_bits_for_every_cut() {
    check_cuts(calibrated(0.1, Preset::Default));
}

#[test]
fn the_seeds_rule_gives_the_same_bits_for_every_cut() {
    check_cuts(seed(24, 0.1));
}

/// A render that is begun anew with its seed gives the same again, with another seed another.
#[test]
fn a_restart_forgets_everything() {
    use crate::common::with_device;
    use steradian::Renderer;
    let settings = with_rule(calibrated(0.1, Preset::Default), 128);
    let (expected, statistics) = render(&scene(), &settings);
    with_device(|device| {
        let mut renderer = Renderer::new(device, &scene(), &settings).unwrap();
        let mut of_seed = |seed| {
            renderer.restart(seed).unwrap();
            // Left in the middle, and begun once more.
            assert!(renderer.step().unwrap());
            renderer.restart(seed).unwrap();
            while renderer.step().unwrap() {}
            renderer.finish().unwrap();
            assert!(renderer.statistics().samples <= 128 * 38 * 21);
            (renderer.film().clone(), renderer.statistics().samples)
        };
        let (other, _) = of_seed(settings.seed + 1);
        assert_ne!(bits(&other), bits(&expected));
        let (film, samples) = of_seed(settings.seed);
        assert_eq!(bits(&film), bits(&expected));
        assert_eq!(film.sample_counts(), expected.sample_counts());
        assert_eq!(samples, statistics.samples);
    });
}

/// With emission alone every sample is one ray: what has stopped traces none.
#[test]
fn stopped_pixels_trace_no_rays() {
    let base = with_rule(seed(8, 0.05), 512);
    let (film, statistics) = render(&scene(), &RenderSettings { max_bounces: Some(0), ..base });
    let counted: u64 = film.sample_counts().iter().map(|&n| u64::from(n)).sum();
    assert_eq!((statistics.samples, statistics.closest_rays), (counted, counted));
    assert!(film.most_samples() == 512 && film.least_samples() == 8);
}

/// Broken off within a round, where some pixels have samples of it and others have none.
#[test]
fn a_broken_off_round_leaves_what_was_known() {
    use crate::common::with_device;
    use steradian::Renderer;
    // One sample of one tile at a time: 15 tiles.
    let tuning = Tuning { submit_seconds: 1e-9, ..Tuning::default() };
    let settings = with_rule(calibrated(NEVER, Preset::Default), 4096);
    with_device(|device| {
        let mut renderer = Renderer::with_tuning(device, &scene(), &settings, &tuning).unwrap();
        // 64 samples, after which all are judged, and one more for half of the tiles.
        while renderer.film().least_samples() < 64 {
            assert!(renderer.step().unwrap());
        }
        for _ in 0..7 {
            assert!(renderer.step().unwrap());
        }
        renderer.finish().unwrap();
        let film = renderer.film();
        assert_eq!((film.least_samples(), film.most_samples()), (64, 65));
        let stops = film.stops().unwrap();
        let unfinished = stops.iter().filter(|s| s.reason == StopReason::Unfinished).count();
        assert!(unfinished == stops.len(), "{unfinished}");
        for (i, stop) in stops.iter().enumerate() {
            assert!(stop.half_width >= 0.0 && stop.half_width.is_finite(), "{i}: {stop:?}");
        }
    });
}

/// Fewer samples than two units: nothing is known of the error.
#[test]
fn one_run_gives_no_interval() {
    for spp in [4, 15] {
        let (film, _) = render(&scene(), &with_rule(calibrated(0.1, Preset::Default), spp));
        assert_eq!(film.least_samples(), spp);
        for stop in film.stops().unwrap() {
            assert_eq!((stop.reason, stop.half_width), (StopReason::Limit, f32::INFINITY));
        }
    }
}
