//! What is at a hit: place, normals, alpha and emission.

use super::geometry::{Geometry, Hit, Primitive, Ray, linear_part};
use super::texture::lookup;
use crate::scene::{AlphaMode, Instance, Material, Mesh, Scene, TextureRef};
use glam::{DVec2, DVec3, DVec4};

/// The cosine to the geometric normal that a mirror image of the direction of view shall have, where
/// that direction's own is larger.
const LEAST_MIRRORED_COSINE: f64 = 0.01;

/// The least cosine between the shading normal and the direction of view.
const LEAST_COSINE: f64 = 1e-4;

/// A point of a surface as seen along a ray.
#[derive(Debug)]
pub(super) struct Surface<'a> {
    scene: &'a Scene,
    pub(super) material: &'a Material,
    /// Index of the material in the scene.
    pub(super) material_index: u32,
    /// Whether camera rays pass through the back.
    is_culled: bool,
    /// Two sets of texture coordinates.
    uvs: [DVec2; 2],
    /// Of the vertices.
    color: DVec4,
    pub(super) position: DVec3,
    /// Whether the front is seen.
    pub(super) is_front: bool,
    /// Unit geometric normal of the front.
    pub(super) front_ng: DVec3,
    /// Unit shading normal of the front, before the normal map.
    pub(super) front_ns: DVec3,
    /// Unit tangent and bitangent that the normal map refers to.
    pub(super) tangents: Option<[DVec3; 2]>,
}

impl<'a> Surface<'a> {
    /// Where `ray` hits.
    pub(super) fn new(scene: &'a Scene, geometry: &Geometry, ray: &Ray, hit: &Hit) -> Self {
        let position = geometry.position(ray, hit);
        match geometry.primitive(hit.primitive) {
            Primitive::Sphere(index) => {
                let sphere = &scene.spheres[index as usize];
                let normal = (position - sphere.center.as_dvec3()).normalize();
                Self {
                    scene,
                    material: &scene.materials[sphere.material as usize],
                    material_index: sphere.material,
                    is_culled: false,
                    uvs: [DVec2::ZERO; 2],
                    color: DVec4::ONE,
                    position,
                    is_front: normal.dot(ray.direction) < 0.0,
                    front_ng: normal,
                    front_ns: normal,
                    tangents: None,
                }
            }
            Primitive::Triangle { instance, triangle } => {
                let instance = &scene.instances[instance as usize];
                let mesh = &scene.meshes[instance.mesh as usize];
                let face = Face {
                    mesh,
                    instance,
                    indices: mesh.triangles[triangle as usize].map(|i| i as usize),
                    corners: geometry.corners(hit.primitive),
                    weights: hit.barycentrics,
                };
                let (front_ng, front_ns) = face.normals();
                let material = &scene.materials[mesh.material as usize];
                let map_uvs = material.normal_texture.map_or(0, |map| map.uv_set);
                Self {
                    scene,
                    material,
                    material_index: mesh.material,
                    is_culled: geometry.is_culled(instance.mesh),
                    uvs: [0, 1].map(|set| face.uv(set)),
                    color: face.color(),
                    position,
                    is_front: front_ng.dot(ray.direction) < 0.0,
                    front_ng,
                    front_ns,
                    tangents: face.tangents(front_ns, map_uvs as usize),
                }
            }
        }
    }

    /// Whether a camera ray passes through it from here.
    pub(super) fn is_hidden_from_camera(&self) -> bool {
        self.is_culled && !self.is_front
    }

    /// Probability that the surface is there for a ray that meets it.
    pub(super) fn presence(&self) -> f64 {
        match self.material.alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask(cutoff) => f64::from(u8::from(self.alpha() >= f64::from(cutoff))),
            AlphaMode::Blend => self.alpha().clamp(0.0, 1.0),
        }
    }

    fn alpha(&self) -> f64 {
        let texel = self.texel(self.material.base_color_texture.as_ref()).w;
        f64::from(self.material.alpha) * self.color.w * texel
    }

    /// Radiance that the surface sends towards where it is seen from.
    pub(super) fn emitted(&self) -> DVec3 {
        if self.material.unlit {
            return self.base_color();
        }
        if !(self.is_front || self.material.double_sided) {
            return DVec3::ZERO;
        }
        let texel = self.texel(self.material.emission_texture.as_ref()).truncate();
        self.material.emission.as_dvec3() * texel
    }

    /// A texture's value here; 1 without one.
    pub(super) fn texel(&self, texture: Option<&TextureRef>) -> DVec4 {
        texture.map_or(DVec4::ONE, |t| lookup(&self.scene.images, t, &self.uvs))
    }

    /// Linear base colour with texture and vertex colour.
    pub(super) fn base_color(&self) -> DVec3 {
        let texel = self.texel(self.material.base_color_texture.as_ref());
        self.material.base_color.as_dvec3() * (self.color * texel).truncate()
    }

    /// Geometric and shading normal on the side of `wo`, towards which the surface is seen.
    pub(super) fn facing_normals(&self, wo: DVec3) -> (DVec3, DVec3) {
        let map = self.material.normal_texture.as_ref();
        let ns = self.mapped_normal(map, self.material.normal_scale);
        (self.front_ng * self.side(), self.facing(ns, wo))
    }

    /// 1 where the front is seen.
    fn side(&self) -> f64 {
        if self.is_front { 1.0 } else { -1.0 }
    }

    /// A normal of the front on the side of `wo`. One that faces away is turned until it just
    /// does not.
    pub(super) fn facing(&self, front: DVec3, wo: DVec3) -> DVec3 {
        let normal = front * self.side();
        let cos = normal.dot(wo);
        let turned = || (normal + wo * (LEAST_COSINE - cos)).normalize();
        let normal = if cos < LEAST_COSINE { turned() } else { normal };
        reflecting(normal, self.front_ng * self.side(), wo)
    }

    /// The front's shading normal after a normal map.
    pub(super) fn mapped_normal(&self, map: Option<&TextureRef>, scale: f32) -> DVec3 {
        let Some((map, [tangent, bitangent])) = map.zip(self.tangents) else {
            return self.front_ns;
        };
        let scale = f64::from(scale);
        let texel = self.texel(Some(map)).truncate();
        let n = (texel * 2.0 - 1.0) * DVec3::new(scale, scale, 1.0);
        let mapped = tangent * n.x + bitangent * n.y + self.front_ns * n.z;
        mapped.try_normalize().unwrap_or(self.front_ns)
    }
}

