//! How far things have moved in the picture since an earlier time.

use crate::gpu::{GpuFirstHit, Objects};
use crate::scene::{Camera, Projection, Scene};
use crate::settings::{Accel, RenderSettings};
use crate::{Error, Result};
use glam::{DMat4, DVec2, DVec3, DVec4};

/// A scene at an earlier time, seen from where the camera was then.
pub(super) struct Motion {
    before: Scene,
    camera: Camera,
    /// Whether vertices of the placements' triangles have changed places: they are mirrored.
    is_mirrored: Vec<bool>,
    /// Centres and radii of the spheres now.
    spheres: Vec<(DVec3, f64)>,
    pixel_from_world_before: DMat4,
    resolution: (u32, u32),
}

impl Motion {
    /// `before` is the same file at another time.
    ///
    /// # Errors
    /// [`Error::Settings`] where it has not the same objects.
    pub(super) fn new(scene: &Scene, before: Scene, settings: &RenderSettings) -> Result<Self> {
        let meshes = |scene: &Scene| -> Vec<_> {
            scene
                .instances
                .iter()
                .map(|i| scene.meshes[i.mesh as usize].triangles.clone())
                .collect()
        };
        let is_same =
            scene.spheres.len() == before.spheres.len() && meshes(scene) == meshes(&before);
        if !is_same {
            let message =
                "layer motion: at the earlier time the scene has other objects or triangles";
            return Err(Error::Settings(message.into()));
        }
        let camera = scene.cameras[settings.camera].clone();
        // A camera that is not the file's stays where it is.
        let earlier = before.cameras.get(settings.camera).filter(|c| c.name == camera.name);
        let earlier = Camera {
            world_from_camera: earlier.unwrap_or(&camera).world_from_camera,
            projection: earlier.unwrap_or(&camera).projection,
            ..camera.clone()
        };
        let is_shared = scene.shared_meshes();
        let shares = settings.accel != Accel::None;
        let is_mirrored = |i: &crate::scene::Instance| {
            !(shares && is_shared[i.mesh as usize])
                && i.world_from_object.matrix3.determinant() < 0.0
        };
        let sphere = |s: &crate::scene::Sphere| (s.center.as_dvec3(), f64::from(s.radius));
        let resolution = settings.resolution;
        let size = DVec3::new(resolution.0.into(), resolution.1.into(), 1.0);
        Ok(Self {
            camera,
            is_mirrored: scene.instances.iter().map(is_mirrored).collect(),
            spheres: scene.spheres.iter().map(sphere).collect(),
            pixel_from_world_before: DMat4::from_scale(size) * earlier.ndc_from_world(resolution),
            resolution,
            before,
        })
    }

    /// Pixels to the right and down since the earlier time, of what the ray through the centre of
    /// pixel `at` of the picture meets; of the background, as far away as can be. 0 for what was
    /// behind the camera.
    pub(super) fn of(&self, at: (u32, u32), hit: &GpuFirstHit, objects: &Objects) -> [f32; 2] {
        let centre = DVec2::new(f64::from(at.0) + 0.5, f64::from(at.1) + 0.5);
        let point = match objects.find(hit.source, hit.instance) {
            Some(object) => self.point_before(object, centre, hit, objects).extend(1.0),
            None => self.ray(centre).1.extend(0.0),
        };
        let DVec4 { x, y, w, .. } = self.pixel_from_world_before * point;
        match w > 0.0 {
            true => (centre - DVec2::new(x, y) / w).as_vec2().to_array(),
            false => [0.0; 2],
        }
    }

    /// Where the point that is met now was, world space.
    fn point_before(
        &self,
        object: u32,
        centre: DVec2,
        hit: &GpuFirstHit,
        objects: &Objects,
    ) -> DVec3 {
        let object = object as usize;
        let Some(instance) = self.before.instances.get(object) else {
            let sphere = object - self.before.instances.len();
            let ((now, radius), before) = (self.spheres[sphere], &self.before.spheres[sphere]);
            let (origin, direction) = self.ray(centre);
            let outward = (origin + f64::from(hit.centre_depth) * direction - now) / radius;
            return before.center.as_dvec3() + outward * f64::from(before.radius);
        };
        let mesh = &self.before.meshes[instance.mesh as usize];
        let [a, b, c] = mesh.triangles[objects.primitive(hit.source) as usize];
        let [a, b, c] = if self.is_mirrored[object] { [a, c, b] } else { [a, b, c] };
        let at = |i: u32| mesh.positions[i as usize].as_dvec3();
        let [u, v] = hit.weights.map(f64::from);
        let m = instance.world_from_object;
        let [x, y, z] =
            [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis].map(|c| c.as_dvec3());
        let p = at(a) * (1.0 - u - v) + at(b) * u + at(c) * v;
        x * p.x + y * p.y + z * p.z + m.translation.as_dvec3()
    }

    /// Origin and unit direction of the ray through a place of the picture, now, through the lens's
    /// centre.
    fn ray(&self, place: DVec2) -> (DVec3, DVec3) {
        let m = self.camera.world_from_camera;
        let [right, up, back] =
            [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis].map(|axis| axis.as_dvec3());
        let (width, height) = (f64::from(self.resolution.0), f64::from(self.resolution.1));
        let film = |half_height: f64| {
            let x = (2.0 * place.x / width - 1.0) * half_height * width / height;
            right * x + up * ((1.0 - 2.0 * place.y / height) * half_height)
        };
        let eye = m.translation.as_dvec3();
        match self.camera.projection {
            Projection::Perspective { yfov } => {
                (eye, (film((f64::from(yfov) * 0.5).tan()) - back).normalize())
            }
            Projection::Orthographic { ymag } => (eye + film(ymag.into()), -back),
        }
    }
}
