//! Usual triangle tests, for comparison.

use glam::{Vec2, Vec3};

fn mul_add<const FUSED: bool>(a: f32, b: f32, c: f32) -> f32 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

fn dot<const FUSED: bool>(a: Vec3, b: Vec3) -> f32 {
    mul_add::<FUSED>(a.z, b.z, mul_add::<FUSED>(a.y, b.y, a.x * b.x))
}

fn cross<const FUSED: bool>(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(
        mul_add::<FUSED>(a.y, b.z, -(a.z * b.y)),
        mul_add::<FUSED>(a.z, b.x, -(a.x * b.z)),
        mul_add::<FUSED>(a.x, b.y, -(a.y * b.x)),
    )
}

/// Möller and Trumbore (1997); misses where the determinant is below `det_cut`. Whether it
/// hits at some t > 0.
pub(super) fn moller_trumbore<const FUSED: bool>(
    o: Vec3,
    d: Vec3,
    [v0, v1, v2]: [Vec3; 3],
    det_cut: f32,
) -> bool {
    let (e1, e2, s) = (v1 - v0, v2 - v0, o - v0);
    let (h, q) = (cross::<FUSED>(d, e2), cross::<FUSED>(s, e1));
    let det = dot::<FUSED>(e1, h);
    if det.abs() < det_cut {
        return false;
    }
    let u = dot::<FUSED>(s, h) / det;
    let v = dot::<FUSED>(d, q) / det;
    let t = dot::<FUSED>(e2, q) / det;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0
}

/// Woop, Benthin and Wald (2013) with each edge function as the text has it: fused
/// evaluation is not antisymmetric in the ends of an edge.
pub(super) fn woop_fused(o: Vec3, d: Vec3, v: [Vec3; 3]) -> bool {
    let m = d.abs();
    let order = |v: Vec3| {
        if m.z >= m.x.max(m.y) {
            v
        } else if m.x >= m.y {
            Vec3::new(v.y, v.z, v.x)
        } else {
            Vec3::new(v.z, v.x, v.y)
        }
    };
    let d = order(d);
    let [a, b, c] = v.map(|v| {
        let p = order(v - o);
        Vec3::new((-d.x / d.z).mul_add(p.z, p.x), (-d.y / d.z).mul_add(p.z, p.y), p.z / d.z)
    });
    let edge = |p: Vec3, q: Vec3| -> f32 {
        let (p, q) = (Vec2::new(p.x, p.y), Vec2::new(q.x, q.y));
        p.x.mul_add(q.y, -(p.y * q.x))
    };
    let w = Vec3::new(edge(b, c), edge(c, a), edge(a, b));
    if w.min_element() < 0.0 && w.max_element() > 0.0 {
        return false;
    }
    let det = w.x + w.y + w.z;
    det != 0.0 && w.dot(Vec3::new(a.z, b.z, c.z)) / det > 0.0
}
