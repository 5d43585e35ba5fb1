//! The scene as plain data: what was read from a file, in the units and spaces
//! of glTF 2.0 (metres, +Y up, right-handed, linear Rec. 709 radiance), with no
//! knowledge of any device.
//!
//! Geometry stays in object space and is shared between [`Instance`]s; spheres,
//! lights and cameras are in world space.

mod camera;
mod environment;
pub mod gltf;
mod light;
mod material;
mod mesh;
mod texture;

pub use camera::{Camera, Projection};
pub use environment::Environment;
pub use light::{LightKind, PunctualLight};
pub use material::{AlphaMode, Material};
pub use mesh::{Instance, Mesh, Sphere};
pub use texture::{ColorSpace, Image, TextureRef, Wrap};

use glam::Vec3;

/// Everything that can be rendered from one file.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// The file's stem; used in messages and output names.
    pub name: String,
    /// One entry for each glTF mesh primitive that has triangles.
    pub meshes: Vec<Mesh>,
    /// Placements of meshes.
    pub instances: Vec<Instance>,
    /// Analytic spheres, one for each placement.
    pub spheres: Vec<Sphere>,
    /// Materials that meshes and spheres index.
    pub materials: Vec<Material>,
    /// Decoded images that textures index.
    pub images: Vec<Image>,
    /// Point, spot and directional lights.
    pub lights: Vec<PunctualLight>,
    /// Light from infinity.
    pub environment: Option<Environment>,
    /// Cameras of the file in node order; never empty after loading: where the
    /// file has none, a default one frames the scene.
    pub cameras: Vec<Camera>,
    /// What of the file is honoured, approximated or ignored.
    pub notices: Vec<Notice>,
}

/// One line about a feature of the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Notice {
    /// How faithfully it is treated.
    pub treatment: Treatment,
    /// The feature and, unless honoured, where it occurs and what happens instead.
    pub message: String,
}

/// How a feature of a file is treated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Treatment {
    /// Rendered as the specification says.
    Honoured,
    /// Rendered, with a stated difference.
    Approximated,
    /// Has no effect on the picture.
    Ignored,
}

impl Scene {
    /// World-space bounds (min, max) of all geometry; `None` without geometry.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let mut bounds: Option<(Vec3, Vec3)> = None;
        let mut grow = |lo: Vec3, hi: Vec3| {
            bounds = Some(match bounds {
                None => (lo, hi),
                Some((a, b)) => (a.min(lo), b.max(hi)),
            });
        };
        for instance in &self.instances {
            for &p in &self.meshes[instance.mesh as usize].positions {
                let p = instance.world_from_object.transform_point3(p);
                grow(p, p);
            }
        }
        for s in &self.spheres {
            grow(s.center - s.radius, s.center + s.radius);
        }
        bounds
    }

    /// Number of triangles after instancing, and of spheres.
    pub fn primitive_count(&self) -> usize {
        let triangles: usize =
            self.instances.iter().map(|i| self.meshes[i.mesh as usize].triangles.len()).sum();
        triangles + self.spheres.len()
    }
}
