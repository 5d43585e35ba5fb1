//! Materials: glTF metallic-roughness and the extensions that are rendered.
//!
//! A texture multiplies the factor of its name; the channels that it takes are told beside it.

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
    /// KHR_materials_pbrSpecularGlossiness in place of metallic and roughness, which are 0 and
    /// 1 then; `base_color` is the diffuse colour.
    pub specular_glossiness: Option<SpecularGlossiness>,
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
    /// KHR_materials_unlit: emits its base colour, with textures and vertex colours, from both
    /// sides, and scatters nothing.
    pub unlit: bool,
    /// Index of refraction (KHR_materials_ior), at least 1; 1.5 by default.
    pub ior: f32,
    /// KHR_materials_dispersion: 20 over the Abbe number; 0 is none.
    pub dispersion: f32,
    /// KHR_materials_specular: strength of the dielectric's reflection.
    pub specular: f32,
    /// Alpha multiplies `specular`.
    pub specular_texture: Option<TextureRef>,
    /// KHR_materials_specular: multiplies the dielectric's f0, linear.
    pub specular_color: Vec3,
    /// Colour (sRGB) multiplies `specular_color`.
    pub specular_color_texture: Option<TextureRef>,
    /// KHR_materials_transmission: share of the diffuse base that transmits instead.
    pub transmission: f32,
    /// Red multiplies `transmission`.
    pub transmission_texture: Option<TextureRef>,
    /// Closed volume (KHR_materials_volume with a thickness above 0): light
    /// refracts. Otherwise a transmitting surface is infinitely thin.
    pub volume: bool,
    /// KHR_materials_volume: absorption coefficient of the inside, 1/m in world space:
    /// -ln(attenuationColor) / attenuationDistance.
    pub absorption: Vec3,
    /// KHR_materials_diffuse_transmission.
    pub diffuse_transmission: Option<DiffuseTransmission>,
    /// KHR_materials_anisotropy.
    pub anisotropy: Option<Anisotropy>,
    /// KHR_materials_iridescence.
    pub iridescence: Option<Iridescence>,
    /// KHR_materials_sheen.
    pub sheen: Option<Sheen>,
    /// KHR_materials_clearcoat.
    pub clearcoat: Option<Clearcoat>,
}

/// KHR_materials_pbrSpecularGlossiness.
#[derive(Debug, Clone, PartialEq)]
pub struct SpecularGlossiness {
    /// Reflectance at normal incidence, linear.
    pub specular: Vec3,
    /// 1 - roughness.
    pub glossiness: f32,
    /// Colour (sRGB) multiplies `specular`, alpha `glossiness`.
    pub texture: Option<TextureRef>,
}

/// KHR_materials_diffuse_transmission: a part of the diffuse lobe that leaves on the other side.
#[derive(Debug, Clone, PartialEq)]
pub struct DiffuseTransmission {
    /// The part, in [0, 1].
    pub factor: f32,
    /// Alpha multiplies `factor`.
    pub texture: Option<TextureRef>,
    /// Linear colour of that light, in place of the base colour.
    pub color: Vec3,
    /// Colour (sRGB) multiplies `color`.
    pub color_texture: Option<TextureRef>,
}

/// KHR_materials_anisotropy: highlights that are stretched along a direction of the surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Anisotropy {
    /// In [0, 1].
    pub strength: f32,
    /// Of the direction, radians, counter-clockwise from the tangent.
    pub rotation: f32,
    /// Red and green: the direction in [-1, 1], which `rotation` turns. Blue multiplies `strength`.
    pub texture: Option<TextureRef>,
}

/// KHR_materials_iridescence: a thin film over the specular reflection of the base.
#[derive(Debug, Clone, PartialEq)]
pub struct Iridescence {
    /// In [0, 1].
    pub factor: f32,
    /// Red multiplies `factor`.
    pub texture: Option<TextureRef>,
    /// The film's index of refraction, at least 1.
    pub ior: f32,
    /// Thickness of the film, nm, where the texture's green is 0; without a texture it is not used.
    pub thickness_minimum: f32,
    /// Thickness of the film, nm, where the texture's green is 1, and without a texture.
    pub thickness_maximum: f32,
    /// Green mixes the two.
    pub thickness_texture: Option<TextureRef>,
}

/// KHR_materials_sheen: back-scattering fibres above the base.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheen {
    /// Linear reflectance at grazing incidence.
    pub color: Vec3,
    /// Colour (sRGB) multiplies `color`.
    pub color_texture: Option<TextureRef>,
    /// Artist's roughness in [0, 1]; the distribution's alpha is its square.
    pub roughness: f32,
    /// Alpha multiplies `roughness`.
    pub roughness_texture: Option<TextureRef>,
}

/// KHR_materials_clearcoat: a transparent dielectric layer of index 1.5 above all else.
#[derive(Debug, Clone, PartialEq)]
pub struct Clearcoat {
    /// In [0, 1].
    pub factor: f32,
    /// Red multiplies `factor`.
    pub texture: Option<TextureRef>,
    /// Artist's roughness in [0, 1]; GGX alpha is its square.
    pub roughness: f32,
    /// Green multiplies `roughness`.
    pub roughness_texture: Option<TextureRef>,
    /// The layer's own tangent-space normals; without, it follows the vertices' normals.
    pub normal_texture: Option<TextureRef>,
    /// Scales x and y of those.
    pub normal_scale: f32,
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
            specular_glossiness: None,
            emission: Vec3::ZERO,
            emission_texture: None,
            alpha_mode: AlphaMode::Opaque,
            alpha: 1.0,
            double_sided: false,
            unlit: false,
            ior: 1.5,
            dispersion: 0.0,
            specular: 1.0,
            specular_texture: None,
            specular_color: Vec3::ONE,
            specular_color_texture: None,
            transmission: 0.0,
            transmission_texture: None,
            volume: false,
            absorption: Vec3::ZERO,
            diffuse_transmission: None,
            anisotropy: None,
            iridescence: None,
            sheen: None,
            clearcoat: None,
        }
    }
}

impl Material {
    /// Whether any light leaves this material by itself.
    pub fn is_emissive(&self) -> bool {
        self.emitted().0.max_element() > 0.0
    }

    /// Radiance that it emits, W/(sr m²), and the texture that multiplies it: of an unlit material
    /// the base colour and its texture.
    pub fn emitted(&self) -> (Vec3, Option<TextureRef>) {
        match self.unlit {
            true => (self.base_color, self.base_color_texture),
            false => (self.emission, self.emission_texture),
        }
    }

    /// Whether its back emits too.
    pub fn emits_behind(&self) -> bool {
        self.double_sided || self.unlit
    }

    /// Whether it is the boundary of a volume that light enters.
    pub fn is_boundary(&self) -> bool {
        self.volume
            && !self.unlit
            && (self.transmission > 0.0 || self.diffuse_transmission.is_some())
    }
}
