//! Writing, band by band: nothing but the rows in hand is held in the file's form.

use super::{
    Attribute, ChannelData, ExrImage, Layer, Precision, REC_709, WORLD_TO_CAMERA, WORLD_TO_NDC,
    exr_error, full_name,
};
use crate::image::{invalid_data, write_atomically};
use crate::settings::Crop;
use crate::{Error, Result};
use ::exr::block::lines::LineRefMut;
use ::exr::block::writer::{ChunksWriter, ParallelBlocksCompressor, SequentialBlocksCompressor};
use ::exr::block::{BlockIndex, UncompressedBlock};
use ::exr::meta::BlockDescription;
use ::exr::meta::attribute::{ChannelDescription, LineOrder, SampleType};
use ::exr::meta::header::{Header, ImageAttributes, LayerAttributes};
use ::exr::prelude::{AttributeValue, Compression, IntegerBounds, Text, Vec2, f16};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// Standard attributes that [`ExrHeader::metadata`] may have.
const CAPTURE_DATE: &str = "capDate";
/// See [`CAPTURE_DATE`].
const UTC_OFFSET: &str = "utcOffset";

/// Rows that are compressed together.
const BLOCK_ROWS: u32 = 16;

/// What a file says of its pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct ExrHeader {
    /// Columns and rows of the whole picture (the display window).
    pub resolution: (u32, u32),
    /// The part that has pixels (the data window), inside the whole picture.
    pub window: Crop,
    /// Attributes of the file beside the standard ones.
    pub metadata: BTreeMap<String, Attribute>,
    /// Of the main layer's R, G and B.
    pub precision: Precision,
}

/// Rows of all layers.
struct Band<'a> {
    rows: u32,
    layers: Cow<'a, [Layer]>,
}

/// A channel's place in a band's layers, with its name in the file.
struct Place {
    name: String,
    sample_type: SampleType,
    layer: usize,
    channel: usize,
}

/// Writes `image`. Fails without writing if a channel has not one value per
/// pixel, if a name is reserved or used twice, or if a value is too large for
/// the precision that was asked for.
pub fn write_exr(path: &Path, image: &ExrImage, precision: Precision) -> Result<()> {
    write_atomically(path, |file| write_image(file, path, image, precision))
}

/// Writes a file whose pixels `rows` gives band by band: all layers of a window of full width, the
/// next one below the last. Bands have `band_rows` rows, rounded up to whole blocks of 16; every
/// band has the same channels.
///
/// # Errors
/// Those of `rows`, and as [`write_exr`].
pub fn write_exr_bands(
    path: &Path,
    header: &ExrHeader,
    band_rows: u32,
    mut rows: impl FnMut(Crop) -> Result<Vec<Layer>>,
) -> Result<()> {
    let band_rows = band_rows.max(1).next_multiple_of(BLOCK_ROWS);
    let window = header.window;
    write_atomically(path, |file| {
        write_bands(file, path, header, |first| {
            let height = band_rows.min(window.height - first);
            let layers = rows(Crop { y: window.y + first, height, ..window })?;
            Ok(Band { rows: height, layers: Cow::Owned(layers) })
        })
    })
}

fn write_image(
    file: impl Read + Write + Seek,
    path: &Path,
    image: &ExrImage,
    precision: Precision,
) -> Result<()> {
    let ExrImage { resolution, window, ref metadata, .. } = *image;
    let header = ExrHeader { resolution, window, metadata: metadata.clone(), precision };
    let layers = Cow::Borrowed(&image.layers[..]);
    write_bands(file, path, &header, |_| Ok(Band { rows: window.height, layers: layers.clone() }))
}

