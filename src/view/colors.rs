//! False colours, as linear values that the sRGB transfer function turns into the colours meant.

use crate::image::linear_from_srgb;
use colorous::Gradient;

/// Where there is nothing.
pub(super) const NOTHING: [f32; 3] = [0.0; 3];

/// Display colour to linear.
pub(super) fn shown(srgb: [f32; 3]) -> [f32; 3] {
    srgb.map(|v| linear_from_srgb(v.clamp(0.0, 1.0)))
}

/// `share` of a gradient, 0 to 1.
pub(super) fn along(gradient: Gradient, share: f64) -> [f32; 3] {
    let color = gradient.eval_continuous(share.clamp(0.0, 1.0));
    shown(color.as_array().map(|c| f32::from(c) / 255.0))
}

/// Distinct colours for neighbouring numbers: hues by the golden ratio, in three brightnesses.
pub(super) fn distinct(index: u32) -> [f32; 3] {
    let hue = (f64::from(index) * 0.618_033_988_749_895).fract() * 6.0;
    let value = [0.95, 0.7, 0.5][index as usize % 3];
    let wheel = [0.0, 2.0, 4.0].map(|offset: f64| {
        let distance = ((hue + offset) % 6.0 - 3.0).abs() - 1.0;
        distance.clamp(0.0, 1.0)
    });
    shown(wheel.map(|w| (value * (0.3 + 0.7 * w)) as f32))
}
