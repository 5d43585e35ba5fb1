//! The volumes that a path is in.

use crate::scene::Material;
use glam::DVec3;

/// Volumes that a path knows at once.
const MOST: usize = 4;

/// Indices of the volumes' materials, innermost first.
#[derive(Debug, Clone, Default)]
pub(super) struct Media(Vec<u32>);

impl Media {
    /// The volume around, if any.
    pub(super) fn innermost(&self) -> Option<u32> {
        self.0.first().copied()
    }

    pub(super) fn contains(&self, material: u32) -> bool {
        self.0.contains(&material)
    }

    /// Within one more volume. Of more than four the outermost is forgotten.
    pub(super) fn entered(&self, material: u32) -> Self {
        let others = self.0.iter().copied().take(MOST - 1);
        Self(std::iter::once(material).chain(others).collect())
    }

    /// Without the innermost volume of that material.
    pub(super) fn left(&self, material: u32) -> Self {
        let mut others = self.0.clone();
        if let Some(place) = others.iter().position(|&m| m == material) {
            others.remove(place);
        }
        Self(others)
    }

    /// Share of the light that is left after `distance` metres (Beer and Lambert).
    pub(super) fn transmittance(&self, materials: &[Material], distance: f64) -> DVec3 {
        let Some(material) = self.innermost() else { return DVec3::ONE };
        // Without absorption no distance matters, not even an infinite one.
        materials[material as usize]
            .absorption
            .as_dvec3()
            .map(|per_metre| if per_metre > 0.0 { (-per_metre * distance).exp() } else { 1.0 })
    }
}

/// Index of refraction of a material for one channel of red, green and blue, or in general:
/// KHR_materials_dispersion.
pub(super) fn index(material: &Material, channel: Option<usize>) -> f64 {
    let n = f64::from(material.ior);
    let half_spread = (n - 1.0) * 0.025 * f64::from(material.dispersion);
    let steps = channel.map_or(0.0, |channel| channel as f64 - 1.0);
    (n + steps * half_spread).max(1.0)
}
