//! The scene as plain data: what was read from a file, in the units and spaces
//! of glTF 2.0 (metres, +Y up, right-handed, linear Rec. 709 radiance), with no
//! knowledge of any device.
//!
//! Geometry stays in object space and is shared between [`Instance`]s; spheres,
//! lights and cameras are in world space.

mod camera;
mod camera_file;
mod camera_matrices;
mod content_hash;
mod environment;
pub mod gltf;
mod guard;
mod light;
mod material;
mod mesh;
mod precision;
mod texture;
mod usage;

pub use camera::{Camera, Projection};
pub(crate) use content_hash::Fnv;
pub use environment::Environment;
pub use light::{LightKind, PunctualLight};
pub use material::{
    AlphaMode, Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, Material, Sheen,
    SpecularGlossiness,
};
pub use mesh::{Instance, Mesh, Sphere};
pub use texture::{ColorSpace, Image, TextureRef, Wrap};
pub use usage::SphereAnchor;

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
    /// The file's animations; the scene is what one of them shows, or the rest pose.
    pub animations: Vec<Animation>,
    /// Names of the file's material variants (KHR_materials_variants).
    pub variants: Vec<String>,
    /// What of the file is honoured, approximated or ignored.
    pub notices: Vec<Notice>,
}

/// An animation of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Animation {
    /// Its name in the file, or nothing.
    pub name: String,
    /// Time of its last keyframe, seconds; NaN where its keyframes are broken.
    pub duration: f64,
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
        let spheres = self.spheres.iter().map(|s| (s.center - s.radius, s.center + s.radius));
        spheres.chain(self.mesh_bounds()).reduce(|(a, b), (lo, hi)| (a.min(lo), b.max(hi)))
    }

    /// World-space bounds (min, max) of the meshes; `None` without any.
    pub fn mesh_bounds(&self) -> Option<(Vec3, Vec3)> {
        let place = |i: &Instance| {
            let m = i.world_from_object;
            let points = self.meshes[i.mesh as usize].positions.iter();
            points.map(|&p| m.transform_point3(p)).fold(None, |b: Option<(Vec3, Vec3)>, p| {
                Some(b.map_or((p, p), |(lo, hi)| (lo.min(p), hi.max(p))))
            })
        };
        self.instances.iter().filter_map(place).reduce(|(a, b), (lo, hi)| (a.min(lo), b.max(hi)))
    }

    /// Number of triangles after instancing, and of spheres.
    pub fn primitive_count(&self) -> usize {
        let triangles: usize =
            self.instances.iter().map(|i| self.meshes[i.mesh as usize].triangles.len()).sum();
        triangles + self.spheres.len()
    }
}
