//! The estimator: paths from the camera, and light samples at their vertices.

use super::bsdf::Bsdf;
use super::geometry::{Hit, Ray};
use super::light::incident;
use super::media::{Media, index};
use super::random::Random;
use super::shading::Shading;
use super::shadow::Start;
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
    pub(super) reference: &'a Reference<'a>,
    random: Random,
    pub(super) tally: Tally,
    radiance: DVec3,
    throughput: DVec3,
    /// Scattering events so far.
    bounces: u32,
    /// What the path is in.
    media: Media,
    /// The only channel of the throughput that is not 0, once indices differ between them.
    channel: Option<usize>,
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
            media: Media::default(),
            channel: None,
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
            if surface.material.unlit {
                return (self.radiance, self.tally);
            }
            self.choose_channel(&surface);
            let wo = -ray.direction;
            let normals = surface.facing_normals(wo);
            let beyond = self.media_beyond(&surface);
            let shading = self.shading(&surface, wo, &beyond);
            let compensate = self.reference.settings.energy_compensation;
            let bsdf = Bsdf::new(&shading, wo, normals, compensate);
            if bsdf.is_continuous() && self.is_wanted(self.bounces + 1) {
                self.add_light_samples(&surface, hit.primitive, &bsdf, &beyond);
            }
            let Some(scattered) = bsdf.sample(&mut self.random) else {
                return (self.radiance, self.tally);
            };
            self.bounces += 1;
            self.throughput *= scattered.weight;
            if self.throughput.max_element() < LEAST_THROUGHPUT {
                return (self.radiance, self.tally);
            }
            if scattered.is_through {
                self.media = beyond;
            }
            vertex = Vertex { position: surface.position, pdf: scattered.pdf };
            ray = Ray { origin: surface.position, direction: scattered.wi };
            left = Some(hit.primitive);
        }
        self.add_sky(&vertex, ray.direction);
        (self.radiance, self.tally)
    }

    /// From the first surface on whose refraction disperses light, a path follows one channel
    /// for all three.
    fn choose_channel(&mut self, surface: &Surface) {
        let m = surface.material;
        let disperses = m.dispersion > 0.0 && m.volume && m.transmission > 0.0;
        if disperses && self.channel.is_none() {
            let channel = (3.0 * self.random.uniform()) as usize;
            self.throughput *= 3.0 * DVec3::AXES[channel];
            self.channel = Some(channel);
        }
    }

    /// What the path is in once it has gone through the surface.
    fn media_beyond(&self, surface: &Surface) -> Media {
        let material = surface.material_index;
        match (surface.material.is_boundary(), surface.is_front) {
            (false, _) => self.media.clone(),
            (true, true) => self.media.entered(material),
            (true, false) => self.media.left(material),
        }
    }

    /// The material with its indices for the path's channel.
    fn shading(&self, surface: &Surface, wo: DVec3, beyond: &Media) -> Shading {
        let materials = &self.reference.scene.materials;
        let within = |media: &Media| {
            media.innermost().map_or(1.0, |m| index(&materials[m as usize], self.channel))
        };
        let shading = surface.shading(wo);
        if !shading.is_volume {
            return shading;
        }
        let ior = index(surface.material, self.channel);
        Shading { ior, passage_index: within(beyond) / within(&self.media), ..shading }
    }

    /// Whether light that was scattered so often is part of the picture.
    fn is_wanted(&self, bounces: u32) -> bool {
        self.reference.settings.only_bounce.is_none_or(|only| only == bounces)
    }

    /// The next surface that is there; the ray begins anew behind every other. `left`: the
    /// primitive on which it begins. What is on the way takes its share of the throughput.
    fn next_surface(
        &mut self,
        ray: &mut Ray,
        left: &mut Option<usize>,
    ) -> Option<(Hit, Surface<'a>)> {
        let mut distance = 0.0;
        loop {
            self.tally.closest_rays += 1;
            let Some((hit, surface)) = self.reference.surface(ray, *left) else {
                self.attenuate(f64::INFINITY);
                return None;
            };
            distance += hit.t;
            let is_hidden = self.bounces == 0 && surface.is_hidden_from_camera();
            let presence = if is_hidden { 0.0 } else { surface.presence() };
            if presence >= 1.0 || self.random.uniform() < presence {
                let material = surface.material_index;
                // The path was in it all the time: its camera is.
                let is_back = surface.material.is_boundary() && !surface.is_front;
                if is_back && !self.media.contains(material) {
                    self.media = self.media.entered(material);
                }
                self.attenuate(distance);
                return Some((hit, surface));
            }
            ray.origin = surface.position;
            *left = Some(hit.primitive);
        }
    }

    fn attenuate(&mut self, distance: f64) {
        self.throughput *= self.media.transmittance(&self.reference.scene.materials, distance);
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
    fn add_light_samples(&mut self, surface: &Surface, left: usize, bsdf: &Bsdf, beyond: &Media) {
        let Reference { scene, geometry, emitters, sky, .. } = self.reference;
        let origin = surface.position;
        let media = self.media.clone();
        let start = |wi: DVec3| {
            let media = if bsdf.is_through(wi) { beyond } else { &media };
            Start { ray: Ray { origin, direction: wi }, left, media }
        };
        let mut gathered = DVec3::ZERO;
        if let Some((primitive, wi, pdf)) =
            emitters.sample(scene, geometry, origin, &mut self.random)
        {
            let value = bsdf.eval(wi);
            if value != DVec3::ZERO {
                let weight = power_heuristic(pdf, bsdf.pdf(wi)) / pdf;
                gathered += value * self.emitted_along(&start(wi), primitive) * weight;
            }
        }
        if let Some((wi, pdf)) = sky.as_ref().and_then(|sky| sky.sample(&mut self.random)) {
            let value = bsdf.eval(wi);
            if value != DVec3::ZERO {
                let weight = power_heuristic(pdf, bsdf.pdf(wi)) / pdf;
                let open = self.transmittance(&start(wi), f64::INFINITY);
                let radiance = sky.as_ref().map_or(DVec3::ZERO, |sky| sky.radiance(wi));
                gathered += value * radiance * open * weight;
            }
        }
        for incident in scene.lights.iter().filter_map(|light| incident(light, origin)) {
            let value = bsdf.eval(incident.wi);
            if value != DVec3::ZERO {
                let open = self.transmittance(&start(incident.wi), incident.distance);
                gathered += value * incident.irradiance * open;
            }
        }
        self.radiance += self.throughput * gathered;
    }
}

/// The weight of a sample with density `pdf` where the other strategy has `other` (Veach
/// 1997), without squares that overflow.
fn power_heuristic(pdf: f64, other: f64) -> f64 {
    let ratio = other / pdf;
    1.0 / (1.0 + ratio * ratio)
}
