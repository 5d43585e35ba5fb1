//! KTX2 containers: their first level, uncompressed or transcoded from Basis Universal. The
//! libraries' arithmetic can panic on damaged files: whoever calls guards against that.

use super::images::Pixels;
use ktx2::{ColorModel, Format, Reader, SupercompressionScheme};
use std::io::Read;

type Result<T> = std::result::Result<T, String>;

/// Whether the bytes begin as such a container.
pub(super) fn is_ktx2(bytes: &[u8]) -> bool {
    bytes.starts_with(&ktx2::MAGIC)
}

/// Width and height of the one picture in it.
pub(super) fn size(bytes: &[u8]) -> Result<(u32, u32)> {
    let header = open(bytes)?.header();
    Ok((header.pixel_width, header.pixel_height))
}

fn open(bytes: &[u8]) -> Result<Reader<&[u8]>> {
    let reader = Reader::new(bytes).map_err(|e| format!("damaged KTX2: {e}"))?;
    let header = reader.header();
    let is_picture = header.pixel_depth == 0 && header.layer_count == 0 && header.face_count == 1;
    match is_picture && header.pixel_width > 0 && header.pixel_height > 0 {
        true => Ok(reader),
        false => Err("KTX2 with another content than one two-dimensional picture".into()),
    }
}

/// The picture. Its size must have been checked.
pub(super) fn decode(bytes: &[u8]) -> Result<Pixels> {
    let reader = open(bytes)?;
    let header = reader.header();
    if reader.is_alpha_premultiplied() == Some(true) {
        return Err("KTX2 with premultiplied alpha".into());
    }
    let rgba = match reader.color_model() {
        Some(ColorModel::ETC1S | ColorModel::UASTC) => basis(&reader)?,
        _ => uncompressed(&reader)?,
    };
    Ok(Pixels { width: header.pixel_width, height: header.pixel_height, rgba })
}

/// Texels of 1 to 4 channels of 8 bits.
fn uncompressed(reader: &Reader<&[u8]>) -> Result<Vec<[u8; 4]>> {
    let header = reader.header();
    let (width, swapped) = match header.format {
        Some(Format::R8_UNORM | Format::R8_SRGB) => (1, false),
        Some(Format::R8G8_UNORM | Format::R8G8_SRGB) => (2, false),
        Some(Format::R8G8B8_UNORM | Format::R8G8B8_SRGB) => (3, false),
        Some(Format::R8G8B8A8_UNORM | Format::R8G8B8A8_SRGB) => (4, false),
        Some(Format::B8G8R8_UNORM | Format::B8G8R8_SRGB) => (3, true),
        Some(Format::B8G8R8A8_UNORM | Format::B8G8R8A8_SRGB) => (4, true),
        Some(format) => return Err(format!("KTX2 with texels of {format:?}, which is not read")),
        None => return Err("KTX2 of an unknown texel format".into()),
    };
    let texels = header.pixel_width as usize * header.pixel_height as usize;
    let level = first_level(reader, texels * width)?;
    let rgba = level.chunks_exact(width).map(|texel| {
        let mut rgba = [0, 0, 0, 255];
        rgba[..width].copy_from_slice(texel);
        if swapped {
            rgba.swap(0, 2);
        }
        rgba
    });
    Ok(rgba.collect())
}

/// The bytes of the first level, which must be `expected` of them.
fn first_level(reader: &Reader<&[u8]>, expected: usize) -> Result<Vec<u8>> {
    let level = reader.levels().next().ok_or("KTX2 without a level")?;
    let bytes = match reader.header().supercompression_scheme {
        None => level.data.to_vec(),
        Some(SupercompressionScheme::Zstandard) => {
            let decoder = ruzstd::decoding::StreamingDecoder::new(level.data)
                .map_err(|e| format!("KTX2, Zstandard: {e}"))?;
            let mut bytes = Vec::new();
            // One byte more than there should be tells that there is too much.
            let mut limited = decoder.take(expected as u64 + 1);
            limited.read_to_end(&mut bytes).map_err(|e| format!("KTX2, Zstandard: {e}"))?;
            bytes
        }
        Some(SupercompressionScheme::ZLIB) => {
            miniz_oxide::inflate::decompress_to_vec_zlib_with_limit(level.data, expected)
                .map_err(|e| format!("KTX2, zlib: {e}"))?
        }
        Some(scheme) => return Err(format!("KTX2 compressed with {scheme:?}, which is not read")),
    };
    match bytes.len() == expected {
        true => Ok(bytes),
        false => Err(format!("KTX2: the first level must have {expected} bytes")),
    }
}

#[cfg(not(feature = "basis"))]
fn basis(_: &Reader<&[u8]>) -> Result<Vec<[u8; 4]>> {
    Err("Basis Universal textures need a build with the cargo feature `basis`".into())
}

/// Transcodes ETC1S or UASTC.
#[cfg(feature = "basis")]
fn basis(reader: &Reader<&[u8]>) -> Result<Vec<[u8; 4]>> {
    let header = reader.header();
    let file = match header.supercompression_scheme {
        Some(SupercompressionScheme::BasisLZ) => std::borrow::Cow::Borrowed(reader.data()),
        _ => std::borrow::Cow::Owned(one_plain_level(reader)?),
    };
    let damaged = || "damaged Basis Universal texture".to_owned();
    let fault = |e| format!("{}: {e:?}", damaged());
    let bytes = basisu::Transcoder::new(&file)
        .and_then(|t| t.transcode(0, basisu::TargetFormat::Rgba32, basisu::DecodeFlags::NONE))
        .map_err(fault)?;
    let rgba = bytes.as_chunks().0.to_vec();
    match rgba.len() == header.pixel_width as usize * header.pixel_height as usize {
        true => Ok(rgba),
        false => Err(damaged()),
    }
}

/// The same container with its first level alone, uncompressed: blocks of UASTC.
#[cfg(feature = "basis")]
fn one_plain_level(reader: &Reader<&[u8]>) -> Result<Vec<u8>> {
    let header = reader.header();
    let blocks = |side: u32| side.div_ceil(4) as usize;
    let level = first_level(reader, 16 * blocks(header.pixel_width) * blocks(header.pixel_height))?;
    let index = header.index;
    let descriptor = index.dfd_byte_offset as usize..;
    let descriptor = &reader.data()[descriptor][..index.dfd_byte_length as usize];
    let dfd_begin = ktx2::Header::LENGTH + ktx2::LevelIndex::LENGTH;
    let begin = (dfd_begin + descriptor.len()).next_multiple_of(16);
    let header = ktx2::Header {
        level_count: 1,
        supercompression_scheme: None,
        index: ktx2::Index {
            dfd_byte_offset: dfd_begin as u32,
            kvd_byte_offset: 0,
            kvd_byte_length: 0,
            sgd_byte_offset: 0,
            sgd_byte_length: 0,
            ..index
        },
        ..header
    };
    let entry = ktx2::LevelIndex {
        byte_offset: begin as u64,
        byte_length: level.len() as u64,
        uncompressed_byte_length: level.len() as u64,
    };
    let mut file = header.as_bytes().to_vec();
    file.extend(entry.as_bytes());
    file.extend(descriptor);
    file.resize(begin, 0);
    file.extend(level);
    Ok(file)
}
