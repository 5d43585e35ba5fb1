//! Light from infinity.

use glam::{Mat3, Vec3};

/// An equirectangular radiance map. For a unit world direction d and
/// `e = environment_from_world * d` the column is `atan2(e.z, e.x)/2π + ½` and
/// the row `acos(e.y)/π` from the top, as in three.js and Blender after its
/// glTF import.
#[derive(Debug, Clone)]
pub struct Environment {
    /// File name, or what made it; for messages.
    pub name: String,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Radiance, row by row from the top, W/(sr m²), finite and not negative.
    pub radiance: Vec<Vec3>,
    /// Rotation of the map.
    pub environment_from_world: Mat3,
    /// Multiplies `radiance`.
    pub intensity: f32,
}

impl Environment {
    /// The same radiance from every direction.
    pub fn constant(radiance: Vec3) -> Self {
        Self {
            name: "constant".into(),
            width: 1,
            height: 1,
            radiance: vec![radiance],
            environment_from_world: Mat3::IDENTITY,
            intensity: 1.0,
        }
    }
}
