//! Punctual lights (KHR_lights_punctual), in world space.

use glam::Vec3;

/// A light without area.
#[derive(Debug, Clone, PartialEq)]
pub struct PunctualLight {
    /// Name in the file.
    pub name: String,
    /// Where and which way.
    pub kind: LightKind,
    /// Colour times intensity: radiant intensity, W/sr, for point and spot;
    /// irradiance on a facing surface, W/m², for directional. The file's candela
    /// and lux are taken as these without a photometric factor.
    pub intensity: Vec3,
}

/// The kinds of punctual light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// Equal in all directions.
    Point {
        /// World position.
        position: Vec3,
        /// Distance at which the light is windowed to zero; infinite by default.
        range: f32,
    },
    /// A cone.
    Spot {
        /// World position.
        position: Vec3,
        /// Unit direction of travel along the axis.
        direction: Vec3,
        /// Cosine of the angle at which falloff begins.
        cos_inner: f32,
        /// Cosine of the angle at which it is zero.
        cos_outer: f32,
        /// As for [`LightKind::Point`].
        range: f32,
    },
    /// Parallel light from infinity.
    Directional {
        /// Unit direction of travel.
        direction: Vec3,
    },
}
