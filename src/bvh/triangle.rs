//! Ray against triangle: Möller-Trumbore, made watertight. The WGSL function of
//! the same name is this one line by line.
//!
//! # The test
//!
//! With the vertices relative to the origin of the ray, `p_i = v_i - o`, the
//! ray's line meets the triangle when the three weights
//!
//! `w0 = d . (p1 x p2)`, `w1 = d . (p2 x p0)`, `w2 = d . (p0 x p1)`
//!
//! have no two different signs; `w_i` divided by their sum is the barycentric
//! weight of vertex i. Möller and Trumbore (1997) compute `w1` and `w2` with one
//! shared cross product and `w0` as the determinant minus both. Rounding gives
//! two neighbours different ideas of the sign on their common edge, so rays leak
//! between them. Where a sign is in doubt, the weights are therefore computed
//! once more: the vertices are sheared along the ray into a plane, each by itself,
//! so that neighbours get the same bits, and `w_i` is the edge function there,
//! which is antisymmetric to the bit (Woop, Benthin and Wald 2013). Both ends of
//! an edge come in one canonical order, so that this also holds where a compiler
//! fuses a multiplication with one half of the difference; an edge whose ends fall
//! together counts as 0, or a triangle too far away for its size would be hit by any ray.
//!
//! # Why no ray is lost
//!
//! The sheared and rounded vertices are a picture of the mesh in the plane, and
//! the pictures of neighbours share their corners exactly. A closed mesh seen
//! from inside covers the point 0 in it. Rounding is monotonic, so
//! `fl(fl(a.x b.y) - fl(a.y b.x))` is never of the sign opposite to the exact
//! value, and since zero counts as inside, every triangle whose picture holds 0
//! is accepted by the edge functions. It remains that Möller-Trumbore must not
//! reject such a triangle when it is used alone: when all `|w_i|` exceed
//! `UNCERTAINTY * max|d_k| * D * (E + 2^-19 D)`. Let `u = 2^-24`, `D >= |p_i|`
//! and `E >= |e1|, |e2|`.
//!
//! - Möller-Trumbore. A cross product errs by at most `2 sqrt(2) u` of the product
//!   of the lengths, a dot product by `3 u`, an edge by `u` of its own length. So
//!   `w1` and `w2` err by at most `6.9 u |d| D E`, and with `|e1| |e2| <= 2 D E`
//!   the determinant by `15.7 u |d| D E`. Two subtractions of values up to
//!   `4 |d| D E` add `7 u |d| D E`: `w0` errs by `36.5 u |d| D E`. As
//!   `|d| <= sqrt(3) max|d_k|`, this is `63.3 u max|d_k| D E`.
//! - The plane. A sheared coordinate `p.x - s p.z` with `|s| <= 1` errs by at most
//!   `2.5 u D`, and by `5 u D` more if the division is right to 2.5 units in the
//!   last place only, which is what WGSL promises: a corner moves by `10.6 u D`.
//!   The shear stretches lengths by at most `sqrt(3)` and the third edge is at most
//!   `2 E` long; if the picture holds 0, no corner is farther from 0 than its
//!   longest edge, `2 sqrt(3) E + 22 u D`. Moving both corners so far changes an
//!   edge function by at most
//!   `10.6 u D (2 sqrt(3) E + 22 u D) + (2 sqrt(3) E + 33 u D) 22 u D`,
//!   which is less than `113 u D (E + 9 u D)`.
//!
//! Together this is `177 u max|d_k| D (E + 9 u D)`; the constants used, 256 and 32,
//! leave room for terms of second order and for fused operations.
//!
//! There is no other tolerance: scaling the scene by a power of two changes no
//! decision, and a determinant rejects only when it is zero. A triangle without
//! area, `cross(v1 - v0, v2 - v0) = 0`, is missed, so that every hit has a
//! normal. The proof leaves out triangles thinner than `2^-24` of their length, whose
//! picture can vanish in rounding.
//!
//! # Distance
//!
//! `t` is where the ray meets the plane, `dot(n, p0) / det`, kept between the least
//! and the greatest t of the vertices. On a large triangle that lies across an axis it
//! is right to a few units in the last place, where interpolating the vertices' t errs
//! by units of the vertices' distance; the limits hold it where the determinant is all
//! error. It orders hits; the point for shading is interpolated from the vertices.

use super::arithmetic::{cross, dot, mul_add};
use glam::{Vec2, Vec3};

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleHit {
    /// Ray parameter: the point is `o + t d`.
    pub t: f32,
    /// Barycentric weight of the second vertex.
    pub u: f32,
    /// Barycentric weight of the third vertex.
    pub v: f32,
}

/// Width of the band about an edge in which Möller-Trumbore is not trusted: 256 * 2^-24.
const UNCERTAINTY: f32 = 1.0 / 65536.0;

/// Share of `D` added to `E` in the band: 32 * 2^-24.
const UNCERTAINTY_FLOOR: f32 = 1.0 / 524_288.0;

/// Quotients beyond this are not formed; a bound that f32 can still multiply by.
const GREATEST_T: f32 = 1e30;

