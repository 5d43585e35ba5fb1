//! Materials: glTF metallic-roughness and the extensions that are rendered.

use super::TextureRef;
use glam::Vec3;

/// How a surface scatters and emits. Factors multiply their textures.
#[derive(Debug, Clone)]
pub struct Material {
    /// Name in the file.
    pub name: String,
    /// Linear base colour, each component in [0, 1].
    pub base_color: Vec3,
    /// Base colour (sRGB) with alpha.
    pub base_color_texture: Option<TextureRef>,
    /// 0 dielectric, 1 metal.
    pub metallic: f32,
    /// Artist's roughness in [0, 1]; GGX alpha is its square.
    pub roughness: f32,
    /// Green: roughness, blue: metallic.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Tangent-space normals.
    pub normal_texture: Option<TextureRef>,
    /// Scales x and y of the tangent-space normal.
    pub normal_scale: f32,
    /// Emitted radiance, W/(sr m²): emissiveFactor × emissiveStrength.
    pub emission: Vec3,
    /// Multiplies `emission` (sRGB).
    pub emission_texture: Option<TextureRef>,
    /// What alpha means.
    pub alpha_mode: AlphaMode,
    /// Multiplies the base colour texture's alpha.
    pub alpha: f32,
    /// Emits from, and is normal-mapped on, both sides. A single-sided surface
    /// still blocks and scatters light on its back.
    pub double_sided: bool,
    /// Index of refraction (KHR_materials_ior), 1.5 by default.
    pub ior: f32,
    /// KHR_materials_specular: strength of the dielectric's reflection.
    pub specular: f32,
    /// KHR_materials_specular: multiplies the dielectric's f0, linear.
    pub specular_color: Vec3,
    /// KHR_materials_transmission: share of the diffuse base that transmits instead.
    pub transmission: f32,
    /// Closed volume (KHR_materials_volume with a thickness above 0): light
    /// refracts. Otherwise a transmitting surface is infinitely thin.
    pub volume: bool,
}

/// glTF's alpha modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    Opaque,
    /// Present where alpha is at least the cut-off.
    Mask(f32),
    /// Present with probability alpha.
    Blend,
}

impl Default for Material {
    /// glTF's default material: white, metallic 1, roughness 1.
    fn default() -> Self {
        Self {
            name: "default".into(),
            base_color: Vec3::ONE,
            base_color_texture: None,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            emission: Vec3::ZERO,
            emission_texture: None,
            alpha_mode: AlphaMode::Opaque,
            alpha: 1.0,
            double_sided: false,
            ior: 1.5,
            specular: 1.0,
            specular_color: Vec3::ONE,
            transmission: 0.0,
            volume: false,
        }
    }
}

impl Material {
    /// Whether any light leaves this material by itself.
    pub fn is_emissive(&self) -> bool {
        self.emission.max_element() > 0.0
    }
}
