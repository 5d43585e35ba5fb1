//! A material slot's texture: image, sampler, set of texture coordinates and
//! KHR_texture_transform.
//!
//! Filtering is that of magnification, bilinear or nearest, on the full image. Minification
//! filters and mip maps are not used: the samples of a pixel spread over its footprint, so that
//! their mean is what those filters approximate (`tests/textures.rs` measures it).

use super::buffers::Buffers;
use super::document::Document;
use super::images::Images;
use super::members::Members;
use super::notices::Notices;
use crate::Result;
use crate::scene::{ColorSpace, TextureRef, Wrap};
use glam::{Affine2, Vec2};
use gltf::json;
use gltf::json::texture::{MagFilter, WrappingMode};
use gltf::json::validation::Checked;
use serde::Deserialize;

/// What the crate puts where a texture has no source.
const NO_SOURCE: usize = u32::MAX as usize;

/// Extensions of a texture that name another image, the preferred one first.
const SOURCES: [&str; 2] = ["KHR_texture_basisu", "EXT_texture_webp"];

/// What a slot of a material says.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Slot {
    index: u32,
    #[serde(default)]
    tex_coord: u32,
    /// Of normal textures.
    #[serde(default = "one")]
    scale: f64,
    #[serde(default)]
    extensions: SlotExtensions,
}

#[derive(Default, Deserialize)]
struct SlotExtensions {
    #[serde(default, rename = "KHR_texture_transform")]
    transform: TextureTransform,
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct TextureTransform {
    offset: [f64; 2],
    rotation: f64,
    scale: [f64; 2],
    tex_coord: Option<u32>,
}

impl Default for TextureTransform {
    fn default() -> Self {
        Self { offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2], tex_coord: None }
    }
}

fn one() -> f64 {
    1.0
}

impl Slot {
    /// The scale of a normal texture.
    pub(super) fn scale(&self) -> std::result::Result<f32, String> {
        let scale = self.scale as f32;
        if scale.is_finite() { Ok(scale) } else { Err(format!("{:e} is too large", self.scale)) }
    }
}

/// Reads the textures of one material.
pub(super) struct TextureReader<'a, 'b> {
    pub(super) document: &'a Document,
    pub(super) buffers: &'b Buffers<'b>,
    pub(super) images: &'a mut Images<'b>,
    pub(super) notices: &'a mut Notices,
    /// The material, for messages.
    pub(super) place: &'a str,
}

impl TextureReader<'_, '_> {
    /// The texture of a slot, with the file's number of the set of texture coordinates; `None`,
    /// with a notice, where it has no image.
    pub(super) fn read(
        &mut self,
        slot: Slot,
        color_space: ColorSpace,
    ) -> Result<Option<TextureRef>> {
        let document = self.document;
        let index = json::Index::new(slot.index);
        let texture: &json::Texture = document.get(index, self.place)?;
        let what = format!("{}, {}", self.place, document.label(index));

        let transform = slot.extensions.transform;
        let Some(image) = self.source(texture, &what)? else {
            self.notices.ignored("texture without an image: left out", &what);
            return Ok(None);
        };
        let (wrap, nearest) = match texture.sampler {
            None => ([Wrap::Repeat; 2], false),
            Some(index) => {
                let sampler = document.get(index, &what)?;
                let wrap = [self.wrap(&sampler.wrap_s, &what)?, self.wrap(&sampler.wrap_t, &what)?];
                if matches!(sampler.mag_filter, Some(Checked::Invalid)) {
                    self.notices.approximated("unknown magFilter taken as LINEAR", &what);
                }
                (wrap, sampler.mag_filter == Some(Checked::Valid(MagFilter::Nearest)))
            }
        };
        Ok(Some(TextureRef {
            image: self.images.index_of(document, self.buffers, image, &what, color_space)?,
            color_space,
            uv_set: transform.tex_coord.unwrap_or(slot.tex_coord),
            transform: uv_transform(&transform).ok_or_else(|| {
                document.error(format!("{what}: KHR_texture_transform overflows"))
            })?,
            wrap,
            nearest,
        }))
    }

    /// The image of a texture: an extension's before the plain one.
    fn source(
        &mut self,
        texture: &json::Texture,
        what: &str,
    ) -> Result<Option<json::Index<json::Image>>> {
        let plain = (texture.source.value() != NO_SOURCE).then_some(texture.source);
        let others = texture.extensions.as_ref().map(|extensions| &extensions.others);
        for name in SOURCES {
            let Some(value) = others.and_then(|others| others.get(name)) else { continue };
            let source = Members::of(name, value).and_then(|members| members.index("source"));
            let Some(source) =
                source.map_err(|message| self.document.error(format!("{what}: {message}")))?
            else {
                continue;
            };
            if name == "KHR_texture_basisu" && !cfg!(feature = "basis") && plain.is_some() {
                let message = "KHR_texture_basisu: this build lacks the feature `basis`; \
                     the texture's plain image is used";
                self.notices.approximated(message, what);
                continue;
            }
            return Ok(Some(json::Index::new(source)));
        }
        Ok(plain)
    }

    fn wrap(&self, mode: &Checked<WrappingMode>, what: &str) -> Result<Wrap> {
        match mode {
            Checked::Valid(WrappingMode::Repeat) => Ok(Wrap::Repeat),
            Checked::Valid(WrappingMode::MirroredRepeat) => Ok(Wrap::MirroredRepeat),
            Checked::Valid(WrappingMode::ClampToEdge) => Ok(Wrap::ClampToEdge),
            Checked::Invalid => Err(self.document.error(format!("{what}: unknown wrap mode"))),
        }
    }
}

/// Translation × rotation × scale; `None` where it is not finite. v points down,
/// so a counter-clockwise turn of texture coordinates has the negative angle.
fn uv_transform(transform: &TextureTransform) -> Option<Affine2> {
    let vec2 = |[x, y]: [f64; 2]| Vec2::new(x as f32, y as f32);
    let affine = Affine2::from_scale_angle_translation(
        vec2(transform.scale),
        -transform.rotation as f32,
        vec2(transform.offset),
    );
    affine.is_finite().then_some(affine)
}
