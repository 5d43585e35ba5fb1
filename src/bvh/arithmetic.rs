//! `a * b + c` in the two ways in which a shader compiler may evaluate it.
//!
//! WGSL allows a device to round the product before the sum or to fuse both into one
//! operation. The functions whose names end in `_as` take the choice as a parameter:
//! with `FUSED` every such expression is fused, without it none is.

use glam::Vec3;

pub(super) fn mul_add<const FUSED: bool>(a: f32, b: f32, c: f32) -> f32 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// `s * a + b`.
pub(super) fn scale_add<const FUSED: bool>(s: f32, a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(
        mul_add::<FUSED>(s, a.x, b.x),
        mul_add::<FUSED>(s, a.y, b.y),
        mul_add::<FUSED>(s, a.z, b.z),
    )
}

pub(super) fn dot<const FUSED: bool>(a: Vec3, b: Vec3) -> f32 {
    mul_add::<FUSED>(a.z, b.z, mul_add::<FUSED>(a.y, b.y, a.x * b.x))
}

pub(super) fn cross<const FUSED: bool>(a: Vec3, b: Vec3) -> Vec3 {
    Vec3::new(
        mul_add::<FUSED>(a.y, b.z, -(a.z * b.y)),
        mul_add::<FUSED>(a.z, b.x, -(a.x * b.z)),
        mul_add::<FUSED>(a.x, b.y, -(a.y * b.x)),
    )
}
