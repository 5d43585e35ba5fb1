//! Rays through pixels.

use super::geometry::Ray;
use super::random::Random;
use crate::scene::{Camera, Projection};
use glam::{DVec3, Vec3A};

/// A ray from the lens through a place of `pixel` (column, row in a picture of `resolution`)
/// that is uniform within it.
pub(super) fn sample_ray(
    camera: &Camera,
    resolution: (u32, u32),
    pixel: (u32, u32),
    random: &mut Random,
) -> Ray {
    let along =
        |pixel: u32, count: u32, offset: f64| (f64::from(pixel) + offset) / f64::from(count);
    let x = 2.0 * along(pixel.0, resolution.0, random.uniform()) - 1.0;
    let y = 1.0 - 2.0 * along(pixel.1, resolution.1, random.uniform());
    let half_height = match camera.projection {
        Projection::Perspective { yfov } => (f64::from(yfov) / 2.0).tan(),
        Projection::Orthographic { ymag } => ymag.into(),
    };
    let half_width = half_height * f64::from(resolution.0) / f64::from(resolution.1);
    let on_film = DVec3::new(x * half_width, y * half_height, 0.0);

    // In the camera's space, with the view along -Z.
    let (origin, direction) = match camera.projection {
        Projection::Perspective { .. } => (DVec3::ZERO, on_film - DVec3::Z),
        Projection::Orthographic { .. } => (on_film, -DVec3::Z),
    };
    // All rays of a film point meet in the plane of focus.
    let focus = origin + direction * f64::from(camera.focus_distance);
    let (lens_x, lens_y) = random.disk();
    let radius = f64::from(camera.aperture_radius);
    let on_lens = origin + DVec3::new(lens_x, lens_y, 0.0) * radius;
    let direction = if radius > 0.0 { focus - on_lens } else { direction };

    let columns = camera.world_from_camera.matrix3;
    let [right, up, back] =
        [columns.x_axis, columns.y_axis, columns.z_axis].map(|axis: Vec3A| axis.as_dvec3());
    let in_world = |v: DVec3| right * v.x + up * v.y + back * v.z;
    let eye = camera.world_from_camera.translation.as_dvec3();
    Ray { origin: eye + in_world(on_lens), direction: in_world(direction).normalize() }
}