/// `next`: the band that begins in a row of the window.
fn write_bands<'a>(
    mut file: impl Read + Write + Seek,
    path: &Path,
    header: &ExrHeader,
    mut next: impl FnMut(u32) -> Result<Band<'a>>,
) -> Result<()> {
    header.check(path)?;
    let window = header.window;
    let mut band = next(0)?;
    let places = places(&band.layers, header.precision);
    band.check(path, window.width, &places)?;
    let mut first_row = 0;
    // An error of ours goes around the library.
    let mut failure = None;
    let written = ::exr::block::write(
        BufWriter::new(&mut file),
        [header.of_file(&places)].into_iter().collect(),
        true,
        |meta, chunks| {
            let of_file = &meta.headers[0];
            let count = chunks.total_chunks_count();
            let mut block = |index: usize| -> Result<UncompressedBlock> {
                let row = index as u32 * BLOCK_ROWS;
                if row >= first_row + band.rows {
                    first_row += band.rows;
                    band = next(first_row)?;
                    band.check(path, window.width, &places)?;
                }
                let rows = BLOCK_ROWS.min(window.height - row);
                let place = BlockIndex {
                    layer: 0,
                    pixel_position: Vec2(0, row as usize),
                    pixel_size: Vec2(window.width as usize, rows as usize),
                    level: Vec2(0, 0),
                };
                let mut too_large = None;
                let block = UncompressedBlock::from_lines(&of_file.channels, place, |line| {
                    let place = &places[line.location.channel];
                    let at = (line.location.position.1 as u32 - first_row) * window.width;
                    too_large = too_large.or(copy_line(line, place, &band.layers, at as usize));
                });
                match too_large {
                    None => Ok(block),
                    Some((channel, value)) => {
                        Err(too_large_for_half(path, &places[channel].name, value))
                    }
                }
            };
            let mut checked = |index| {
                block(index).map_err(|error| {
                    failure = Some(error);
                    ::exr::error::Error::Aborted
                })
            };
            match ParallelBlocksCompressor::new(&meta, chunks) {
                Some(mut compressor) => (0..count)
                    .try_for_each(|i| compressor.add_block_to_compression_queue(i, checked(i)?)),
                None => {
                    let mut compressor = SequentialBlocksCompressor::new(&meta, chunks);
                    (0..count).try_for_each(|i| compressor.compress_block(i, checked(i)?))
                }
            }
        },
    );
    match failure {
        Some(error) => return Err(error),
        None => written.map_err(|e| exr_error(path, e))?,
    }
    sort_attributes(&mut file).map_err(|e| Error::io(path, e))
}

/// Every channel of `layers`, in the order of the file: that of their names.
fn places(layers: &[Layer], precision: Precision) -> Vec<Place> {
    let mut places = Vec::new();
    for (layer, of) in layers.iter().enumerate() {
        for (channel, (name, data)) in of.channels.iter().enumerate() {
            let is_color = of.name.is_empty() && matches!(name.as_str(), "R" | "G" | "B");
            let sample_type = match data {
                ChannelData::U32(_) => SampleType::U32,
                ChannelData::F32(_) if is_color && precision == Precision::Half => SampleType::F16,
                ChannelData::F32(_) => SampleType::F32,
            };
            places.push(Place { name: full_name(&of.name, name), sample_type, layer, channel });
        }
    }
    places.sort_by(|a, b| a.name.as_bytes().cmp(b.name.as_bytes()));
    places
}

/// Writes the values from `at` on into the line; gives the channel and the value that is too large
/// for 16 bits.
fn copy_line(
    line: LineRefMut<'_>,
    place: &Place,
    layers: &[Layer],
    at: usize,
) -> Option<(usize, f32)> {
    let end = at + line.location.sample_count;
    match &layers[place.layer].channels[place.channel].1 {
        ChannelData::U32(v) => line.value.copy_from_slice(bytemuck::cast_slice(&v[at..end])),
        ChannelData::F32(v) if place.sample_type == SampleType::F16 => {
            for (&value, bytes) in v[at..end].iter().zip(line.value.chunks_exact_mut(2)) {
                if !Precision::Half.holds(value) {
                    return Some((line.location.channel, value));
                }
                bytes.copy_from_slice(&f16::from_f32(value).to_ne_bytes());
            }
        }
        ChannelData::F32(v) => line.value.copy_from_slice(bytemuck::cast_slice(&v[at..end])),
    }
    None
}

fn too_large_for_half(path: &Path, name: &str, value: f32) -> Error {
    let message =
        format!("channel {name} holds {value}, more than a 16-bit float can; store 32-bit floats");
    invalid_data(path, message)
}

impl Band<'_> {
    /// That its channels are those of the first band, with a value for every pixel.
    fn check(&self, path: &Path, width: u32, places: &[Place]) -> Result<()> {
        let pixels = self.rows as usize * width as usize;
        let channels: usize = self.layers.iter().map(|layer| layer.channels.len()).sum();
        if channels != places.len() {
            let message = format!("{channels} channels in a band, {} in the first", places.len());
            return Err(invalid_data(path, message));
        }
        for place in places {
            let layer = self.layers.get(place.layer);
            let channel = layer.and_then(|l| Some((l, l.channels.get(place.channel)?)));
            let count = channel
                .filter(|(layer, (name, _))| full_name(&layer.name, name) == place.name)
                .map_or(0, |(_, (_, data))| data.len());
            if count != pixels {
                let message =
                    format!("channel {} has {count} values for {pixels} pixels", place.name);
                return Err(invalid_data(path, message));
            }
        }
        Ok(())
    }
}

