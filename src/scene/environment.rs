//! Light from infinity.

use super::guard::decoding;
use crate::{Error, Result};
use glam::{DVec3, Mat3, Vec3};
use image::{DynamicImage, ImageDecoder, codecs::hdr::HdrDecoder};
use std::io::Cursor;
use std::path::Path;

/// Largest map, pixels: 16384 × 8192, 1.5 GiB decoded.
const MAX_PIXELS: u64 = 1 << 27;
/// Largest file, bytes: what so many uncompressed pixels of four floats need.
const MAX_FILE_SIZE: u64 = MAX_PIXELS * 16;
/// Pixels of any map, and of a larger one for each byte of its file: a flat picture of three
/// half floats is 172 a byte by deflate. A small file cannot make the program hold much.
const ANY_PIXELS: u64 = 1 << 22;
const PIXELS_PER_BYTE: u64 = 256;
const EXR_MAGIC: [u8; 4] = 20000630_u32.to_le_bytes();
const HDR_MAGIC: &[u8] = b"#?";

/// An equirectangular radiance map. For a unit world direction d and
/// `e = environment_from_world * d` the column is `atan2(e.z, e.x)/2π + ½` and
/// the row `acos(e.y)/π` from the top, as in three.js and Blender after its
/// glTF import.
#[derive(Debug, Clone)]
pub struct Environment {
    /// File name, or what made it; for messages.
    pub name: String,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Radiance, row by row from the top, W/(sr m²), finite and not negative.
    pub radiance: Vec<Vec3>,
    /// Rotation of the map.
    pub environment_from_world: Mat3,
    /// Multiplies `radiance`.
    pub intensity: f32,
}

impl Environment {
    /// The same radiance from every direction.
    pub fn constant(radiance: Vec3) -> Self {
        Self {
            name: "constant".into(),
            width: 1,
            height: 1,
            radiance: vec![radiance],
            environment_from_world: Mat3::IDENTITY,
            intensity: 1.0,
        }
    }

    /// Loads an equirectangular map, Radiance `.hdr` or OpenEXR with R, G and B;
    /// which one it is follows from the content. Rotation none, intensity 1.
    /// Negative values, which filters of image programs leave behind, become 0.
    /// An EXPOSURE line of a `.hdr` file is not applied.
    ///
    /// # Errors
    ///
    /// [`Error::Scene`] for a file that cannot be read, is too large, or has
    /// pixels that are not finite.
    pub fn load(path: &Path) -> Result<Self> {
        Self::load_counting_negatives(path).map(|(environment, _)| environment)
    }

    /// As [`load`](Self::load); also the number of pixels with negative values.
    pub fn load_counting_negatives(path: &Path) -> Result<(Self, usize)> {
        let bytes = read_file(path).map_err(|message| Error::scene(path, message))?;
        Self::from_bytes(path, &bytes)
    }

