//! Punctual lights (KHR_lights_punctual), in world space.

use super::Scene;
use glam::Vec3;

/// A light without area.
#[derive(Debug, Clone, PartialEq)]
pub struct PunctualLight {
    /// Name in the file.
    pub name: String,
    /// Where and which way.
    pub kind: LightKind,
    /// Colour times intensity: radiant intensity, W/sr, for point and spot;
    /// irradiance on a facing surface, W/m², for directional. The file's candela
    /// and lux are taken as these without a photometric factor.
    pub intensity: Vec3,
}

/// The kinds of punctual light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// Equal in all directions.
    Point {
        /// World position.
        position: Vec3,
        /// Distance at which the light is windowed to zero; infinite by default.
        range: f32,
    },
    /// A cone.
    Spot {
        /// World position.
        position: Vec3,
        /// Unit direction of travel along the axis.
        direction: Vec3,
        /// Cosine of the angle at which falloff begins.
        cos_inner: f32,
        /// Cosine of the angle at which it is zero.
        cos_outer: f32,
        /// As for [`LightKind::Point`].
        range: f32,
    },
    /// Parallel light from infinity.
    Directional {
        /// Unit direction of travel.
        direction: Vec3,
    },
}

/// Lights that an emissive triangle with a picture may be divided into, at most.
const MOST_CELLS: usize = 256;

impl Scene {
    /// Lights that have a place, at most: emissive triangles and spheres, point and spot lights.
    pub(crate) fn finite_lights(&self) -> usize {
        let emits = |m: u32| self.materials[m as usize].is_emissive();
        let in_mesh = |mesh: u32| {
            let mesh = &self.meshes[mesh as usize];
            let texture = self.materials[mesh.material as usize].emitted().1;
            let is_divided = texture.is_some_and(|t| {
                let image = &self.images[t.image as usize];
                image.width * image.height > 1
            });
            match emits(mesh.material) {
                true => mesh.triangles.len() * if is_divided { MOST_CELLS } else { 1 },
                false => 0,
            }
        };
        let triangles: usize = self.instances.iter().map(|i| in_mesh(i.mesh)).sum();
        let spheres = self.spheres.iter().filter(|s| emits(s.material)).count();
        let has_place = |l: &&PunctualLight| {
            !matches!(l.kind, LightKind::Directional { .. }) && l.intensity.max_element() > 0.0
        };
        triangles + spheres + self.lights.iter().filter(has_place).count()
    }
}
