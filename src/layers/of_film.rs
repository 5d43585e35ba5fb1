//! Layers that a render's film knows.

use super::LayerKind;
use crate::film::Film;
use crate::image::{ChannelData, Layer};
use crate::settings::Crop;

/// Of the rows of `window`, which has the film's width: the layer `noise`, which says how many
/// samples there are, and where it is known the standard error of the luminance, and how pixels
/// stopped; and `variance` if it is among `kinds`.
pub fn film_layers(
    film: &Film,
    errors: Option<&[f32]>,
    kinds: &[LayerKind],
    window: Crop,
) -> Vec<Layer> {
    let whole = film.window();
    let first = ((window.y - whole.y) * whole.width) as usize;
    let rows = first..first + (window.width * window.height) as usize;
    let named = |name: &str, data| (name.to_owned(), data);
    let counts = film.sample_counts()[rows.clone()].to_vec();
    let mut channels = vec![named("samples", ChannelData::U32(counts))];
    let errors = errors.map(|errors| &errors[rows.clone()]);
    if let Some(errors) = errors {
        channels.push(named("standard_error", ChannelData::F32(errors.to_vec())));
    }
    if let Some(stops) = film.stops() {
        let stops = &stops[rows];
        let half_widths = stops.iter().map(|stop| stop.half_width).collect();
        channels.push(named("half_width", ChannelData::F32(half_widths)));
        let reasons = stops.iter().map(|stop| stop.reason as u32).collect();
        channels.push(named("stop_reason", ChannelData::U32(reasons)));
    }
    let mut layers = vec![Layer { name: "noise".into(), channels }];
    if let Some(errors) = errors.filter(|_| kinds.contains(&LayerKind::Variance)) {
        let variance = ChannelData::F32(errors.iter().map(|e| e * e).collect());
        layers.push(Layer { name: "variance".into(), channels: vec![named("Y", variance)] });
    }
    layers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::BlockMean;

    #[test]
    fn rows_are_those_of_the_window() {
        let whole = Crop { x: 5, y: 7, width: 2, height: 3 };
        let mut film = Film::new(whole, 1);
        for i in 0..6 {
            for sample in 0..=i {
                let mean = [f64::from(sample); 3];
                film.add_block(i % 2, i / 2, BlockMean { mean, sample_count: 1 });
            }
        }
        let errors = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let rows = Crop { y: 8, height: 2, ..whole };
        let layers = film_layers(&film, Some(&errors), &[LayerKind::Variance], rows);
        let channel = |layer: usize, k: usize| layers[layer].channels[k].1.clone();
        assert_eq!(channel(0, 0), ChannelData::U32(vec![3, 4, 5, 6]));
        assert_eq!(channel(0, 1), ChannelData::F32(vec![2.0, 3.0, 4.0, 5.0]));
        assert_eq!(channel(1, 0), ChannelData::F32(vec![4.0, 9.0, 16.0, 25.0]));
        assert_eq!(film_layers(&film, None, &[LayerKind::Variance], rows).len(), 1);
    }
}
