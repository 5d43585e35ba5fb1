//! OpenEXR: linear values of any number of named channels, without loss.
//!
//! One part per file; a channel of a layer is named `layer.channel`, the form
//! that every reader knows. Compression is ZIP, which keeps every bit. Equal
//! images give equal files, byte by byte.

use super::{Picture, invalid_data, write_atomically};
use crate::settings::Crop;
use crate::{Error, Result};
use ::exr::meta::attribute::Chromaticities;
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, IntegerBounds,
    LayerAttributes, ReadChannels, ReadLayers, Text, Vec2, WritableImage, f16,
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Cursor, Write};
use std::path::Path;

/// The contents of an EXR file.
#[derive(Debug, Clone, PartialEq)]
pub struct ExrImage {
    /// Columns and rows of the whole picture (the display window).
    pub resolution: (u32, u32),
    /// The part that has pixels (the data window), inside the whole picture.
    pub window: Crop,
    /// Layers with distinct names.
    pub layers: Vec<Layer>,
    /// Attributes of the file beside the standard ones.
    pub metadata: BTreeMap<String, Attribute>,
}

/// Channels that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Without a dot at its end; empty for the main layer, whose R, G and B are the picture.
    pub name: String,
    /// Names and values. Each channel has one value per pixel of the window,
    /// row by row from the top.
    pub channels: Vec<(String, ChannelData)>,
}

/// Values of one channel.
#[derive(Debug, Clone, PartialEq)]
pub enum ChannelData {
    /// Any quantity; not-finite values are kept.
    F32(Vec<f32>),
    /// Counts and indices.
    U32(Vec<u32>),
}

/// Value of an attribute.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Attribute {
    /// Text, UTF-8.
    Text(String),
    /// Any number; integers are exact up to 2^53.
    Number(f64),
}

/// How the main layer's R, G and B are stored. All else keeps 32 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// 32 bits: exactly what was rendered.
    #[default]
    Float,
    /// 16 bits: rounded to 11 significant ones; at most 65504.
    Half,
}

/// The primaries and white point of Rec. 709 (ITU-R BT.709-6, table 1).
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.3, 0.6),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.329),
};

impl ChannelData {
    fn len(&self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::U32(values) => values.len(),
        }
    }
}

impl ExrImage {
    /// A whole picture as the main layer.
    pub fn from_picture(picture: &Picture) -> Self {
        let (width, height) = (picture.width, picture.height);
        Self::from_crop(picture, (width, height), Crop { x: 0, y: 0, width, height })
    }

    /// The part `window` of a picture of size `resolution` as the main layer;
    /// `picture` has the size of the window.
    pub fn from_crop(picture: &Picture, resolution: (u32, u32), window: Crop) -> Self {
        let component = |i: usize| ChannelData::F32(picture.rgb.iter().map(|p| p[i]).collect());
        let channels = ["R", "G", "B"].iter().enumerate();
        let channels = channels.map(|(i, name)| ((*name).to_owned(), component(i))).collect();
        let main = Layer { name: String::new(), channels };
        Self { resolution, window, layers: vec![main], metadata: BTreeMap::new() }
    }

    /// The channel `name` of the layer `layer`.
    pub fn channel(&self, layer: &str, name: &str) -> Option<&ChannelData> {
        let layer = self.layers.iter().find(|l| l.name == layer)?;
        layer.channels.iter().find(|(n, _)| n == name).map(|(_, data)| data)
    }

    /// R, G and B of the main layer, of the window's size, if it has all three
    /// as floats.
    pub fn picture(&self) -> Option<Picture> {
        let component = |name| match self.channel("", name) {
            Some(ChannelData::F32(values)) => Some(values),
            _ => None,
        };
        let (r, g, b) = (component("R")?, component("G")?, component("B")?);
        let rgb = r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b]).collect();
        Some(Picture::new(self.window.width, self.window.height, rgb))
    }

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
        let pixels = window.width as usize * window.height as usize;
        for layer in &self.layers {
            for (name, data) in &layer.channels {
                if data.len() != pixels {
                    let message = format!(
                        "channel {} has {} values for {pixels} pixels",
                        full_name(&layer.name, name),
                        data.len()
                    );
                    return Err(invalid_data(path, message));
                }
            }
        }
        Ok(())
    }
}

