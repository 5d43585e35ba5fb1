//! Views of how far a render is.

use super::colors::{along, shown};
use super::{View, ViewPicture};
use crate::film::{ERROR_FLOOR, Film};
use crate::image::{ChannelData, Layer, MapColors, Picture, sample_map};
use crate::shader::generated::{Fault, StopReason};
use colorous::INFERNO;

/// Relative standard errors that are black and white: a thousandth and 1.
const ERROR_DECADES: f64 = 3.0;

/// sRGB, in the order of [`StopReason::ALL`].
const STOP_COLORS: [[f32; 3]; 3] = [[0.35, 0.4, 0.55], [0.25, 0.7, 0.35], [0.9, 0.35, 0.15]];
/// sRGB, in the order of [`Fault::ALL`].
const FAULT_COLORS: [[f32; 3]; 4] =
    [[1.0, 0.0, 1.0], [0.0, 0.9, 1.0], [1.0, 0.9, 0.0], [1.0, 0.5, 0.0]];
/// Of pixels without faults, by their luminance: so that one sees where one is.
const FAULTLESS: f32 = 0.25;

/// A view of `film`. `limit`: most samples that a pixel may have. `None` for a view of first hits,
/// and where the film does not know: the standard error before two blocks, the stop reason of
/// a render without a stopping rule.
pub fn of_film(view: View, film: &Film, limit: u32) -> Option<ViewPicture> {
    let (rgb, legend, channels) = match view {
        View::SampleCount => sample_count(film, limit),
        View::StandardError => standard_error(film)?,
        View::StopReason => stop_reason(film)?,
        View::NonFinite => faults(film),
        _ => return None,
    };
    let (width, height) = (film.window().width, film.window().height);
    let channels = channels.into_iter().map(|(name, data)| (name.into(), data)).collect();
    let layer = Layer { name: view.layer_name().into(), channels };
    Some(ViewPicture { picture: Picture::new(width, height, rgb), legend, layer })
}

