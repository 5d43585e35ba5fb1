//! The base of a surface: a mixture of metal and dielectric, and what is under the dielectric.

use super::compensation;
use super::fresnel::{Fresnel, at_normal, refracted};
use super::ggx::{Frame, Ggx};
use crate::reference::shading::{Dielectric, Shading};
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;

/// Nearer to 1 than this, a relative index does not determine where a microfacet lies that
/// refracts one given direction to another: such a surface lets light pass as a smooth one.
const LEAST_INDEX_STEP: f64 = 1e-3;

/// The base, seen from `wo`.
#[derive(Debug)]
pub(super) struct Base {
    wo: DVec3,
    ns: DVec3,
    metallic: f64,
    metal: Fresnel,
    dielectric: Fresnel,
    /// Factors on the reflection of both, against what single scattering loses.
    boosts: [DVec3; 2],
    /// `None` for a mirror.
    pub(super) ggx: Option<Ggx>,
    /// Albedo of the diffuse lobe, under no interface.
    pub(super) diffuse: DVec3,
    /// Of the diffuse lobe on the other side.
    pub(super) translucent: DVec3,
    /// What of the light that enters is transmitted.
    pub(super) tint: DVec3,
    /// How.
    passage: Passage,
}

/// Ways through a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Passage {
    /// Thin and smooth.
    Straight,
    /// Thin, and as rough on the other side as on this.
    Thin,
    /// Smooth, into a medium whose index is so many times this one's.
    Smooth(f64),
    /// Rough, into such a medium.
    Rough(f64),
}

impl Base {
    pub(super) fn new(m: &Shading, wo: DVec3, ns: DVec3, compensate: bool) -> Self {
        let film = m.film.filter(|_| !m.is_inside);
        let metal = Fresnel { f0: m.base, f90: DVec3::ONE, index: None, film };
        let index = m.is_transmitting.then_some(m.passage_index);
        let (f0, f90) = match m.dielectric {
            Dielectric::Glossy { f0 } => (f0, DVec3::ONE),
            Dielectric::Specular { strength, color } => {
                let at_normal = at_normal(index.unwrap_or(m.ior));
                ((color * at_normal).min(DVec3::ONE) * strength, DVec3::splat(strength))
            }
        };
        let alpha = m.roughness * m.roughness;
        let stretch = m.stretch.filter(|s| s.strength > 0.0);
        let stretched = stretch.and_then(|s| {
            let along = alpha + (1.0 - alpha) * s.strength * s.strength;
            Some(Ggx::stretched([along, alpha], Frame::along(s.axis, ns)?))
        });
        let ggx = stretched.or_else(|| Ggx::isotropic(alpha, ns));
        let boosts = [m.base, f0].map(|f0| match &ggx {
            Some(ggx) if compensate => compensation::factor(f0, ns.dot(wo), ggx.mean_alpha()),
            _ => DVec3::ONE,
        });
        let under = m.base * (1.0 - m.metallic);
        let behind = m.diffuse_transmission_color * (1.0 - m.metallic);
        Self {
            wo,
            ns,
            metallic: m.metallic,
            metal,
            dielectric: Fresnel { f0, f90, index, film },
            boosts,
            diffuse: under * ((1.0 - m.transmission) * (1.0 - m.diffuse_transmission)),
            translucent: behind * ((1.0 - m.transmission) * m.diffuse_transmission),
            tint: under * m.transmission,
            passage: match (m.is_volume, &ggx) {
                (false, None) => Passage::Straight,
                (false, Some(_)) => Passage::Thin,
                (true, Some(_)) if (m.passage_index - 1.0).abs() >= LEAST_INDEX_STEP => {
                    Passage::Rough(m.passage_index)
                }
                (true, _) => Passage::Smooth(m.passage_index),
            },
            ggx,
        }
    }

    /// Reflectance of metal and dielectric together.
    pub(super) fn reflectance(&self, cos: f64) -> DVec3 {
        let [metal, dielectric] = self.boosts;
        self.metal.at(cos) * metal * self.metallic
            + self.dielectric.at(cos) * dielectric * (1.0 - self.metallic)
    }

    /// About the most that is reflected at any angle; 0 where nothing ever is.
    pub(super) fn most_reflected(&self) -> f64 {
        let of_film = self.dielectric.film.map_or(0.0, |film| film.factor);
        let dielectric = self.dielectric.f90.max_element().max(of_film);
        self.metallic + (1.0 - self.metallic) * dielectric
    }

