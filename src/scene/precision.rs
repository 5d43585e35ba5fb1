//! Where single precision is too coarse for a scene, in words for whoever renders it.

use super::{Camera, Instance, Notice, Projection, Scene, Sphere, Treatment};
use glam::{Affine3A, Vec3};

/// An object of fewer units in the last place of its largest coordinate is coarse: rays
/// leave surfaces by 8 of these units, which is then more than 0.4 % of its size.
const LEAST_SIZE: f32 = 2048.0;

/// A pixel of fewer of the smallest steps between rays is coarse: its edges are off by
/// more than an eighth of its width.
const LEAST_PIXEL: f64 = 8.0;

/// Smallest step of a unit vector's component between ½ and 1.
const DIRECTION_STEP: f64 = 1.0 / 16_777_216.0;

impl Scene {
    /// What is too small for its distance from the origin: at most one line for the meshes
    /// and one for the spheres.
    pub fn precision_notices(&self) -> Vec<Notice> {
        let coarse_spheres = self.spheres.iter().enumerate().filter(|(_, s)| is_coarse_sphere(s));
        let boxes: Vec<_> = self.meshes.iter().map(|mesh| mesh.bounds()).collect();
        let is_coarse = |i: &Instance| {
            boxes[i.mesh as usize].is_some_and(|b| is_coarse_box(&i.world_from_object, b))
        };
        let coarse_meshes = self.instances.iter().enumerate().filter(|(_, i)| is_coarse(i));
        let spheres = notice("sphere", coarse_spheres.map(|(k, s)| (k, s.name.as_str())));
        let meshes = notice("mesh", coarse_meshes.map(|(k, i)| (k, i.name.as_str())));
        spheres.into_iter().chain(meshes).collect()
    }
}

/// One line for all objects of a kind: their indices and names.
fn notice<'a>(kind: &str, mut objects: impl Iterator<Item = (usize, &'a str)>) -> Option<Notice> {
    let (index, name) = objects.next()?;
    let count = 1 + objects.count();
    let place = match count {
        1 => format!("number {index} {name:?}"),
        _ => format!("{count} times, first number {index} {name:?}"),
    };
    let message = format!(
        "{kind} too small for its distance from the origin: coordinates in single precision \
         make its surface coarse; move the scene to the origin ({place})"
    );
    Some(Notice { treatment: Treatment::Approximated, message })
}

/// Distance between neighbouring numbers of this size.
fn step(size: f32) -> f32 {
    size.next_up() - size
}

fn is_coarse_sphere(sphere: &Sphere) -> bool {
    sphere.radius < LEAST_SIZE * step(sphere.center.length())
}

/// Of the box of a placed mesh; one without any extent has nothing to render.
fn is_coarse_box(world_from_object: &Affine3A, (low, high): (Vec3, Vec3)) -> bool {
    let corners = (0..8).map(|corner| {
        let is_high = glam::BVec3::new(corner & 1 != 0, corner & 2 != 0, corner & 4 != 0);
        world_from_object.transform_point3(Vec3::select(is_high, high, low))
    });
    let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = corners.fold(empty, |(lo, hi), p| (lo.min(p), hi.max(p)));
    let size = (high - low).max_element();
    size > 0.0 && size < LEAST_SIZE * step(low.abs().max(high.abs()).max_element())
}

impl Camera {
    /// Says so if neighbouring pixels of a picture of this size have nearly the same rays.
    pub fn precision_notice(&self, (_, height): (u32, u32)) -> Option<Notice> {
        let rows = f64::from(height);
        let (pixel, least, remedy) = match self.projection {
            Projection::Perspective { yfov } => {
                let pixel = 2.0 * (f64::from(yfov) * 0.5).tan() / rows;
                let remedy = "use a wider field of view, nearer, or fewer pixels";
                (pixel, DIRECTION_STEP, remedy)
            }
            Projection::Orthographic { ymag } => {
                let place = Vec3::from(self.world_from_camera.translation).abs().max_element();
                let remedy = "move the scene to the origin, or use fewer pixels";
                (2.0 * f64::from(ymag) / rows, f64::from(step(place)), remedy)
            }
        };
        (pixel < LEAST_PIXEL * least).then(|| Notice {
            treatment: Treatment::Approximated,
            message: format!(
                "camera {:?}: a pixel is only {:.1} of single precision's steps wide: {remedy}",
                self.name,
                pixel / least
            ),
        })
    }
}
