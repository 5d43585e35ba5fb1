//! What the KHR_materials_ extensions say of scattering. Factors that switch a lobe off leave it
//! out. KHR_materials_unlit and _emissive_strength are in `materials`.

use super::materials::MaterialReader;
use super::members::Members;
use crate::Result;
use crate::scene::ColorSpace::{Linear, Srgb};
use crate::scene::{
    Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, Material, Sheen, SpecularGlossiness,
};
use glam::Vec3;

/// In place of the ior 0, by which KHR_materials_ior means that the dielectric reflects
/// everything: the reflectance ((n - 1) / (n + 1))² of this one is 1 in f32.
const PERFECT_IOR: f32 = 1e8;

/// The largest absorption coefficient, 1/m, in place of larger ones and of the infinite one of a
/// black attenuationColor. The smallest scene that is accepted, 1e-12 m, transmits exp(-1e8): 0.
const MOST_ABSORPTION: f32 = 1e20;

const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// Extensions of the metallic-roughness model, which exclude specular-glossiness.
const EXCLUDED: [&str; 10] = [
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_volume",
];

impl MaterialReader<'_, '_> {
    /// Reads them all into `material`.
    pub(super) fn extensions(&mut self, all: Members, material: &mut Material) -> Result<()> {
        if let Some(from) = self.checked(all.optional(SPECULAR_GLOSSINESS))? {
            for name in EXCLUDED.iter().filter(|name| all.has(name)) {
                self.ignored(&format!("{name} beside {SPECULAR_GLOSSINESS}, which excludes it"));
            }
            return self.specular_glossiness(from, material);
        }
        if let Some(from) = self.checked(all.optional("KHR_materials_ior"))? {
            let ior = self.checked(from.number("ior", 1.5))?;
            material.ior = self.ior(ior, "ior");
        }
        if let Some(from) = self.checked(all.optional("KHR_materials_specular"))? {
            material.specular = self.unit(from, "specularFactor", 1.0)?;
            material.specular_texture = self.texture(from, "specularTexture", Linear)?;
            material.specular_color =
                self.non_negative_color(from, "specularColorFactor", Vec3::ONE)?;
            material.specular_color_texture = self.texture(from, "specularColorTexture", Srgb)?;
        }
        if let Some(from) = self.checked(all.optional("KHR_materials_transmission"))? {
            material.transmission = self.unit(from, "transmissionFactor", 0.0)?;
            material.transmission_texture = self.texture(from, "transmissionTexture", Linear)?;
        }
        if let Some(from) = self.checked(all.optional("KHR_materials_volume"))? {
            self.volume(from, material)?;
        }
        if let Some(from) = self.checked(all.optional("KHR_materials_dispersion"))? {
            let dispersion = self.non_negative(from, "dispersion", 0.0)?;
            // Light is refracted into volumes only.
            material.dispersion = if material.volume { dispersion } else { 0.0 };
        }
        self.layers(all, material)
    }

    fn layers(&mut self, all: Members, material: &mut Material) -> Result<()> {
        if let Some(from) = self.checked(all.optional("KHR_materials_diffuse_transmission"))? {
            material.diffuse_transmission = self.diffuse_transmission(from)?;
        }
        if let Some(from) = self.checked(all.optional("KHR_materials_anisotropy"))? {
            material.anisotropy = self.anisotropy(from)?;
        }
        if let Some(from) = self.checked(all.optional("KHR_materials_iridescence"))? {
            material.iridescence = self.iridescence(from)?;
        }
        if let Some(from) = self.checked(all.optional("KHR_materials_sheen"))? {
            material.sheen = self.sheen(from)?;
        }
        if let Some(from) = self.checked(all.optional("KHR_materials_clearcoat"))? {
            material.clearcoat = self.clearcoat(from)?;
            if material.clearcoat.is_some() && material.is_emissive() {
                self.approximated("emission is not dimmed by the clearcoat above it");
            }
        }
        Ok(())
    }

    /// An index of refraction brought into [1, `PERFECT_IOR`], whose squares fit f32.
    fn ior(&mut self, ior: f32, what: &str) -> f32 {
        if ior == 0.0 {
            return PERFECT_IOR;
        }
        if ior < 1.0 {
            self.approximated(&format!("{what} below 1 clamped to 1"));
        }
        if ior > PERFECT_IOR {
            self.approximated(&format!("{what} above {PERFECT_IOR:e} clamped"));
        }
        ior.clamp(1.0, PERFECT_IOR)
    }