    /// Share of the light that enters the dielectric.
    pub(super) fn entering(&self, cos: f64) -> f64 {
        1.0 - self.dielectric.at(cos).max_element()
    }

    /// Whether transmitted light has more than one direction.
    pub(super) fn is_transmission_rough(&self) -> bool {
        matches!(self.passage, Passage::Thin | Passage::Rough(_))
    }

    /// BSDF times cosine, without what has one direction only.
    pub(super) fn eval(&self, wi: DVec3) -> DVec3 {
        let cos_i = self.ns.dot(wi);
        let up = self.upwards(wi);
        let cos_h = self.wo.dot((self.wo + up).normalize()).min(1.0);
        let under = self.entering(cos_h) * cos_i.abs() * FRAC_1_PI;
        if cos_i > 0.0 {
            let rough = self.ggx.as_ref().map(|ggx| ggx.reflection(self.wo, wi));
            return self.diffuse * under + self.reflectance(cos_h) * rough.unwrap_or(0.0);
        }
        let transmitted = match (&self.ggx, self.passage) {
            (Some(ggx), Passage::Thin) => self.entering(cos_h) * ggx.reflection(self.wo, up),
            (Some(ggx), Passage::Rough(index)) => self.refraction(ggx, index, wi),
            _ => 0.0,
        };
        self.translucent * under + self.tint * transmitted
    }

    /// Walter et al. (2007), equation 21, times the cosine of `wi`.
    fn refraction(&self, ggx: &Ggx, index: f64, wi: DVec3) -> f64 {
        let wo = self.wo;
        let Some((half, jacobian)) = self.refracting(index, wi) else { return 0.0 };
        let shape = ggx.distribution(half) * ggx.masking(wo) * ggx.masking(wi);
        // Radiance is less by the square of the index where that is less.
        let value = shape * wo.dot(half) * jacobian / (self.ns.dot(wo) * index * index);
        value * self.entering(wo.dot(half).min(1.0))
    }

    /// The microfacet on the side of `wo` that refracts `wo` to `wi`, and solid angle of such
    /// normals over that of `wi`.
    fn refracting(&self, index: f64, wi: DVec3) -> Option<(DVec3, f64)> {
        let half = (self.wo + wi * index).normalize();
        let half = half * self.ns.dot(half).signum();
        let (cos_o, cos_i) = (self.wo.dot(half), wi.dot(half));
        let jacobian = cos_i.abs() / (cos_i + cos_o / index).powi(2);
        (cos_o > 0.0 && cos_i < 0.0).then_some((half, jacobian))
    }

    /// Density of the directions that [`transmit`](Self::transmit) draws.
    pub(super) fn transmission_pdf(&self, wi: DVec3) -> f64 {
        match (&self.ggx, self.passage) {
            (Some(ggx), Passage::Thin) => ggx.reflection_pdf(self.wo, self.mirrored(wi)),
            (Some(ggx), Passage::Rough(index)) => self
                .refracting(index, wi)
                .map_or(0.0, |(half, jacobian)| ggx.normal_pdf(self.wo, half) * jacobian),
            _ => 0.0,
        }
    }

    /// Where light goes through a microfacet with normal `half`.
    pub(super) fn transmit(&self, half: DVec3) -> Option<DVec3> {
        match self.passage {
            Passage::Straight => Some(-self.wo),
            Passage::Thin => Some(self.mirrored(half * (2.0 * half.dot(self.wo)) - self.wo)),
            Passage::Smooth(index) | Passage::Rough(index) => refracted(self.wo, half, index),
        }
    }

    /// What a smooth surface makes of the light that it transmits.
    pub(super) fn smooth_transmittance(&self) -> DVec3 {
        let compression =
            if let Passage::Smooth(index) = self.passage { index * index } else { 1.0 };
        self.tint * (self.entering(self.ns.dot(self.wo).min(1.0)) / compression)
    }

    /// The mirror image in the surface.
    fn mirrored(&self, w: DVec3) -> DVec3 {
        w - self.ns * (2.0 * self.ns.dot(w))
    }

    fn upwards(&self, wi: DVec3) -> DVec3 {
        if self.ns.dot(wi) < 0.0 { self.mirrored(wi) } else { wi }
    }
}
