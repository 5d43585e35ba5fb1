//! A material's numbers at a point: factors and textures multiplied.

use super::bsdf::Film;
use super::surface::Surface;
use crate::scene::{Anisotropy, Clearcoat, Iridescence, Sheen};
use glam::{DVec2, DVec3};

/// What the scattering of a point depends on, beside its normals.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shading {
    pub(super) base: DVec3,
    pub(super) metallic: f64,
    pub(super) roughness: f64,
    pub(super) dielectric: Dielectric,
    /// The material's own index.
    pub(super) ior: f64,
    /// Share of the light under the interface that is transmitted.
    pub(super) transmission: f64,
    /// Whether the material transmits anywhere.
    pub(super) is_transmitting: bool,
    pub(super) is_volume: bool,
    /// Whether the point is seen from within the volume.
    pub(super) is_inside: bool,
    /// Index on the other side over that on this one; that of a thin surface over air.
    pub(super) passage_index: f64,
    /// Share of the diffuse light that leaves on the other side.
    pub(super) diffuse_transmission: f64,
    pub(super) diffuse_transmission_color: DVec3,
    pub(super) stretch: Option<Stretch>,
    pub(super) film: Option<Film>,
    pub(super) sheen: Option<SheenShading>,
    pub(super) coat: Option<CoatShading>,
}

/// Reflectance of the dielectric.
#[derive(Debug, Clone, Copy)]
pub(super) enum Dielectric {
    /// KHR_materials_specular over the index.
    Specular { strength: f64, color: DVec3 },
    /// KHR_materials_pbrSpecularGlossiness.
    Glossy { f0: DVec3 },
}

/// Anisotropy.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    pub(super) strength: f64,
    /// Unit, in the tangent plane of the shading normal before the normal map.
    pub(super) axis: DVec3,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct SheenShading {
    pub(super) color: DVec3,
    pub(super) roughness: f64,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct CoatShading {
    pub(super) factor: f64,
    pub(super) roughness: f64,
    /// On the side from which the surface is seen.
    pub(super) normal: DVec3,
}

impl Surface<'_> {
    /// The material here, seen from `wo`. What is beyond a volume's surface is not known here:
    /// `passage_index` is that of the material in air.
    pub(super) fn shading(&self, wo: DVec3) -> Shading {
        let m = self.material;
        let rough = self.texel(m.metallic_roughness_texture.as_ref());
        let transmission = self.texel(m.transmission_texture.as_ref()).x;
        let is_inside = m.is_boundary() && !self.is_front;
        let ior = f64::from(m.ior);
        let (diffuse_transmission, diffuse_transmission_color) =
            m.diffuse_transmission.as_ref().map_or((0.0, DVec3::ZERO), |d| {
                let share = f64::from(d.factor) * self.texel(d.texture.as_ref()).w;
                let color = self.texel(d.color_texture.as_ref()).truncate();
                (share, d.color.as_dvec3() * color)
            });
        let shading = Shading {
            base: self.base_color(),
            metallic: f64::from(m.metallic) * rough.z,
            roughness: f64::from(m.roughness) * rough.y,
            dielectric: Dielectric::Specular {
                strength: f64::from(m.specular) * self.texel(m.specular_texture.as_ref()).w,
                color: m.specular_color.as_dvec3()
                    * self.texel(m.specular_color_texture.as_ref()).truncate(),
            },
            ior,
            transmission: f64::from(m.transmission) * transmission,
            is_transmitting: m.transmission > 0.0,
            is_volume: m.volume,
            is_inside,
            passage_index: if is_inside { 1.0 / ior } else { ior },
            diffuse_transmission,
            diffuse_transmission_color,
            stretch: m.anisotropy.as_ref().and_then(|a| self.stretch(a)),
            film: m.iridescence.as_ref().map(|i| self.film(i)),
            sheen: m.sheen.as_ref().map(|s| self.sheen(s)),
            coat: m.clearcoat.as_ref().map(|c| self.coat(c, wo)),
        };
        self.glossy(shading)
    }

    /// With specular and glossiness in place of metallic and roughness, where the material says so.
    fn glossy(&self, shading: Shading) -> Shading {
        let Some(s) = &self.material.specular_glossiness else { return shading };
        let texel = self.texel(s.texture.as_ref());
        let f0 = s.specular.as_dvec3() * texel.truncate();
        Shading {
            base: shading.base * (1.0 - f0.max_element()),
            metallic: 0.0,
            roughness: 1.0 - f64::from(s.glossiness) * texel.w,
            dielectric: Dielectric::Glossy { f0 },
            ..shading
        }
    }

    /// `None` where the mesh has no tangents.
    fn stretch(&self, a: &Anisotropy) -> Option<Stretch> {
        let [tangent, bitangent] = self.tangents?;
        let texel = a.texture.as_ref().map(|t| self.texel(Some(t)));
        let along = texel.map_or(DVec2::X, |t| t.truncate().truncate() * 2.0 - 1.0);
        let along = along.try_normalize().unwrap_or(DVec2::X);
        let turned = DVec2::from_angle(a.rotation.into()).rotate(along);
        Some(Stretch {
            strength: f64::from(a.strength) * texel.map_or(1.0, |t| t.z),
            axis: tangent * turned.x + bitangent * turned.y,
        })
    }

    fn film(&self, i: &Iridescence) -> Film {
        let share = i.thickness_texture.as_ref().map_or(1.0, |t| self.texel(Some(t)).y);
        let (least, most) = (f64::from(i.thickness_minimum), f64::from(i.thickness_maximum));
        Film {
            factor: f64::from(i.factor) * self.texel(i.texture.as_ref()).x,
            ior: i.ior.into(),
            thickness: least + (most - least) * share,
        }
    }

    fn sheen(&self, s: &Sheen) -> SheenShading {
        SheenShading {
            color: s.color.as_dvec3() * self.texel(s.color_texture.as_ref()).truncate(),
            roughness: f64::from(s.roughness) * self.texel(s.roughness_texture.as_ref()).w,
        }
    }

    fn coat(&self, c: &Clearcoat, wo: DVec3) -> CoatShading {
        let normal = self.mapped_normal(c.normal_texture.as_ref(), c.normal_scale);
        CoatShading {
            factor: f64::from(c.factor) * self.texel(c.texture.as_ref()).x,
            roughness: f64::from(c.roughness) * self.texel(c.roughness_texture.as_ref()).y,
            normal: self.facing(normal, wo),
        }
    }
}