    /// From the bytes of a file, as [`load_counting_negatives`](Self::load_counting_negatives);
    /// `path` is for messages and names the map.
    ///
    /// # Errors
    ///
    /// [`Error::Scene`] as for [`load`](Self::load).
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<(Self, usize)> {
        let error = |message: String| Error::scene(path, message);
        let (width, height, mut radiance) = decoding(|| decode(bytes)).map_err(error)?;
        let mut negative_count = 0;
        for (i, pixel) in radiance.iter_mut().enumerate() {
            if !pixel.is_finite() {
                let (x, y) = (i % width as usize, i / width as usize);
                return Err(error(format!(
                    "pixel ({x}, {y}) is {pixel}; every value must be finite"
                )));
            }
            negative_count += usize::from(pixel.min_element() < 0.0);
            *pixel = pixel.max(Vec3::ZERO);
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok((Self { name, width, height, radiance, ..Self::constant(Vec3::ZERO) }, negative_count))
    }
}

impl Environment {
    /// Averages squares of texels, by solid angle, until the map is at most `max_width` wide.
    /// False, and nothing is done, where it is already.
    pub fn reduce(&mut self, max_width: u32) -> bool {
        let factor = self.width.div_ceil(max_width.max(1));
        if factor <= 1 {
            return false;
        }
        // Squares that need not begin or end with a texel, so that the new map spans the sphere.
        let (width, height) = (self.width.div_ceil(factor), self.height.div_ceil(factor));
        let columns = overlaps(self.width, width, |low, high| high - low);
        let step = std::f64::consts::PI / f64::from(self.height);
        let rows = overlaps(self.height, height, |low, high| {
            (0.5 * (low + high) * step).sin() * (0.5 * (high - low) * step).sin()
        });
        let mut radiance = Vec::with_capacity(width as usize * height as usize);
        for row in &rows {
            for column in &columns {
                let mut sum = DVec3::ZERO;
                for &(y, weight_y) in row {
                    for &(x, weight_x) in column {
                        let texel = self.radiance[y * self.width as usize + x];
                        sum += texel.as_dvec3() * (weight_x * weight_y);
                    }
                }
                radiance.push(sum.as_vec3());
            }
        }
        (self.width, self.height, self.radiance) = (width, height, radiance);
        true
    }
}

/// For each of `count` equal parts of `texels`: which texels lie in it, and which share of the
/// part's `measure` (from, to) each of them has.
fn overlaps(texels: u32, count: u32, measure: impl Fn(f64, f64) -> f64) -> Vec<Vec<(usize, f64)>> {
    let edge = |i: u32| f64::from(i) * f64::from(texels) / f64::from(count);
    let part = |i: u32| {
        let (from, to) = (edge(i), edge(i + 1));
        let inside = (from as u32)..(to.ceil() as u32).min(texels);
        let mut weights: Vec<(usize, f64)> = inside
            .map(|t| {
                let (low, high) = (f64::from(t).max(from), f64::from(t + 1).min(to));
                (t as usize, measure(low, high.max(low)))
            })
            .collect();
        let sum: f64 = weights.iter().map(|(_, w)| w).sum();
        weights.iter_mut().for_each(|(_, w)| *w /= sum);
        weights
    };
    (0..count).map(part).collect()
}

/// Width, height and radiance row by row from the top.
type Pixels = (u32, u32, Vec<Vec3>);

fn read_file(path: &Path) -> std::result::Result<Vec<u8>, String> {
    let cannot_read = |e: std::io::Error| format!("cannot be read: {e}");
    let metadata = path.metadata().map_err(cannot_read)?;
    if !metadata.is_file() {
        return Err("is not a file".into());
    }
    if metadata.len() > MAX_FILE_SIZE {
        return Err(format!("has {} bytes; the limit is {MAX_FILE_SIZE}", metadata.len()));
    }
    std::fs::read(path).map_err(cannot_read)
}

fn decode(bytes: &[u8]) -> std::result::Result<Pixels, String> {
    if bytes.starts_with(&EXR_MAGIC) {
        decode_exr(bytes)
    } else if bytes.starts_with(HDR_MAGIC) {
        decode_hdr(bytes)
    } else {
        Err("is neither a Radiance .hdr nor an OpenEXR file".into())
    }
}

/// Whether a map may have this size, of which a header speaks in a file of `bytes` bytes.
fn check_size(width: u64, height: u64, bytes: usize) -> std::result::Result<(), String> {
    let by_file = (bytes as u64).saturating_mul(PIXELS_PER_BYTE).max(ANY_PIXELS);
    match width.checked_mul(height) {
        Some(0) => Err("has no pixels".into()),
        Some(pixels) if pixels > MAX_PIXELS => {
            Err(format!("has {width} × {height} pixels; the limit is {MAX_PIXELS} in all"))
        }
        Some(pixels) if pixels > by_file => Err(format!(
            "has {width} × {height} pixels in {bytes} bytes; the limit is {by_file} for so small a file"
        )),
        Some(_) => Ok(()),
        None => Err(format!("has {width} × {height} pixels; the limit is {MAX_PIXELS} in all")),
    }
}

fn decode_hdr(bytes: &[u8]) -> std::result::Result<Pixels, String> {
    let decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(|e| e.to_string())?;
    let (width, height) = decoder.dimensions();
    check_size(width.into(), height.into(), bytes.len())?;
    let picture = DynamicImage::from_decoder(decoder).map_err(|e| e.to_string())?.into_rgb32f();
    Ok((width, height, picture.pixels().map(|pixel| Vec3::from(pixel.0)).collect()))
}

fn decode_exr(bytes: &[u8]) -> std::result::Result<Pixels, String> {
    use exr::prelude::{MetaData, ReadChannels, ReadLayers, read};

    let metadata =
        MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|e| e.to_string())?;
    for header in &metadata.headers {
        check_size(header.layer_size.x() as u64, header.layer_size.y() as u64, bytes.len())?;
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size, vec![Vec3::ZERO; size.area()]),
            |(size, pixels), position, (r, g, b): (f32, f32, f32)| {
                pixels[position.y() * size.x() + position.x()] = Vec3::new(r, g, b);
            },
        )
        .first_valid_layer()
        .all_attributes()
        // In this thread, where a panic can be caught.
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| e.to_string())?;
    let layer = image.layer_data;
    let shown = image.attributes.display_window;
    if (layer.attributes.layer_position, layer.size) != (shown.position, shown.size) {
        return Err("shows another window than its data; save it uncropped".into());
    }
    let (size, pixels) = layer.channel_data.pixels;
    Ok((size.x() as u32, size.y() as u32, pixels))
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::write_rgb_file;

    /// Writes an EXR of 2 × 2 pixels, loads it.
    fn load_exr(pixels: [[f32; 3]; 4]) -> Result<(Environment, usize)> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.exr");
        write_rgb_file(&path, 2, 2, |x, y| pixels[y * 2 + x].into()).unwrap();
        Environment::load_counting_negatives(&path)
    }

    #[test]
    fn exr_pixels_keep_their_place_and_value() {
        let pixels = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0], [1e5, 0.0, 1e-9]];
        let (sky, negative_count) = load_exr(pixels).unwrap();
        assert_eq!((sky.name.as_str(), sky.width, sky.height), ("sky.exr", 2, 2));
        assert_eq!(sky.radiance, pixels.map(Vec3::from));
        assert_eq!((negative_count, sky.intensity), (0, 1.0));
    }

    #[test]
    fn reducing_keeps_the_power_of_a_map() {
        for (width, height, max_width) in [(8, 4, 4), (64, 32, 10), (7, 5, 3), (4, 2, 1)] {
            let mut map = Environment::constant(Vec3::ONE);
            let texel = |i: u32| Vec3::new((i * 37 % 11) as f32, 1.0, (i % width) as f32);
            (map.width, map.height) = (width, height);
            map.radiance = (0..width * height).map(texel).collect();
            let power = |map: &Environment| {
                let step = std::f64::consts::PI / f64::from(map.height);
                let edge = |y: u32| (f64::from(y) * step).cos();
                let share = |(i, r): (usize, &Vec3)| {
                    let y = i as u32 / map.width;
                    r.as_dvec3() * (edge(y) - edge(y + 1)) / f64::from(map.width)
                };
                map.radiance.iter().enumerate().map(share).sum::<DVec3>()
            };
            let before = power(&map);
            assert!(map.reduce(max_width) && map.width <= max_width);
            assert!(!map.reduce(max_width));
            // Each texel is rounded once.
            let rounding = f64::from(f32::EPSILON);
            assert!(
                (power(&map) / before - 1.0).abs().max_element() < rounding,
                "{width}x{height}"
            );
        }
    }

    #[test]
    fn negative_values_become_zero_and_are_counted() {
        let (sky, negative_count) =
            load_exr([[-1.0, 2.0, -3.0], [0.0; 3], [0.0, -0.5, 1.0], [1.0; 3]]).unwrap();
        assert_eq!(negative_count, 2);
        assert_eq!(sky.radiance[0], Vec3::new(0.0, 2.0, 0.0));
    }

    #[test]
    fn values_that_are_not_finite_are_refused_with_their_place() {
        for value in [f32::NAN, f32::INFINITY] {
            let broken = load_exr([[0.0; 3], [0.0; 3], [0.0; 3], [0.0, value, 0.0]]);
            let message = broken.unwrap_err().to_string();
            assert!(message.contains("sky.exr: pixel (1, 1) is"), "{message}");
        }
    }

    #[test]
    fn a_size_beyond_the_limit_is_refused_before_decoding() {
        let header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n";
        let message = decode(header.as_bytes()).unwrap_err();
        assert!(message.contains("100000 × 100000 pixels; the limit is 134217728"), "{message}");
        let header = header.replace("100000", "10000");
        let message = decode(header.as_bytes()).unwrap_err();
        assert!(message.contains("pixels in 53 bytes; the limit is 4194304"), "{message}");
        assert!(decode(b"#?RADIANCE\n").is_err());
        assert!(decode(&EXR_MAGIC).is_err());
        assert!(decode(b"").unwrap_err().contains("neither"));
    }
}
