//! The estimator: paths from the camera, and light samples at their vertices.

use super::bsdf::Bsdf;
use super::geometry::{Hit, Ray};
use super::light::incident;
use super::random::Random;
use super::surface::Surface;
use super::{Reference, Tally};
use glam::DVec3;

/// Scattering events after which a path is cut off and counted.
const LENGTH_LIMIT: u32 = 4096;

/// A path whose throughput is below this ends: what it would still gather is its share of
/// the light at its end. Even there a thousand times brighter than in the picture, that
/// changes the picture by 1e-6 of itself, less than its 32-bit floats with a few roundings.
const LEAST_THROUGHPUT: f64 = 1e-9;

/// One camera path under way.
pub(super) struct Path<'a> {
    reference: &'a Reference<'a>,
    random: Random,
    tally: Tally,
    radiance: DVec3,
    throughput: DVec3,
    /// Scattering events so far.
    bounces: u32,
}

/// Where light was scattered last: needed to weigh lights that are then hit by chance.
struct Vertex {
    position: DVec3,
    /// Density of the direction taken; `None` where no light sample could have taken it.
    pdf: Option<f64>,
}

impl<'a> Path<'a> {
    pub(super) fn new(reference: &'a Reference<'a>, random: Random) -> Self {
        Self {
            reference,
            random,
            tally: Tally::default(),
            radiance: DVec3::ZERO,
            throughput: DVec3::ONE,
            bounces: 0,
        }
    }

    /// The radiance that arrives along the reversed camera ray.
    pub(super) fn trace(mut self, mut ray: Ray) -> (DVec3, Tally) {
        let mut vertex = Vertex { position: ray.origin, pdf: None };
        let mut left = None;
        while let Some((hit, surface)) = self.next_surface(&mut ray, &mut left) {
            self.add_emission(&vertex, &ray, &hit, &surface);
            if self.bounces >= self.reference.bounce_limit {
                return (self.radiance, self.tally);
            }
            if self.bounces == LENGTH_LIMIT {
                self.tally.cut_off += 1;
                return (self.radiance, self.tally);
            }
            let wo = -ray.direction;
            let normals = surface.facing_normals(wo);
            let bsdf = Bsdf::new(&surface.shading(), wo, normals, surface.is_front);
            if bsdf.is_continuous() && self.is_wanted(self.bounces + 1) {
                self.add_light_samples(&surface, hit.primitive, &bsdf);
            }
            let Some(scattered) = bsdf.sample(&mut self.random) else {
                return (self.radiance, self.tally);
            };
            self.bounces += 1;
            self.throughput *= scattered.weight;
            if self.throughput.max_element() < LEAST_THROUGHPUT {
                return (self.radiance, self.tally);
            }
            vertex = Vertex { position: surface.position, pdf: scattered.pdf };
            ray = Ray { origin: surface.position, direction: scattered.wi };
            left = Some(hit.primitive);
        }
        self.add_sky(&vertex, ray.direction);
        (self.radiance, self.tally)
    }

    /// Whether light that was scattered so often is part of the picture.
    fn is_wanted(&self, bounces: u32) -> bool {
        self.reference.settings.only_bounce.is_none_or(|only| only == bounces)
    }

    /// The next surface that is there; the ray begins anew behind every other. `left`: the
    /// primitive on which it begins.
    fn next_surface(
        &mut self,
        ray: &mut Ray,
        left: &mut Option<usize>,
    ) -> Option<(Hit, Surface<'a>)> {
        loop {
            self.tally.closest_rays += 1;
            let (hit, surface) = self.reference.surface(ray, *left)?;
            let presence = surface.presence();
            if presence >= 1.0 || self.random.uniform() < presence {
                return Some((hit, surface));
            }
            ray.origin = surface.position;
            *left = Some(hit.primitive);
        }
    }

    /// Light of an emitter that the path has hit.
    fn add_emission(&mut self, vertex: &Vertex, ray: &Ray, hit: &Hit, surface: &Surface) {
        let emitted = surface.emitted();
        if emitted == DVec3::ZERO || !self.is_wanted(self.bounces) {
            return;
        }
        let Reference { scene, geometry, emitters, .. } = self.reference;
        let weight = vertex.pdf.map_or(1.0, |pdf| {
            let other =
                emitters.pdf(scene, geometry, vertex.position, hit.primitive, ray.direction);
            power_heuristic(pdf, other)
        });
        self.radiance += self.throughput * emitted * weight;
    }

