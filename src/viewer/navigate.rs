//! How a camera moves: around a pivot, along the picture, towards a point, or by itself.
//! All of it is rigid: the camera keeps its projection and its lens.

use glam::{Affine3A, Mat3A, Quat, Vec3, Vec3A};
use steradian::scene::{Camera, Projection};

/// Least angle between the view and the vertical, radians: there, turning would roll.
const POLE: f32 = 0.01;

/// Directions along which a scene can be looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Axis {
    /// From +Z, glTF's front.
    Front,
    /// From -Z.
    Back,
    /// From +X.
    Right,
    /// From -X.
    Left,
    /// From +Y.
    Top,
    /// From -Y.
    Bottom,
}

impl Axis {
    /// All, with their names.
    pub(super) const ALL: [(Axis, &str); 6] = [
        (Axis::Front, "Front"),
        (Axis::Back, "Back"),
        (Axis::Right, "Right"),
        (Axis::Left, "Left"),
        (Axis::Top, "Top"),
        (Axis::Bottom, "Bottom"),
    ];

    /// From the scene to the camera, and what is up in the picture.
    fn frame(self) -> (Vec3, Vec3) {
        match self {
            Axis::Front => (Vec3::Z, Vec3::Y),
            Axis::Back => (Vec3::NEG_Z, Vec3::Y),
            Axis::Right => (Vec3::X, Vec3::Y),
            Axis::Left => (Vec3::NEG_X, Vec3::Y),
            Axis::Top => (Vec3::Y, Vec3::NEG_Z),
            Axis::Bottom => (Vec3::NEG_Y, Vec3::Z),
        }
    }
}

/// Where the camera is.
pub(super) fn eye(camera: &Camera) -> Vec3 {
    camera.world_from_camera.translation.into()
}

/// Unit direction that it looks along.
pub(super) fn forward(camera: &Camera) -> Vec3 {
    (-camera.world_from_camera.matrix3.z_axis).into()
}

/// Turns the camera about `pivot`: `yaw` about the world's +Y, `pitch` about the picture's
/// horizontal, radians; positive moves the camera to the left and up, so that the near side of the
/// scene goes to the right and down in the picture, with the mouse.
pub(super) fn orbit(camera: &mut Camera, pivot: Vec3, yaw: f32, pitch: f32) {
    let turn = turn(camera, -yaw, -pitch);
    let m = &mut camera.world_from_camera;
    let arm = Vec3::from(m.translation) - pivot;
    set_rotation(m, turn);
    m.translation = (pivot + turn * arm).into();
}

/// Turns the camera where it stands: positive looks to the left and up.
pub(super) fn look(camera: &mut Camera, yaw: f32, pitch: f32) {
    let turn = turn(camera, yaw, pitch);
    set_rotation(&mut camera.world_from_camera, turn);
}

/// The turn of `yaw` about +Y after `pitch` about the camera's x, which stops at the poles.
fn turn(camera: &Camera, yaw: f32, pitch: f32) -> Quat {
    let m = &camera.world_from_camera.matrix3;
    let (x, ahead) = (Vec3::from(m.x_axis), forward(camera));
    // Angle from straight down to the view; a camera on its head turns the other way.
    let sign = if m.y_axis.y < 0.0 { -1.0 } else { 1.0 };
    let height = (-ahead.y).clamp(-1.0, 1.0).acos() * sign;
    let (low, high) = (POLE, std::f32::consts::PI - POLE);
    let range = if sign > 0.0 { (low, high) } else { (-high, -low) };
    // What already is beyond a pole may come back.
    let pitch = match height + pitch {
        h if h < range.0 => pitch.max((range.0 - height).min(0.0)),
        h if h > range.1 => pitch.min((range.1 - height).max(0.0)),
        _ => pitch,
    };
    Quat::from_rotation_y(yaw) * Quat::from_axis_angle(x.normalize(), pitch)
}

/// Turns the axes and makes them orthonormal again, so that thousands of turns stay rigid.
fn set_rotation(m: &mut Affine3A, turn: Quat) {
    let z = (turn * Vec3::from(m.matrix3.z_axis)).normalize();
    let x = (turn * Vec3::from(m.matrix3.x_axis)).reject_from_normalized(z).normalize();
    m.matrix3 = Mat3A::from_cols(x.into(), z.cross(x).into(), z.into());
}

/// Width and height in metres of what the picture shows at `distance`, for an aspect ratio.
pub(super) fn extent(camera: &Camera, distance: f32, aspect_ratio: f32) -> (f32, f32) {
    let height = match camera.projection {
        Projection::Perspective { yfov } => 2.0 * distance * (0.5 * yfov).tan(),
        Projection::Orthographic { ymag } => 2.0 * ymag,
    };
    (height * aspect_ratio, height)
}

/// Moves the camera along the picture: right and up by so many metres.
pub(super) fn pan(camera: &mut Camera, right: f32, up: f32) {
    let m = &mut camera.world_from_camera;
    m.translation += m.matrix3.x_axis * right + m.matrix3.y_axis * up;
}

