//! Ray against box, in the coordinates of a tree's grid.
//!
//! # The test
//!
//! For each axis, once for a ray and tree:
//!
//! - `d'` is the direction, or `1e-18` with its sign where it is smaller than this;
//! - `inv = 1 / d'`, `s = grid_scale * inv`, `b = (grid_min - o) * inv`;
//! - `e = BOX_ERROR * (|b| + 65535 |s|)`.
//!
//! The ray passes plane q at `q * s + b`. It enters the box at `t_near`, the greatest
//! of the three `q_near * s + (b - e)`, and leaves it at `t_far`, the least of the
//! three `q_far * s + (b + e)`, where `q_near` is the lower plane if `inv >= 0` and the
//! upper one if not. It meets the box if `max(t_near, 0) <= min(t_far, t_max)`.
//! No infinity or NaN occurs and none is relied on.
//!
//! # Why no hit is lost
//!
//! Let `u = 2^-24` and let division be right to 2.5 units in the last place, a
//! relative error of `5 u`, which is all that WGSL promises. Then `s` errs by
//! `6 u |s|` and `b` by `7 u |b|`; the product with q, the term `b - e` and the sum add
//! `2 u (|b| + 65535 |s|)` at most. So the computed position of a plane is within
//! `9 u (|b| + 65535 |s|)` of the exact one, and `e`, which is `32 u` of the same, makes
//! `t_near` too small and `t_far` too great even when all errors add up. The
//! rest, `23 u`, is for the primitive: in space it is more than 23 units of 2^-24 of the
//! distance between the origin and the far side of the grid on that axis, while the
//! triangle test decides on vertices that are rounded by up to `14 u` of their distance
//! from the origin on that axis. A box without extent has both planes at one place, and
//! this margin is all that lets a ray through. For most rays `e` is an eighth of a step of the grid.
//!
//! A direction below `1e-18` moves less than the margin over any distance at which
//! f32 still tells points of the scene apart, so replacing it does not matter.

use super::arithmetic::mul_add;
use super::{Bvh, BvhChild};
use glam::Vec3;

/// Margin of the box test in units of the largest intermediate value: 32 * 2^-24.
pub const BOX_ERROR: f32 = 1.0 / 524_288.0;

/// Components of directions below this are replaced by it before the reciprocal.
pub const MIN_DIRECTION: f32 = 1e-18;

/// A ray prepared for the boxes of one tree. With `FUSED`, as a compiler would evaluate
/// it that turns every `a * b + c` into one operation.
#[derive(Debug, Clone, Copy)]
pub struct GridRay<const FUSED: bool = false> {
    scale: Vec3,
    near: Vec3,
    far: Vec3,
    is_positive: [bool; 3],
}

impl GridRay {
    /// Prepares the ray `o + t d`, nothing fused.
    pub fn new(bvh: &Bvh, o: Vec3, d: Vec3) -> Self {
        Self::prepare(bvh, o, d)
    }
}

impl<const FUSED: bool> GridRay<FUSED> {
    /// Prepares the ray `o + t d`.
    pub fn prepare(bvh: &Bvh, o: Vec3, d: Vec3) -> Self {
        let inverse =
            d.map(|c| 1.0 / if c.abs() < MIN_DIRECTION { MIN_DIRECTION.copysign(c) } else { c });
        let scale = bvh.grid_scale * inverse;
        let offset = (bvh.grid_min - o) * inverse;
        let largest = |axis: usize| {
            let (b, s) = (offset[axis].abs(), scale[axis].abs());
            mul_add::<FUSED>(super::GRID_MAX as f32, s, b)
        };
        let widened = |by: f32| {
            let bias = |axis: usize| mul_add::<FUSED>(by, largest(axis), offset[axis]);
            Vec3::new(bias(0), bias(1), bias(2))
        };
        Self {
            scale,
            near: widened(-BOX_ERROR),
            far: widened(BOX_ERROR),
            is_positive: inverse.to_array().map(|c| c >= 0.0),
        }
    }

    /// Where the ray enters the box of `child`, if it meets it for `0 <= t <= t_max`.
    pub fn entry(&self, child: &BvhChild, t_max: f32) -> Option<f32> {
        let (lower, upper) = (child.lower(), child.upper());
        let mut t_near = 0.0f32;
        let mut t_far = t_max;
        for axis in 0..3 {
            let (near, far) = if self.is_positive[axis] {
                (lower[axis], upper[axis])
            } else {
                (upper[axis], lower[axis])
            };
            t_near = t_near.max(mul_add::<FUSED>(near as f32, self.scale[axis], self.near[axis]));
            t_far = t_far.min(mul_add::<FUSED>(far as f32, self.scale[axis], self.far[axis]));
        }
        (t_near <= t_far).then_some(t_near)
    }
}