fn full_name(layer: &str, channel: &str) -> String {
    if layer.is_empty() { channel.to_owned() } else { format!("{layer}.{channel}") }
}

/// Writes `image`. Fails without writing if a channel has not one value per
/// pixel, if a name is reserved or used twice, or if a value is too large for
/// the precision that was asked for.
pub fn write_exr(path: &Path, image: &ExrImage, precision: Precision) -> Result<()> {
    image.check(path)?;
    let mut channels = Vec::new();
    for layer in &image.layers {
        for (name, data) in &layer.channels {
            let is_color = layer.name.is_empty() && matches!(name.as_str(), "R" | "G" | "B");
            let samples = match data {
                ChannelData::U32(values) => FlatSamples::U32(values.clone()),
                ChannelData::F32(values) if is_color && precision == Precision::Half => {
                    FlatSamples::F16(half_values(path, name, values)?)
                }
                ChannelData::F32(values) => FlatSamples::F32(values.clone()),
            };
            channels.push(AnyChannel::new(text(&full_name(&layer.name, name)), samples));
        }
    }
    let size = |width: u32, height: u32| Vec2(width as usize, height as usize);
    let window = image.window;
    let mut attributes = LayerAttributes {
        layer_position: Vec2(window.x as i32, window.y as i32),
        software_name: Some(text(concat!("Steradian ", env!("CARGO_PKG_VERSION")))),
        ..LayerAttributes::default()
    };
    for (name, value) in &image.metadata {
        let value = match value {
            Attribute::Text(value) => AttributeValue::Text(text(value)),
            Attribute::Number(value) => AttributeValue::F64(*value),
        };
        attributes.other.insert(text(name), value);
    }
    let layer = ::exr::prelude::Layer::new(
        size(window.width, window.height),
        attributes,
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels.into()),
    );
    let mut file = Image::from_layer(layer);
    file.attributes.display_window =
        IntegerBounds::new((0, 0), size(image.resolution.0, image.resolution.1));
    file.attributes.chromaticities = Some(REC_709);

    let mut bytes = Cursor::new(Vec::new());
    file.write().to_buffered(&mut bytes).map_err(|e| exr_error(path, e))?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes);
    write_atomically(path, |file| file.write_all(&bytes).map_err(|e| Error::io(path, e)))
}

/// Strings of the format are bytes; we store UTF-8.
fn text(value: &str) -> Text {
    Text::from_slice_unchecked(value.as_bytes())
}

fn half_values(path: &Path, name: &str, values: &[f32]) -> Result<Vec<f16>> {
    let mut halves = Vec::with_capacity(values.len());
    for &value in values {
        let half = f16::from_f32(value);
        if value.is_finite() && !half.is_finite() {
            let message = format!(
                "channel {name} holds {value}, more than a 16-bit float can; store 32-bit floats"
            );
            return Err(invalid_data(path, message));
        }
        halves.push(half);
    }
    Ok(halves)
}

/// Puts the attributes of a one-part file's header into the order of their
/// names. The library writes them in the order of a hash map, which differs
/// from run to run. The header keeps its length, so offsets stay right.
fn sort_attributes(file: &mut [u8]) {
    /// Magic number and version (OpenEXR file layout).
    const HEADER_START: usize = 8;
    let mut attributes = Vec::new();
    let mut at = HEADER_START;
    // name 0 type 0 size:i32 value; an empty name ends the header.
    while file[at] != 0 {
        let string_end =
            |from: usize| from + file[from..].iter().position(|&b| b == 0).unwrap() + 1;
        let size_at = string_end(string_end(at));
        let size = i32::from_le_bytes(file[size_at..size_at + 4].try_into().unwrap());
        let end = size_at + 4 + size as usize;
        attributes.push(file[at..end].to_vec());
        at = end;
    }
    attributes.sort();
    file[HEADER_START..at].copy_from_slice(&attributes.concat());
}