/// Moves the camera so that its distance to `target` is multiplied by `factor` and the target
/// stays where it is in the picture.
pub(super) fn dolly(camera: &mut Camera, target: Vec3, factor: f32) {
    let eye = eye(camera);
    match &mut camera.projection {
        Projection::Perspective { .. } => {
            camera.world_from_camera.translation = (target + (eye - target) * factor).into();
        }
        Projection::Orthographic { ymag } => {
            *ymag *= factor;
            // Only along the picture: depth does not show.
            let m = &camera.world_from_camera.matrix3;
            let offset = Vec3A::from((target - eye) * (1.0 - factor));
            let (x, y) = (m.x_axis * m.x_axis.dot(offset), m.y_axis * m.y_axis.dot(offset));
            camera.world_from_camera.translation += x + y;
        }
    }
}

/// Moves the camera by metres along its own right, up and forward.
pub(super) fn fly(camera: &mut Camera, motion: Vec3) {
    let m = &mut camera.world_from_camera;
    m.translation += m.matrix3.x_axis * motion.x + m.matrix3.y_axis * motion.y;
    m.translation -= m.matrix3.z_axis * motion.z;
}

/// Moves the camera back or forth along its view until it sees all of `bounds` (min, max) in a
/// picture of that aspect ratio. Gives the new pivot, their middle.
pub(super) fn frame_all(camera: &mut Camera, bounds: (Vec3, Vec3), aspect_ratio: f32) -> Vec3 {
    let center = bounds.0 + (bounds.1 - bounds.0) * 0.5;
    let radius = ((bounds.1 - bounds.0).length() * 0.5).max(f32::MIN_POSITIVE);
    let distance = match &mut camera.projection {
        Projection::Perspective { yfov } => {
            let half = 0.5 * *yfov;
            // The narrower of the two directions decides.
            let half = half.min((half.tan() * aspect_ratio).atan());
            radius / half.sin()
        }
        Projection::Orthographic { ymag } => {
            *ymag = radius / aspect_ratio.min(1.0);
            2.0 * radius
        }
    };
    camera.world_from_camera.translation = (center - forward(camera) * distance).into();
    camera.focus_distance = distance;
    center
}

/// Looks along an axis at `pivot`, from as far as before.
pub(super) fn look_along(camera: &mut Camera, axis: Axis, pivot: Vec3) {
    let (z, y) = axis.frame();
    let distance = eye(camera).distance(pivot);
    camera.world_from_camera =
        Affine3A::from_cols(y.cross(z).into(), y.into(), z.into(), (pivot + z * distance).into());
}

/// Direction of unit length from the camera through a point of the picture, both coordinates
/// from -1 (left, bottom) to 1 (right, top), and where the ray begins.
pub(super) fn ray(camera: &Camera, at: (f32, f32), aspect_ratio: f32) -> (Vec3, Vec3) {
    let m = &camera.world_from_camera;
    let (half_width, half_height) = {
        let (w, h) = extent(camera, 1.0, aspect_ratio);
        (0.5 * w, 0.5 * h)
    };
    let (x, y) = (at.0 * half_width, at.1 * half_height);
    match camera.projection {
        Projection::Perspective { .. } => {
            let d = m.matrix3 * Vec3A::new(x, y, -1.0);
            (eye(camera), Vec3::from(d).normalize())
        }
        Projection::Orthographic { .. } => {
            (m.transform_point3(Vec3::new(x, y, 0.0)), forward(camera))
        }
    }
}

