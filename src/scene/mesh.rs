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
    /// Texture coordinates of sets 0 and 1; (0, 0) is the upper left corner.
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

    /// Whether every edge of a triangle is another's in the opposite direction, as on the surface
    /// of a solid. Vertices at the same position count as one.
    ///
    /// Compares sums of hashes over the directed edges and over the reversed ones: an open mesh
    /// passes with a probability of about 2^-64.
    pub fn is_closed(&self) -> bool {
        let hashes: Vec<u64> = self.positions.iter().map(|&p| position_hash(p)).collect();
        let mut difference = 0_u64;
        for &[a, b, c] in &self.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let (from, to) = (hashes[from as usize], hashes[to as usize]);
                difference =
                    difference.wrapping_add(edge_hash(from, to)).wrapping_sub(edge_hash(to, from));
            }
        }
        difference == 0
    }
}

/// Of a position; -0 is 0.
fn position_hash(p: Vec3) -> u64 {
    (p + 0.0).to_array().iter().fold(0, |hash, c| mix(hash ^ u64::from(c.to_bits())))
}

/// Of the edge in this direction.
fn edge_hash(from: u64, to: u64) -> u64 {
    mix(from.wrapping_add(mix(to)))
}

/// SplitMix64 (Steele, Lea and Flood 2014).
fn mix(state: u64) -> u64 {
    let z = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, -Vec3::ZERO],
            triangles: vec![[0, 2, 1], [4, 1, 3], [0, 3, 2], [1, 2, 3]],
            ..Mesh::default()
        }
    }

    #[test]
    fn a_solid_is_closed() {
        assert!(tetrahedron().is_closed());
    }

    #[test]
    fn a_hole_or_a_turned_triangle_opens_it() {
        let mut mesh = tetrahedron();
        mesh.triangles[3] = [1, 3, 2];
        assert!(!mesh.is_closed());
        mesh.triangles.pop();
        assert!(!mesh.is_closed());
    }
}
