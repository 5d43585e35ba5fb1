//! Fibres that stand on the surface: KHR_materials_sheen, after Estevez and Kulla (2017).

use super::albedo::AlbedoTable;
use crate::statistics::integrate_rectangle;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Directional albedo of white sheen.
static ALBEDO: AlbedoTable = AlbedoTable::new(albedo);

/// Sheen of one colour.
#[derive(Debug)]
pub(super) struct Sheen {
    color: DVec3,
    alpha: f64,
    /// Largest component of the colour times the albedo towards the eye.
    taken: f64,
    /// Albedo of white towards the eye; may exceed 1.
    white: f64,
}

impl Sheen {
    /// `None` without a colour.
    pub(super) fn new(color: DVec3, roughness: f64, cos_o: f64) -> Option<Self> {
        let alpha = (roughness * roughness).max(1e-3);
        let white = ALBEDO.at(cos_o, alpha);
        let taken = color.max_element() * white.min(1.0);
        (color.max_element() > 0.0).then_some(Self { color, alpha, taken, white })
    }

    /// The share of light that the base keeps where it scatters it to a cosine of `cos_i`.
    pub(super) fn base_share(&self, cos_i: f64) -> f64 {
        let of_i = ALBEDO.at(cos_i.abs(), self.alpha).min(1.0);
        1.0 - self.taken.max(self.color.max_element() * of_i)
    }

    /// Roughly the share of light that is scattered here.
    pub(super) fn importance(&self) -> f64 {
        self.taken + 0.05 * self.color.max_element()
    }

    /// BRDF times cosine for directions above the surface. The fit reflects more than arrives
    /// where fibres are smooth and the light grazes: there it is divided by its own albedo.
    pub(super) fn eval(&self, wo: DVec3, wi: DVec3, normal: DVec3) -> DVec3 {
        let half = (wo + wi).normalize();
        let sin = normal.cross(half).length();
        let excess = self.white.max(ALBEDO.at(normal.dot(wi), self.alpha)).max(1.0);
        self.color * (value(sin, normal.dot(wo), normal.dot(wi), self.alpha) / excess)
    }
}

/// D V cos_i for white.
fn value(sin_half: f64, cos_o: f64, cos_i: f64, alpha: f64) -> f64 {
    let distribution = (2.0 + 1.0 / alpha) * sin_half.powf(1.0 / alpha) / TAU;
    distribution / ((1.0 + lambda(cos_o, alpha) + lambda(cos_i, alpha)) * 4.0 * cos_o)
}

/// The fit of Smith's function to this distribution.
fn lambda(cos: f64, alpha: f64) -> f64 {
    let mix = (1.0 - alpha).powi(2);
    let [a, b, c, d, e] = [
        [21.5473, 25.3245],
        [3.82987, 3.32435],
        [0.19823, 0.16801],
        [-1.97760, -1.27393],
        [-4.32054, -4.85967],
    ]
    .map(|[rough, fine]| rough + (fine - rough) * mix);
    let fit = |x: f64| a / (1.0 + b * x.powf(c)) + d * x + e;
    if cos < 0.5 { fit(cos).exp() } else { (2.0 * fit(0.5) - fit(1.0 - cos)).exp() }
}

/// Integral of [`value`] over the hemisphere, to 1e-7: over azimuths from behind, and over
/// cosines, which are stretched near 0 and 1 and cut where the fit has a bend.
pub(super) fn albedo(cos_o: f64, alpha: f64) -> f64 {
    let sin_o = (1.0 - cos_o * cos_o).max(0.0).sqrt();
    let over = |from: f64, to: f64, power: i32| {
        let f = |t: f64, s: f64| {
            // dx = power t^(power-1) |to - from| dt, and phi = pi s² away from wo's azimuth.
            let stretch = f64::from(power) * t.powi(power - 1) * (to - from).abs();
            let (cos_i, phi) = (from + (to - from) * t.powi(power), PI * s * s);
            let sin_i = (1.0 - cos_i * cos_i).max(0.0).sqrt();
            // Towards where wo comes from h lies flat.
            let half = DVec3::new(sin_o - sin_i * phi.cos(), sin_i * phi.sin(), cos_o + cos_i);
            let sin_half = half.truncate().length() / half.length();
            // Both halves of the circle.
            2.0 * value(sin_half, cos_o, cos_i, alpha) * stretch * (TAU * s)
        };
        integrate_rectangle(&f, (0.0, 1.0), (0.0, 1.0), 1e-7, 1e-8)
    };
    over(0.0, 0.5, 4) + over(1.0, 0.5, 4)
}