/// Where a point is in the picture, in the coordinates of [`ray`]; `None` behind the camera.
pub(super) fn project(camera: &Camera, point: Vec3, aspect_ratio: f32) -> Option<(f32, f32)> {
    let p = camera.world_from_camera.inverse().transform_point3(point);
    let depth = match camera.projection {
        Projection::Perspective { .. } => -p.z,
        Projection::Orthographic { .. } => 1.0,
    };
    if depth <= 0.0 {
        return None;
    }
    let (width, height) = extent(camera, depth, aspect_ratio);
    Some((2.0 * p.x / width, 2.0 * p.y / height))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::framing((Vec3::splat(-1.0), Vec3::ONE))
    }

    fn is_rigid(camera: &Camera) -> bool {
        let m = camera.world_from_camera.matrix3;
        (m.transpose() * m).abs_diff_eq(Mat3A::IDENTITY, 1e-5) && m.determinant() > 0.0
    }

    #[test]
    fn orbiting_keeps_the_pivot_in_its_place() {
        let mut c = camera();
        let pivot = Vec3::new(0.3, -0.2, 0.1);
        let (distance, before) = (eye(&c).distance(pivot), project(&c, pivot, 1.5).unwrap());
        for _ in 0..1000 {
            orbit(&mut c, pivot, 0.3, 0.02);
            orbit(&mut c, pivot, -0.1, -0.02);
        }
        let after = project(&c, pivot, 1.5).unwrap();
        assert!((eye(&c).distance(pivot) - distance).abs() < 1e-3 * distance);
        assert!((after.0 - before.0).abs() < 1e-3 && (after.1 - before.1).abs() < 1e-3);
        assert!(is_rigid(&c));
    }

    #[test]
    fn positive_angles_move_the_camera_left_and_up() {
        let mut c = camera();
        let (right, height) = (Vec3::from(c.world_from_camera.matrix3.x_axis), eye(&c).y);
        let start = eye(&c);
        orbit(&mut c, Vec3::ZERO, 0.1, 0.0);
        assert!((eye(&c) - start).dot(right) < 0.0);
        orbit(&mut c, Vec3::ZERO, 0.0, 0.1);
        assert!(eye(&c).y > height);
        let ahead = forward(&c);
        let side = Vec3::from(c.world_from_camera.matrix3.x_axis);
        look(&mut c, 0.1, 0.1);
        assert!(forward(&c).dot(side) < 0.0 && forward(&c).y > ahead.y);
    }

    #[test]
    fn pitch_stops_at_the_poles() {
        for pitch in [0.5, -0.5] {
            let mut c = camera();
            for _ in 0..20 {
                orbit(&mut c, Vec3::ZERO, 0.0, pitch);
            }
            assert!(forward(&c).y.abs() < 1.0 && forward(&c).y.abs() > 0.99, "{pitch}");
            assert!(c.world_from_camera.matrix3.y_axis.y > 0.0, "upside down");
            assert!(is_rigid(&c));
            // And it comes back.
            orbit(&mut c, Vec3::ZERO, 0.0, -pitch);
            assert!(forward(&c).y.abs() < 0.95);
        }
    }

    #[test]
    fn dolly_keeps_the_target_in_its_place() {
        let projections =
            [Projection::Perspective { yfov: 0.7 }, Projection::Orthographic { ymag: 2.0 }];
        for projection in projections {
            let mut c = Camera { projection, ..camera() };
            let target = Vec3::new(0.5, 0.3, -0.2);
            let before = project(&c, target, 1.3).unwrap();
            dolly(&mut c, target, 0.6);
            let after = project(&c, target, 1.3).unwrap();
            assert!((before.0 - after.0).abs() < 1e-4 && (before.1 - after.1).abs() < 1e-4);
            // All else moves away from it.
            let other = Vec3::new(-0.5, 0.3, -0.2);
            let near = project(&c, other, 1.3).unwrap();
            assert!((near.0 - after.0).abs() > 0.1);
        }
    }

    #[test]
    fn rays_and_points_agree() {
        let projections =
            [Projection::Perspective { yfov: 0.7 }, Projection::Orthographic { ymag: 2.0 }];
        for projection in projections {
            let c = Camera { projection, ..camera() };
            for at in [(0.0, 0.0), (-1.0, 0.4), (0.7, -1.0)] {
                let (origin, direction) = ray(&c, at, 1.4);
                let back = project(&c, origin + direction * 3.0, 1.4).unwrap();
                assert!((back.0 - at.0).abs() < 1e-5 && (back.1 - at.1).abs() < 1e-5);
            }
            assert!((direction_of(&c).length() - 1.0).abs() < 1e-6);
        }
        let behind = eye(&camera()) - forward(&camera());
        assert_eq!(project(&camera(), behind, 1.0), None);
    }

    fn direction_of(c: &Camera) -> Vec3 {
        ray(c, (0.3, 0.3), 1.0).1
    }

    #[test]
    fn framing_shows_every_corner() {
        let bounds = (Vec3::new(-3.0, 0.0, 1.0), Vec3::new(5.0, 2.0, 2.0));
        for aspect_ratio in [0.5, 1.0, 2.0] {
            for (axis, name) in Axis::ALL {
                let mut c = camera();
                look_along(&mut c, axis, Vec3::ZERO);
                let center = frame_all(&mut c, bounds, aspect_ratio);
                for k in 0..8 {
                    let pick = |i: u32, a: f32, b: f32| if k >> i & 1 == 0 { a } else { b };
                    let corner = Vec3::new(
                        pick(0, bounds.0.x, bounds.1.x),
                        pick(1, bounds.0.y, bounds.1.y),
                        pick(2, bounds.0.z, bounds.1.z),
                    );
                    let (x, y) = project(&c, corner, aspect_ratio).unwrap();
                    assert!(x.abs() <= 1.0 && y.abs() <= 1.0, "{name} {aspect_ratio}: {x} {y}");
                }
                let middle = project(&c, center, aspect_ratio).unwrap();
                assert!(middle.0.abs() < 1e-5 && middle.1.abs() < 1e-5);
                assert!(is_rigid(&c));
            }
        }
    }

    #[test]
    fn panning_and_flying_are_along_the_cameras_axes() {
        let mut c = camera();
        let m = c.world_from_camera.matrix3;
        let start = eye(&c);
        pan(&mut c, 2.0, 3.0);
        fly(&mut c, Vec3::new(-2.0, -3.0, 1.5));
        let moved = eye(&c) - start;
        assert!((moved - forward(&c) * 1.5).length() < 1e-5);
        assert_eq!(c.world_from_camera.matrix3, m);
    }
}