    /// Light from beyond the scene.
    fn add_sky(&mut self, vertex: &Vertex, direction: DVec3) {
        let Some(sky) = &self.reference.sky else { return };
        if self.is_wanted(self.bounces) {
            let weight = vertex.pdf.map_or(1.0, |pdf| power_heuristic(pdf, sky.pdf(direction)));
            self.radiance += self.throughput * sky.radiance(direction) * weight;
        }
    }

    /// One sample of the emitters, one of the sky, and every punctual light.
    fn add_light_samples(&mut self, surface: &Surface, left: usize, bsdf: &Bsdf) {
        let Reference { scene, geometry, emitters, sky, .. } = self.reference;
        let origin = surface.position;
        let mut gathered = DVec3::ZERO;
        if let Some((primitive, wi, pdf)) =
            emitters.sample(scene, geometry, origin, &mut self.random)
        {
            let value = bsdf.eval(wi);
            if value != DVec3::ZERO {
                let ray = Ray { origin, direction: wi };
                let weight = power_heuristic(pdf, bsdf.pdf(wi)) / pdf;
                gathered += value * self.emitted_along(ray, left, primitive) * weight;
            }
        }
        if let Some((wi, pdf)) = sky.as_ref().and_then(|sky| sky.sample(&mut self.random)) {
            let value = bsdf.eval(wi);
            if value != DVec3::ZERO {
                let ray = Ray { origin, direction: wi };
                let weight = power_heuristic(pdf, bsdf.pdf(wi)) / pdf;
                let open = self.transmittance(ray, left, f64::INFINITY);
                let radiance = sky.as_ref().map_or(DVec3::ZERO, |sky| sky.radiance(wi));
                gathered += value * radiance * (open * weight);
            }
        }
        for incident in scene.lights.iter().filter_map(|light| incident(light, origin)) {
            let value = bsdf.eval(incident.wi);
            if value != DVec3::ZERO {
                let ray = Ray { origin, direction: incident.wi };
                let open = self.transmittance(ray, left, incident.distance);
                gathered += value * incident.irradiance * open;
            }
        }
        self.radiance += self.throughput * gathered;
    }

    /// Radiance that the emitter `target` sends against the ray, on average over what is there
    /// by chance before it.
    fn emitted_along(&mut self, ray: Ray, left: usize, target: usize) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        self.cross(ray, left, f64::INFINITY, |hit, surface, open| {
            if hit.primitive == target {
                radiance += surface.emitted() * (surface.presence() * open);
            }
        });
        radiance
    }

    /// Probability that nothing is in the way before `distance`.
    fn transmittance(&mut self, ray: Ray, left: usize, distance: f64) -> f64 {
        self.cross(ray, left, distance, |_, _, _| {})
    }

    /// Follows a ray until nothing passes or `distance` is reached, and calls `meet` with every
    /// surface and the probability that nothing is before it. Returns that of the whole way.
    fn cross(
        &mut self,
        mut ray: Ray,
        left: usize,
        mut distance: f64,
        mut meet: impl FnMut(&Hit, &Surface, f64),
    ) -> f64 {
        self.tally.shadow_rays += 1;
        let (mut left, mut open) = (left, 1.0);
        while let Some((hit, surface)) = self.reference.surface(&ray, Some(left)) {
            if hit.t >= distance {
                break;
            }
            meet(&hit, &surface, open);
            open *= 1.0 - surface.presence();
            if open == 0.0 {
                break;
            }
            distance -= hit.t;
            ray.origin = surface.position;
            left = hit.primitive;
        }
        open
    }
}

/// The weight of a sample with density `pdf` where the other strategy has `other` (Veach
/// 1997), without squares that overflow.
fn power_heuristic(pdf: f64, other: f64) -> f64 {
    let ratio = other / pdf;
    1.0 / (1.0 + ratio * ratio)
}
