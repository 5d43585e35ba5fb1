//! What of a scene is used, and how its geometry is best held.

use super::{Camera, Mesh, Projection, Scene, Sphere, TextureRef};
use glam::{DVec3, Vec3};
use std::collections::BTreeSet;

/// A mesh is held once and instanced when its copies would need more triangles
/// than this; below, copies in world space are faster to trace.
const LEAST_SHARED_TRIANGLES: usize = 4096;

/// A sphere this many times larger than the rest of the scene is traced in the anchored form.
const VAST: f32 = 50.0;

/// Where the anchored form of a sphere is exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereAnchor {
    /// The point of the sphere nearest to the rest of the scene.
    pub point: Vec3,
    /// Outward unit normal there.
    pub normal: Vec3,
}

impl Scene {
    /// For each mesh, whether its instances share one copy in object space. A mesh
    /// that emits is never shared: its lights are in world space.
    pub fn shared_meshes(&self) -> Vec<bool> {
        let mut uses = vec![0_usize; self.meshes.len()];
        for instance in &self.instances {
            uses[instance.mesh as usize] += 1;
        }
        let is_shared = |(mesh, &uses): (&Mesh, &usize)| {
            uses > 1
                && (uses - 1) * mesh.triangles.len() > LEAST_SHARED_TRIANGLES
                && !self.materials[mesh.material as usize].is_emissive()
        };
        self.meshes.iter().zip(&uses).map(is_shared).collect()
    }

    /// For each mesh, whether camera rays pass through its back: it is single-sided, open, and no
    /// boundary of a volume. The back of a closed mesh is seen only from inside, where it is wanted.
    pub fn culled_meshes(&self) -> Vec<bool> {
        let is_culled = |mesh: &Mesh| {
            let m = &self.materials[mesh.material as usize];
            !(m.double_sided || m.volume || m.unlit || mesh.is_closed())
        };
        self.meshes.iter().map(is_culled).collect()
    }

    /// Whether the back of any triangle that [`culled_meshes`](Self::culled_meshes) is about faces
    /// some point of this camera's lens; the triangle may be outside the picture, or hidden.
    pub fn has_culled_backs(&self, camera: &Camera) -> bool {
        let eye = camera.world_from_camera.translation.as_dvec3();
        let ahead = -camera.world_from_camera.matrix3.z_axis.as_dvec3();
        let is_culled = self.culled_meshes();
        self.instances.iter().filter(|i| is_culled[i.mesh as usize]).any(|instance| {
            let mesh = &self.meshes[instance.mesh as usize];
            let place = instance.world_from_object;
            let front = f64::from(place.matrix3.determinant().signum());
            mesh.triangles.iter().any(|corners| {
                let [a, b, c] =
                    corners.map(|i| place.transform_point3(mesh.positions[i as usize]).as_dvec3());
                let normal = (b - a).cross(c - a) * front;
                match camera.projection {
                    Projection::Orthographic { .. } => normal.dot(ahead) > 0.0,
                    Projection::Perspective { .. } => {
                        let reach = f64::from(camera.aperture_radius) * normal.length();
                        normal.dot(eye - a) < reach
                    }
                }
            })
        })
    }

    /// Materials of anything that is placed in the scene.
    pub fn used_materials(&self) -> BTreeSet<usize> {
        let of_meshes = self.instances.iter().map(|i| self.meshes[i.mesh as usize].material);
        of_meshes.chain(self.spheres.iter().map(|s| s.material)).map(|m| m as usize).collect()
    }

    /// The anchor of a sphere whose radius dwarfs the rest of the scene; `None` for others.
    pub fn anchor_of(&self, sphere: &Sphere) -> Option<SphereAnchor> {
        let mut rest = self.extent_without_spheres();
        let smaller = self.spheres.iter().filter(|s| s.radius * VAST < sphere.radius);
        for s in smaller {
            rest.push(s.center - s.radius);
            rest.push(s.center + s.radius);
        }
        let low = rest.iter().copied().reduce(Vec3::min)?;
        let high = rest.iter().copied().reduce(Vec3::max)?;
        let center: DVec3 = sphere.center.as_dvec3();
        let toward = (low.as_dvec3() + high.as_dvec3()) * 0.5 - center;
        let normal = toward.try_normalize()?;
        let point = center + normal * f64::from(sphere.radius);
        // The form is exact near the anchor only, so the rest must be near it: a lone camera
        // has no extent of its own.
        let (low, high) = (low.min(point.as_vec3()), high.max(point.as_vec3()));
        if sphere.radius <= VAST * low.distance(high) {
            return None;
        }
        Some(SphereAnchor { point: point.as_vec3(), normal: normal.as_vec3() })
    }

    /// Corners of what is not a sphere: bounds of the meshes, and the cameras.
    fn extent_without_spheres(&self) -> Vec<Vec3> {
        let mut points: Vec<Vec3> =
            self.cameras.iter().map(|c| c.world_from_camera.translation.into()).collect();
        if let Some((low, high)) = self.mesh_bounds() {
            points.extend([low, high]);
        }
        points
    }
}

/// Every slot of a material, borrowed by `$borrow`; `$iter` iterates over an optional lobe.
macro_rules! texture_slots {
    ($material:ident, $iter:ident, $($borrow:tt)+) => {{
        let m = $material;
        // The order tells which textures stay where there are too many sets of coordinates.
        let mut slots = vec![
            $($borrow)+ m.base_color_texture,
            $($borrow)+ m.normal_texture,
            $($borrow)+ m.metallic_roughness_texture,
            $($borrow)+ m.emission_texture,
            $($borrow)+ m.specular_texture,
            $($borrow)+ m.specular_color_texture,
            $($borrow)+ m.transmission_texture,
        ];
        slots.extend(m.specular_glossiness.$iter().map(|s| $($borrow)+ s.texture));
        slots.extend(m.diffuse_transmission.$iter().flat_map(|d| {
            [$($borrow)+ d.texture, $($borrow)+ d.color_texture]
        }));
        slots.extend(m.anisotropy.$iter().map(|a| $($borrow)+ a.texture));
        slots.extend(m.iridescence.$iter().flat_map(|i| {
            [$($borrow)+ i.texture, $($borrow)+ i.thickness_texture]
        }));
        slots.extend(m.sheen.$iter().flat_map(|s| {
            [$($borrow)+ s.color_texture, $($borrow)+ s.roughness_texture]
        }));
        slots.extend(m.clearcoat.$iter().flat_map(|c| {
            [$($borrow)+ c.texture, $($borrow)+ c.roughness_texture, $($borrow)+ c.normal_texture]
        }));
        slots
    }};
}

impl super::Material {
    /// The textures in use.
    pub fn textures(&self) -> impl Iterator<Item = TextureRef> {
        texture_slots!(self, iter, &).into_iter().copied().flatten()
    }

    /// Every slot for a texture.
    pub(super) fn texture_slots_mut(&mut self) -> Vec<&mut Option<TextureRef>> {
        texture_slots!(self, iter_mut, &mut)
    }

    /// The texture whose coordinates give the tangents, where the material needs any: normal maps
    /// and anisotropy do. The inner `None`: set 0, untransformed.
    pub fn tangent_texture(&self) -> Option<Option<TextureRef>> {
        let anisotropy = self.anisotropy.as_ref().map(|a| a.texture);
        self.normal_texture.or(self.clearcoat_normals()).map(Some).or(anisotropy)
    }

    /// The clearcoat's normal texture.
    pub(super) fn clearcoat_normals(&self) -> Option<TextureRef> {
        self.clearcoat.as_ref().and_then(|c| c.normal_texture)
    }
}
