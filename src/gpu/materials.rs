//! Materials and textures as the device reads them.

use super::GpuMaterial;
use super::split::OTHER_BUFFERS;
use crate::scene::{AlphaMode, ColorSpace, Image, Material, Scene, TextureRef, Wrap};
use crate::shader::generated::{INVALID, material, texture};
use std::borrow::Cow;

/// `materials` and `textures`.
pub(super) struct Materials {
    pub(super) records: Vec<GpuMaterial>,
    /// Descriptors, then texels.
    textures: Vec<[u32; 4]>,
    descriptor_count: usize,
}

/// The variables that hold the words of [`Materials`]' textures, one after the other; where one
/// buffer can hold all, only the first is used.
pub(super) const TEXTURE_BUFFERS: [&str; 4] =
    ["textures", "textures_1", "textures_2", "textures_3"];

/// How textures are spread over buffers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Spread {
    /// All in the first.
    One,
    /// `1 << shift` words in each but the last.
    Many { shift: u32 },
}

impl Spread {
    /// Of `bytes` over bindings of at most `limit` bytes where `most_buffers` can be bound;
    /// nothing where they do not suffice.
    pub(super) fn of(bytes: u64, limit: u64, most_buffers: u32) -> Option<Self> {
        if bytes <= limit {
            return Some(Self::One);
        }
        let shift = (limit / 16).checked_ilog2()?;
        let buffers = bytes.div_ceil(16 << shift);
        let extra = TEXTURE_BUFFERS.len() as u32 - 1;
        let fits = buffers <= TEXTURE_BUFFERS.len() as u64 && most_buffers >= OTHER_BUFFERS + extra;
        fits.then_some(Self::Many { shift })
    }
}

impl Materials {
    /// Bytes of all textures.
    pub(super) fn texture_bytes(&self) -> usize {
        size_of_val(self.textures.as_slice())
    }

    /// The contents of the buffers, by [`TEXTURE_BUFFERS`]. The descriptors, which are in the
    /// first, tell the shift.
    pub(super) fn texture_buffers(&self, spread: Spread) -> Vec<Cow<'_, [[u32; 4]]>> {
        let Spread::Many { shift } = spread else { return vec![self.textures.as_slice().into()] };
        let mut buffers: Vec<Cow<[[u32; 4]]>> =
            self.textures.chunks(1 << shift).map(Cow::Borrowed).collect();
        for descriptor in 0..self.descriptor_count {
            buffers[0].to_mut()[3 * descriptor + 1][3] = shift;
        }
        buffers
    }

    /// Bytes of the descriptors, which the first buffer must hold.
    pub(super) fn descriptor_bytes(&self) -> usize {
        3 * 16 * self.descriptor_count
    }
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
            let mut slot = |t: Option<TextureRef>| {
                if used.contains(&i) { descriptors.index_of(t) } else { INVALID }
            };
            record(&m.without_shading(), &mut slot)
        })
        .collect();
    let descriptor_count = descriptors.list.len();
    Materials { records, textures: pack(&descriptors.list, &scene.images), descriptor_count }
}

/// `slot` numbers a texture.
fn record(m: &Material, slot: &mut dyn FnMut(Option<TextureRef>) -> u32) -> GpuMaterial {
    let flag = |holds: bool, bit: u32| if holds { bit } else { 0 };
    let mut gpu = GpuMaterial {
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
            | flag(m.unlit, material::UNLIT)
            | flag(m.specular_glossiness.is_some(), material::SPECULAR_GLOSSINESS),
        base_color_texture: slot(m.base_color_texture),
        metallic_roughness_texture: slot(m.metallic_roughness_texture),
        normal_texture: slot(m.normal_texture),
        emission_texture: slot(m.emission_texture),
        specular_texture: slot(m.specular_texture),
        specular_color_texture: slot(m.specular_color_texture),
        absorption: m.absorption.into(),
        dispersion: m.dispersion,
        transmission_texture: slot(m.transmission_texture),
        ..no_extension()
    };
    extensions(&mut gpu, m, slot);
    gpu
}

