//! What is between a vertex and a light.

use super::geometry::{Hit, Ray};
use super::media::Media;
use super::path::Path;
use super::surface::Surface;
use glam::DVec3;

/// Where a shadow ray begins.
pub(super) struct Start<'m> {
    pub(super) ray: Ray,
    /// The primitive that it leaves.
    pub(super) left: usize,
    /// What is on that side of it.
    pub(super) media: &'m Media,
}

impl Path<'_> {
    /// Radiance that the emitter `target` sends against the ray, on average over what is there
    /// by chance before it.
    pub(super) fn emitted_along(&mut self, start: &Start, target: usize) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        let materials = &self.reference.scene.materials;
        self.cross(start, f64::INFINITY, |hit, surface, distance, open| {
            if hit.primitive == target {
                let left = start.media.transmittance(materials, distance);
                radiance += surface.emitted() * left * (surface.presence() * open);
            }
        });
        radiance
    }

    /// Share of the light that is left after `distance`: the probability that nothing is in the
    /// way, and what the medium leaves.
    pub(super) fn transmittance(&mut self, start: &Start, distance: f64) -> DVec3 {
        let open = self.cross(start, distance, |_, _, _, _| {});
        start.media.transmittance(&self.reference.scene.materials, distance) * open
    }

    /// Follows a ray until nothing passes or `end` is reached, and calls `meet` with every surface,
    /// its distance and the probability that nothing is before it. Returns that of the whole way.
    fn cross(
        &mut self,
        start: &Start,
        end: f64,
        mut meet: impl FnMut(&Hit, &Surface, f64, f64),
    ) -> f64 {
        self.tally.shadow_rays += 1;
        let (mut ray, mut left) = (start.ray, start.left);
        let (mut distance, mut open) = (0.0, 1.0);
        while let Some((hit, surface)) = self.reference.surface(&ray, Some(left)) {
            if distance + hit.t >= end {
                break;
            }
            distance += hit.t;
            meet(&hit, &surface, distance, open);
            open *= 1.0 - surface.presence();
            if open == 0.0 {
                break;
            }
            ray.origin = surface.position;
            left = hit.primitive;
        }
        open
    }
}
