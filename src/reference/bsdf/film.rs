//! A thin film over the base: KHR_materials_iridescence, which is Belcour and Barla's model
//! (2017) with Schlick's term in place of Fresnel's and without polarisation.

use glam::{DMat3, DVec3};
use std::f64::consts::{PI, TAU};

/// A film in air.
#[derive(Debug, Clone, Copy)]
pub(in crate::reference) struct Film {
    /// Share of the surface with the film.
    pub(in crate::reference) factor: f64,
    /// Index of refraction, at least 1.
    pub(in crate::reference) ior: f64,
    /// nm.
    pub(in crate::reference) thickness: f64,
}

/// Gaussians that fit the CIE 1931 matching functions over wave numbers (per metre): height,
/// centre, variance of X, Y and Z, and of a second lobe of X.
pub(super) const HEIGHT: DVec3 = DVec3::new(5.4856e-13, 4.4201e-13, 5.2481e-13);
pub(super) const CENTRE: DVec3 = DVec3::new(1.6810e6, 1.7953e6, 2.2084e6);
pub(super) const VARIANCE: DVec3 = DVec3::new(4.3278e9, 9.3046e9, 6.6121e9);
pub(super) const SECOND: [f64; 3] = [9.7470e-14, 2.2399e6, 4.5282e9];
/// Integral of the matching functions in the same unit.
const WHOLE: f64 = 1.0685e-7;

/// Linear Rec. 709 from XYZ.
pub(super) const REC709: DMat3 = DMat3::from_cols_array(&[
    3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108, -0.2040259, -0.4985314, 0.0415560,
    1.0572252,
]);

impl Film {
    /// Reflectance of film and base together, where the base alone has `base_f0` in air.
    pub(super) fn reflectance(&self, cos: f64, base_f0: DVec3) -> DVec3 {
        // A film much thinner than light is none.
        let edge = (self.thickness / 0.03).clamp(0.0, 1.0);
        let film = 1.0 + (self.ior - 1.0) * (edge * edge * (3.0 - 2.0 * edge));
        let cos2_within = 1.0 - (1.0 - cos * cos) / (film * film);
        if cos2_within < 0.0 {
            return DVec3::ONE;
        }
        let cos_within = cos2_within.sqrt();
        let schlick = |f0: f64, cos: f64| f0 + (1.0 - f0) * (1.0 - cos).powi(5);
        let top = schlick(((film - 1.0) / (film + 1.0)).powi(2), cos);
        // The base's index as if it were a dielectric.
        let root = base_f0.clamp(DVec3::ZERO, DVec3::splat(0.9999)).map(f64::sqrt);
        let base = (DVec3::ONE + root) / (DVec3::ONE - root);
        let bottom = base.map(|base| schlick(((base - film) / (base + film)).powi(2), cos_within));
        // A reflection at a smaller index counts half a wave: always at the top, from within.
        let phase = base.map(|base| PI + if base < film { PI } else { 0.0 });
        let path = 2.0 * film * self.thickness * cos_within;

        let both = (bottom * top).clamp(DVec3::ZERO, DVec3::splat(0.9999));
        let round_trip = both.map(f64::sqrt);
        let through = (1.0 - top).powi(2) * bottom / (DVec3::ONE - both);
        let mut sum = through + top;
        let mut amplitude = through - (1.0 - top);
        for m in [1.0, 2.0] {
            amplitude *= round_trip;
            sum += amplitude * (2.0 * sensitivity(m * path, phase * m));
        }
        sum.clamp(DVec3::ZERO, DVec3::ONE)
    }
}

/// What a wave over all wave numbers, with `path` nm and a shift of phase between crests, comes
/// to in linear Rec. 709.
fn sensitivity(path: f64, shift: DVec3) -> DVec3 {
    let phase = TAU * path * 1e-9;
    let lobe = |height: f64, centre: f64, variance: f64, shift: f64| {
        let envelope = (-variance * phase * phase).exp();
        height * (TAU * variance).sqrt() * (centre * phase + shift).cos() * envelope
    };
    let xyz = |c: usize| lobe(HEIGHT[c], CENTRE[c], VARIANCE[c], shift[c]);
    let [height, centre, variance] = SECOND;
    let x = xyz(0) + lobe(height, centre, variance, shift.x);
    REC709 * (DVec3::new(x, xyz(1), xyz(2)) / WHOLE)
}
