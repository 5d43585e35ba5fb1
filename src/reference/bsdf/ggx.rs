//! Microfacets: the GGX distribution with Smith's masking (Walter et al. 2007, Heitz 2014).

use super::super::random::Random;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// GGX narrower than this is a mirror.
pub(super) const LEAST_ALPHA: f64 = 1e-3;

/// Microfacets of a surface.
#[derive(Debug)]
pub(super) struct Ggx {
    frame: Frame,
    /// Along the frame's tangent and bitangent.
    alpha: [f64; 2],
}

/// Orthonormal axes; the last one is the normal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame([DVec3; 3]);

impl Frame {
    /// Any frame with that normal.
    pub(super) fn around(normal: DVec3) -> Self {
        let (x, y) = normal.any_orthonormal_pair();
        Self([x, y, normal])
    }

    /// The frame whose tangent is the part of `axis` at right angles to the normal.
    pub(super) fn along(axis: DVec3, normal: DVec3) -> Option<Self> {
        let x = (axis - normal * normal.dot(axis)).try_normalize()?;
        Some(Self([x, normal.cross(x), normal]))
    }

    pub(super) fn local(&self, v: DVec3) -> DVec3 {
        DVec3::from(self.0.map(|axis| axis.dot(v)))
    }

    pub(super) fn world(&self, v: DVec3) -> DVec3 {
        let [x, y, z] = self.0;
        x * v.x + y * v.y + z * v.z
    }
}

impl Ggx {
    /// `None` for a mirror.
    pub(super) fn isotropic(alpha: f64, normal: DVec3) -> Option<Self> {
        let rough = Self { frame: Frame::around(normal), alpha: [alpha; 2] };
        (alpha >= LEAST_ALPHA).then_some(rough)
    }

    /// Never a mirror.
    pub(super) fn stretched(alpha: [f64; 2], frame: Frame) -> Self {
        Self { frame, alpha: alpha.map(|alpha| alpha.max(LEAST_ALPHA)) }
    }

    /// The alpha of the isotropic surface that is as rough on the whole.
    pub(super) fn mean_alpha(&self) -> f64 {
        (self.alpha[0] * self.alpha[1]).sqrt()
    }

    /// Microfacet area per area of the surface and solid angle of normals.
    pub(super) fn distribution(&self, half: DVec3) -> f64 {
        let h = self.frame.local(half);
        let [t, b] = self.alpha;
        let stretched = (h.x / t).powi(2) + (h.y / b).powi(2) + h.z * h.z;
        1.0 / (PI * t * b * stretched * stretched)
    }

    /// Smith's function: hidden area over visible area, seen from either side.
    pub(super) fn lambda(&self, w: DVec3) -> f64 {
        let w = self.frame.local(w);
        let [t, b] = self.alpha;
        let slope2 = ((t * w.x).powi(2) + (b * w.y).powi(2)) / (w.z * w.z);
        ((1.0 + slope2).sqrt() - 1.0) / 2.0
    }

    /// Share that is visible from one direction.
    pub(super) fn masking(&self, w: DVec3) -> f64 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// BRDF times cosine for a reflectance of 1, heights of masking and shadowing correlated.
    pub(super) fn reflection(&self, wo: DVec3, wi: DVec3) -> f64 {
        let cos_o = self.frame.local(wo).z;
        let both = 1.0 / (1.0 + self.lambda(wo) + self.lambda(wi));
        self.distribution((wo + wi).normalize()) * both / (4.0 * cos_o)
    }

    /// Density of `wi` where visible normals reflect `wo`.
    pub(super) fn reflection_pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let half = (wo + wi).normalize();
        self.normal_pdf(wo, half) / (4.0 * wo.dot(half))
    }

    /// Density with which [`visible_normal`](Self::visible_normal) is `half`.
    pub(super) fn normal_pdf(&self, wo: DVec3, half: DVec3) -> f64 {
        let [cos_o, cos_h] = [wo, half].map(|v| self.frame.local(v).z);
        if cos_h <= 0.0 {
            return 0.0;
        }
        self.distribution(half) * self.masking(wo) * wo.dot(half).max(0.0) / cos_o
    }

    /// A microfacet normal as seen from `wo`: the reflections of `wo` stretched to a unit
    /// hemisphere are uniform on a spherical cap (Dupuy and Benyoub 2023).
    pub(super) fn visible_normal(&self, wo: DVec3, random: &mut Random) -> DVec3 {
        self.normal_at(wo, [random.uniform(), random.uniform()])
    }

    /// As [`visible_normal`](Self::visible_normal), from two numbers in [0, 1).
    pub(super) fn normal_at(&self, wo: DVec3, [u, v]: [f64; 2]) -> DVec3 {
        let wo = self.frame.local(wo);
        let [t, b] = self.alpha;
        let stretched = DVec3::new(t * wo.x, b * wo.y, wo.z).normalize();
        let z = 1.0 - u * (1.0 + stretched.z);
        let (sin, angle) = ((1.0 - z * z).max(0.0).sqrt(), TAU * v);
        let half = DVec3::new(sin * angle.cos(), sin * angle.sin(), z) + stretched;
        self.frame.world(DVec3::new(t * half.x, b * half.y, half.z).normalize())
    }
}
