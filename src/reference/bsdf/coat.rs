//! KHR_materials_clearcoat: a clear layer of index 1.5 above all else.

use super::ggx::Ggx;
use glam::DVec3;

/// The layer, seen from one side.
#[derive(Debug)]
pub(super) struct Coat {
    normal: DVec3,
    /// `None` for a mirror.
    pub(super) ggx: Option<Ggx>,
    /// What it reflects; the rest goes on to what is below.
    pub(super) reflected: f64,
}

impl Coat {
    /// `normal` is on the side of `wo`.
    pub(super) fn new(factor: f64, roughness: f64, normal: DVec3, wo: DVec3) -> Self {
        let fresnel = 0.04 + 0.96 * (1.0 - normal.dot(wo)).powi(5);
        let ggx = Ggx::isotropic(roughness * roughness, normal);
        Self { normal, ggx, reflected: factor * fresnel }
    }

    /// The direction of a mirror.
    pub(super) fn mirrored(&self, wo: DVec3) -> DVec3 {
        self.normal * (2.0 * self.normal.dot(wo)) - wo
    }

    /// What is reflected of light from `wi`, without the share `reflected`.
    pub(super) fn eval(&self, wo: DVec3, wi: DVec3) -> f64 {
        let is_above = self.normal.dot(wi) > 0.0;
        self.ggx.as_ref().filter(|_| is_above).map_or(0.0, |ggx| ggx.reflection(wo, wi))
    }

    /// Density of [`Ggx::visible_normal`]'s reflections.
    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.ggx.as_ref().map_or(0.0, |ggx| ggx.reflection_pdf(wo, wi))
    }
}
