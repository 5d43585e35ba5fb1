//! What the materials of a scene need of the shaders.

use super::{Feature, Features};
use crate::scene::{AlphaMode, Material, Scene};

/// Below this GGX is a mirror: `LEAST_ALPHA` of `bsdf/width.wgsl`.
const LEAST_ALPHA: f32 = 1e-3;

impl Features {
    /// This set, and what the materials of anything in `scene` need.
    pub(super) fn with_materials(self, scene: &Scene) -> Self {
        let used = scene.used_materials();
        used.iter().fold(self, |set, &m| set.with_material(&scene.materials[m].without_shading()))
    }

    fn with_material(self, m: &Material) -> Self {
        let base = Widths::of_base(m).only_if(m.is_specular());
        let coat = m.clearcoat.as_ref().filter(|c| c.factor > 0.0);
        let transmits = m.transmission > 0.0;
        let is_rough_interface = transmits && Widths::of_base(m).rough;
        let is_diffuse_below = m.diffuse_transmission.as_ref().is_some_and(|d| d.factor > 0.0);
        let is_iridescent = m.has_film();
        self.with_if(Feature::Alpha, m.alpha_mode != AlphaMode::Opaque)
            .with_if(Feature::Textures, m.textures().next().is_some())
            .with_if(Feature::Ggx, base.rough || is_rough_interface || coat.is_some())
            .with_if(Feature::Delta, base.smooth || transmits || coat.is_some())
            .with_if(Feature::Transmission, transmits)
            .with_if(Feature::Media, m.is_boundary())
            .with_if(Feature::Unlit, m.unlit)
            .with_if(Feature::RoughTransmission, is_rough_interface)
            .with_if(Feature::TransmissionTexture, transmits && m.transmission_texture.is_some())
            .with_if(Feature::Dispersion, transmits && m.volume && m.dispersion > 0.0)
            .with_if(Feature::DiffuseTransmission, is_diffuse_below)
            .with_if(Feature::LowerLobes, is_rough_interface || is_diffuse_below)
            .with_if(Feature::SplitFresnel, transmits || is_iridescent)
            .with_if(
                Feature::SpecularTextures,
                m.specular_texture.is_some() || m.specular_color_texture.is_some(),
            )
            .with_if(Feature::SpecularGlossiness, m.specular_glossiness.is_some())
            .with_if(Feature::Anisotropy, m.is_anisotropic())
            .with_if(Feature::Iridescence, is_iridescent)
            .with_if(Feature::Sheen, m.sheen.as_ref().is_some_and(|s| s.color.max_element() > 0.0))
            .with_if(Feature::Clearcoat, coat.is_some())
            .with_if(Feature::ClearcoatNormal, coat.is_some_and(|c| c.normal_texture.is_some()))
    }
}

impl Material {
    fn is_specular(&self) -> bool {
        self.metallic > 0.0 || self.specular > 0.0 || self.has_film()
    }

    fn has_film(&self) -> bool {
        self.iridescence.as_ref().is_some_and(|i| i.factor > 0.0)
    }

    fn is_anisotropic(&self) -> bool {
        self.anisotropy.as_ref().is_some_and(|a| a.strength > 0.0)
    }
}

/// Which widths of GGX occur on a surface.
#[derive(Clone, Copy)]
struct Widths {
    smooth: bool,
    rough: bool,
}

impl Widths {
    fn of_base(m: &Material) -> Self {
        let is_smooth = |roughness: f32| roughness * roughness < LEAST_ALPHA;
        let isotropic = match &m.specular_glossiness {
            // A texture can only make it rougher.
            Some(s) => {
                let smooth = is_smooth(1.0 - s.glossiness);
                Self { smooth, rough: !smooth || s.texture.is_some() }
            }
            // A texture can bring the roughness of any texel down to 0.
            None => {
                let smooth = is_smooth(m.roughness);
                Self { smooth: smooth || m.metallic_roughness_texture.is_some(), rough: !smooth }
            }
        };
        // Where there is no tangent, or a texture says 0, the surface is isotropic.
        Self { rough: isotropic.rough || m.is_anisotropic(), ..isotropic }
    }

    fn only_if(self, holds: bool) -> Self {
        Self { smooth: self.smooth && holds, rough: self.rough && holds }
    }
}
