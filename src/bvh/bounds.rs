//! Axis-aligned boxes.

use glam::Vec3;

/// An axis-aligned box, closed. Empty if `min > max` on an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box that holds nothing: neutral for [`Self::union`].
    pub const fn empty() -> Self {
        Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY }
    }

    /// The least box that holds all `points`.
    pub fn of_points(points: &[Vec3]) -> Self {
        points.iter().fold(Self::empty(), |bounds, &p| bounds.grow(p))
    }

    /// A box that holds the sphere: rounded outward, by up to two units in the last place.
    pub fn of_sphere(center: Vec3, radius: f32) -> Self {
        Self {
            min: (center - radius).map(f32::next_down),
            max: (center + radius).map(f32::next_up),
        }
    }

    /// The least box that holds this one and `point`.
    #[must_use]
    pub fn grow(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The least box that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Area of the surface; 0 for the empty box.
    pub fn surface_area(&self) -> f32 {
        let e = (self.max - self.min).max(Vec3::ZERO);
        2.0 * (e.x * e.y + e.y * e.z + e.z * e.x)
    }

    /// The middle. Halved before the sum, so that no coordinate overflows.
    pub fn centroid(&self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// Whether no point is inside.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }
}