impl ExrHeader {
    fn check(&self, path: &Path) -> Result<()> {
        let ((width, height), window) = (self.resolution, self.window);
        let end = |start: u32, length: u32| u64::from(start) + u64::from(length);
        if window.width == 0
            || window.height == 0
            || end(window.x, window.width) > u64::from(width)
            || end(window.y, window.height) > u64::from(height)
        {
            let message = format!("the window {window:?} does not lie in {width}x{height} pixels");
            return Err(invalid_data(path, message));
        }
        Ok(())
    }

    fn of_file(&self, places: &[Place]) -> Header {
        let size = |width: u32, height: u32| Vec2(width as usize, height as usize);
        let window = self.window;
        let channels = places.iter().map(|place| ChannelDescription {
            name: text(&place.name),
            sample_type: place.sample_type,
            quantize_linearly: false,
            sampling: Vec2(1, 1),
        });
        let mut attributes = LayerAttributes {
            layer_position: Vec2(window.x as i32, window.y as i32),
            software_name: Some(text(concat!("Steradian ", env!("CARGO_PKG_VERSION")))),
            ..LayerAttributes::default()
        };
        for (name, value) in &self.metadata {
            let value = match (name.as_str(), value) {
                (WORLD_TO_CAMERA, Attribute::Matrix(m)) => {
                    attributes.world_to_camera = Some(*m);
                    continue;
                }
                (WORLD_TO_NDC, Attribute::Matrix(m)) => {
                    attributes.world_to_normalized_device = Some(*m);
                    continue;
                }
                (CAPTURE_DATE, Attribute::Text(date)) => {
                    attributes.capture_date = Some(text(date));
                    continue;
                }
                (UTC_OFFSET, Attribute::Single(seconds)) => {
                    attributes.utc_offset = Some(*seconds);
                    continue;
                }
                (_, Attribute::Text(value)) => AttributeValue::Text(text(value)),
                (_, Attribute::Number(value)) => AttributeValue::F64(*value),
                (_, Attribute::Integer(value)) => AttributeValue::I32(*value),
                (_, Attribute::Single(value)) => AttributeValue::F32(*value),
                (_, Attribute::Matrix(value)) => AttributeValue::Matrix4x4(*value),
            };
            attributes.other.insert(text(name), value);
        }
        let display = IntegerBounds::new((0, 0), size(self.resolution.0, self.resolution.1));
        let shared =
            ImageAttributes { chromaticities: Some(REC_709), ..ImageAttributes::new(display) };
        Header::new(text(""), size(window.width, window.height), channels.collect())
            .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing)
            .with_attributes(attributes)
            .with_shared_attributes(shared)
    }
}

/// Strings of the format are bytes; we store UTF-8.
fn text(value: &str) -> Text {
    Text::from_slice_unchecked(value.as_bytes())
}

/// Puts the attributes of a one-part file's header into the order of their
/// names. The library writes them in the order of a hash map, which differs
/// from run to run. The header keeps its length, so offsets stay right.
fn sort_attributes(file: &mut (impl Read + Write + Seek)) -> std::io::Result<()> {
    /// Magic number and version (OpenEXR file layout).
    const HEADER_START: u64 = 8;
    file.seek(SeekFrom::Start(HEADER_START))?;
    let mut reader = BufReader::new(&mut *file);
    let mut attributes = Vec::new();
    // name 0 type 0 size:i32 value; an empty name ends the header.
    loop {
        let mut attribute = Vec::new();
        let mut string = || {
            let first = attribute.len();
            loop {
                let mut byte = [0];
                reader.read_exact(&mut byte)?;
                attribute.push(byte[0]);
                if byte[0] == 0 {
                    return Ok::<_, std::io::Error>(attribute.len() - first > 1);
                }
            }
        };
        if !string()? {
            break;
        }
        string()?;
        let mut size = [0; 4];
        reader.read_exact(&mut size)?;
        attribute.extend(size);
        let first = attribute.len();
        attribute.resize(first + i32::from_le_bytes(size) as usize, 0);
        reader.read_exact(&mut attribute[first..])?;
        attributes.push(attribute);
    }
    attributes.sort();
    file.seek(SeekFrom::Start(HEADER_START))?;
    file.write_all(&attributes.concat())
}
