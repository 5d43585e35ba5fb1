//! The renderer's own traversals on the device, for arrays of rays over a scene.

use crate::common::{Call, harness, settings, with_device};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use steradian::RenderSettings;
use steradian::scene::Scene;
use steradian::settings::Accel;
use steradian::shader::Feature;

/// Rays of one dispatch.
const DISPATCH: usize = 1 << 20;

/// The ways in which the device finds hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Walk {
    /// Every thread by itself over the tree of two children a node.
    Lane,
    /// Eight threads together over the tree of four.
    Packets,
    /// Every primitive.
    BruteForce,
}

impl Walk {
    /// Those that the device's renders may use.
    pub(crate) fn each() -> impl Iterator<Item = Self> {
        let has_packets = with_device(|device| device.traces_packets());
        let offered = move |walk: &Self| *walk != Self::Packets || has_packets;
        [Self::Lane, Self::Packets, Self::BruteForce].into_iter().filter(offered)
    }

    /// Those over a tree.
    pub(crate) fn over_trees() -> impl Iterator<Item = Self> {
        Self::each().filter(|walk| *walk != Self::BruteForce)
    }
}

/// One ray, asked for its closest hit in (0, t_max) and for any in (0, any_t_max).
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct Query {
    pub(crate) o: Vec3,
    pub(crate) t_max: f32,
    pub(crate) d: Vec3,
    pub(crate) any_t_max: f32,
}

impl Query {
    /// Without an end.
    pub(crate) fn new(o: Vec3, d: Vec3) -> Self {
        Self { o, t_max: f32::MAX, d, any_t_max: f32::MAX }
    }
}

/// What the device found.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(crate) struct Answer {
    pub(crate) t: f32,
    /// Barycentric weights of the second and third vertex.
    pub(crate) u: f32,
    pub(crate) v: f32,
    /// Index in scene order.
    source: u32,
    is_blocked: u32,
    faults: u32,
}

impl Answer {
    /// Primitive of the closest hit in scene order.
    pub(crate) fn source(&self) -> Option<u32> {
        (self.source != u32::MAX).then_some(self.source)
    }

    pub(crate) fn is_blocked(&self) -> bool {
        self.is_blocked != 0
    }
}

/// The answers to all queries; asserts that none met a fault.
pub(crate) fn trace(scene: &Scene, walk: Walk, queries: &[Query]) -> Vec<Answer> {
    let accel = if walk == Walk::BruteForce { Accel::None } else { Accel::Bvh };
    let settings = RenderSettings { accel, ..settings(1, 1, 1) };
    let features: &[Feature] = if walk == Walk::Packets { &[Feature::Packets] } else { &[] };
    let call = Call::new(harness!("trace"), features).on(scene, &settings);
    let mut answers: Vec<Answer> = Vec::with_capacity(queries.len());
    for chunk in queries.chunks(DISPATCH) {
        let mut padded = chunk.to_vec();
        padded.resize(chunk.len().next_multiple_of(64), chunk[0]);
        let outputs: Vec<Answer> = call.run(&padded, 1);
        answers.extend(&outputs[..chunk.len()]);
    }
    assert!(answers.iter().all(|a| a.faults == 0), "{walk:?}: faults");
    answers
}