/// Reads every channel of every part. 16-bit floats are widened exactly.
pub fn read_exr(path: &Path) -> Result<ExrImage> {
    let file = File::open(path).map_err(|e| Error::io(path, e))?;
    let image = ::exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(BufReader::new(file))
        .map_err(|e| exr_error(path, e))?;
    let Some(first) = image.layer_data.first() else {
        return Err(invalid_data(path, "holds no picture"));
    };
    let display = image.attributes.display_window;
    let (position, size) = (first.attributes.layer_position, first.size);
    let offset = (position - display.position).to_usize("window").ok();
    let window = offset
        .filter(|o| o.0 + size.0 <= display.size.0 && o.1 + size.1 <= display.size.1)
        .map(|o| [o.0, o.1, size.0, size.1].map(|v| v as u32));
    let Some([x, y, width, height]) = window else {
        return Err(invalid_data(path, "has pixels outside its display window"));
    };
    let mut layers = BTreeMap::<String, Vec<(String, ChannelData)>>::new();
    let mut metadata = BTreeMap::new();
    for part in &image.layer_data {
        if part.attributes.layer_position != position || part.size != size {
            return Err(invalid_data(path, "has parts of different sizes or positions"));
        }
        for channel in &part.channel_data.list {
            let name = string(&channel.name);
            let name = match &part.attributes.layer_name {
                // A part's name stands for a layer unless the channels say it already.
                Some(part_name) if image.layer_data.len() > 1 && !name.contains('.') => {
                    full_name(&string(part_name), &name)
                }
                _ => name,
            };
            let data = match &channel.sample_data {
                FlatSamples::F16(v) => ChannelData::F32(v.iter().map(|h| h.to_f32()).collect()),
                FlatSamples::F32(v) => ChannelData::F32(v.clone()),
                FlatSamples::U32(v) => ChannelData::U32(v.clone()),
            };
            if data.len() != size.area() {
                return Err(invalid_data(path, format!("channel {name} is subsampled")));
            }
            let (layer, name) = name.rsplit_once('.').unwrap_or(("", &name));
            layers.entry(layer.to_owned()).or_default().push((name.to_owned(), data));
        }
        metadata.extend(part.attributes.other.iter().filter_map(attribute));
    }
    metadata.extend(image.attributes.other.iter().filter_map(attribute));
    Ok(ExrImage {
        resolution: (display.size.0 as u32, display.size.1 as u32),
        window: Crop { x, y, width, height },
        layers: layers.into_iter().map(|(name, channels)| Layer { name, channels }).collect(),
        metadata,
    })
}

/// Attributes of other kinds than ours are left out.
fn attribute((name, value): (&Text, &AttributeValue)) -> Option<(String, Attribute)> {
    let value = match value {
        AttributeValue::Text(value) => Attribute::Text(string(value)),
        AttributeValue::F64(value) => Attribute::Number(*value),
        AttributeValue::F32(value) => Attribute::Number(f64::from(*value)),
        AttributeValue::I32(value) => Attribute::Number(f64::from(*value)),
        _ => return None,
    };
    Some((string(name), value))
}

fn string(value: &Text) -> String {
    String::from_utf8_lossy(value.as_slice()).into_owned()
}

fn exr_error(path: &Path, error: ::exr::error::Error) -> Error {
    match error {
        ::exr::error::Error::Io(source) => Error::io(path, source),
        other => invalid_data(path, other.to_string()),
    }
}

#[cfg(test)]
mod tests;
