//! How a surface scatters: a diffuse lobe and either GGX, a mirror, or a smooth interface.
//!
//! `wo` and `wi` are unit and point away from the surface. Densities are per solid angle.

use super::random::Random;
use super::surface::Shading;
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, PI};

/// GGX narrower than this is a mirror.
const LEAST_ALPHA: f64 = 1e-3;

/// The scattering of one point, seen from `wo`.
#[derive(Debug)]
pub(super) struct Bsdf {
    wo: DVec3,
    ng: DVec3,
    ns: DVec3,
    /// Albedo of the diffuse lobe under no coat.
    diffuse: DVec3,
    /// Grey Fresnel term of the coat over the diffuse lobe.
    coat: Schlick<f64>,
    specular: Specular,
    /// Probabilities with which a direction is drawn: diffuse, reflected, transmitted.
    chances: [f64; 3],
}

#[derive(Debug)]
enum Specular {
    Rough { alpha: f64, fresnel: Schlick<DVec3> },
    Mirror { fresnel: Schlick<DVec3> },
    Interface { reflected: f64, transmitted: Transmitted },
}

/// Light that a smooth interface lets through.
#[derive(Debug)]
struct Transmitted {
    wi: DVec3,
    weight: DVec3,
}

/// Schlick's Fresnel term.
#[derive(Debug, Clone, Copy)]
struct Schlick<T> {
    f0: T,
    f90: T,
}

impl<
    T: Copy + std::ops::Add<Output = T> + std::ops::Sub<Output = T> + std::ops::Mul<f64, Output = T>,
> Schlick<T>
{
    fn at(&self, cos: f64) -> T {
        self.f0 + (self.f90 - self.f0) * (1.0 - cos).powi(5)
    }
}

/// A direction drawn from a BSDF.
#[derive(Debug)]
pub(super) struct Scattered {
    pub(super) wi: DVec3,
    /// BSDF times cosine over density.
    pub(super) weight: DVec3,
    /// `None`: the direction is the only one of its lobe.
    pub(super) pdf: Option<f64>,
}

impl Bsdf {
    /// `ng` and `ns` are on the side of `wo`; `is_front`: that is the front.
    pub(super) fn new(m: &Shading, wo: DVec3, (ng, ns): (DVec3, DVec3), is_front: bool) -> Self {
        let dielectric = 1.0 - m.metallic;
        let at_normal = ((m.ior - 1.0) / (m.ior + 1.0)).powi(2);
        let f0 = (m.specular_color * at_normal).min(DVec3::ONE) * m.specular;
        let diffuse = m.base * dielectric * (1.0 - m.transmission);
        let through = m.base * dielectric * m.transmission;
        let cos_o = ns.dot(wo);
        let fresnel = Schlick {
            f0: f0 * dielectric + m.base * m.metallic,
            f90: DVec3::splat(dielectric * m.specular + m.metallic),
        };
        let alpha = if m.transmission > 0.0 { 0.0 } else { m.roughness * m.roughness };
        let specular = if through.max_element() > 0.0 {
            interface(through, m, wo, ns, is_front)
        } else if alpha < LEAST_ALPHA {
            Specular::Mirror { fresnel }
        } else {
            Specular::Rough { alpha, fresnel }
        };
        let shares = match &specular {
            // A little for reflection where the term is small now and larger at the half vector.
            Specular::Rough { .. } => fresnel.at(cos_o).max_element() + 0.05 * fresnel.f90.x,
            Specular::Mirror { .. } => fresnel.at(cos_o).max_element(),
            Specular::Interface { reflected, .. } => *reflected,
        };
        let transmitted = match &specular {
            Specular::Interface { transmitted, .. } => transmitted.weight.max_element(),
            _ => 0.0,
        };
        let shares = [diffuse.max_element(), shares, transmitted];
        let sum: f64 = shares.iter().sum();
        Self {
            wo,
            ng,
            ns,
            diffuse,
            coat: Schlick { f0: f0.max_element(), f90: m.specular },
            specular,
            chances: shares.map(|share| if sum > 0.0 { share / sum } else { 0.0 }),
        }
    }

    /// Whether light from a given direction can be scattered, other than by a mirror.
    pub(super) fn is_continuous(&self) -> bool {
        self.diffuse.max_element() > 0.0 || matches!(self.specular, Specular::Rough { .. })
    }

    /// BSDF times the cosine of `wi`, mirrors and smooth interfaces left out.
    pub(super) fn eval(&self, wi: DVec3) -> DVec3 {
        let (cos_o, cos_i) = (self.ns.dot(self.wo), self.ns.dot(wi));
        if cos_o <= 0.0 || cos_i <= 0.0 || self.ng.dot(wi) <= 0.0 {
            return DVec3::ZERO;
        }
        let half = (self.wo + wi).normalize();
        let cos_h = self.wo.dot(half).clamp(0.0, 1.0);
        let diffuse = self.diffuse * (FRAC_1_PI * cos_i * (1.0 - self.coat.at(cos_h)));
        let Specular::Rough { alpha, fresnel } = &self.specular else { return diffuse };
        let masking = 1.0 / (1.0 + smith_lambda(*alpha, cos_o) + smith_lambda(*alpha, cos_i));
        diffuse + fresnel.at(cos_h) * (self.ggx(*alpha, half) * masking / (4.0 * cos_o))
    }

