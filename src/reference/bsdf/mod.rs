//! How a surface scatters: a coat over sheen over the base.
//!
//! `wo` and `wi` are unit and point away from the surface. Densities are per solid angle.

mod albedo;
mod base;
mod coat;
mod compensation;
mod film;
mod fresnel;
mod ggx;
mod sheen;

#[cfg(test)]
mod tests;

pub(super) use film::Film;

use super::random::Random;
use super::shading::Shading;
use base::Base;
use coat::Coat;
use ggx::Frame;
use glam::DVec3;
use sheen::Sheen;
use std::f64::consts::{FRAC_1_PI, TAU};

/// The scattering of one point, seen from `wo`.
#[derive(Debug)]
pub(super) struct Bsdf {
    wo: DVec3,
    ng: DVec3,
    ns: DVec3,
    base: Base,
    sheen: Option<Sheen>,
    coat: Option<Coat>,
    /// Probabilities with which directions are drawn from [`Lobe::ALL`].
    chances: [f64; 6],
}

/// What a direction can be drawn from.
#[derive(Debug, Clone, Copy)]
enum Lobe {
    Coat,
    Sheen,
    Reflection,
    Diffuse,
    Translucent,
    Transmission,
}

impl Lobe {
    const ALL: [Self; 6] = [
        Self::Coat,
        Self::Sheen,
        Self::Reflection,
        Self::Diffuse,
        Self::Translucent,
        Self::Transmission,
    ];
}

/// A direction before it is known what it is worth.
#[derive(Debug)]
enum Drawn {
    OfMany(DVec3),
    Only { wi: DVec3, weight: DVec3, is_through: bool },
}

/// A direction drawn from a BSDF.
#[derive(Debug)]
pub(super) struct Scattered {
    pub(super) wi: DVec3,
    /// BSDF times cosine over density.
    pub(super) weight: DVec3,
    /// `None`: the direction is the only one of its lobe.
    pub(super) pdf: Option<f64>,
    /// Whether it leaves on the other side.
    pub(super) is_through: bool,
}

impl Bsdf {
    /// `ng` and `ns` are on the side of `wo`. `compensate`: what microfacets lose is given back.
    pub(super) fn new(m: &Shading, wo: DVec3, (ng, ns): (DVec3, DVec3), compensate: bool) -> Self {
        let base = Base::new(m, wo, ns, compensate);
        let sheen = m.sheen.and_then(|s| Sheen::new(s.color, s.roughness, ns.dot(wo)));
        let coat = m.coat.filter(|coat| coat.factor > 0.0);
        let coat = coat.map(|c| Coat::new(c.factor, c.roughness, c.normal, wo));
        let mut bsdf = Self { wo, ng, ns, base, sheen, coat, chances: [0.0; 6] };
        let shares = Lobe::ALL.map(|lobe| bsdf.importance(lobe));
        let sum: f64 = shares.iter().sum();
        bsdf.chances = shares.map(|share| if sum > 0.0 { share / sum } else { 0.0 });
        bsdf
    }

    /// Roughly the share of light that a lobe scatters, and above 0 where it scatters any.
    fn importance(&self, lobe: Lobe) -> f64 {
        let base = &self.base;
        let cos = self.ns.dot(self.wo).min(1.0);
        // At the half vector Fresnel's term may be larger than here.
        let at_others = |is_rough: bool| if is_rough { 0.05 } else { 0.0 };
        let below = self.below_coat();
        match lobe {
            Lobe::Coat => self.coat.as_ref().map_or(0.0, |coat| coat.reflected),
            Lobe::Sheen => self.sheen.as_ref().map_or(0.0, |sheen| below * sheen.importance()),
            Lobe::Reflection => {
                let elsewhere = at_others(base.ggx.is_some()) * base.most_reflected();
                below * (base.reflectance(cos).max_element() + elsewhere)
            }
            Lobe::Diffuse => below * base.diffuse.max_element(),
            Lobe::Translucent => below * base.translucent.max_element(),
            Lobe::Transmission => {
                let elsewhere = at_others(base.is_transmission_rough());
                below * base.tint.max_element() * (base.entering(cos) + elsewhere)
            }
        }
    }

    /// Share of the light that the coat lets through.
    fn below_coat(&self) -> f64 {
        1.0 - self.coat.as_ref().map_or(0.0, |coat| coat.reflected)
    }

    /// What coat and sheen leave of the light that the base scatters towards `wi`.
    fn base_share(&self, wi: DVec3) -> f64 {
        let below_sheen =
            self.sheen.as_ref().map_or(1.0, |sheen| sheen.base_share(self.ns.dot(wi)));
        self.below_coat() * below_sheen
    }

    /// Whether a direction leaves on the other side.
    pub(super) fn is_through(&self, wi: DVec3) -> bool {
        self.ns.dot(wi) < 0.0
    }

    /// Whether the two normals agree on which side a direction is.
    fn is_consistent(&self, wi: DVec3) -> bool {
        (self.ns.dot(wi) > 0.0) == (self.ng.dot(wi) > 0.0)
    }

    /// Whether light from a given direction can be scattered, other than by what has one
    /// direction only.
    pub(super) fn is_continuous(&self) -> bool {
        let base = &self.base;
        let is_transmitting = base.tint.max_element() > 0.0;
        base.ggx.is_some()
            || base.diffuse.max_element() > 0.0
            || base.translucent.max_element() > 0.0
            || is_transmitting && base.is_transmission_rough()
            || self.sheen.is_some()
            || self.coat.as_ref().is_some_and(|coat| coat.ggx.is_some())
    }