/// A material without any of the extensions that [`extensions`] writes.
fn no_extension() -> GpuMaterial {
    GpuMaterial {
        anisotropy_cos: 1.0,
        film_ior: 1.0,
        diffuse_transmission_texture: INVALID,
        diffuse_transmission_color_texture: INVALID,
        anisotropy_texture: INVALID,
        iridescence_texture: INVALID,
        film_texture: INVALID,
        sheen_color_texture: INVALID,
        sheen_roughness_texture: INVALID,
        clearcoat_texture: INVALID,
        clearcoat_roughness_texture: INVALID,
        clearcoat_normal_texture: INVALID,
        specular_glossiness_texture: INVALID,
        ..bytemuck::Zeroable::zeroed()
    }
}

fn extensions(
    gpu: &mut GpuMaterial,
    m: &Material,
    slot: &mut dyn FnMut(Option<TextureRef>) -> u32,
) {
    if let Some(s) = &m.specular_glossiness {
        gpu.specular_color = s.specular.into();
        gpu.specular = 1.0;
        gpu.roughness = s.glossiness;
        gpu.specular_glossiness_texture = slot(s.texture);
    }
    if let Some(d) = &m.diffuse_transmission {
        gpu.diffuse_transmission = d.factor;
        gpu.diffuse_transmission_color = d.color.into();
        gpu.diffuse_transmission_texture = slot(d.texture);
        gpu.diffuse_transmission_color_texture = slot(d.color_texture);
    }
    if let Some(a) = &m.anisotropy {
        gpu.anisotropy = a.strength;
        (gpu.anisotropy_sin, gpu.anisotropy_cos) = a.rotation.sin_cos();
        gpu.anisotropy_texture = slot(a.texture);
    }
    if let Some(i) = &m.iridescence {
        gpu.iridescence = i.factor;
        gpu.film_ior = i.ior;
        (gpu.film_minimum, gpu.film_maximum) = (i.thickness_minimum, i.thickness_maximum);
        gpu.iridescence_texture = slot(i.texture);
        gpu.film_texture = slot(i.thickness_texture);
    }
    if let Some(s) = &m.sheen {
        gpu.sheen_color = s.color.into();
        gpu.sheen_roughness = s.roughness;
        gpu.sheen_color_texture = slot(s.color_texture);
        gpu.sheen_roughness_texture = slot(s.roughness_texture);
    }
    if let Some(c) = &m.clearcoat {
        gpu.clearcoat = c.factor;
        gpu.clearcoat_roughness = c.roughness;
        gpu.clearcoat_normal_scale = c.normal_scale;
        gpu.clearcoat_texture = slot(c.texture);
        gpu.clearcoat_roughness_texture = slot(c.roughness_texture);
        gpu.clearcoat_normal_texture = slot(c.normal_texture);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textures_spread_over_as_many_buffers_as_they_need() {
        let mebibytes = |n: u64| n << 20;
        assert_eq!(Spread::of(mebibytes(128), mebibytes(128), 9), Some(Spread::One));
        let two = Spread::of(mebibytes(128) + 16, mebibytes(128), 12);
        assert_eq!(two, Some(Spread::Many { shift: 23 }));
        assert_eq!(Spread::of(mebibytes(512), mebibytes(128), 12), two);
        assert_eq!(Spread::of(mebibytes(512) + 16, mebibytes(128), 12), None);
        // Three more variables must fit.
        assert_eq!(Spread::of(mebibytes(129), mebibytes(128), 11), None);
        // Parts are powers of two, wholes need not be.
        assert_eq!(Spread::of(100, 100, 9), Some(Spread::One));
        assert_eq!(Spread::of(112, 100, 12), Some(Spread::Many { shift: 2 }));
        assert_eq!(Spread::of(1, 0, 12), None);
    }
}
