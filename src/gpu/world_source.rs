//! Primitives in scene order, before any tree: each has a fixed index, its source.

use super::emission::{EmissionTexture, luminance_weights};
use super::environment::luminance;
use super::world::{Emitter, EmitterShape};
use crate::scene::{Instance, Mesh, Scene, SphereAnchor};
use crate::shader::generated::{INVALID, attribute};
use glam::{Affine3A, Mat3A, Vec3, Vec4};

/// A triangle in the space of its tree, counter-clockwise from the front.
pub(super) struct Triangle {
    pub(super) vertices: [Vec3; 3],
    pub(super) material: u32,
    /// Camera rays pass through its back.
    pub(super) is_culled: bool,
    pub(super) light: u32,
    pub(super) source: u32,
    corners: [u32; 4],
}

/// A sphere in world space.
pub(super) struct SourceSphere {
    pub(super) center: Vec3,
    pub(super) radius: f32,
    material: u32,
    light: u32,
    source: u32,
    anchor: Option<SphereAnchor>,
}

/// A placement of a shared mesh.
pub(super) struct SourceInstance {
    /// Index into [`Sources::shared`].
    pub(super) shared: usize,
    pub(super) world_from_object: Affine3A,
}

/// Everything that is traced.
#[derive(Default)]
pub(super) struct Sources {
    /// Triangles in world space.
    pub(super) top: Vec<Triangle>,
    pub(super) spheres: Vec<SourceSphere>,
    /// Triangles of shared meshes, in object space.
    pub(super) shared: Vec<Vec<Triangle>>,
    pub(super) instances: Vec<SourceInstance>,
    pub(super) emitters: Vec<Emitter>,
    vertices: Vec<Vertex>,
    has_attributes: bool,
    has_vertex_data: bool,
    /// By mesh: camera rays pass through its back.
    is_culled: Vec<bool>,
}

#[derive(Clone, Copy)]
struct Vertex {
    normal: Vec3,
    uv: [f32; 4],
    color: Vec4,
    tangent: Vec4,
}

impl Sources {
    /// All primitives of `scene`; nothing is shared unless `share`.
    pub(super) fn gather(scene: &Scene, share: bool) -> Self {
        let is_shared = scene.shared_meshes();
        let mut sources = Self { is_culled: scene.culled_meshes(), ..Self::default() };
        let mut shared_index = vec![None; scene.meshes.len()];
        for instance in &scene.instances {
            if !(share && is_shared[instance.mesh as usize]) {
                let triangles = sources.place(scene, instance.mesh, Some(instance));
                sources.top.extend(triangles);
                continue;
            }
            let shared = *shared_index[instance.mesh as usize].get_or_insert_with(|| {
                let triangles = sources.place(scene, instance.mesh, None);
                sources.shared.push(triangles);
                sources.shared.len() - 1
            });
            let world_from_object = instance.world_from_object;
            sources.instances.push(SourceInstance { shared, world_from_object });
        }
        for sphere in &scene.spheres {
            let source = sources.count() as u32;
            let shape = EmitterShape::Sphere { center: sphere.center, radius: sphere.radius };
            let cells = || (1, vec![whole_luminance(scene, sphere.material)]);
            let light = sources.emitter(scene, sphere.material, source, shape, cells);
            sources.spheres.push(SourceSphere {
                center: sphere.center,
                radius: sphere.radius,
                material: sphere.material,
                light,
                source,
                anchor: scene.anchor_of(sphere),
            });
        }
        sources
    }

    /// Primitives held, each once.
    pub(super) fn count(&self) -> usize {
        self.triangle_count() + self.spheres.len()
    }

    pub(super) fn triangle_count(&self) -> usize {
        self.top.len() + self.shared.iter().map(Vec::len).sum::<usize>()
    }

    /// The light of an emitting surface, or INVALID; the first of a divided triangle. `cells` are
    /// its number along a side and the mean luminance of each.
    fn emitter(
        &mut self,
        scene: &Scene,
        material: u32,
        source: u32,
        shape: EmitterShape,
        cells: impl FnOnce() -> (u32, Vec<f64>),
    ) -> u32 {
        let m = &scene.materials[material as usize];
        let has_area = match shape {
            EmitterShape::Triangle([a, b, c]) => (b - a).cross(c - a) != Vec3::ZERO,
            EmitterShape::Sphere { .. } => true,
        };
        if !m.is_emissive() || !has_area {
            return INVALID;
        }
        let first = self.emitters.len() as u32;
        let (side, luminances) = cells();
        self.emitters.extend(luminances.into_iter().zip(0..).map(|(luminance, k)| Emitter {
            material,
            source,
            shape,
            luminance,
            cell: [k, side],
        }));
        first
    }