    /// Density of `wi` among directions that [`eval`](Self::eval) is about: it falls short
    /// of 1 in all by the chance of the others.
    pub(super) fn pdf(&self, wi: DVec3) -> f64 {
        let (cos_o, cos_i) = (self.ns.dot(self.wo), self.ns.dot(wi));
        if cos_o <= 0.0 || cos_i <= 0.0 {
            return 0.0;
        }
        let diffuse = self.chances[0] * cos_i * FRAC_1_PI;
        let Specular::Rough { alpha, .. } = &self.specular else { return diffuse };
        let half = (self.wo + wi).normalize();
        let visible = self.ggx(*alpha, half) / (1.0 + smith_lambda(*alpha, cos_o));
        diffuse + self.chances[1] * visible / (4.0 * cos_o)
    }

    /// A direction; `None` if the light is absorbed.
    pub(super) fn sample(&self, random: &mut Random) -> Option<Scattered> {
        let choice = random.uniform();
        let [diffuse, reflected, transmitted] = self.chances;
        if choice < diffuse {
            let (x, y) = random.disk();
            return self.continuous(self.world(DVec3::new(
                x,
                y,
                (1.0 - x * x - y * y).max(0.0).sqrt(),
            )));
        }
        let is_reflected = choice < diffuse + reflected;
        let mirrored = self.ns * (2.0 * self.ns.dot(self.wo)) - self.wo;
        match &self.specular {
            Specular::Rough { alpha, .. } => {
                let half = self.world(visible_normal(*alpha, self.local(self.wo), random));
                self.continuous(half * (2.0 * half.dot(self.wo)) - self.wo)
            }
            Specular::Mirror { fresnel } if reflected > 0.0 => {
                self.single(mirrored, fresnel.at(self.ns.dot(self.wo)) / reflected)
            }
            Specular::Interface { reflected: fresnel, .. } if is_reflected => {
                self.single(mirrored, DVec3::splat(fresnel / reflected))
            }
            Specular::Interface { transmitted: through, .. } if transmitted > 0.0 => {
                self.single(through.wi, through.weight / transmitted)
            }
            _ => None,
        }
    }

    fn continuous(&self, wi: DVec3) -> Option<Scattered> {
        let (value, pdf) = (self.eval(wi), self.pdf(wi));
        (pdf > 0.0 && value.max_element() > 0.0).then(|| Scattered {
            wi,
            weight: value / pdf,
            pdf: Some(pdf),
        })
    }

    /// The only direction of a lobe, unless the two normals disagree on which side it is.
    fn single(&self, wi: DVec3, weight: DVec3) -> Option<Scattered> {
        let is_consistent = (self.ns.dot(wi) > 0.0) == (self.ng.dot(wi) > 0.0);
        is_consistent.then_some(Scattered { wi, weight, pdf: None })
    }

    /// The GGX distribution of microfacet normals: area per area of the surface and solid angle.
    fn ggx(&self, alpha: f64, half: DVec3) -> f64 {
        let (cos, sin) = (self.ns.dot(half), self.ns.cross(half).length());
        1.0 / (PI * (alpha * (cos * cos + (sin / alpha).powi(2))).powi(2))
    }

    fn local(&self, v: DVec3) -> DVec3 {
        let (x, y) = self.ns.any_orthonormal_pair();
        DVec3::new(v.dot(x), v.dot(y), v.dot(self.ns))
    }

    fn world(&self, v: DVec3) -> DVec3 {
        let (x, y) = self.ns.any_orthonormal_pair();
        x * v.x + y * v.y + self.ns * v.z
    }
}

/// Smith's function: the mean area in the shadow of a visible one.
fn smith_lambda(alpha: f64, cos: f64) -> f64 {
    let tan2 = (1.0 - cos * cos).max(0.0) / (cos * cos);
    ((1.0 + alpha * alpha * tan2).sqrt() - 1.0) / 2.0
}

/// A microfacet normal with density D G1 cos / cos_o, in the frame of the surface: the
/// reflections of `wo` stretched to a unit hemisphere are uniform on a spherical cap (Dupuy
/// and Benyoub 2023).
fn visible_normal(alpha: f64, wo: DVec3, random: &mut Random) -> DVec3 {
    let stretched = DVec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
    let z = 1.0 - random.uniform() * (1.0 + stretched.z);
    let angle = 2.0 * PI * random.uniform();
    let sin = (1.0 - z * z).max(0.0).sqrt();
    let half = DVec3::new(sin * angle.cos(), sin * angle.sin(), z) + stretched;
    DVec3::new(alpha * half.x, alpha * half.y, half.z).normalize()
}

/// A smooth dielectric: what it reflects, and what it lets through tinted by `tint`.
fn interface(tint: DVec3, m: &Shading, wo: DVec3, ns: DVec3, is_front: bool) -> Specular {
    // Index on the side of `wo` over index on the other side.
    let eta = if m.is_volume && !is_front { m.ior } else { 1.0 / m.ior };
    let cos_o = ns.dot(wo).clamp(0.0, 1.0);
    let sin2_t = eta * eta * (1.0 - cos_o * cos_o);
    if sin2_t >= 1.0 {
        let nothing = Transmitted { wi: -wo, weight: DVec3::ZERO };
        return Specular::Interface { reflected: 1.0, transmitted: nothing };
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    // Fresnel's amplitudes for the two polarisations.
    let across = (eta * cos_o - cos_t) / (eta * cos_o + cos_t);
    let within = (cos_o - eta * cos_t) / (cos_o + eta * cos_t);
    let reflected = 0.5 * (across * across + within * within);
    let weight = tint * (1.0 - reflected);
    let transmitted = if m.is_volume {
        let wi = (ns * (eta * cos_o - cos_t) - wo * eta).normalize();
        // Radiance over the square of the index is what an interface keeps.
        Transmitted { wi, weight: weight * eta * eta }
    } else {
        Transmitted { wi: -wo, weight }
    };
    Specular::Interface { reflected, transmitted }
}
