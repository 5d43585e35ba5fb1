//! How much an interface reflects.

use super::film::Film;
use glam::DVec3;

/// Fresnel's term as a function of the cosine between a direction and a microfacet.
#[derive(Debug)]
pub(super) struct Fresnel {
    /// At normal incidence.
    pub(super) f0: DVec3,
    /// At grazing incidence.
    pub(super) f90: DVec3,
    /// Index on the other side over that on this one, where the interface transmits: the way
    /// from `f0` to `f90` is then that of the exact term in place of Schlick's.
    pub(super) index: Option<f64>,
    /// What lies on it.
    pub(super) film: Option<Film>,
}

impl Fresnel {
    /// Reflectance.
    pub(super) fn at(&self, cos: f64) -> DVec3 {
        let share = match self.index {
            None => (1.0 - cos).powi(5),
            Some(index) => match exact(cos, index) {
                // All is reflected, whatever else is said of the surface.
                None => return DVec3::ONE,
                Some(reflected) => {
                    let least = at_normal(index);
                    (reflected - least) / (1.0 - least)
                }
            },
        };
        // The exact term of a large index dips below its value at normal incidence.
        let bare = (self.f0 + (self.f90 - self.f0) * share).max(DVec3::ZERO);
        match &self.film {
            None => bare,
            Some(film) => bare.lerp(film.reflectance(cos, self.f0), film.factor),
        }
    }
}

/// Reflectance at normal incidence, where the index changes by the factor `index`.
pub(super) fn at_normal(index: f64) -> f64 {
    ((index - 1.0) / (index + 1.0)).powi(2)
}

/// Unpolarised reflectance where the index changes by the factor `index` (Fresnel 1823);
/// `None` under total reflection.
pub(super) fn exact(cos: f64, index: f64) -> Option<f64> {
    let sin2_t = (1.0 - cos * cos) / (index * index);
    if sin2_t >= 1.0 {
        return None;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    // Amplitudes of the two polarisations.
    let across = (cos - index * cos_t) / (cos + index * cos_t);
    let within = (index * cos - cos_t) / (index * cos + cos_t);
    Some(0.5 * (across * across + within * within))
}

/// The direction in which light from `wo` goes on beyond an interface with normal `half`
/// (Snell); `None` under total reflection.
pub(super) fn refracted(wo: DVec3, half: DVec3, index: f64) -> Option<DVec3> {
    let cos = wo.dot(half);
    let sin2_t = (1.0 - cos * cos) / (index * index);
    let cos_t = (sin2_t < 1.0).then(|| (1.0 - sin2_t).sqrt())?;
    Some((half * (cos / index - cos_t) - wo / index).normalize())
}
