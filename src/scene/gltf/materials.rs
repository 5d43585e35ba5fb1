//! glTF materials with their extensions, and the textures that they use.

use super::buffers::Buffers;
use super::document::Document;
use super::images::Images;
use super::notices::Notices;
use super::textures::{Slot, TextureReader};
use crate::Result;
use crate::scene::{AlphaMode, ColorSpace, Image, Material};
use glam::Vec3;
use gltf::json;
use gltf::json::extensions::material as extension;
use gltf::json::validation::Checked;

/// Reads all materials, in the file's order, and the images that they use.
pub(super) fn read(
    document: &Document,
    buffers: &Buffers,
    notices: &mut Notices,
) -> Result<(Vec<Material>, Vec<Image>)> {
    let mut images = Images::default();
    let mut materials = Vec::new();
    for (index, source) in document.root.materials.iter().enumerate() {
        let index = json::Index::new(index as u32);
        let place = document.label::<json::Material>(index);
        let textures =
            TextureReader { document, buffers, images: &mut images, notices, place: &place };
        let mut reader = MaterialReader { textures };
        let mut material = reader.core(source)?;
        material.name = document.name::<json::Material>(index);
        if let Some(extensions) = &source.extensions {
            reader.extensions(extensions, &mut material)?;
        }
        materials.push(material);
    }
    Ok((materials, images.into_images()))
}

/// Reads one material.
struct MaterialReader<'a> {
    textures: TextureReader<'a>,
}