    /// BSDF times the cosine of `wi`, without what has one direction only.
    pub(super) fn eval(&self, wi: DVec3) -> DVec3 {
        if !self.is_consistent(wi) || self.ns.dot(wi) == 0.0 {
            return DVec3::ZERO;
        }
        let mut value = self.base.eval(wi) * self.base_share(wi);
        if self.ns.dot(wi) > 0.0 {
            if let Some(sheen) = &self.sheen {
                value += sheen.eval(self.wo, wi, self.ns) * self.below_coat();
            }
            if let Some(coat) = &self.coat {
                value += coat.reflected * coat.eval(self.wo, wi);
            }
        }
        value
    }

    /// Density of `wi` among directions that [`eval`](Self::eval) is about: it falls short
    /// of 1 in all by the chance of the others.
    pub(super) fn pdf(&self, wi: DVec3) -> f64 {
        let cos_i = self.ns.dot(wi);
        let density = |lobe: Lobe| match lobe {
            Lobe::Coat => self.coat.as_ref().map_or(0.0, |coat| coat.pdf(self.wo, wi)),
            Lobe::Sheen if cos_i > 0.0 => 1.0 / TAU,
            Lobe::Diffuse => cos_i.max(0.0) * FRAC_1_PI,
            Lobe::Translucent => (-cos_i).max(0.0) * FRAC_1_PI,
            Lobe::Reflection => {
                self.base.ggx.as_ref().map_or(0.0, |ggx| ggx.reflection_pdf(self.wo, wi))
            }
            Lobe::Transmission => self.base.transmission_pdf(wi),
            Lobe::Sheen => 0.0,
        };
        let chances = Lobe::ALL.into_iter().zip(self.chances);
        chances.filter(|(_, c)| *c > 0.0).map(|(lobe, chance)| chance * density(lobe)).sum()
    }

    /// A direction; `None` if the light is absorbed.
    pub(super) fn sample(&self, random: &mut Random) -> Option<Scattered> {
        match self.draw(random)? {
            Drawn::OfMany(wi) => {
                let (value, pdf) = (self.eval(wi), self.pdf(wi));
                let is_through = self.is_through(wi);
                let weight = value / pdf;
                let scattered = Scattered { wi, weight, pdf: Some(pdf), is_through };
                (pdf > 0.0 && value.max_element() > 0.0).then_some(scattered)
            }
            Drawn::Only { wi, weight, is_through } => {
                // Unless the normals disagree on which side it is.
                let is_right = self.is_consistent(wi) && self.is_through(wi) == is_through;
                is_right.then_some(Scattered { wi, weight, pdf: None, is_through })
            }
        }
    }

    /// A direction with density [`pdf`](Self::pdf), or the only one of its lobe.
    fn draw(&self, random: &mut Random) -> Option<Drawn> {
        let mut choice = random.uniform();
        for (lobe, chance) in Lobe::ALL.into_iter().zip(self.chances) {
            if choice < chance {
                return self.draw_from(lobe, chance, random);
            }
            choice -= chance;
        }
        None
    }

    fn draw_from(&self, lobe: Lobe, chance: f64, random: &mut Random) -> Option<Drawn> {
        let (wo, ns, base) = (self.wo, self.ns, &self.base);
        let reflected = |half: DVec3| half * (2.0 * half.dot(wo)) - wo;
        Some(match (lobe, &base.ggx) {
            (Lobe::Coat, _) => {
                let coat = self.coat.as_ref()?;
                match &coat.ggx {
                    Some(ggx) => Drawn::OfMany(reflected(ggx.visible_normal(wo, random))),
                    None => Drawn::Only {
                        wi: coat.mirrored(wo),
                        weight: DVec3::splat(coat.reflected / chance),
                        is_through: false,
                    },
                }
            }
            (Lobe::Sheen, _) => {
                let (z, angle) = (random.uniform(), TAU * random.uniform());
                let sin = (1.0 - z * z).sqrt();
                let local = DVec3::new(sin * angle.cos(), sin * angle.sin(), z);
                Drawn::OfMany(Frame::around(ns).world(local))
            }
            (Lobe::Reflection, Some(ggx)) => {
                Drawn::OfMany(reflected(ggx.visible_normal(wo, random)))
            }
            (Lobe::Reflection, None) => {
                let wi = reflected(ns);
                let weight = base.reflectance(ns.dot(wo).min(1.0)) * self.base_share(wi);
                Drawn::Only { wi, weight: weight / chance, is_through: false }
            }
            (Lobe::Diffuse, _) => Drawn::OfMany(self.cosine(1.0, random)),
            (Lobe::Translucent, _) => Drawn::OfMany(self.cosine(-1.0, random)),
            (Lobe::Transmission, Some(ggx)) if base.is_transmission_rough() => {
                Drawn::OfMany(base.transmit(ggx.visible_normal(wo, random))?)
            }
            (Lobe::Transmission, _) => {
                let wi = base.transmit(ns)?;
                let weight = base.smooth_transmittance() * self.base_share(wi);
                Drawn::Only { wi, weight: weight / chance, is_through: true }
            }
        })
    }

    /// A direction above (`side` 1) or below (-1) with density |cos| / pi.
    fn cosine(&self, side: f64, random: &mut Random) -> DVec3 {
        let (x, y) = random.disk();
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        Frame::around(self.ns).world(DVec3::new(x, y, side * z))
    }
}
