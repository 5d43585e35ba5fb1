//! Picture files with everything in them that a comparison uses.

use super::noise::Noise;
use crate::image::{
    ChannelData, ExrImage, OutputFormat, Picture, invalid_data, read_exr, read_png,
};
use crate::settings::Crop;
use crate::{Error, Result};
use ::png::{Decoder, DecodingError};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Layers that tell of a picture's noise and are no pictures themselves.
const NOISE_LAYERS: [&str; 2] = ["noise", "variance"];

/// Channels of the main layer that are the colour, in order. A file has them by the alphabet.
const COLOR: [&str; 3] = ["R", "G", "B"];

/// The contents of a PNG or EXR file as linear values.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureFile {
    /// What kind of file it was.
    pub format: OutputFormat,
    /// Columns and rows of the whole picture.
    pub resolution: (u32, u32),
    /// The part that has pixels.
    pub window: Crop,
    /// The layers that can be compared. The colour is the one whose name is empty.
    pub layers: Vec<PictureLayer>,
    /// What the file says of its noise.
    pub noise: Option<Noise>,
    /// Its texts and attributes, by their names.
    pub metadata: BTreeMap<String, String>,
}

/// Channels that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureLayer {
    /// Name of the layer; empty for the colour.
    pub name: String,
    /// Names and values, one for each pixel of the window, row by row from the top.
    pub channels: Vec<(String, Vec<f32>)>,
}

impl PictureLayer {
    /// The layer as a picture, if its channels are R, G and B.
    pub fn picture(&self, window: &Crop) -> Option<Picture> {
        let channel = |name| self.channels.iter().find(|(n, _)| n == name).map(|(_, v)| v);
        let [r, g, b] = COLOR.map(channel);
        let (r, g, b) = (r?, g?, b?);
        let rgb = r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b]).collect();
        Some(Picture::new(window.width, window.height, rgb))
    }

    /// The name for people: "colour" for the main layer.
    pub fn title(&self) -> &str {
        if self.name.is_empty() { "colour" } else { &self.name }
    }

    fn of_picture(picture: &Picture) -> Self {
        let channel = |c: usize| picture.rgb.iter().map(|p| p[c]).collect();
        let channels = COLOR.iter().enumerate().map(|(c, name)| ((*name).to_owned(), channel(c)));
        Self { name: String::new(), channels: channels.collect() }
    }
}

impl PictureFile {
    /// Reads a `.png` (8 or 16 bits, taken as sRGB) or an `.exr`.
    ///
    /// # Errors
    /// [`Error::Io`] for a file that is missing or broken, [`Error::Settings`] for another ending.
    pub fn read(path: &Path) -> Result<Self> {
        match OutputFormat::from_path(path)? {
            OutputFormat::Png => {
                let mut file = Self::from_picture(&read_png(path)?, OutputFormat::Png);
                file.metadata = png_text(path)?;
                Ok(file)
            }
            OutputFormat::Exr => Self::from_exr(&read_exr(path)?, path),
        }
    }

    /// A picture in memory, of which no noise is known.
    pub fn from_picture(picture: &Picture, format: OutputFormat) -> Self {
        let (width, height) = (picture.width, picture.height);
        Self {
            format,
            resolution: (width, height),
            window: Crop { x: 0, y: 0, width, height },
            layers: vec![PictureLayer::of_picture(picture)],
            noise: None,
            metadata: BTreeMap::new(),
        }
    }

    /// The contents of an EXR file; `path` names it in errors.
    ///
    /// # Errors
    /// [`Error::Io`] if a variance is negative or no number.
    pub fn from_exr(image: &ExrImage, path: &Path) -> Result<Self> {
        let metadata = image.metadata.iter().map(|(name, value)| (name.clone(), value.to_string()));
        let metadata: BTreeMap<_, _> = metadata.collect();
        let noise = Noise::of(image, &metadata).map_err(|e| invalid_data(path, e))?;
        Ok(Self {
            format: OutputFormat::Exr,
            resolution: image.resolution,
            window: image.window,
            layers: layers(image),
            noise,
            metadata,
        })
    }

    /// The layer of a name; the empty one is the colour.
    pub fn layer(&self, name: &str) -> Option<&PictureLayer> {
        self.layers.iter().find(|layer| layer.name == name)
    }

    /// The colour.
    pub fn picture(&self) -> Option<Picture> {
        self.layer("")?.picture(&self.window)
    }

    /// A metadata entry of this renderer: `steradian.NAME`.
    pub fn setting(&self, name: &str) -> Option<&str> {
        self.metadata.get(&format!("steradian.{name}")).map(String::as_str)
    }
}

/// The colour first, then what else stands in the main layer, channel by channel, then the
/// named layers.
fn layers(image: &ExrImage) -> Vec<PictureLayer> {
    let values = |data: &ChannelData| match data {
        ChannelData::F32(values) => values.clone(),
        // Counts and indices up to 2^24 are exact.
        ChannelData::U32(values) => values.iter().map(|&v| v as f32).collect(),
    };
    let mut layers = Vec::new();
    for layer in &image.layers {
        let channels = |keep: &dyn Fn(&str) -> bool| -> Vec<(String, Vec<f32>)> {
            let kept = layer.channels.iter().filter(|(name, _)| keep(name));
            let mut kept: Vec<_> = kept.map(|(name, data)| (name.clone(), values(data))).collect();
            let place = |name: &str| COLOR.iter().position(|c| *c == name).unwrap_or(COLOR.len());
            kept.sort_by_key(|(name, _)| place(name));
            kept
        };
        if NOISE_LAYERS.contains(&layer.name.as_str()) {
            continue;
        }
        if !layer.name.is_empty() {
            layers.push(PictureLayer { name: layer.name.clone(), channels: channels(&|_| true) });
            continue;
        }
        let is_color = COLOR.iter().all(|c| layer.channels.iter().any(|(name, _)| name == c));
        let belongs = |name: &str| is_color && COLOR.contains(&name);
        if is_color {
            let color = channels(&belongs);
            layers.insert(0, PictureLayer { name: String::new(), channels: color });
        }
        for (name, data) in layer.channels.iter().filter(|(name, _)| !belongs(name)) {
            let channels = vec![(name.clone(), values(data))];
            layers.push(PictureLayer { name: name.clone(), channels });
        }
    }
    layers
}

/// Keywords and texts of a PNG.
fn png_text(path: &Path) -> Result<BTreeMap<String, String>> {
    let failure = |e| match e {
        DecodingError::IoError(source) => Error::io(path, source),
        other => invalid_data(path, other.to_string()),
    };
    let file = File::open(path).map_err(|e| Error::io(path, e))?;
    let reader = Decoder::new(BufReader::new(file)).read_info().map_err(failure)?;
    let info = reader.info();
    let latin = info.uncompressed_latin1_text.iter().map(|c| (c.keyword.clone(), c.text.clone()));
    let utf8 = info.utf8_text.iter();
    let utf8 = utf8.filter_map(|c| Some((c.keyword.clone(), c.get_text().ok()?)));
    Ok(latin.chain(utf8).collect())
}
