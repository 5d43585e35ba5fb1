//! Rays of a test through functions of the device: `trace_closest`, `surface_at` and
//! `ray_spawn` on a scene, or those of a single sphere.

use crate::common::{Call, harness, settings};
use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};
use steradian::RenderSettings;
use steradian::scene::Scene;
use steradian::settings::Accel;
use steradian::shader::Feature;

/// A ray, and the ray that is to leave where it meets something.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct Probe {
    pub(crate) origin: Vec3,
    pub(crate) t_max: f32,
    pub(crate) direction: Vec3,
    pub(crate) first: u32,
    /// The second ray's direction with z = the geometric normal on the first ray's side.
    pub(crate) scattered: Vec3,
    /// How many primitives from `first` on are there; 0 is the whole scene.
    pub(crate) count: u32,
}

/// What the device found.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct Found {
    pub(crate) position: Vec3,
    t: f32,
    /// On the first ray's side.
    pub(crate) ng: Vec3,
    pub(crate) offset: f32,
    /// Origin of the second ray.
    pub(crate) origin: Vec3,
    again: f32,
    /// Direction of the second ray.
    pub(crate) direction: Vec3,
    /// 1 if the first ray met the front.
    pub(crate) is_front: u32,
}

impl Probe {
    /// Against the whole scene; the second ray leaves along the normal.
    pub(crate) fn new(origin: Vec3, direction: Vec3) -> Self {
        let (t_max, scattered) = (f32::MAX, Vec3::Z);
        Self { origin, t_max, direction, first: 0, scattered, count: 0 }
    }

    /// Against `count` primitives from `first` on, in scene order.
    pub(crate) fn of_primitives(self, first: u32, count: u32) -> Self {
        Self { first, count, ..self }
    }
}

impl Found {
    /// Where the first ray meets something.
    pub(crate) fn t(&self) -> Option<f32> {
        (self.t < f32::MAX).then_some(self.t)
    }

    /// Where the second ray does.
    pub(crate) fn again(&self) -> Option<f32> {
        (self.again < f32::MAX).then_some(self.again)
    }
}

/// Traces `probes` through the tree of `scene`; only whole scenes.
pub(crate) fn probe_tree(scene: &Scene, probes: &[Probe]) -> Vec<Found> {
    run(scene, Accel::Bvh, probes)
}

/// Traces `probes` without a tree: primitives are in scene order.
pub(crate) fn probe_primitives(scene: &Scene, probes: &[Probe]) -> Vec<Found> {
    run(scene, Accel::None, probes)
}

fn run(scene: &Scene, accel: Accel, probes: &[Probe]) -> Vec<Found> {
    let settings = RenderSettings { accel, ..settings(8, 8, 1) };
    let mut padded = probes.to_vec();
    padded.resize(probes.len().next_multiple_of(64), probes[0]);
    let mut found: Vec<Found> =
        Call::new(harness!("spawn"), &[]).on(scene, &settings).run(&padded, 1);
    found.truncate(probes.len());
    found
}

/// Distances of one ray against one sphere, by its centre and in the anchored form; `f32::MAX`
/// or more for a miss. An input is as in `tests/shaders/sphere.wgsl`.
pub(crate) fn sphere_hits(inputs: &[[Vec4; 5]]) -> Vec<[f32; 2]> {
    let mut padded = inputs.to_vec();
    padded.resize(inputs.len().next_multiple_of(64), inputs[0]);
    let features = [Feature::Spheres, Feature::AnchoredSpheres];
    let mut found: Vec<[f32; 2]> = Call::new(harness!("sphere"), &features).run(&padded, 1);
    found.truncate(inputs.len());
    found
}

/// What became of a light sample; as in `tests/shaders/segment.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct Segment {
    state: u32,
    /// Radiance over density times the receiver's cosine.
    pub(crate) irradiance: f32,
}

impl Segment {
    /// Whether the way is clear; `None` where there is no surface or the light does not face it.
    pub(crate) fn is_visible(&self) -> Option<bool> {
        [None, Some(true), Some(false)][self.state as usize]
    }
}

/// For each ray, a light sample of its hit by the pair of numbers beside it.
pub(crate) fn segments(
    scene: &Scene,
    settings: &RenderSettings,
    rays: &[((Vec3, Vec3), [f32; 2])],
) -> Vec<Segment> {
    let input = |((o, d), [u, v]): &((Vec3, Vec3), [f32; 2])| [o.extend(*u), d.extend(*v)];
    let mut inputs: Vec<[Vec4; 2]> = rays.iter().map(input).collect();
    inputs.resize(rays.len().next_multiple_of(64), inputs[0]);
    let mut found: Vec<Segment> =
        Call::new(harness!("segment"), &[]).on(scene, settings).run(&inputs, 1);
    found.truncate(rays.len());
    found
}

/// Rays of the camera for a film position and a lens sample each: origin and direction.
pub(crate) fn camera_rays(
    scene: &Scene,
    settings: &RenderSettings,
    inputs: &[Vec4],
) -> Vec<[Vec4; 2]> {
    let mut padded = inputs.to_vec();
    padded.resize(inputs.len().next_multiple_of(64), inputs[0]);
    let mut rays: Vec<[Vec4; 2]> =
        Call::new(harness!("camera"), &[]).on(scene, settings).run(&padded, 1);
    rays.truncate(inputs.len());
    rays
}

/// What of a ray is left after its refractions; as in `tests/shaders/glass.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct Refracted {
    pub(crate) position: Vec3,
    /// Interfaces passed.
    pub(crate) count: u32,
    pub(crate) direction: Vec3,
    /// 1 after total reflection, which ends it.
    pub(crate) is_reflected: u32,
}

/// Refracts rays until they meet nothing.
pub(crate) fn refractions(scene: &Scene, rays: &[(Vec3, Vec3)]) -> Vec<Refracted> {
    let input = |(o, d): &(Vec3, Vec3)| [o.extend(0.0), d.extend(0.0)];
    let mut inputs: Vec<[Vec4; 2]> = rays.iter().map(input).collect();
    inputs.resize(rays.len().next_multiple_of(64), inputs[0]);
    let settings = settings(8, 8, 1);
    let mut found: Vec<Refracted> =
        Call::new(harness!("glass"), &[]).on(scene, &settings).run(&inputs, 1);
    found.truncate(rays.len());
    found
}
