//! Light sources: shapes that emit, and punctual lights.

use super::geometry::{Geometry, Primitive};
use super::random::Random;
use crate::scene::{LightKind, Material, PunctualLight, Scene};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Emitting primitives, to be drawn by their power: area times radiance times sides.
#[derive(Debug)]
pub(super) struct Emitters {
    /// Ascending.
    primitives: Vec<usize>,
    /// Running sums of their powers, textures left out.
    cumulative: Vec<f64>,
}

impl Emitters {
    pub(super) fn new(scene: &Scene, geometry: &Geometry) -> Self {
        let (mut primitives, mut cumulative, mut sum) = (Vec::new(), Vec::new(), 0.0);
        for primitive in 0..geometry.count() {
            let (material, area) = match geometry.primitive(primitive) {
                Primitive::Triangle { instance, .. } => {
                    let mesh = scene.instances[instance as usize].mesh;
                    (scene.meshes[mesh as usize].material, triangle_area(geometry, primitive))
                }
                Primitive::Sphere(i) => {
                    let sphere = &scene.spheres[i as usize];
                    (sphere.material, 4.0 * PI * f64::from(sphere.radius).powi(2))
                }
            };
            let power = area * brightness(&scene.materials[material as usize]);
            if power > 0.0 {
                sum += power;
                primitives.push(primitive);
                cumulative.push(sum);
            }
        }
        Self { primitives, cumulative }
    }

    /// Probability of the emitter at a place in the list.
    fn pmf(&self, place: usize) -> f64 {
        let before = if place == 0 { 0.0 } else { self.cumulative[place - 1] };
        (self.cumulative[place] - before) / self.cumulative[self.cumulative.len() - 1]
    }

    /// A primitive, and a unit direction from `point` that may meet it, with their density
    /// per solid angle.
    pub(super) fn sample(
        &self,
        scene: &Scene,
        geometry: &Geometry,
        point: DVec3,
        random: &mut Random,
    ) -> Option<(usize, DVec3, f64)> {
        let wanted = random.uniform() * self.cumulative.last()?;
        let place = self.cumulative.partition_point(|&sum| sum <= wanted);
        let primitive = *self.primitives.get(place)?;
        let wi = match geometry.primitive(primitive) {
            Primitive::Triangle { .. } => {
                // Folding the unit square along its diagonal keeps areas.
                let (mut u, mut v) = (random.uniform(), random.uniform());
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                let [a, b, c] = geometry.corners(primitive);
                (a + (b - a) * u + (c - a) * v - point).try_normalize()?
            }
            Primitive::Sphere(i) => {
                let sphere = &scene.spheres[i as usize];
                let axis = sphere.center.as_dvec3() - point;
                let widest = cone_height(axis.length(), sphere.radius.into());
                let one_minus_cos = widest * random.uniform();
                let cos = 1.0 - one_minus_cos;
                let sin = (one_minus_cos * (1.0 + cos)).sqrt();
                let angle = TAU * random.uniform();
                let z = axis.try_normalize().unwrap_or(DVec3::Z);
                let (x, y) = z.any_orthonormal_pair();
                (x * (sin * angle.cos()) + y * (sin * angle.sin()) + z * cos).normalize()
            }
        };
        let pdf = self.pdf(scene, geometry, point, primitive, wi);
        (pdf > 0.0 && pdf.is_finite()).then_some((primitive, wi, pdf))
    }

    /// Density per solid angle at `point` with which [`sample`](Self::sample) gives the primitive
    /// and the direction `wi`, which meets it.
    pub(super) fn pdf(
        &self,
        scene: &Scene,
        geometry: &Geometry,
        point: DVec3,
        primitive: usize,
        wi: DVec3,
    ) -> f64 {
        let Ok(place) = self.primitives.binary_search(&primitive) else { return 0.0 };
        let density = match geometry.primitive(primitive) {
            Primitive::Triangle { .. } => {
                let [a, b, c] = geometry.corners(primitive);
                let normal = (b - a).cross(c - a).normalize();
                let cos = normal.dot(wi).abs();
                let distance = normal.dot(a - point).abs() / cos;
                distance * distance / (cos * triangle_area(geometry, primitive))
            }
            Primitive::Sphere(i) => {
                let sphere = &scene.spheres[i as usize];
                let distance = sphere.center.as_dvec3().distance(point);
                1.0 / (TAU * cone_height(distance, sphere.radius.into()))
            }
        };
        self.pmf(place) * density
    }
}

/// 1 minus the cosine of the half angle under which a sphere is seen: its solid angle over 2π.
/// From inside it is seen in every direction.
fn cone_height(distance: f64, radius: f64) -> f64 {
    if distance <= radius {
        return 2.0;
    }
    let sin2 = (radius / distance).powi(2);
    sin2 / (1.0 + (1.0 - sin2).sqrt())
}

fn triangle_area(geometry: &Geometry, primitive: usize) -> f64 {
    let [a, b, c] = geometry.corners(primitive);
    0.5 * (b - a).cross(c - a).length()
}

/// Emitted radiance of both sides together, without texture.
fn brightness(material: &Material) -> f64 {
    if material.unlit {
        return 2.0 * f64::from(material.base_color.element_sum());
    }
    let sides = if material.double_sided { 2.0 } else { 1.0 };
    sides * f64::from(material.emission.element_sum())
}

/// Light from a punctual light at a point.
#[derive(Debug)]
pub(super) struct Incident {
    /// Unit direction to the light.
    pub(super) wi: DVec3,
    /// Where it is; infinite for parallel light.
    pub(super) distance: f64,
    /// On a surface that faces it, W/m².
    pub(super) irradiance: DVec3,
}

/// What arrives at `point` if nothing is in the way; `None` out of reach.
pub(super) fn incident(light: &PunctualLight, point: DVec3) -> Option<Incident> {
    let intensity = light.intensity.as_dvec3();
    let (position, range, cone) = match light.kind {
        LightKind::Directional { direction } => {
            let wi = -direction.as_dvec3().normalize();
            return Some(Incident { wi, distance: f64::INFINITY, irradiance: intensity });
        }
        LightKind::Point { position, range } => (position, range, None),
        LightKind::Spot { position, direction, cos_inner, cos_outer, range } => {
            (position, range, Some((direction.as_dvec3(), cos_inner, cos_outer)))
        }
    };
    let to_light = position.as_dvec3() - point;
    let distance = to_light.length();
    let wi = to_light.try_normalize()?;
    // KHR_lights_punctual's window and cone.
    let window = (1.0 - (distance / f64::from(range)).powi(4)).clamp(0.0, 1.0);
    let cone = cone.map_or(1.0, |(axis, cos_inner, cos_outer)| {
        let (inner, outer) = (f64::from(cos_inner), f64::from(cos_outer));
        let share = (-wi.dot(axis) - outer) / (inner - outer).max(1e-3);
        share.clamp(0.0, 1.0).powi(2)
    });
    let irradiance = intensity * (window * cone / (distance * distance));
    (irradiance.max_element() > 0.0).then_some(Incident { wi, distance, irradiance })
}
