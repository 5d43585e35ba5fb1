//! Materials and textures as the device reads them.

use super::GpuMaterial;
use crate::scene::{AlphaMode, ColorSpace, Image, Material, Scene, TextureRef, Wrap};
use crate::shader::generated::{INVALID, material, texture};
use glam::Vec3;
use std::borrow::Cow;

/// `materials` and `textures`.
pub(super) struct Materials {
    pub(super) records: Vec<GpuMaterial>,
    /// Descriptors, then texels.
    pub(super) textures: Vec<[u32; 4]>,
}

/// Descriptors of the textures in use, in the order of their first use.
#[derive(Default)]
struct Descriptors {
    list: Vec<TextureRef>,
}

impl Descriptors {
    fn index_of(&mut self, texture: Option<TextureRef>) -> u32 {
        let Some(texture) = texture else { return INVALID };
        let found = self.list.iter().position(|t| *t == texture);
        found.unwrap_or_else(|| {
            self.list.push(texture);
            self.list.len() - 1
        }) as u32
    }
}

pub(super) fn build(scene: &Scene) -> Materials {
    let mut descriptors = Descriptors::default();
    let used = scene.used_materials();
    let records = scene
        .materials
        .iter()
        .enumerate()
        .map(|(i, m)| {
            // A material that nothing wears brings no image with it.
            let black = black_if_unlit(m);
            let m = &*black;
            let mut slot = |t| if used.contains(&i) { descriptors.index_of(t) } else { INVALID };
            let textures = [
                slot(m.base_color_texture),
                slot(m.metallic_roughness_texture),
                slot(m.normal_texture),
                slot(m.emission_texture),
            ];
            record(m, textures)
        })
        .collect();
    Materials { records, textures: pack(&descriptors.list, &scene.images) }
}

/// An unlit material scatters nothing.
fn black_if_unlit(m: &Material) -> Cow<'_, Material> {
    if !m.unlit {
        return Cow::Borrowed(m);
    }
    let (emission, emission_texture) = m.emitted();
    Cow::Owned(Material {
        name: m.name.clone(),
        unlit: true,
        emission,
        emission_texture,
        base_color: Vec3::ZERO,
        base_color_texture: m.base_color_texture,
        alpha: m.alpha,
        alpha_mode: m.alpha_mode,
        metallic: 0.0,
        specular: 0.0,
        ..Material::default()
    })
}

fn record(m: &Material, textures: [u32; 4]) -> GpuMaterial {
    let flag = |holds: bool, bit: u32| if holds { bit } else { 0 };
    GpuMaterial {
        base_color: m.base_color.into(),
        alpha: m.alpha,
        emission: m.emission.into(),
        alpha_cutoff: match m.alpha_mode {
            AlphaMode::Mask(cutoff) => cutoff,
            // Every alpha reaches it.
            AlphaMode::Opaque => 0.0,
            AlphaMode::Blend => -1.0,
        },
        specular_color: m.specular_color.into(),
        specular: m.specular,
        metallic: m.metallic,
        roughness: m.roughness,
        ior: m.ior,
        transmission: m.transmission,
        normal_scale: m.normal_scale,
        flags: flag(m.emits_behind(), material::EMITS_BEHIND)
            | flag(m.volume, material::VOLUME)
            | flag(m.unlit, material::UNLIT),
        base_color_texture: textures[0],
        metallic_roughness_texture: textures[1],
        normal_texture: textures[2],
        emission_texture: textures[3],
        padding_0: 0,
        padding_1: 0,
    }
}

fn pack(descriptors: &[TextureRef], images: &[Image]) -> Vec<[u32; 4]> {
    let head = 3 * descriptors.len();
    let mut words = vec![[0_u32; 4]; head];
    let mut first_texel = vec![None; images.len()];
    for (i, t) in descriptors.iter().enumerate() {
        let image = &images[t.image as usize];
        let first = *first_texel[t.image as usize].get_or_insert_with(|| {
            let first = 4 * words.len() as u32;
            words.extend(image.rgba.chunks(4).map(|four| {
                std::array::from_fn(|k| four.get(k).map_or(0, |c| u32::from_le_bytes(*c)))
            }));
            first
        });
        words[3 * i] = [first, image.width, image.height, flags(t)];
        let (m, d) = (t.transform.matrix2, t.transform.translation);
        words[3 * i + 1] = [m.x_axis.x, m.y_axis.x, d.x, 0.0].map(f32::to_bits);
        words[3 * i + 2] = [m.x_axis.y, m.y_axis.y, d.y, 0.0].map(f32::to_bits);
    }
    words
}

fn flags(t: &TextureRef) -> u32 {
    let wrap = |w: Wrap| match w {
        Wrap::Repeat => texture::WRAP_REPEAT,
        Wrap::MirroredRepeat => texture::WRAP_MIRROR,
        Wrap::ClampToEdge => texture::WRAP_CLAMP,
    };
    let flag = |holds: bool, bit: u32| if holds { bit } else { 0 };
    flag(t.color_space == ColorSpace::Srgb, texture::SRGB)
        | flag(t.uv_set == 1, texture::UV_SET)
        | flag(t.nearest, texture::NEAREST)
        | wrap(t.wrap[0]) << texture::WRAP_U_SHIFT
        | wrap(t.wrap[1]) << texture::WRAP_V_SHIFT
}