impl MaterialReader<'_> {
    /// What glTF 2.0 itself defines.
    fn core(&mut self, source: &json::Material) -> Result<Material> {
        use ColorSpace::{Linear, Srgb};
        let pbr = &source.pbr_metallic_roughness;
        let [red, green, blue, alpha] = pbr.base_color_factor.0;
        let Checked::Valid(alpha_mode) = source.alpha_mode else {
            let place = self.textures.place;
            return Err(self.textures.document.error(format!("{place}: unknown alphaMode")));
        };
        let cutoff = source.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
        if source.occlusion_texture.is_some() {
            self.ignored("occlusionTexture: path tracing computes occlusion itself");
        }
        Ok(Material {
            base_color: self.unit_vec3([red, green, blue], "baseColorFactor"),
            base_color_texture: self.texture(pbr.base_color_texture.as_ref(), Srgb)?,
            metallic: self.unit(pbr.metallic_factor.0, "metallicFactor"),
            roughness: self.unit(pbr.roughness_factor.0, "roughnessFactor"),
            metallic_roughness_texture: self
                .texture(pbr.metallic_roughness_texture.as_ref(), Linear)?,
            normal_texture: match &source.normal_texture {
                Some(texture) => {
                    let place = self.textures.place;
                    let slot = Slot::from_normal(texture).map_err(|message| {
                        self.textures.document.error(format!("{place}: {message}"))
                    })?;
                    self.textures.read(slot, Linear)?
                }
                None => None,
            },
            normal_scale: match &source.normal_texture {
                Some(texture) => self.finite(texture.scale, "normalTexture.scale")?,
                None => 1.0,
            },
            emission: self.emission(source)?,
            emission_texture: self.texture(source.emissive_texture.as_ref(), Srgb)?,
            alpha_mode: match alpha_mode {
                json::material::AlphaMode::Opaque => AlphaMode::Opaque,
                json::material::AlphaMode::Mask => {
                    AlphaMode::Mask(self.non_negative(cutoff, "alphaCutoff")?)
                }
                json::material::AlphaMode::Blend => AlphaMode::Blend,
            },
            alpha: self.unit(alpha, "baseColorFactor alpha"),
            double_sided: source.double_sided,
            ..Material::default()
        })
    }

    /// emissiveFactor × emissiveStrength.
    fn emission(&mut self, source: &json::Material) -> Result<Vec3> {
        let factor = source.emissive_factor.0;
        if factor.iter().any(|&c| c > 1.0) {
            self.approximated("emissiveFactor above 1 is taken as it is");
        }
        let strength = source.extensions.as_ref().and_then(|e| e.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |strength| strength.emissive_strength.0);
        let strength = self.non_negative(strength, "emissiveStrength")?;
        let mut emission = Vec3::ZERO;
        for (channel, factor) in emission.as_mut().iter_mut().zip(factor) {
            let factor = self.non_negative(factor, "emissiveFactor")?;
            *channel = self.finite(factor * strength, "emissiveFactor × emissiveStrength")?;
        }
        Ok(emission)
    }

    /// The ratified extensions that are rendered.
    fn extensions(
        &mut self,
        extensions: &extension::Material,
        material: &mut Material,
    ) -> Result<()> {
        if let Some(ior) = &extensions.ior {
            material.ior = self.ior(ior.ior.0)?;
        }
        if let Some(specular) = &extensions.specular {
            material.specular = self.unit(specular.specular_factor.0, "specularFactor");
            for (channel, factor) in
                material.specular_color.as_mut().iter_mut().zip(specular.specular_color_factor.0)
            {
                *channel = self.non_negative(factor, "specularColorFactor")?;
            }
            if specular.specular_texture.is_some() || specular.specular_color_texture.is_some() {
                self.approximated("KHR_materials_specular by its factors, without its textures");
            }
        }
        if let Some(transmission) = &extensions.transmission {
            material.transmission =
                self.unit(transmission.transmission_factor.0, "transmissionFactor");
            if transmission.transmission_texture.is_some() {
                self.approximated("KHR_materials_transmission by its factor, without its texture");
            }
            if material.transmission > 0.0 && material.roughness > 0.0 {
                self.approximated("rough transmission rendered as smooth");
            }
        }
        if let Some(volume) = &extensions.volume {
            let thickness = self.non_negative(volume.thickness_factor.0, "thicknessFactor")?;
            material.volume = thickness > 0.0;
            if material.volume && volume.thickness_texture.is_some() {
                self.ignored("thicknessTexture: paths measure thickness themselves");
            }
            if material.volume
                && volume.attenuation_distance.0.is_finite()
                && volume.attenuation_color.0 != [1.0; 3]
            {
                self.ignored("attenuation of KHR_materials_volume: volumes are clear");
            }
        }
        Ok(())
    }

    /// An index of refraction. The extension gives 0 a meaning of its own.
    fn ior(&mut self, ior: f32) -> Result<f32> {
        let ior = self.finite(ior, "ior")?;
        if ior == 0.0 {
            self.approximated("ior 0 (reflects everything) rendered as 1.5");
            return Ok(Material::default().ior);
        }
        if ior < 1.0 {
            self.approximated("ior below 1 clamped to 1");
        }
        Ok(ior.max(1.0))
    }

    fn texture(
        &mut self,
        info: Option<&json::texture::Info>,
        color_space: ColorSpace,
    ) -> Result<Option<crate::scene::TextureRef>> {
        info.map_or(Ok(None), |info| self.textures.read(Slot::from_info(info), color_space))
    }

    fn unit(&mut self, value: f32, what: &str) -> f32 {
        let clamped = value.clamp(0.0, 1.0);
        if clamped != value {
            self.approximated(&format!("{what} outside [0, 1] clamped"));
        }
        clamped
    }

    fn unit_vec3(&mut self, values: [f32; 3], what: &str) -> Vec3 {
        Vec3::from(values.map(|value| self.unit(value, what)))
    }

    fn non_negative(&mut self, value: f32, what: &str) -> Result<f32> {
        if value < 0.0 {
            self.approximated(&format!("negative {what} clamped to 0"));
        }
        Ok(self.finite(value, what)?.max(0.0))
    }

    /// A JSON number may be too large for f32.
    fn finite(&mut self, value: f32, what: &str) -> Result<f32> {
        let TextureReader { document, place, .. } = &self.textures;
        match value.is_finite() {
            true => Ok(value),
            false => Err(document.error(format!("{place}: {what} is too large a number"))),
        }
    }

    fn approximated(&mut self, message: &str) {
        self.textures.notices.approximated(message, self.textures.place);
    }

    fn ignored(&mut self, message: &str) {
        self.textures.notices.ignored(message, self.textures.place);
    }
}
