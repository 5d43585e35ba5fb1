//! Geometry and its placements.

use glam::{Affine3A, Vec2, Vec3, Vec4};

/// An indexed triangle mesh in object space: one glTF primitive.
///
/// The attribute arrays are empty when the file does not have them, and as long
/// as `positions` otherwise.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// The glTF mesh's name and, where it has several primitives, which one.
    pub name: String,
    /// Vertex positions; every one is finite.
    pub positions: Vec<Vec3>,
    /// Unit shading normals. Empty means flat shading.
    pub normals: Vec<Vec3>,
    /// Unit tangents; w is the sign of the bitangent, `cross(normal, tangent) * w`.
    pub tangents: Vec<Vec4>,
    /// Texture coordinates of the two sets that the material can use, 0 and 1 of the file unless
    /// it uses others; (0, 0) is the upper left corner.
    pub uvs: [Vec<Vec2>; 2],
    /// Linear vertex colours that multiply the base colour.
    pub colors: Vec<Vec4>,
    /// Vertex indices, counter-clockwise seen from the front. Every index is in range.
    pub triangles: Vec<[u32; 3]>,
    /// Index into [`super::Scene::materials`].
    pub material: u32,
}

impl Mesh {
    /// Bounds (min, max) of the vertices in object space; `None` without any.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let points = self.positions.iter().map(|&p| (p, p));
        points.reduce(|(low, high), (p, _)| (low.min(p), high.max(p)))
    }
}

/// A placed mesh.
#[derive(Debug, Clone)]
pub struct Instance {
    /// The node's name.
    pub name: String,
    /// Index into [`super::Scene::meshes`].
    pub mesh: u32,
    /// Places object space in the world. Finite and invertible; the determinant
    /// may be negative (mirrored: the front face is then clockwise in world space).
    pub world_from_object: Affine3A,
}

/// An analytic sphere in world space.
#[derive(Debug, Clone)]
pub struct Sphere {
    /// The node's name.
    pub name: String,
    /// Centre.
    pub center: Vec3,
    /// Radius, positive and finite.
    pub radius: f32,
    /// Index into [`super::Scene::materials`].
    pub material: u32,
}
