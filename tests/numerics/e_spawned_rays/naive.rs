//! How others leave surfaces, for comparison in E2.

use glam::Vec3;

/// A way of making the second ray: its origin and the least t of its hits.
pub(super) type Strategy = fn(&Leaving) -> (Vec3, f32);

/// A hit, and the direction in which a ray is to leave it.
pub(super) struct Leaving {
    /// `o + t d` of the first ray.
    pub(super) along_ray: Vec3,
    /// Interpolated from the vertices.
    pub(super) interpolated: Vec3,
    /// Unit normal on the side of `direction`.
    pub(super) normal: Vec3,
}

/// Name, and how.
pub(super) const STRATEGIES: [(&str, Strategy); 5] = [
    ("none", |l| (l.along_ray, 0.0)),
    ("1e-3 along n", |l| (l.along_ray + 1e-3 * l.normal, 0.0)),
    ("1e-4 along n", |l| (l.along_ray + 1e-4 * l.normal, 0.0)),
    ("t > 1e-4", |l| (l.along_ray, 1e-4)),
    ("integer offset", |l| (integer_offset(l.interpolated, l.normal), 0.0)),
];

/// Wächter and Binder, "A fast and robust method for avoiding self-intersection", Ray
/// Tracing Gems, 2019: 256 units in the last place, and 1/65536 near the origin.
fn integer_offset(p: Vec3, n: Vec3) -> Vec3 {
    let component = |p: f32, n: f32| {
        let steps = (256.0 * n) as i32;
        let steps = if p < 0.0 { -steps } else { steps };
        let moved = f32::from_bits((p.to_bits() as i32).wrapping_add(steps) as u32);
        if p.abs() < 1.0 / 32.0 { p + n / 65536.0 } else { moved }
    };
    Vec3::new(component(p.x, n.x), component(p.y, n.y), component(p.z, n.z))
}
