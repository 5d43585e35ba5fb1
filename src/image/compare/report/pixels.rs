//! Pixels for the page: compressed, and as text.
//!
//! Values are 8-bit sRGB codes where that is exactly what they are, and 16-bit floats otherwise.
//! Channel by channel, each value is stored as the difference to the one on its left, which
//! compresses better; of 16-bit values first all high bytes, then all low ones.

use super::super::{PictureLayer, magma_bytes};
use crate::image::{linear_from_srgb, srgb_from_linear};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use half::f16;
use miniz_oxide::deflate::compress_to_vec_zlib;
use serde_json::{Value, json};

/// Channels that a picture on a screen has.
const MOST_CHANNELS: usize = 3;

/// Level of the compression, of 10.
const LEVEL: u8 = 6;

/// One layer as numbers for the page; `factor` pixels along each side become one.
pub(super) fn layer(layer: &PictureLayer, size: (u32, u32), factor: u32) -> Value {
    let channels = &layer.channels[..layer.channels.len().min(MOST_CHANNELS)];
    let planes: Vec<Vec<f32>> =
        channels.iter().map(|(_, values)| binned(values, size, factor, average)).collect();
    let (width, height) = (size.0.div_ceil(factor), size.1.div_ceil(factor));
    let codes: Option<Vec<Vec<u8>>> = planes.iter().map(|plane| codes(plane)).collect();
    let (format, bytes) = match codes {
        Some(planes) => ("u8", planes.iter().flat_map(|p| differences_u8(p, width)).collect()),
        None => ("f16", planes.iter().flat_map(|p| differences_f16(p, width)).collect::<Vec<u8>>()),
    };
    let names: Vec<&str> = channels.iter().map(|(name, _)| name.as_str()).collect();
    json!({
        "format": format, "width": width, "height": height, "factor": factor,
        "channels": names, "data": text(&bytes),
    })
}

/// A map of errors from 0 to 1 as bytes; the largest of the pixels that become one.
pub(super) fn map(name: &str, values: &[f32], size: (u32, u32), factor: u32) -> Value {
    let largest = |values: &[f32]| values.iter().fold(0.0, |a: f32, &b| a.max(b));
    let values = binned(values, size, factor, largest);
    let (width, height) = (size.0.div_ceil(factor), size.1.div_ceil(factor));
    let bytes = differences_u8(&magma_bytes(&values), width);
    json!({
        "name": name, "format": "u8", "width": width, "height": height, "factor": factor,
        "channels": ["error"], "data": text(&bytes),
    })
}

fn text(bytes: &[u8]) -> String {
    BASE64_STANDARD.encode(compress_to_vec_zlib(bytes, LEVEL))
}

fn average(values: &[f32]) -> f32 {
    values.iter().sum::<f32>() / values.len() as f32
}

fn binned(
    values: &[f32],
    (width, height): (u32, u32),
    factor: u32,
    merge: impl Fn(&[f32]) -> f32,
) -> Vec<f32> {
    if factor == 1 {
        return values.to_vec();
    }
    let (width, height, factor) = (width as usize, height as usize, factor as usize);
    let mut result = Vec::new();
    let mut block = Vec::new();
    for y in (0..height).step_by(factor) {
        for x in (0..width).step_by(factor) {
            block.clear();
            for row in y..(y + factor).min(height) {
                block.extend(&values[row * width + x..row * width + (x + factor).min(width)]);
            }
            result.push(merge(&block));
        }
    }
    result
}

/// The 8-bit sRGB codes that the values are; `None` if one is not.
fn codes(values: &[f32]) -> Option<Vec<u8>> {
    let linear: Vec<f32> = (0..256).map(|code| linear_from_srgb(code as f32 / 255.0)).collect();
    let code = |&value: &f32| {
        let code = (srgb_from_linear(value.clamp(0.0, 1.0)) * 255.0).round() as u8;
        (linear[usize::from(code)] == value).then_some(code)
    };
    values.iter().map(code).collect()
}

fn differences_u8(values: &[u8], width: u32) -> Vec<u8> {
    let rows = values.chunks(width as usize);
    let row = |row: &[u8]| -> Vec<u8> {
        let left = std::iter::once(0).chain(row.iter().copied());
        row.iter().zip(left).map(|(value, left)| value.wrapping_sub(left)).collect()
    };
    rows.flat_map(row).collect()
}

fn differences_f16(values: &[f32], width: u32) -> Vec<u8> {
    let half = |v: &f32| {
        // Finite values stay finite.
        let value = if v.is_finite() { v.clamp(-65504.0, 65504.0) } else { *v };
        f16::from_f32(value).to_bits()
    };
    let halves: Vec<u16> = values.iter().map(half).collect();
    let row = |row: &[u16]| -> Vec<u16> {
        let left = std::iter::once(0).chain(row.iter().copied());
        row.iter().zip(left).map(|(value, left)| value.wrapping_sub(left)).collect()
    };
    let differences: Vec<u16> = halves.chunks(width as usize).flat_map(row).collect();
    let high = differences.iter().map(|d| (d >> 8) as u8);
    high.chain(differences.iter().map(|d| *d as u8)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use miniz_oxide::inflate::decompress_to_vec_zlib;

    fn bytes(value: &Value) -> Vec<u8> {
        let data = BASE64_STANDARD.decode(value["data"].as_str().unwrap()).unwrap();
        decompress_to_vec_zlib(&data).unwrap()
    }

    fn plane(values: Vec<f32>) -> PictureLayer {
        PictureLayer { name: String::new(), channels: vec![("R".into(), values)] }
    }

    /// What the page undoes, undone here.
    #[test]
    fn sixteen_bits_come_back() {
        let values = vec![0.1, -2.0, 1e9, f32::NAN, 0.25, 7.0];
        let encoded = layer(&plane(values), (3, 2), 1);
        assert_eq!(encoded["format"], "f16");
        let bytes = bytes(&encoded);
        let word = |i: usize| u16::from(bytes[i]) << 8 | u16::from(bytes[6 + i]);
        let mut halves: Vec<u16> = (0..6).map(word).collect();
        for i in [1, 2, 4, 5] {
            halves[i] = halves[i].wrapping_add(halves[i - 1]);
        }
        let back: Vec<f32> = halves.iter().map(|&h| f16::from_bits(h).to_f32()).collect();
        assert_eq!(back[0], f16::from_f32(0.1).to_f32());
        assert_eq!([back[1], back[2], back[4], back[5]], [-2.0, 65504.0, 0.25, 7.0]);
        assert!(back[3].is_nan());
    }

    #[test]
    fn eight_bits_stay_codes() {
        let values = [10_u8, 200, 255, 0].map(|c| linear_from_srgb(f32::from(c) / 255.0));
        let encoded = layer(&plane(values.to_vec()), (2, 2), 1);
        assert_eq!(encoded["format"], "u8");
        assert_eq!(bytes(&encoded), [10, 190, 255, 1]);
    }

    #[test]
    fn smaller_pictures_are_means_and_smaller_maps_maxima() {
        let values = [1.0, 3.0, 5.0, 5.0, 7.0, 9.0];
        assert_eq!(binned(&values, (3, 2), 2, average), [4.0, 7.0]);
        let encoded = map("FLIP", &[0.0, 1.0, 0.0, 0.2, 0.0, 0.4], (3, 2), 2);
        assert_eq!([&encoded["width"], &encoded["height"]], [2, 1]);
        assert_eq!(bytes(&encoded), [255, 102_u8.wrapping_sub(255)]);
    }
}
