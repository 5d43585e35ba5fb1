//! Ray against sphere. The WGSL functions of the same names are these line by line.

use glam::Vec3;

/// Meets the sphere with the ray `o + t d`: the least t with `0 < t < t_max`, from outside
/// or inside. `d` need not be a unit vector.
///
/// Haines, Günther and Akenine-Möller ("Precision improvements for ray/sphere
/// intersection", Ray Tracing Gems, 2019): the discriminant comes from the distance
/// between the line and the centre, not from the difference of two large squares, and
/// the roots from the stable pair `c / q` and `q / a`.
pub fn sphere_hit(o: Vec3, d: Vec3, center: Vec3, radius: f32, t_max: f32) -> Option<f32> {
    let f = o - center;
    let a = d.dot(d);
    let b = -f.dot(d);
    let from_center = f + (b / a) * d;
    let discriminant = radius * radius - from_center.dot(from_center);
    if discriminant < 0.0 {
        return None;
    }
    let root = (a * discriminant).sqrt();
    let q = if b >= 0.0 { b + root } else { b - root };
    let c = f.dot(f) - radius * radius;
    first_root(a, q, c, t_max)
}

/// Meets a sphere that is given by a point on it, the outward unit normal there and
/// the curvature `k = 1 / radius`; 0 is a plane. For spheres much larger than the rest
/// of the scene: with the anchor near that, the hit is as exact as on small ones.
///
/// With `w` relative to the anchor the surface is `k |w|^2 + 2 n . w = 0`.
pub fn sphere_hit_anchored(
    o: Vec3,
    d: Vec3,
    anchor: Vec3,
    normal: Vec3,
    k: f32,
    t_max: f32,
) -> Option<f32> {
    let w = o - anchor;
    let a = k * d.dot(d);
    let b = -(k * w.dot(d) + normal.dot(d));
    let c = k * w.dot(w) + 2.0 * normal.dot(w);
    let discriminant = b * b - a * c;
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
