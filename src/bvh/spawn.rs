//! The point of a hit and how a ray leaves it, in the arithmetic of
//! `shaders/geometry/surface_triangle.wgsl`, `surface_sphere.wgsl` and `ray.wgsl`.
//! `FUSED`: as a compiler would evaluate it that turns every `a * b + c` into one operation.

use super::AnchoredSphere;
use super::arithmetic::{cross, dot, mul_add, scale_add};
use glam::Vec3;

/// A point on a surface from which rays can leave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpawnPoint {
    /// The point, on the surface but for rounding.
    pub position: Vec3,
    /// Unit geometric normal on the front.
    pub normal: Vec3,
    /// By how far rays leave the surface along the normal.
    pub offset: f32,
}

/// Distance by which rays leave a surface whose coordinates are up to `extent`: 8 units in
/// the last place of the largest.
pub fn spawn_offset(extent: f32) -> f32 {
    8.0 * f32::EPSILON * extent
}

impl SpawnPoint {
    /// The point of a triangle with barycentric weights `u` and `v` of its second and third
    /// vertex: interpolated, so that it lies in the plane however far the ray came.
    pub fn on_triangle<const FUSED: bool>([a, b, c]: [Vec3; 3], u: f32, v: f32) -> Self {
        let position = scale_add::<FUSED>(v, c, scale_add::<FUSED>(u, b, (1.0 - u - v) * a));
        let extent = a.abs().max(b.abs()).max(c.abs()).max_element();
        let normal = unit::<FUSED>(cross::<FUSED>(b - a, c - a));
        Self { position, normal, offset: spawn_offset(extent) }
    }

    /// The point of a sphere at distance `t` of the ray `o + t d`, moved onto the sphere.
    pub fn on_sphere<const FUSED: bool>(
        (o, d, t): (Vec3, Vec3, f32),
        center: Vec3,
        radius: f32,
    ) -> Self {
        let normal = unit::<FUSED>(scale_add::<FUSED>(t, d, o) - center);
        let position = scale_add::<FUSED>(radius, normal, center);
        let extent = center.abs().max(position.abs()).max_element().max(radius);
        Self { position, normal, offset: spawn_offset(extent) }
    }

    /// The point of a sphere in the anchored form, by one Newton step along its normal.
    pub fn on_anchored_sphere<const FUSED: bool>(
        (o, d, t): (Vec3, Vec3, f32),
        sphere: AnchoredSphere,
    ) -> Self {
        let AnchoredSphere { point, normal: n, curvature: k } = sphere;
        let at = scale_add::<FUSED>(t, d, o);
        let w = at - point;
        let normal = unit::<FUSED>(scale_add::<FUSED>(k, w, n));
        let height = mul_add::<FUSED>(0.5 * k, dot::<FUSED>(w, w), dot::<FUSED>(n, w));
        let position = scale_add::<FUSED>(-height, normal, at);
        let extent = point.abs().max(position.abs()).max_element();
        Self { position, normal, offset: spawn_offset(extent) }
    }

    /// Where a ray along `direction` begins: off the surface, on the side that it goes to.
    pub fn origin<const FUSED: bool>(&self, direction: Vec3) -> Vec3 {
        let leaves_front = dot::<FUSED>(self.normal, direction) >= 0.0;
        let offset = if leaves_front { self.offset } else { -self.offset };
        scale_add::<FUSED>(offset, self.normal, self.position)
    }
}

/// Scaled by the largest component first, so that no square overflows or vanishes.
fn unit<const FUSED: bool>(v: Vec3) -> Vec3 {
    let m = v.abs().max_element();
    if m == 0.0 {
        return Vec3::Z;
    }
    let v = v / m;
    v / dot::<FUSED>(v, v).sqrt()
}