/// A triangle and a point on it.
struct Face<'a> {
    mesh: &'a Mesh,
    instance: &'a Instance,
    indices: [usize; 3],
    /// World space.
    corners: &'a [DVec3; 3],
    weights: [f64; 3],
}

impl Face<'_> {
    /// The mean of the corners' values with the weights of the point.
    fn interpolate<T>(&self, value: impl Fn(usize) -> T) -> T
    where
        T: std::ops::Mul<f64, Output = T> + std::iter::Sum,
    {
        self.indices.iter().zip(self.weights).map(|(&i, weight)| value(i) * weight).sum()
    }

    fn uv(&self, set: usize) -> DVec2 {
        let uvs = &self.mesh.uvs[set];
        if uvs.is_empty() { DVec2::ZERO } else { self.interpolate(|i| uvs[i].as_dvec2()) }
    }

    fn color(&self) -> DVec4 {
        let colors = &self.mesh.colors;
        if colors.is_empty() { DVec4::ONE } else { self.interpolate(|i| colors[i].as_dvec4()) }
    }

    /// -1 for an instance that mirrors.
    fn handedness(&self) -> f64 {
        linear_part(self.instance).determinant().signum()
    }

    /// Unit normals of the front in world space: geometric and shading.
    fn normals(&self) -> (DVec3, DVec3) {
        let [a, b, c] = self.corners;
        // The corners turn the other way in a mirrored copy; its front stays where it was.
        let ng = (b - a).cross(c - a).normalize() * self.handedness();
        let normals = &self.mesh.normals;
        if normals.is_empty() {
            return (ng, ng);
        }
        let in_object = self.interpolate(|i| normals[i].as_dvec3());
        // The transform of normals is the inverse transpose; the cofactors are that times the
        // determinant, without a division.
        let m = linear_part(self.instance);
        let cofactors = glam::DMat3::from_cols(
            m.y_axis.cross(m.z_axis),
            m.z_axis.cross(m.x_axis),
            m.x_axis.cross(m.y_axis),
        );
        let ns = cofactors * in_object.normalize_or_zero() * self.handedness();
        (ng, ns.try_normalize().unwrap_or(ng))
    }

    /// Tangent and bitangent, unit and at right angles to the front's shading normal `ns`;
    /// `uv_set`: where they come from if the mesh has none.
    fn tangents(&self, ns: DVec3, uv_set: usize) -> Option<[DVec3; 2]> {
        let (tangent, side) = match &self.mesh.tangents[..] {
            [] => self.uv_tangent(ns, uv_set)?,
            tangents => {
                let in_object = self.interpolate(|i| tangents[i].as_dvec4()).truncate();
                // glTF takes the cross product in object space; a mirror turns it round.
                let sign = f64::from(tangents[self.indices[0]].w) * self.handedness();
                (linear_part(self.instance) * in_object, sign)
            }
        };
        let tangent = (tangent - ns * ns.dot(tangent)).try_normalize()?;
        Some([tangent, ns.cross(tangent) * side])
    }

    /// The direction in which u of a set grows; and the side on which of it v decreases, as
    /// the sign of the cross product of `ns` and it.
    fn uv_tangent(&self, ns: DVec3, uv_set: usize) -> Option<(DVec3, f64)> {
        let uvs = &self.mesh.uvs[uv_set];
        if uvs.is_empty() {
            return None;
        }
        let [a, b, c] = self.indices.map(|i| uvs[i].as_dvec2());
        let (first, second) = (b - a, c - a);
        let area = first.perp_dot(second);
        if area == 0.0 {
            return None;
        }
        let edges = [self.corners[1] - self.corners[0], self.corners[2] - self.corners[0]];
        let along_u = (edges[0] * second.y - edges[1] * first.y) / area;
        let along_v = (edges[1] * first.x - edges[0] * second.x) / area;
        Some((along_u, -ns.cross(along_u).dot(along_v).signum()))
    }
}

/// `normal`, turned towards the geometric normal `ng` only as far as it takes for the mirror image
/// of `wo` to be above the surface. Found by bisection of the angle.
fn reflecting(normal: DVec3, ng: DVec3, wo: DVec3) -> DVec3 {
    let cos_o = ng.dot(wo).max(0.0);
    let least = LEAST_MIRRORED_COSINE.min(0.9 * cos_o);
    let is_above = |n: DVec3| 2.0 * n.dot(wo) * n.dot(ng) - cos_o >= least;
    if is_above(normal) {
        return normal;
    }
    let between = |share: f64| normal.lerp(ng, share).normalize_or(ng);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if is_above(between(middle)) { high = middle } else { low = middle }
    }
    between(high)
}
