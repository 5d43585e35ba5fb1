//! Ray against sphere. The WGSL functions of the same names are these line by line.

use super::arithmetic::{dot, mul_add, scale_add};
use glam::Vec3;

/// A sphere that is given by a point on it: for spheres much larger than the rest of the
/// scene. With the anchor near that, hits are as exact as on small ones.
///
/// With `w` relative to the point, the surface is `k |w|^2 + 2 n . w = 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnchoredSphere {
    /// A point of the surface.
    pub point: Vec3,
    /// The outward unit normal there.
    pub normal: Vec3,
    /// `k = 1 / radius`; 0 is a plane.
    pub curvature: f32,
}

/// Meets the sphere with the ray `o + t d`: the least t with `0 < t < t_max`, from outside
/// or inside. `d` need not be a unit vector. `FUSED`: as a compiler would evaluate it that
/// turns every `a * b + c` into one operation.
///
/// Haines, Günther and Akenine-Möller ("Precision improvements for ray/sphere
/// intersection", Ray Tracing Gems, 2019): the discriminant comes from the distance
/// between the line and the centre, not from the difference of two large squares, and
/// the roots from the stable pair `c / q` and `q / a`.
pub fn sphere_hit<const FUSED: bool>(
    o: Vec3,
    d: Vec3,
    center: Vec3,
    radius: f32,
    t_max: f32,
) -> Option<f32> {
    let f = o - center;
    let a = dot::<FUSED>(d, d);
    let b = -dot::<FUSED>(f, d);
    let from_center = scale_add::<FUSED>(b / a, d, f);
    let distance_squared = dot::<FUSED>(from_center, from_center);
    let discriminant = mul_add::<FUSED>(radius, radius, -distance_squared);
    if discriminant < 0.0 {
        return None;
    }
    let root = (a * discriminant).sqrt();
    let q = if b >= 0.0 { b + root } else { b - root };
    let c = mul_add::<FUSED>(-radius, radius, dot::<FUSED>(f, f));
    first_root(a, q, c, t_max)
}

/// [`sphere_hit`] for a sphere in the anchored form.
pub fn sphere_hit_anchored<const FUSED: bool>(
    o: Vec3,
    d: Vec3,
    sphere: AnchoredSphere,
    t_max: f32,
) -> Option<f32> {
    let AnchoredSphere { point, normal, curvature: k } = sphere;
    let w = o - point;
    let a = k * dot::<FUSED>(d, d);
    let b = -mul_add::<FUSED>(k, dot::<FUSED>(w, d), dot::<FUSED>(normal, d));
    let c = mul_add::<FUSED>(k, dot::<FUSED>(w, w), 2.0 * dot::<FUSED>(normal, w));
    let discriminant = mul_add::<FUSED>(b, b, -(a * c));
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    let q = if b >= 0.0 { b + root } else { b - root };
    first_root(a, q, c, t_max)
}

/// Roots beyond this are no hits; a bound that f32 can still multiply by.
const GREATEST_ROOT: f32 = 1e30;

/// The least t in the open interval from 0 to `t_max` of `c / q` and `q / a`, the roots of
/// `a t^2 - 2 b t + c = 0` with `a >= 0`. Looks before it divides, so that no
/// quotient is infinite.
fn first_root(a: f32, q: f32, c: f32, t_max: f32) -> Option<f32> {
    let size = q.abs();
    let c = if q < 0.0 { -c } else { c };
    let mut t = t_max;
    if c > 0.0 && c / GREATEST_ROOT < size {
        t = t.min(c / size);
    }
    if q > 0.0 && q / GREATEST_ROOT < a {
        t = t.min(q / a);
    }
    (t > 0.0 && t < t_max).then_some(t)
}

#[cfg(test)]
mod tests;
