//! Pictures of how many samples each pixel took.

use super::{Picture, linear_from_srgb};

/// Colours of a map of counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapColors {
    /// Viridis (van der Walt and Smith 2015), perceptually uniform, by the logarithm of the count.
    Viridis,
    /// Blue for none, green for half of the limit, red for all of it.
    Rate,
}

/// A picture of `counts`, `width` × `height` of them, row by row. `limit`: the most there may be.
pub fn sample_map(
    counts: &[u32],
    (width, height): (u32, u32),
    limit: u32,
    colors: MapColors,
) -> Picture {
    let most = counts.iter().copied().max().unwrap_or(1).clamp(1, limit.max(1));
    let least = counts.iter().copied().min().unwrap_or(1).clamp(1, most);
    let color = |&count: &u32| match colors {
        MapColors::Rate => rate(f64::from(count) / f64::from(limit.max(1))),
        MapColors::Viridis => {
            let log = |n: u32| f64::from(n.max(1)).ln();
            let range = log(most) - log(least);
            let share = if range > 0.0 { (log(count) - log(least)) / range } else { 0.0 };
            let color = colorous::VIRIDIS.eval_continuous(share.clamp(0.0, 1.0));
            color.as_array().map(|c| f64::from(c) / 255.0)
        }
    };
    let rgb = counts.iter().map(|n| color(n).map(|c| linear_from_srgb(c as f32))).collect();
    Picture::new(width, height, rgb)
}

/// sRGB.
fn rate(share: f64) -> [f64; 3] {
    let t = share.clamp(0.0, 1.0);
    [(2.0 * t - 1.0).max(0.0), 1.0 - (2.0 * t - 1.0).abs(), (1.0 - 2.0 * t).max(0.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_blue_green_red() {
        let map = sample_map(&[0, 512, 1024], (3, 1), 1024, MapColors::Rate);
        assert_eq!(map.rgb, [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
    }

    #[test]
    fn viridis_becomes_brighter_with_every_doubling() {
        let map = sample_map(&[64, 128, 256, 512, 1024], (5, 1), 4096, MapColors::Viridis);
        let luminance = |c: &[f32; 3]| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
        let values: Vec<f32> = map.rgb.iter().map(luminance).collect();
        assert!(values.windows(2).all(|w| w[0] < w[1]), "{values:?}");
        let even = sample_map(&[64; 4], (2, 2), 64, MapColors::Viridis);
        assert!(even.rgb.iter().all(|c| *c == even.rgb[0]));
    }
}
