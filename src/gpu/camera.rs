//! The camera as the device reads it.

use super::GpuCamera;
use crate::scene::{Camera, Projection};

pub(super) fn gpu_camera(camera: &Camera, resolution: (u32, u32)) -> GpuCamera {
    let m = camera.world_from_camera;
    // In f64, so that narrow and wide fields are right to the last place.
    let half_height = match camera.projection {
        Projection::Perspective { yfov } => (f64::from(yfov) * 0.5).tan(),
        Projection::Orthographic { ymag } => f64::from(ymag),
    };
    let aspect = f64::from(resolution.0) / f64::from(resolution.1);
    GpuCamera {
        position: m.translation.into(),
        aperture_radius: camera.aperture_radius,
        right: m.matrix3.x_axis.into(),
        focus_distance: camera.focus_distance,
        up: m.matrix3.y_axis.into(),
        half_height: half_height as f32,
        back: m.matrix3.z_axis.into(),
        half_width: (half_height * aspect) as f32,
        orthographic: u32::from(matches!(camera.projection, Projection::Orthographic { .. })),
        padding_0: 0,
        padding_1: 0,
        padding_2: 0,
    }
}
