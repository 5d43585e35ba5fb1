//! OpenEXR: linear values of any number of named channels, without loss.
//!
//! One part per file; a channel of a layer is named `layer.channel`, the form
//! that every reader knows. Compression is ZIP, which keeps every bit. Equal
//! images give equal files, byte by byte.

mod write;

pub use write::{ExrHeader, write_exr, write_exr_bands};

use super::{Picture, invalid_data};
use crate::settings::Crop;
use crate::{Error, Result};
use ::exr::meta::attribute::Chromaticities;
use ::exr::prelude::{AttributeValue, FlatSamples, ReadChannels, ReadLayers, Text, Vec2, f16};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::io::BufReader;
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
    /// Where programs want this type.
    Integer(i32),
    /// Where programs want this type.
    Single(f32),
    /// Row by row, for points that are rows: the translation is in the last four.
    Matrix([f32; 16]),
}

impl fmt::Display for Attribute {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => f.write_str(text),
            Self::Number(number) => number.fmt(f),
            Self::Integer(number) => number.fmt(f),
            Self::Single(number) => number.fmt(f),
            Self::Matrix(values) => f.write_str(&values.map(|v| v.to_string()).join(" ")),
        }
    }
}

/// Names of the standard matrices that [`ExrImage::metadata`] may have.
const WORLD_TO_CAMERA: &str = "worldToCamera";
/// See [`WORLD_TO_CAMERA`].
const WORLD_TO_NDC: &str = "worldToNDC";

/// How the main layer's R, G and B are stored. All else keeps 32 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// 32 bits: exactly what was rendered.
    #[default]
    Float,
    /// 16 bits: rounded to 11 significant ones; at most 65504.
    Half,
}

impl Precision {
    /// Whether the value stays finite, if it is.
    pub fn holds(self, value: f32) -> bool {
        self == Self::Float || !value.is_finite() || f16::from_f32(value).is_finite()
    }
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
}

fn full_name(layer: &str, channel: &str) -> String {
    if layer.is_empty() { channel.to_owned() } else { format!("{layer}.{channel}") }
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
        let matrices = [
            (WORLD_TO_CAMERA, part.attributes.world_to_camera),
            (WORLD_TO_NDC, part.attributes.world_to_normalized_device),
        ];
        let matrices = matrices.into_iter().filter_map(|(name, m)| Some((name.to_owned(), m?)));
        metadata.extend(matrices.map(|(name, m)| (name, Attribute::Matrix(m))));
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
        AttributeValue::F32(value) => Attribute::Single(*value),
        AttributeValue::I32(value) => Attribute::Integer(*value),
        AttributeValue::Matrix4x4(value) => Attribute::Matrix(*value),
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
