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
