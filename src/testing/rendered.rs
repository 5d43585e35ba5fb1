//! A picture with what made it.

use crate::film::Film;
use crate::gpu::{Device, DeviceInfo};
use crate::image::compare::PictureFile;
use crate::image::{Attribute, ChannelData, ExrImage, Layer, Picture, Precision, write_exr};
use crate::scene::Scene;
use crate::{RenderSettings, Renderer, Result};
use std::path::Path;
use std::sync::Arc;

/// A picture, the noise that it knows of, and what made it.
#[derive(Debug, Clone, PartialEq)]
pub struct Rendered {
    image: ExrImage,
}

impl Rendered {
    /// A picture made by an adapter and its driver; any names that tell them apart.
    pub fn new(picture: Picture, device: &str, driver: &str) -> Self {
        let image = ExrImage::from_picture(&picture);
        Self { image }.with("steradian.device", device).with("steradian.driver", driver)
    }

    /// Renders all samples of a scene.
    ///
    /// # Errors
    /// As [`Renderer::new`] and [`Renderer::step`].
    pub fn render(device: Arc<Device>, scene: &Scene, settings: &RenderSettings) -> Result<Self> {
        let info = device.info().clone();
        let mut renderer = Renderer::new(device, scene, settings)?;
        while renderer.step()? {}
        renderer.finish()?;
        Ok(Self::from_film(renderer.film(), &info, scene, settings))
    }

    /// What a film holds.
    pub fn from_film(
        film: &Film,
        device: &DeviceInfo,
        scene: &Scene,
        settings: &RenderSettings,
    ) -> Self {
        let mut image = ExrImage::from_crop(&film.picture(), settings.resolution, film.window());
        if let Some(error) = film.standard_error() {
            let samples = ChannelData::U32(film.sample_counts().to_vec());
            let channels = vec![
                ("samples".into(), samples),
                ("standard_error".into(), ChannelData::F32(error)),
            ];
            image.layers.push(Layer { name: "noise".into(), channels });
        }
        Self { image }
            .with("steradian.device", &device.name)
            .with("steradian.driver", &device.driver)
            .with("steradian.scene", &scene.name)
            .with("steradian.scene_hash", &format!("{:016x}", scene.content_hash(settings.camera)))
            .with("steradian.version", env!("CARGO_PKG_VERSION"))
            .with("steradian.spp", &film.least_samples().to_string())
            .with("steradian.block", &settings.samples_per_block().to_string())
            .with("steradian.seed", &settings.seed.to_string())
    }

    /// With one more line of metadata: settings, a scene's hash; `command` is what the report
    /// shows as the call that makes the picture again.
    pub fn with(mut self, name: &str, value: &str) -> Self {
        self.image.metadata.insert(name.to_owned(), Attribute::Text(value.to_owned()));
        self
    }

    /// With a layer beside the colour.
    pub fn with_layer(mut self, layer: Layer) -> Self {
        self.image.layers.push(layer);
        self
    }

    /// The colours.
    ///
    /// # Panics
    /// If a layer was added that hides them.
    pub fn picture(&self) -> Picture {
        self.image.picture().expect("a rendered picture has colours")
    }

    /// Its metadata of a name.
    pub fn metadata(&self, name: &str) -> Option<&str> {
        match self.image.metadata.get(name) {
            Some(Attribute::Text(text)) => Some(text),
            _ => None,
        }
    }

    /// Adapter and driver in one line.
    pub(super) fn origin(&self) -> String {
        let get = |name| self.metadata(name).unwrap_or("unknown");
        format!("{}, {}", get("steradian.device"), get("steradian.driver"))
    }

    /// Writes everything as EXR.
    ///
    /// # Errors
    /// [`crate::Error::Io`].
    pub fn write(&self, path: &Path) -> Result<()> {
        write_exr(path, &self.image, Precision::Float)
    }

    /// `image` with this picture's metadata.
    pub(super) fn copy_metadata(&self, mut image: ExrImage) -> ExrImage {
        image.metadata.extend(self.image.metadata.clone());
        image
    }

    /// As a comparison takes it; `path` names it in errors.
    ///
    /// # Errors
    /// [`crate::Error::Io`] if its noise is no number.
    pub fn file(&self, path: &Path) -> Result<PictureFile> {
        PictureFile::from_exr(&self.image, path)
    }

    /// Whether all layers but the noise have the same bits. NaN is equal to the same NaN: two ways
    /// to one picture must agree there too.
    pub(super) fn has_bits_of(&self, other: &Self) -> bool {
        let bits = |rendered: &Self| -> Vec<(String, Vec<u32>)> {
            let layers = rendered.image.layers.iter().filter(|layer| layer.name != "noise");
            let channels = layers.flat_map(|layer| {
                layer.channels.iter().map(|(name, data)| {
                    let bits = match data {
                        ChannelData::F32(values) => values.iter().map(|v| v.to_bits()).collect(),
                        ChannelData::U32(values) => values.clone(),
                    };
                    (format!("{}.{name}", layer.name), bits)
                })
            });
            channels.collect()
        };
        self.image.window == other.image.window && bits(self) == bits(other)
    }
}