type Parts = (Vec<[f32; 3]>, String, Vec<(&'static str, ChannelData)>);

fn luminance(c: &[f32; 3]) -> f64 {
    0.2126 * f64::from(c[0]) + 0.7152 * f64::from(c[1]) + 0.0722 * f64::from(c[2])
}

fn sample_count(film: &Film, limit: u32) -> Parts {
    let counts = film.sample_counts();
    let size = (film.window().width, film.window().height);
    let map = sample_map(counts, size, limit, MapColors::Viridis);
    let (least, most) = (film.least_samples(), film.most_samples());
    let legend =
        format!("samples: from {least} (dark blue) to {most} (yellow), by their logarithm");
    (map.rgb, legend, vec![("samples", ChannelData::U32(counts.to_vec()))])
}

fn standard_error(film: &Film) -> Option<Parts> {
    let errors = film.standard_error()?;
    let floor = ERROR_FLOOR * film.mean_luminance();
    let picture = film.picture();
    let relative = errors.iter().zip(&picture.rgb).map(|(error, rgb)| {
        let mean = luminance(rgb).max(floor);
        if *error > 0.0 { f64::from(*error) / mean } else { 0.0 }
    });
    let relative: Vec<f64> = relative.collect();
    // The logarithm of 0 is below every share.
    let color = |r: &f64| along(INFERNO, 1.0 + r.log10() / ERROR_DECADES);
    let legend = "standard error of the mean luminance, relative to it: from a thousandth (black) \
                  to 1 (yellow), by its logarithm";
    let channels = vec![
        ("luminance", ChannelData::F32(errors)),
        ("relative", ChannelData::F32(relative.iter().map(|r| *r as f32).collect())),
    ];
    Some((relative.iter().map(color).collect(), legend.into(), channels))
}

fn stop_reason(film: &Film) -> Option<Parts> {
    let stops = film.stops()?;
    let rgb = stops.iter().map(|stop| shown(STOP_COLORS[stop.reason as usize])).collect();
    let share = |reason: StopReason| {
        let count = stops.iter().filter(|stop| stop.reason == reason).count();
        100.0 * count as f64 / stops.len().max(1) as f64
    };
    let [unfinished, converged, limit] = StopReason::ALL.map(share);
    let legend = format!(
        "converged {converged:.1} % (green), at the limit of samples {limit:.1} % (orange), \
         unfinished {unfinished:.1} % (blue)"
    );
    let reasons = stops.iter().map(|stop| stop.reason as u32).collect();
    let half_widths = stops.iter().map(|stop| stop.half_width).collect();
    let channels =
        vec![("reason", ChannelData::U32(reasons)), ("half_width", ChannelData::F32(half_widths))];
    Some((rgb, legend, channels))
}

fn faults(film: &Film) -> Parts {
    let picture = film.picture();
    let none = vec![[0; 4]; picture.rgb.len()];
    let faults = film.faults().unwrap_or(&none);
    // A sum that has overflowed is as bad as a sample.
    let is_bad = |i: usize| picture.rgb[i].iter().any(|v| !v.is_finite());
    let counts = |cause: Fault| {
        let count = |(i, of_pixel): (usize, &[u32; 4])| match cause {
            Fault::NonFinite => of_pixel[0].max(u32::from(is_bad(i))),
            other => of_pixel[other as usize],
        };
        faults.iter().enumerate().map(count).collect::<Vec<u32>>()
    };
    let counts = Fault::ALL.map(counts);
    let color = |i: usize| match Fault::ALL.iter().find(|cause| counts[**cause as usize][i] > 0) {
        Some(cause) => shown(FAULT_COLORS[*cause as usize]),
        None => picture.rgb[i].map(|v| FAULTLESS * v.clamp(0.0, 1.0)),
    };
    let rgb = (0..picture.rgb.len()).map(color).collect();
    let pixels = |cause: Fault| counts[cause as usize].iter().filter(|n| **n > 0).count();
    let legend = format!(
        "pixels with samples that are not finite {} (magenta), negative {} (cyan), cut off {} \
         (yellow), of a stack overflow {} (orange); the others darkened",
        pixels(Fault::NonFinite),
        pixels(Fault::Negative),
        pixels(Fault::LoopBound),
        pixels(Fault::Stack),
    );
    let names = ["non_finite", "negative", "loop_bound", "stack"];
    let channels = names.into_iter().zip(counts.map(ChannelData::U32)).collect();
    (rgb, legend, channels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{BlockMean, PixelStop};
    use crate::image::DisplayTransform;
    use crate::settings::Crop;

    /// Three pixels of two blocks of 4 samples around luminance 1, 1 and 0.
    fn film() -> Film {
        let mut film = Film::new(Crop { x: 0, y: 0, width: 3, height: 1 }, 4);
        for means in [[0.9, 1.0, 0.0], [1.1, 1.0, 0.0]] {
            for (x, mean) in (0..).zip(means) {
                film.add_block(x, 0, BlockMean { mean: [mean; 3], sample_count: 4 });
            }
        }
        film
    }

    fn bytes(view: &ViewPicture) -> Vec<[u8; 4]> {
        DisplayTransform::default().srgb8(&view.picture.rgb)
    }

    #[test]
    fn planted_faults_are_seen_where_they_are() {
        let mut film = film();
        let clean = of_film(View::NonFinite, &film, 8).unwrap();
        assert!(clean.legend.starts_with("pixels with samples that are not finite 0 "));
        film.add_faults(1, 0, [2, 0, 1, 0]);
        film.add_faults(1, 0, [1, 0, 0, 0]);
        film.add_faults(2, 0, [0, 3, 0, 0]);
        let view = of_film(View::NonFinite, &film, 8).unwrap();
        assert!(view.legend.starts_with("pixels with samples that are not finite 1 "));
        let shown = bytes(&view);
        assert_eq!(shown[0], bytes(&clean)[0]);
        assert_eq!((shown[1], shown[2]), ([255, 0, 255, 255], [0, 230, 255, 255]));
        let channel = |k: usize| view.layer.channels[k].1.clone();
        assert_eq!(channel(0), ChannelData::U32(vec![0, 3, 0]));
        assert_eq!(channel(1), ChannelData::U32(vec![0, 0, 3]));
        assert_eq!(channel(2), ChannelData::U32(vec![0, 1, 0]));

        let block = BlockMean { mean: [f64::INFINITY; 3], sample_count: 4 };
        film.add_block(0, 0, block);
        let view = of_film(View::NonFinite, &film, 8).unwrap();
        assert_eq!(bytes(&view)[0], [255, 0, 255, 255]);
    }

    #[test]
    fn errors_are_relative_to_the_mean() {
        let view = of_film(View::StandardError, &film(), 8).unwrap();
        let ChannelData::F32(relative) = &view.layer.channels[1].1 else { panic!() };
        // Two means 0.2 apart: their mean has a standard error of 0.1.
        assert!((relative[0] - 0.1).abs() < 1e-6, "{relative:?}");
        assert_eq!(relative[1..], [0.0, 0.0]);
        let expected = along(INFERNO, 2.0 / 3.0);
        assert_eq!(
            view.picture.rgb,
            [expected, [0.0; 3], [0.0; 3]].map(|c| match c {
                [0.0, 0.0, 0.0] => along(INFERNO, 0.0),
                color => color,
            })
        );
    }

    #[test]
    fn a_film_that_does_not_know_has_no_view() {
        let mut film = film();
        assert!(of_film(View::StopReason, &film, 8).is_none());
        assert!(of_film(View::Depth, &film, 8).is_none());
        let stop = |reason| PixelStop { reason, half_width: 0.5 };
        film.set_stops(StopReason::ALL.map(stop).to_vec());
        let view = of_film(View::StopReason, &film, 8).unwrap();
        assert_eq!(view.layer.channels[0].1, ChannelData::U32(vec![0, 1, 2]));
        let shown = bytes(&view);
        assert!(shown[0] != shown[1] && shown[1] != shown[2] && shown[0] != shown[2]);
        let counts = of_film(View::SampleCount, &film, 8).unwrap();
        assert_eq!(counts.layer.channels[0].1, ChannelData::U32(vec![8; 3]));
    }
}
