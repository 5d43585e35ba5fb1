//! PNG: what a display shows, as sRGB with 8 or 16 bits.

use super::{
    DisplayTransform, Picture, ToneCurve, invalid_data, linear_from_srgb, srgb_from_linear,
    write_atomically,
};
use crate::{Error, Result};
use ::png::{
    BitDepth as PngDepth, ColorType, Decoder, DecodingError, Encoder, EncodingError,
    SrgbRenderingIntent, Transformations,
};
use std::fs::File;
use std::io::{BufReader, BufWriter, Write};
use std::path::Path;

/// Bits of a colour component.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BitDepth {
    /// 256 levels.
    #[default]
    Eight,
    /// 65,536 levels.
    Sixteen,
}

/// How a picture becomes a PNG.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PngOptions {
    /// Bits of a colour component.
    pub depth: BitDepth,
    /// Exposure in stops: radiance is multiplied by 2 to this power.
    pub exposure_ev: f32,
    /// What comes after the exposure.
    pub tone_curve: ToneCurve,
    /// Text chunks (iTXt): keyword of 1 to 79 Latin-1 characters, and text.
    pub text: Vec<(String, String)>,
}

/// Writes `picture` with the sRGB transfer function, rounded to nearest without
/// dither. The format has no values outside [0, 1]: without a tone curve they clip. A pixel that is
/// not finite is an error that names it, and no file is written.
pub fn write_png(path: &Path, picture: &Picture, options: &PngOptions) -> Result<()> {
    let samples = encode_samples(path, picture, options)?;
    let encoding = |e| encoding_error(path, e);
    write_atomically(path, |file| {
        let mut buffered = BufWriter::new(file);
        let mut encoder = Encoder::new(&mut buffered, picture.width, picture.height);
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(match options.depth {
            BitDepth::Eight => PngDepth::Eight,
            BitDepth::Sixteen => PngDepth::Sixteen,
        });
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
        for (keyword, text) in &options.text {
            encoder.add_itxt_chunk(keyword.clone(), text.clone()).map_err(encoding)?;
        }
        let mut writer = encoder.write_header().map_err(encoding)?;
        writer.write_image_data(&samples).map_err(encoding)?;
        writer.finish().map_err(encoding)?;
        buffered.flush().map_err(|e| Error::io(path, e))
    })
}

/// The bytes of the file's samples: big-endian, row by row from the top.
fn encode_samples(path: &Path, picture: &Picture, options: &PngOptions) -> Result<Vec<u8>> {
    let PngOptions { exposure_ev, tone_curve, .. } = *options;
    let display = DisplayTransform { exposure_ev, tone_curve };
    let mut bytes = Vec::with_capacity(picture.rgb.len() * 6);
    for (index, pixel) in picture.rgb.iter().enumerate() {
        if let Some(value) = pixel.iter().find(|value| !value.is_finite()) {
            let (x, y) = (index % picture.width as usize, index / picture.width as usize);
            let message = format!("pixel ({x}, {y}) is {value}, which PNG cannot hold");
            return Err(invalid_data(path, message));
        }
        for linear in display.linear(*pixel) {
            let encoded = srgb_from_linear(linear);
            match options.depth {
                BitDepth::Eight => bytes.push((encoded * 255.0).round() as u8),
                BitDepth::Sixteen => {
                    bytes.extend(((encoded * 65535.0).round() as u16).to_be_bytes());
                }
            }
        }
    }
    Ok(bytes)
}

/// Reads a PNG of any kind as linear colours, taking its samples as sRGB. Alpha
/// is ignored.
pub fn read_png(path: &Path) -> Result<Picture> {
    let file = File::open(path).map_err(|e| Error::io(path, e))?;
    let decoding = |e| decoding_error(path, e);
    let mut decoder = Decoder::new(BufReader::new(file));
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(decoding)?;
    let size = reader
        .output_buffer_size()
        .ok_or_else(|| invalid_data(path, "is too large for this machine's memory"))?;
    let mut bytes = vec![0; size];
    let frame = reader.next_frame(&mut bytes).map_err(decoding)?;
    bytes.truncate(frame.buffer_size());
    let values: Vec<f32> = match frame.bit_depth {
        PngDepth::Sixteen => bytes
            .chunks_exact(2)
            .map(|b| f32::from(u16::from_be_bytes([b[0], b[1]])) / 65535.0)
            .collect(),
        // Fewer bits than 8 have been expanded.
        _ => bytes.iter().map(|&b| f32::from(b) / 255.0).collect(),
    };
    let channels = frame.color_type.samples();
    let rgb = values
        .chunks_exact(channels)
        .map(|pixel| {
            let colour = if channels < 3 { [pixel[0]; 3] } else { [pixel[0], pixel[1], pixel[2]] };
            colour.map(linear_from_srgb)
        })
        .collect();
    Ok(Picture::new(frame.width, frame.height, rgb))
}

fn encoding_error(path: &Path, error: EncodingError) -> Error {
    match error {
        EncodingError::IoError(source) => Error::io(path, source),
        other => invalid_data(path, other.to_string()),
    }
}

