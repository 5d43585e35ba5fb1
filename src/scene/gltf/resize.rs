//! Brings images down to a size.

use super::images::Pixels;
use crate::image::{linear_from_srgb, srgb_from_linear};

/// The image with its longer side brought down to `most`: the mean over each new texel's area, in
/// linear light where the colours are sRGB.
pub(super) fn shrink(image: &Pixels, most: u32, is_srgb: bool) -> Pixels {
    let (w, h) = (image.width, image.height);
    let longest = f64::from(w.max(h));
    let scaled = |side: u32| (f64::from(side) * f64::from(most) / longest).round().max(1.0) as u32;
    let (width, height) = (scaled(w), scaled(h));
    let columns: Vec<_> = (0..width).map(|x| covered(x, width, w)).collect();
    let decode: Vec<f64> = (0..=255_u8)
        .map(|code| f64::from(code) / 255.0)
        .map(|value| if is_srgb { f64::from(linear_from_srgb(value as f32)) } else { value })
        .collect();
    let encode = |value: f64, is_srgb: bool| {
        let value = if is_srgb { f64::from(srgb_from_linear(value as f32)) } else { value };
        (value * 255.0).round() as u8
    };
    let mut rgba = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        let rows = covered(y, height, h);
        for columns in &columns {
            let mut sum = [0.0; 4];
            let mut area = 0.0;
            for &(row, row_share) in &rows {
                for &(column, column_share) in columns {
                    let texel = image.rgba[row as usize * w as usize + column as usize];
                    let share = row_share * column_share;
                    area += share;
                    for (channel, (sum, code)) in sum.iter_mut().zip(texel).enumerate() {
                        // Alpha is linear always.
                        let value = match channel {
                            3 => f64::from(code) / 255.0,
                            _ => decode[usize::from(code)],
                        };
                        *sum += share * value;
                    }
                }
            }
            let [r, g, b, a] = sum.map(|sum| sum / area);
            rgba.push([
                encode(r, is_srgb),
                encode(g, is_srgb),
                encode(b, is_srgb),
                encode(a, false),
            ]);
        }
    }
    Pixels { width, height, rgba }
}

/// The old texels, of `old`, under the new one `index` of `new`, and how much of each.
fn covered(index: u32, new: u32, old: u32) -> Vec<(u32, f64)> {
    let ratio = f64::from(old) / f64::from(new);
    let (begin, end) = (f64::from(index) * ratio, (f64::from(index) + 1.0) * ratio);
    let last = (end.ceil() as u32).min(old);
    (begin as u32..last)
        .map(|texel| {
            let (low, high) = (f64::from(texel), f64::from(texel) + 1.0);
            (texel, high.min(end) - low.max(begin))
        })
        .filter(|&(_, share)| share > 0.0)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shrunk(width: u32, height: u32, rgba: Vec<[u8; 4]>, most: u32, is_srgb: bool) -> Pixels {
        shrink(&Pixels { width, height, rgba }, most, is_srgb)
    }

    #[test]
    fn means_are_of_linear_light() {
        let texels = vec![[0, 255, 100, 0], [255, 255, 100, 255]];
        // Half of the light is (0.5^(1/2.4) × 1.055 - 0.055) × 255 = 187.5 in sRGB.
        let light = shrunk(2, 1, texels.clone(), 1, true);
        assert_eq!((light.width, light.height), (1, 1));
        assert_eq!(light.rgba, [[188, 255, 100, 128]]);
        assert_eq!(shrunk(2, 1, texels, 1, false).rgba, [[128, 255, 100, 128]]);
    }

    #[test]
    fn sides_that_do_not_divide_share_their_texels() {
        let row: Vec<_> = [0, 90, 240].map(|v| [v; 4]).into();
        // 2 of 3: 0 and half of 90; half of 90 and 240.
        assert_eq!(shrunk(3, 1, row, 2, false).rgba, [[30; 4], [190; 4]]);
        let ramp: Vec<_> = (0..35).map(|i| [7 * i as u8; 4]).collect();
        let pixels = shrunk(7, 5, ramp, 4, false);
        assert_eq!((pixels.width, pixels.height, pixels.rgba.len()), (4, 3, 12));
        // The mean stays, up to the rounding of each texel.
        let mean: f64 = pixels.rgba.iter().map(|t| f64::from(t[0])).sum::<f64>() / 12.0;
        assert!((mean - 7.0 * 17.0).abs() <= 0.5, "{mean}");
    }
}