    fn specular_glossiness(&mut self, from: Members, material: &mut Material) -> Result<()> {
        let [red, green, blue, alpha] = self.checked(from.numbers("diffuseFactor", [1.0; 4]))?;
        let diffuse = self.clamped_unit([red, green, blue, alpha], "diffuseFactor");
        material.base_color = Vec3::new(diffuse[0], diffuse[1], diffuse[2]);
        material.alpha = diffuse[3];
        material.base_color_texture = self.texture(from, "diffuseTexture", Srgb)?;
        // These are the other model's.
        (material.metallic, material.roughness) = (0.0, 1.0);
        material.metallic_roughness_texture = None;
        material.specular_glossiness = Some(SpecularGlossiness {
            specular: self.unit_color(from, "specularFactor", Vec3::ONE)?,
            glossiness: self.unit(from, "glossinessFactor", 1.0)?,
            texture: self.texture(from, "specularGlossinessTexture", Srgb)?,
        });
        Ok(())
    }

    /// Thickness is measured by the paths; only that there is one counts.
    fn volume(&mut self, from: Members, material: &mut Material) -> Result<()> {
        material.volume = self.non_negative(from, "thicknessFactor", 0.0)? > 0.0;
        let distance = self.checked(from.number("attenuationDistance", f32::INFINITY))?;
        let color = self.unit_color(from, "attenuationColor", Vec3::ONE)?;
        if !material.volume {
            return Ok(());
        }
        if from.has("thicknessTexture") {
            self.ignored("thicknessTexture: paths measure thickness themselves");
        }
        if distance <= 0.0 {
            self.ignored("attenuationDistance that is not above 0: the volume is clear");
            return Ok(());
        }
        let distance = f64::from(distance);
        // -ln(1) is -0.
        let exact = color.as_dvec3().map(|c| (-c.ln() / distance).abs());
        if exact.max_element() > f64::from(MOST_ABSORPTION) {
            let message = format!(
                "absorption beyond {MOST_ABSORPTION:e} per metre (attenuationColor 0) taken as that"
            );
            self.approximated(&message);
        }
        material.absorption = exact.min(glam::DVec3::splat(MOST_ABSORPTION.into())).as_vec3();
        Ok(())
    }

    fn diffuse_transmission(&mut self, from: Members) -> Result<Option<DiffuseTransmission>> {
        let factor = self.unit(from, "diffuseTransmissionFactor", 0.0)?;
        let lobe = DiffuseTransmission {
            factor,
            texture: self.texture(from, "diffuseTransmissionTexture", Linear)?,
            color: self.unit_color(from, "diffuseTransmissionColorFactor", Vec3::ONE)?,
            color_texture: self.texture(from, "diffuseTransmissionColorTexture", Srgb)?,
        };
        Ok((factor > 0.0).then_some(lobe))
    }

    fn anisotropy(&mut self, from: Members) -> Result<Option<Anisotropy>> {
        let strength = self.unit(from, "anisotropyStrength", 0.0)?;
        let lobe = Anisotropy {
            strength,
            rotation: self.checked(from.number("anisotropyRotation", 0.0))?,
            texture: self.texture(from, "anisotropyTexture", Linear)?,
        };
        Ok((strength > 0.0).then_some(lobe))
    }

    fn iridescence(&mut self, from: Members) -> Result<Option<Iridescence>> {
        let factor = self.unit(from, "iridescenceFactor", 0.0)?;
        let ior = self.checked(from.number("iridescenceIor", 1.3))?;
        let film = Iridescence {
            factor,
            texture: self.texture(from, "iridescenceTexture", Linear)?,
            ior: self.ior(ior.max(f32::MIN_POSITIVE), "iridescenceIor"),
            thickness_minimum: self.non_negative(from, "iridescenceThicknessMinimum", 100.0)?,
            thickness_maximum: self.non_negative(from, "iridescenceThicknessMaximum", 400.0)?,
            thickness_texture: self.texture(from, "iridescenceThicknessTexture", Linear)?,
        };
        Ok((factor > 0.0).then_some(film))
    }

    fn sheen(&mut self, from: Members) -> Result<Option<Sheen>> {
        let color = self.unit_color(from, "sheenColorFactor", Vec3::ZERO)?;
        let sheen = Sheen {
            color,
            color_texture: self.texture(from, "sheenColorTexture", Srgb)?,
            roughness: self.unit(from, "sheenRoughnessFactor", 0.0)?,
            roughness_texture: self.texture(from, "sheenRoughnessTexture", Linear)?,
        };
        Ok((color != Vec3::ZERO).then_some(sheen))
    }

    fn clearcoat(&mut self, from: Members) -> Result<Option<Clearcoat>> {
        let factor = self.unit(from, "clearcoatFactor", 0.0)?;
        let (normal_texture, normal_scale) = self.normals(from, "clearcoatNormalTexture")?;
        let coat = Clearcoat {
            factor,
            texture: self.texture(from, "clearcoatTexture", Linear)?,
            roughness: self.unit(from, "clearcoatRoughnessFactor", 0.0)?,
            roughness_texture: self.texture(from, "clearcoatRoughnessTexture", Linear)?,
            normal_texture,
            normal_scale,
        };
        Ok((factor > 0.0).then_some(coat))
    }
}