fn decoding_error(path: &Path, error: DecodingError) -> Error {
    match error {
        DecodingError::IoError(source) => Error::io(path, source),
        other => invalid_data(path, other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CASES: [[f32; 3]; 6] = [
        [0.0, 0.5, 1.0],
        [0.18, 0.003, 0.0031],
        [-0.5, 2.0, 1e-9],
        [0.25, 0.75, 0.999],
        [1e30, f32::MIN_POSITIVE, -0.0],
        [0.1, 0.01, 0.9],
    ];

    /// The formula of IEC 61966-2-1 in f64, apart from the code under test.
    fn expected_code(linear: f32, exposure: f64, levels: f64) -> u16 {
        let v = (f64::from(linear) * exposure).clamp(0.0, 1.0);
        let e = if v <= 0.0031308 { v * 12.92 } else { v.powf(1.0 / 2.4) * 1.055 - 0.055 };
        (e * levels + 0.5).floor() as u16
    }

    fn decode(path: &Path) -> (::png::Info<'static>, Vec<u8>) {
        let decoder = Decoder::new(BufReader::new(File::open(path).unwrap()));
        let mut reader = decoder.read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        (reader.info().clone(), bytes)
    }

    #[test]
    fn stored_samples_equal_the_formula() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let picture = Picture::new(3, 2, CASES.to_vec());
        for exposure_ev in [0.0, -1.5, 3.0] {
            let exposure = 2f64.powf(f64::from(exposure_ev));
            let options = PngOptions { exposure_ev, ..PngOptions::default() };
            write_png(&path, &picture, &options).unwrap();
            let (info, bytes) = decode(&path);
            assert_eq!((info.width, info.height), (3, 2));
            assert!(info.srgb.is_some());
            let expected: Vec<u8> =
                CASES.iter().flatten().map(|&v| expected_code(v, exposure, 255.0) as u8).collect();
            assert_eq!(bytes, expected);

            let options = PngOptions { depth: BitDepth::Sixteen, ..options };
            write_png(&path, &picture, &options).unwrap();
            let (_, bytes) = decode(&path);
            let codes: Vec<u16> =
                bytes.chunks(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect();
            let expected: Vec<u16> =
                CASES.iter().flatten().map(|&v| expected_code(v, exposure, 65535.0)).collect();
            assert_eq!(codes, expected);
        }
    }

    /// Types and data of the chunks, by the file's own layout (PNG 3rd edition, 5.3).
    fn chunks(path: &Path) -> Vec<([u8; 4], Vec<u8>)> {
        let bytes = std::fs::read(path).unwrap();
        let (mut rest, mut chunks) = (&bytes[8..], Vec::new());
        while let Some((length, after)) = rest.split_first_chunk::<4>() {
            let length = u32::from_be_bytes(*length) as usize;
            let kind = *after.first_chunk().unwrap();
            chunks.push((kind, after[4..4 + length].to_vec()));
            rest = &after[4 + length + 4..];
        }
        chunks
    }

    #[test]
    fn both_depths_say_that_they_are_srgb() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        for (depth, bits) in [(BitDepth::Eight, 8), (BitDepth::Sixteen, 16)] {
            let options = PngOptions { depth, ..PngOptions::default() };
            write_png(&path, &Picture::new(3, 2, CASES.to_vec()), &options).unwrap();
            let chunks = chunks(&path);
            let at = |kind: &[u8; 4]| chunks.iter().position(|(k, _)| k == kind).unwrap();
            assert_eq!(chunks[at(b"IHDR")].1[8], bits);
            // Perceptual; before the pixels, where decoders look for it.
            assert_eq!(chunks[at(b"sRGB")].1, [0]);
            assert!(at(b"sRGB") < at(b"IDAT"));
            // No profile that contradicts it.
            assert!(chunks.iter().all(|(kind, _)| kind != b"iCCP"));
        }
    }

    #[test]
    fn sixteen_bits_read_back_what_they_stored() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let options = PngOptions { depth: BitDepth::Sixteen, ..PngOptions::default() };
        let codes = [[0.0, 1.0, 30000.0], [1.0, 65535.0, 777.0f32]];
        let rgb = codes.map(|c| c.map(|code| linear_from_srgb(code / 65535.0)));
        let picture = Picture::new(2, 1, rgb.to_vec());
        write_png(&path, &picture, &options).unwrap();
        assert_eq!(read_png(&path).unwrap(), picture);
    }

    #[test]
    fn text_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let picture = Picture::new(1, 1, vec![[0.5; 3]]);
        let text = vec![("Software".to_string(), "Steradian — größer".to_string())];
        write_png(&path, &picture, &PngOptions { text, ..PngOptions::default() }).unwrap();
        let (info, _) = decode(&path);
        let chunk = &info.utf8_text[0];
        assert_eq!(chunk.keyword, "Software");
        assert_eq!(chunk.get_text().unwrap(), "Steradian — größer");

        let text = vec![("x".repeat(80), String::new())];
        let error = write_png(&path, &picture, &PngOptions { text, ..PngOptions::default() });
        assert!(matches!(error, Err(Error::Io { .. })));
    }

    #[test]
    fn a_pixel_that_is_not_finite_is_named_and_nothing_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut picture = Picture::new(3, 2, CASES.to_vec());
            picture.rgb[4][1] = bad;
            let message =
                write_png(&path, &picture, &PngOptions::default()).unwrap_err().to_string();
            assert!(message.contains("pixel (1, 1)"), "{message}");
            assert!(!path.exists());
        }
    }

    #[test]
    fn a_file_that_is_no_png_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        std::fs::write(&path, b"no png").unwrap();
        assert!(matches!(read_png(&path), Err(Error::Io { .. })));
        let picture = Picture::new(3, 2, CASES.to_vec());
        write_png(&path, &picture, &PngOptions::default()).unwrap();
        let whole = std::fs::read(&path).unwrap();
        std::fs::write(&path, &whole[..whole.len() - 30]).unwrap();
        assert!(matches!(read_png(&path), Err(Error::Io { .. })));
    }
}
