//! What single scattering on microfacets loses, given back: Turquin (2019), "Practical multiple
//! scattering compensation for microfacet models".

use super::albedo::AlbedoTable;
use super::ggx::Ggx;
use crate::statistics::integrate_rectangle;
use glam::DVec3;

/// Directional albedo of isotropic GGX that reflects all.
static ALBEDO: AlbedoTable = AlbedoTable::new(albedo);

/// The factor on reflection from a surface with reflectance `f0` at normal incidence.
pub(super) fn factor(f0: DVec3, cos_o: f64, alpha: f64) -> DVec3 {
    let kept = ALBEDO.at(cos_o, alpha);
    DVec3::ONE + f0 * ((1.0 - kept) / kept)
}

/// The mean over visible normals of what is not in the shadow on its way out. At the horizon it
/// has an edge, where the quadrature leaves an error of up to some 1e-3.
pub(super) fn albedo(cos_o: f64, alpha: f64) -> f64 {
    let alpha = alpha.max(super::ggx::LEAST_ALPHA);
    let wo = DVec3::new((1.0 - cos_o * cos_o).max(0.0).sqrt(), 0.0, cos_o);
    let Some(ggx) = Ggx::isotropic(alpha, DVec3::Z) else { return 1.0 };
    let lambda_o = ggx.lambda(wo);
    let share = |u: f64, v: f64| {
        let half = ggx.normal_at(wo, [u, v]);
        let wi = half * (2.0 * half.dot(wo)) - wo;
        if wi.z <= 0.0 { 0.0 } else { (1.0 + lambda_o) / (1.0 + lambda_o + ggx.lambda(wi)) }
    };
    integrate_rectangle(&share, (0.0, 1.0), (0.0, 1.0), 1e-5, 1e-6)
}
