//! Cameras.

use glam::{Affine3A, Vec3};

/// A camera in the world: it looks along its local -Z with +Y up.
#[derive(Debug, Clone, PartialEq)]
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

impl Camera {
    /// A perspective camera that sees all of `bounds` (min, max) in any picture
    /// at least as wide as high: from the front (+Z), to the right of it and
    /// slightly above, with a vertical field of view of 45 degrees.
    pub fn framing((min, max): (Vec3, Vec3)) -> Self {
        const YFOV: f32 = std::f32::consts::FRAC_PI_4;
        let center = min + (max - min) * 0.5;
        let towards_camera = Vec3::new(0.5, 0.35, 1.0).normalize();
        // The sphere around the box touches the upper and lower edge. A single
        // point gets a view of its surroundings.
        let radius = match (max - min).length() * 0.5 {
            radius if radius > 0.0 => radius,
            _ => 1.0,
        };
        let distance = radius / (YFOV / 2.0).sin();
        let x = Vec3::Y.cross(towards_camera).normalize();
        let y = towards_camera.cross(x);
        let eye = center + towards_camera * distance;
        Self {
            name: "default".into(),
            world_from_camera: Affine3A::from_cols(
                x.into(),
                y.into(),
                towards_camera.into(),
                eye.into(),
            ),
            projection: Projection::Perspective { yfov: YFOV },
            aspect_ratio: None,
            aperture_radius: 0.0,
            focus_distance: distance,
        }
    }
}
