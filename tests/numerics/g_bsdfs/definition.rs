//! The lobes in f64 by their definitions. Directions have z along the normal and point away
//! from the surface.

use glam::DVec3;
use std::f64::consts::PI;

/// Density of GGX's microfacet normals, per steradian of h (Trowbridge and Reitz 1975).
pub(crate) fn d(alpha: f64, h: DVec3) -> f64 {
    let tan2 = (h.x * h.x + h.y * h.y) / (h.z * h.z);
    let cos4 = (h.z * h.z / h.length_squared()).powi(2);
    1.0 / (PI * alpha * alpha * cos4 * (1.0 + tan2 / (alpha * alpha)).powi(2))
}

/// Smith's auxiliary function (Heitz 2014, equation 72).
fn lambda(alpha: f64, w: DVec3) -> f64 {
    let tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    // (√(1 + x) - 1) / 2 as a quotient.
    let x = alpha * alpha * tan2;
    0.5 * x / ((1.0 + x).sqrt() + 1.0)
}

/// Share of the microfacets facing `w` that it sees.
fn g1(alpha: f64, w: DVec3) -> f64 {
    1.0 / (1.0 + lambda(alpha, w))
}

/// Density of the microfacet normals that `wo` sees, per steradian of h.
pub(crate) fn visible(alpha: f64, wo: DVec3, h: DVec3) -> f64 {
    g1(alpha, wo) * wo.dot(h).max(0.0) * d(alpha, h) / wo.z
}

/// Density of the directions in which visible microfacets reflect `wo`.
pub(crate) fn ggx_pdf(alpha: f64, wo: DVec3, wi: DVec3) -> f64 {
    let h = (wo + wi).normalize();
    visible(alpha, wo, h) / (4.0 * wo.dot(h))
}

/// D G2 / (4 cos wo), height-correlated, the cosine of wi included; without Fresnel's factor.
pub(crate) fn ggx_value(alpha: f64, wo: DVec3, wi: DVec3) -> f64 {
    if wi.z <= 0.0 {
        return 0.0;
    }
    let g2 = 1.0 / (1.0 + lambda(alpha, wo) + lambda(alpha, wi));
    d(alpha, (wo + wi).normalize()) * g2 / (4.0 * wo.z)
}

/// Fresnel's equations for unpolarised light: reflectance and the refracted direction's cosine;
/// `None` beyond the critical angle. `eta`: index on the side of incidence over the other.
pub(crate) fn fresnel(cos_i: f64, eta: f64) -> Option<(f64, f64)> {
    // 1 - eta² sin², in which eta = 1 and small cosines lose nothing.
    let cos2_t = (1.0 - eta) * (1.0 + eta) + eta * eta * cos_i * cos_i;
    if cos2_t <= 0.0 {
        return None;
    }
    let cos_t = cos2_t.sqrt();
    let s = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let p = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    Some((0.5 * (s * s + p * p), cos_t))
}

/// Schlick 1994.
pub(crate) fn schlick(f0: f64, f90: f64, cosine: f64) -> f64 {
    f0 + (f90 - f0) * (1.0 - cosine).powi(5)
}