/// Meets the triangle `v0 v1 v2` with the ray `o + t d` for `0 < t < t_max`, from
/// either side. `d` need not be a unit vector.
pub fn triangle_hit(
    o: Vec3,
    d: Vec3,
    v0: Vec3,
    v1: Vec3,
    v2: Vec3,
    t_max: f32,
) -> Option<TriangleHit> {
    triangle_hit_as::<false>(o, d, v0, v1, v2, t_max)
}

/// [`triangle_hit`]; with `FUSED`, as a compiler would evaluate it that turns every
/// `a * b + c` into one operation.
pub fn triangle_hit_as<const FUSED: bool>(
    o: Vec3,
    d: Vec3,
    v0: Vec3,
    v1: Vec3,
    v2: Vec3,
    t_max: f32,
) -> Option<TriangleHit> {
    let p0 = v0 - o;
    let p1 = v1 - o;
    let p2 = v2 - o;
    let e1 = p1 - p0;
    let e2 = p2 - p0;
    let q = cross::<FUSED>(d, p0);
    let n = cross::<FUSED>(e1, e2);
    let det = dot::<FUSED>(d, n);
    let mut w1 = -dot::<FUSED>(q, e2);
    let mut w2 = dot::<FUSED>(q, e1);
    let mut w0 = det - w1 - w2;

    let vertex_size = sum(p0.abs().max(p1.abs()).max(p2.abs()));
    let edge_size = sum(e1.abs().max(e2.abs()));
    let uncertain = UNCERTAINTY
        * d.abs().max_element()
        * vertex_size
        * (edge_size + UNCERTAINTY_FLOOR * vertex_size);
    if w0.min(w1).min(w2) < -uncertain && w0.max(w1).max(w2) > uncertain {
        return None;
    }
    if w0.abs().min(w1.abs()).min(w2.abs()) <= uncertain {
        if cross::<FUSED>(v1 - v0, v2 - v0) == Vec3::ZERO {
            return None;
        }
        let a = shear::<FUSED>(p0, d);
        let b = shear::<FUSED>(p1, d);
        let c = shear::<FUSED>(p2, d);
        let scale = major(d);
        w0 = scale * edge::<FUSED>(b, c);
        w1 = scale * edge::<FUSED>(c, a);
        w2 = scale * edge::<FUSED>(a, b);
    }
    if w0.min(w1).min(w2) < 0.0 && w0.max(w1).max(w2) > 0.0 {
        return None;
    }
    let total = w0 + w1 + w2;
    if total == 0.0 {
        return None;
    }
    let u = w1 / total;
    let v = w2 / total;
    let d_squared = dot::<FUSED>(d, d);
    let t0 = dot::<FUSED>(p0, d) / d_squared;
    let t1 = dot::<FUSED>(p1, d) / d_squared;
    let t2 = dot::<FUSED>(p2, d) / d_squared;
    let height = dot::<FUSED>(n, p0);
    let t = if height.abs() / GREATEST_T < det.abs() {
        (height / det).max(t0.min(t1).min(t2)).min(t0.max(t1).max(t2))
    } else {
        mul_add::<FUSED>(v, t2, mul_add::<FUSED>(u, t1, w0 / total * t0))
    };
    (t > 0.0 && t < t_max).then_some(TriangleHit { t, u, v })
}

/// The component of `d` of largest magnitude, of equal ones z before x before y.
fn major(d: Vec3) -> f32 {
    let m = d.abs();
    if m.z >= m.x.max(m.y) {
        d.z
    } else if m.x >= m.y {
        d.x
    } else {
        d.y
    }
}

/// Moves `p` along `d` into the coordinate plane across [`major`] and gives its
/// coordinates there, in an order that keeps
/// `major(d) * cross(shear(a), shear(b)) = dot(d, cross(a, b))`.
fn shear<const FUSED: bool>(p: Vec3, d: Vec3) -> Vec2 {
    let m = d.abs();
    let (x, y, z, s) = if m.z >= m.x.max(m.y) {
        (p.x, p.y, p.z, Vec2::new(d.x, d.y) / d.z)
    } else if m.x >= m.y {
        (p.y, p.z, p.x, Vec2::new(d.y, d.z) / d.x)
    } else {
        (p.z, p.x, p.y, Vec2::new(d.z, d.x) / d.y)
    };
    Vec2::new(mul_add::<FUSED>(-s.x, z, x), mul_add::<FUSED>(-s.y, z, y))
}

/// `a.x b.y - a.y b.x`, and exactly minus this with the ends exchanged: so 0 for one and the same
/// point, for which a fused evaluation alone would give the rounding error of a product.
fn edge<const FUSED: bool>(a: Vec2, b: Vec2) -> f32 {
    if a == b {
        0.0
    } else if a.x < b.x || (a.x == b.x && a.y < b.y) {
        mul_add::<FUSED>(a.x, b.y, -(a.y * b.x))
    } else {
        -mul_add::<FUSED>(b.x, a.y, -(b.y * a.x))
    }
}

fn sum(v: Vec3) -> f32 {
    v.x + v.y + v.z
}

#[cfg(test)]
mod tests;
