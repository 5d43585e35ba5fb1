//! Cameras.

use glam::Affine3A;

/// A camera in the world: it looks along its local -Z with +Y up.
#[derive(Debug, Clone)]
pub struct Camera {
    /// Node or camera name in the file.
    pub name: String,
    /// Rigid placement: columns of unit length (scale of the node removed).
    pub world_from_camera: Affine3A,
    /// Lens model.
    pub projection: Projection,
    /// Width over height as the file wants it, if it says so.
    pub aspect_ratio: Option<f32>,
    /// Radius of the thin lens in metres; 0 is a pinhole.
    pub aperture_radius: f32,
    /// Distance of the plane in focus along the view axis, metres.
    pub focus_distance: f32,
}

/// How film positions become rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Vertical field of view in radians, in (0, π). The horizontal one follows
    /// from the picture's aspect ratio.
    Perspective {
        /// Full vertical angle.
        yfov: f32,
    },
    /// Half height of the visible area in metres; the width follows from the
    /// picture's aspect ratio.
    Orthographic {
        /// Half the height.
        ymag: f32,
    },
}
