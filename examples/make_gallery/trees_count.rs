//! What a camera ray touches in a tree, counted by the traversal's twin on the host.

use crate::clock::own_seconds;
use glam::Vec3;
use std::path::Path;
use steradian::bvh::{
    Aabb, BuildItem, Bvh, PrimitiveKind, Ray, build_median, build_sah, closest_hit_counted,
    triangle_hit,
};
use steradian::scene::gltf::{LoadOptions, load_with};
use steradian::scene::{Projection, Scene};

/// A scene's triangles in the world.
pub(crate) struct Triangles {
    vertices: Vec<[Vec3; 3]>,
    rays: Vec<Ray>,
}

/// A tree's figures.
pub(crate) struct Figures {
    /// Processor time of a build, all threads.
    pub(crate) build_seconds: f64,
    /// Of a camera ray on average.
    pub(crate) nodes: f64,
    /// Triangles that a camera ray is tested against, on average.
    pub(crate) triangles: f64,
}

impl Triangles {
    /// Those of the scene at `path`, and rays through the centres of `side`² pixels.
    pub(crate) fn load(path: &str, side: u32) -> Result<Self, String> {
        let scene =
            load_with(Path::new(path), &LoadOptions::default()).map_err(|e| e.to_string())?;
        let mut vertices = Vec::new();
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh as usize];
            let placed =
                |i: u32| instance.world_from_object.transform_point3(mesh.positions[i as usize]);
            vertices.extend(mesh.triangles.iter().map(|corners| corners.map(placed)));
        }
        Ok(Self { rays: camera_rays(&scene, side)?, vertices })
    }

    /// How many.
    pub(crate) fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Of the tree by the surface area heuristic.
    pub(crate) fn sah(&self) -> Figures {
        self.figures(build_sah)
    }

    /// Of the tree by medians.
    pub(crate) fn median(&self) -> Figures {
        self.figures(build_median)
    }

    fn figures(&self, build: fn(&[BuildItem]) -> Bvh) -> Figures {
        let item =
            |v: &[Vec3; 3]| BuildItem { bounds: Aabb::of_points(v), kind: PrimitiveKind::Triangle };
        let items: Vec<_> = self.vertices.iter().map(item).collect();
        let bvh = build(&items);
        let (begin, mut builds) = (own_seconds(), 0);
        let build_seconds = loop {
            build(&items);
            builds += 1;
            let seconds = own_seconds() - begin;
            // Long beside a tick of the clock; without one, there is no figure.
            if seconds > 0.5 || seconds.is_nan() {
                break seconds / f64::from(builds);
            }
        };
        let (mut nodes, mut triangles) = (0, 0);
        for ray in &self.rays {
            let (_, counts) = closest_hit_counted::<false>(&bvh, ray, |_, item, t_max| {
                let [a, b, c] = self.vertices[item as usize];
                triangle_hit(ray.o, ray.d, a, b, c, t_max).map(|hit| hit.t)
            });
            nodes += counts.nodes;
            triangles += counts.items;
        }
        let of_ray = |count: u64| count as f64 / self.rays.len() as f64;
        Figures { build_seconds, nodes: of_ray(nodes), triangles: of_ray(triangles) }
    }
}

/// Rays of the first camera, which must be a perspective one.
fn camera_rays(scene: &Scene, side: u32) -> Result<Vec<Ray>, String> {
    let camera = &scene.cameras[0];
    let Projection::Perspective { yfov } = camera.projection else {
        return Err("the camera is orthographic".into());
    };
    let half = (0.5 * yfov).tan();
    let o = Vec3::from(camera.world_from_camera.translation);
    let along = |i: u32| (2.0 * (i as f32 + 0.5) / side as f32 - 1.0) * half;
    let ray = |i: u32| {
        let d = Vec3::new(along(i % side), -along(i / side), -1.0);
        let d = camera.world_from_camera.transform_vector3(d).normalize();
        Ray { o, d, t_max: f32::INFINITY }
    };
    Ok((0..side * side).map(ray).collect())
}
