//! Boxes in 16 bits a plane, rounded outward.

use super::Aabb;
use super::node::{GRID_MAX, UPPER_PLANE_SHIFT};
use glam::Vec3;

/// The grid of one tree: plane q of an axis is at `min + q * scale`, with q up to
/// [`GRID_MAX`]. The last plane is at or beyond the upper bound.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    pub(super) min: Vec3,
    pub(super) scale: Vec3,
    /// Planes per unit of length; 0 where the scale is. Only for a first guess.
    density: [f64; 3],
}

impl Grid {
    /// The grid over `bounds`, which must not be empty.
    pub(super) fn new(bounds: Aabb) -> Self {
        let scales: [f32; 3] =
            std::array::from_fn(|axis| scale_for(bounds.min[axis], bounds.max[axis]));
        Self { min: bounds.min, scale: scales.into(), density: scales.map(density) }
    }

    /// The words of [`super::BvhChild`] for a box inside the grid's bounds.
    pub(super) fn encode(&self, bounds: Aabb) -> [u32; 3] {
        std::array::from_fn(|axis| {
            let (min, scale, density) = (self.min[axis], self.scale[axis], self.density[axis]);
            lower_plane(min, scale, density, bounds.min[axis])
                | upper_plane(min, scale, density, bounds.max[axis]) << UPPER_PLANE_SHIFT
        })
    }
}

/// Position of plane `q`, exact to f64.
pub(super) fn decode(min: f32, scale: f32, q: u32) -> f64 {
    f64::from(min) + f64::from(q) * f64::from(scale)
}

/// The least spacing with which the last plane reaches `max`. Not subnormal, as a
/// device may take such numbers for 0; 0 if `max` is `min`.
fn scale_for(min: f32, max: f32) -> f32 {
    if max <= min {
        return 0.0;
    }
    let ideal = (f64::from(max) - f64::from(min)) / f64::from(GRID_MAX);
    let mut scale = (ideal as f32).max(f32::MIN_POSITIVE);
    while decode(min, scale, GRID_MAX) < f64::from(max) {
        scale = scale.next_up();
    }
    scale
}

/// The reciprocal of a scale, 0 for 0.
fn density(scale: f32) -> f64 {
    if scale == 0.0 { 0.0 } else { 1.0 / f64::from(scale) }
}

/// The greatest plane that is not above `x`.
fn lower_plane(min: f32, scale: f32, density: f64, x: f32) -> u32 {
    let q = plane_near(min, density, x);
    // The guess errs by one at most; without branches, which none could predict.
    q - u32::from(q > 0 && decode(min, scale, q) > f64::from(x))
}

/// The least plane that is not below `x`.
fn upper_plane(min: f32, scale: f32, density: f64, x: f32) -> u32 {
    let is_below = |q: u32| u32::from(q < GRID_MAX && decode(min, scale, q) < f64::from(x));
    let q = plane_near(min, density, x);
    let q = q + is_below(q);
    q + is_below(q)
}

/// The plane at or just below `x`, to rounding.
fn plane_near(min: f32, density: f64, x: f32) -> u32 {
    let q = (f64::from(x) - f64::from(min)) * density;
    (q as u32).min(GRID_MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::random::Random;

    #[test]
    fn planes_are_outside_by_less_than_one_step() {
        let mut random = Random::new(1);
        for _ in 0..200_000 {
            let size = 10.0f32.powf(60.0 * random.unit() - 30.0);
            let offset = if random.below(2) == 0 { 0.0 } else { 1e5 * size };
            let mut corners = [0; 4].map(|_| offset + size * (2.0 * random.unit() - 1.0));
            corners.sort_by(f32::total_cmp);
            let [min, low, high, max] = corners;
            let scale = scale_for(min, max);
            let d = density(scale);
            let (q, r) = (lower_plane(min, scale, d, low), upper_plane(min, scale, d, high));
            assert!(q <= r && r <= GRID_MAX);
            assert!(decode(min, scale, q) <= f64::from(low));
            assert!(decode(min, scale, r) >= f64::from(high));
            assert!(q == r || decode(min, scale, q + 1) >= f64::from(low));
            assert!(r == q || decode(min, scale, r - 1) <= f64::from(high));
        }
    }

    #[test]
    fn extreme_extents_are_covered() {
        let tiny = f32::from_bits(1);
        for (min, max) in [(0.0, 0.0), (0.0, tiny), (-3e38, 3e38), (1.0, 1.0f32.next_up())] {
            let scale = scale_for(min, max);
            assert!(scale.is_finite());
            let d = density(scale);
            assert_eq!(lower_plane(min, scale, d, min), 0);
            assert!(decode(min, scale, upper_plane(min, scale, d, max)) >= f64::from(max));
        }
    }
}
