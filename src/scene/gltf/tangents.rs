//! Tangents by MikkTSpace, for normal maps and anisotropy on meshes that bring none.

use super::notices::Notices;
use crate::scene::{Material, Mesh, TextureRef};
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3, Vec4};
use std::collections::HashMap;

/// Gives `mesh` tangents where its material needs them and the file has none.
pub(super) fn add(mesh: &mut Mesh, material: &Material, what: &str, notices: &mut Notices) {
    let Some(texture) = material.tangent_texture().filter(|_| mesh.tangents.is_empty()) else {
        return;
    };
    let coordinates = |t: TextureRef| (t.uv_set, t.transform);
    if let (Some(base), Some(coat)) = (material.normal_texture, material.clearcoat_normals())
        && coordinates(base) != coordinates(coat)
    {
        let message = "clearcoatNormalTexture with other coordinates than normalTexture: \
             its normals are turned by the tangents of that one";
        notices.approximated(message, what);
    }
    let uvs = &mesh.uvs[texture.map_or(0, |t| t.uv_set as usize)];
    if !uvs.is_empty() && !generate(mesh, texture) {
        let message = "tangents where texture coordinates have no area: arbitrary";
        notices.approximated(message, what);
    }
}

/// Makes tangents from the coordinates of `texture`, by default those of set 0. Vertices are split
/// where tangents differ. False if coordinates gave no direction somewhere.
///
/// The coordinates are the texture's own, after KHR_texture_transform: a map that is turned on the
/// surface has its tangents turned with it. Flat faces have their own normals here too.
fn generate(mesh: &mut Mesh, texture: Option<TextureRef>) -> bool {
    let uvs = &mesh.uvs[texture.map_or(0, |t| t.uv_set as usize)];
    let mut corners = Corners {
        uvs: match texture {
            Some(t) => uvs.iter().map(|&uv| t.transform.transform_point2(uv)).collect(),
            None => uvs.clone(),
        },
        mesh,
        tangents: vec![None; mesh.triangles.len()],
    };
    // Fails only for a mesh without faces, which is never read.
    let mut has_directions = generate_tangents(&mut corners).is_ok();
    let mut tangents = Vec::with_capacity(mesh.triangles.len());
    for (face, found) in corners.tangents.iter().enumerate() {
        let found = found.unwrap_or_default();
        tangents.push([0, 1, 2].map(|corner| {
            usable(found[corner]).unwrap_or_else(|| {
                has_directions = false;
                corners.normal_at(face, corner).any_orthonormal_vector().extend(1.0)
            })
        }));
    }
    split(mesh, &tangents);
    has_directions
}

/// A unit tangent with the sign that glTF means: v grows downwards in the image, the bitangent
/// points up.
fn usable(tangent: Option<Vec4>) -> Option<Vec4> {
    let tangent = tangent?;
    let direction = tangent.truncate().as_dvec3().try_normalize()?;
    Some(direction.as_vec3().extend(-tangent.w))
}

/// A mesh as the generator reads it.
struct Corners<'a> {
    mesh: &'a Mesh,
    uvs: Vec<Vec2>,
    /// For each corner of each triangle.
    tangents: Vec<Option<[Option<Vec4>; 3]>>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
    }

    fn normal_at(&self, face: usize, corner: usize) -> Vec3 {
        if let Some(&normal) = self.mesh.normals.get(self.vertex(face, corner)) {
            return normal;
        }
        let [a, b, c] =
            self.mesh.triangles[face].map(|i| self.mesh.positions[i as usize].as_dvec3());
        (b - a).cross(c - a).try_normalize().map_or(Vec3::Y, |n| n.as_vec3())
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].into()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.normal_at(face, corner).into()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.uvs[self.vertex(face, corner)].into()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let corners = self.tangents[face].get_or_insert_default();
        corners[corner] = space.map(|space| Vec4::from(space.tangent_encoded()));
    }
}

/// Gives every triangle's corners these tangents: a vertex becomes several where they differ.
fn split(mesh: &mut Mesh, tangents: &[[Vec4; 3]]) {
    let mut numbers = HashMap::new();
    let mut old_of_new = Vec::new();
    let mut of_vertices = Vec::new();
    let mut triangles = std::mem::take(&mut mesh.triangles);
    for (triangle, tangents) in triangles.iter_mut().zip(tangents) {
        for (index, &tangent) in triangle.iter_mut().zip(tangents) {
            let key = (*index, tangent.to_array().map(f32::to_bits));
            *index = *numbers.entry(key).or_insert_with(|| {
                old_of_new.push(*index as usize);
                of_vertices.push(tangent);
                of_vertices.len() as u32 - 1
            });
        }
    }
    fn gather<T: Copy>(values: &mut Vec<T>, of: &[usize]) {
        if !values.is_empty() {
            *values = of.iter().map(|&i| values[i]).collect();
        }
    }
    gather(&mut mesh.positions, &old_of_new);
    gather(&mut mesh.normals, &old_of_new);
    gather(&mut mesh.colors, &old_of_new);
    mesh.uvs.iter_mut().for_each(|uvs| gather(uvs, &old_of_new));
    mesh.triangles = triangles;
    mesh.tangents = of_vertices;
}