    /// The triangles of a mesh, in world space if placed by an instance.
    fn place(&mut self, scene: &Scene, index: u32, instance: Option<&Instance>) -> Vec<Triangle> {
        let mesh = &scene.meshes[index as usize];
        let is_culled = self.is_culled[index as usize];
        let placement = instance.map_or(Affine3A::IDENTITY, |i| i.world_from_object);
        let mirrored = placement.matrix3.determinant() < 0.0;
        let flags = mesh_flags(mesh);
        let first_vertex = self.vertices.len() as u32;
        if flags != 0 {
            self.has_attributes = true;
            self.has_vertex_data |= flags & !attribute::NORMAL != 0;
            self.add_vertices(mesh, placement, mirrored);
        }
        let emission = emission_texture(scene, mesh);
        let first_source = self.count() as u32;
        let mut triangles = Vec::with_capacity(mesh.triangles.len());
        for (k, &[a, b, c]) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = if mirrored { [a, c, b] } else { [a, b, c] };
            let at = |i: u32| placement.transform_point3(mesh.positions[i as usize]);
            let vertices = [at(a), at(b), at(c)];
            let source = first_source + k as u32;
            let cells = || match &emission {
                Some((texture, uvs)) => texture.cells([a, b, c].map(|i| uvs[i as usize])),
                None => (1, vec![whole_luminance(scene, mesh.material)]),
            };
            let shape = EmitterShape::Triangle(vertices);
            let light = self.emitter(scene, mesh.material, source, shape, cells);
            let corners = [first_vertex + a, first_vertex + b, first_vertex + c, flags];
            let corners = if flags == 0 { [0; 4] } else { corners };
            let material = mesh.material;
            triangles.push(Triangle { vertices, material, is_culled, light, source, corners });
        }
        triangles
    }

    fn add_vertices(&mut self, mesh: &Mesh, placement: Affine3A, mirrored: bool) {
        // Cofactors, so that normals keep their side whatever the scale (its sign
        // is taken out again: a mirrored front is still the front).
        let inverse_transpose = placement.matrix3.inverse().transpose();
        let turn = |m: Mat3A, v: Vec3| (m * v).normalize_or_zero();
        let side = if mirrored { -1.0 } else { 1.0 };
        let uv = |set: &[glam::Vec2], i: usize| set.get(i).map_or([0.0; 2], |v| v.to_array());
        for i in 0..mesh.positions.len() {
            let normal = mesh.normals.get(i).map_or(Vec3::ZERO, |&n| turn(inverse_transpose, n));
            let tangent = mesh
                .tangents
                .get(i)
                .map_or(Vec4::ZERO, |t| turn(placement.matrix3, t.truncate()).extend(t.w * side));
            let ([u0, v0], [u1, v1]) = (uv(&mesh.uvs[0], i), uv(&mesh.uvs[1], i));
            let color = mesh.colors.get(i).copied().unwrap_or(Vec4::ONE);
            self.vertices.push(Vertex { normal, uv: [u0, v0, u1, v1], color, tangent });
        }
    }

    /// `attributes`, where its vertices begin, and `vec4`s of a vertex.
    pub(super) fn attributes(&self) -> (Vec<[u32; 4]>, u32, u32) {
        if !self.has_attributes {
            return (Vec::new(), 0, 1);
        }
        let mut words = vec![[0; 4]; self.count()];
        for t in self.top.iter().chain(self.shared.iter().flatten()) {
            words[t.source as usize] = t.corners;
        }
        let base = words.len() as u32;
        for v in &self.vertices {
            words.push(v.normal.extend(0.0).to_array().map(f32::to_bits));
            if self.has_vertex_data {
                words.push(v.uv.map(f32::to_bits));
                words.push(v.color.to_array().map(f32::to_bits));
                words.push(v.tangent.to_array().map(f32::to_bits));
            }
        }
        (words, base, if self.has_vertex_data { 4 } else { 1 })
    }

    pub(super) fn sphere_records(&self) -> Vec<[[u32; 4]; 3]> {
        let word = |v: Vec3, w: u32| [v.x.to_bits(), v.y.to_bits(), v.z.to_bits(), w];
        let record = |s: &SourceSphere| {
            let (point, normal) = s.anchor.map_or((s.center, Vec3::ZERO), |a| (a.point, a.normal));
            let radius = [s.radius.to_bits(), u32::from(s.anchor.is_some()), 0, s.light];
            [word(point, s.material), radius, word(normal, s.source)]
        };
        self.spheres.iter().map(record).collect()
    }
}

/// Mean luminance of what a material emits where nothing is known of its texture coordinates.
fn whole_luminance(scene: &Scene, material: u32) -> f64 {
    let (emission, texture) = scene.materials[material as usize].emitted();
    match texture {
        Some(texture) => {
            EmissionTexture::new(texture, &scene.images, luminance_weights(emission), 1).mean
        }
        None => luminance(emission),
    }
}

/// The mesh's emission texture with the coordinates that it is looked up by.
fn emission_texture<'a>(
    scene: &'a Scene,
    mesh: &'a Mesh,
) -> Option<(EmissionTexture<'a>, &'a [glam::Vec2])> {
    let m = &scene.materials[mesh.material as usize];
    let (emission, texture) = m.emitted();
    let texture = texture.filter(|_| m.is_emissive())?;
    let uvs = &mesh.uvs[texture.uv_set as usize];
    if uvs.is_empty() {
        return None;
    }
    let weights = luminance_weights(emission);
    let triangles = emissive_textured_triangles(scene);
    Some((EmissionTexture::new(texture, &scene.images, weights, triangles), uvs))
}

fn emissive_textured_triangles(scene: &Scene) -> usize {
    let meshes = scene.instances.iter().map(|i| &scene.meshes[i.mesh as usize]);
    let has_texture = |mesh: &&Mesh| {
        let m = &scene.materials[mesh.material as usize];
        m.is_emissive() && m.emitted().1.is_some()
    };
    meshes.filter(has_texture).map(|mesh| mesh.triangles.len()).sum()
}

fn mesh_flags(mesh: &Mesh) -> u32 {
    let flag = |holds: bool, bit: u32| if holds { bit } else { 0 };
    flag(!mesh.normals.is_empty(), attribute::NORMAL)
        | flag(!mesh.uvs[0].is_empty() || !mesh.uvs[1].is_empty(), attribute::UV)
        | flag(!mesh.colors.is_empty(), attribute::COLOR)
        | flag(!mesh.tangents.is_empty(), attribute::TANGENT)
}
