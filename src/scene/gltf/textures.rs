//! A material slot's texture: image, sampler, set of texture coordinates and
//! KHR_texture_transform.

use super::buffers::Buffers;
use super::document::Document;
use super::images::Images;
use super::notices::Notices;
use crate::Result;
use crate::scene::{ColorSpace, TextureRef, Wrap};
use glam::{Affine2, Vec2};
use gltf::json;
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::texture::{MagFilter, WrappingMode};
use gltf::json::validation::Checked;

/// The transform's name in the slots whose type in the crate lacks it.
const TEXTURE_TRANSFORM: &str = "KHR_texture_transform";

/// What the crate puts where a texture has no source.
const NO_SOURCE: usize = u32::MAX as usize;

/// What a slot of a material says.
pub(super) struct Slot {
    texture: json::Index<json::Texture>,
    tex_coord: u32,
    transform: Option<TextureTransform>,
}

impl Slot {
    /// From a slot whose transform the `gltf` crate parses.
    pub(super) fn from_info(info: &json::texture::Info) -> Self {
        let extensions = info.extensions.as_ref();
        Self {
            texture: info.index,
            tex_coord: info.tex_coord,
            transform: extensions.and_then(|e| e.texture_transform.clone()),
        }
    }

    /// From the normal texture's slot.
    pub(super) fn from_normal(
        normal: &json::material::NormalTexture,
    ) -> std::result::Result<Self, String> {
        let extensions = normal.extensions.as_ref();
        let transform = match extensions.and_then(|e| e.others.get(TEXTURE_TRANSFORM)) {
            None => None,
            Some(value) => serde_json::from_value(value.clone())
                .map_err(|e| format!("normalTexture, {TEXTURE_TRANSFORM}: {e}"))?,
        };
        Ok(Self { texture: normal.index, tex_coord: normal.tex_coord, transform })
    }
}

/// Reads the textures of one material.
pub(super) struct TextureReader<'a> {
    pub(super) document: &'a Document,
    pub(super) buffers: &'a Buffers<'a>,
    pub(super) images: &'a mut Images,
    pub(super) notices: &'a mut Notices,
    /// The material, for messages.
    pub(super) place: &'a str,
}

impl TextureReader<'_> {
    /// The texture of a slot; `None`, with a notice, where it cannot be used.
    pub(super) fn read(
        &mut self,
        slot: Slot,
        color_space: ColorSpace,
    ) -> Result<Option<TextureRef>> {
        let document = self.document;
        let texture = document.get(slot.texture, self.place)?;
        let what = format!("{}, {}", self.place, document.label(slot.texture));

        let transform = slot.transform.unwrap_or_default();
        let uv_set = transform.tex_coord.unwrap_or(slot.tex_coord);
        if uv_set > 1 {
            let message = "texture with texture coordinates beyond TEXCOORD_1: left out";
            self.notices.ignored(message, &what);
            return Ok(None);
        }
        if texture.source.value() == NO_SOURCE {
            self.notices.ignored("texture without a PNG or JPEG source: left out", &what);
            return Ok(None);
        }
        let (wrap, nearest) = match texture.sampler {
            None => ([Wrap::Repeat; 2], false),
            Some(index) => {
                let sampler = document.get(index, &what)?;
                let wrap = [self.wrap(&sampler.wrap_s, &what)?, self.wrap(&sampler.wrap_t, &what)?];
                (wrap, sampler.mag_filter == Some(Checked::Valid(MagFilter::Nearest)))
            }
        };
        Ok(Some(TextureRef {
            image: self.images.index_of(
                document,
                self.buffers,
                texture.source,
                &what,
                self.notices,
            )?,
            color_space,
            uv_set,
            transform: uv_transform(&transform)
                .ok_or_else(|| document.error(format!("{what}: {TEXTURE_TRANSFORM} overflows")))?,
            wrap,
            nearest,
        }))
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
    let affine = Affine2::from_scale_angle_translation(
        Vec2::from(transform.scale.0),
        -transform.rotation.0,
        Vec2::from(transform.offset.0),
    );
    affine.is_finite().then_some(affine)
}
