//! Camera rays over a scene, without a render.

#[cfg(doc)]
use crate::Error;
use crate::Result;
use crate::gpu::{Device, SceneBuffers, TreeWidth};
use crate::passes::{FirstHits, Tuning};
use crate::scene::Scene;
use crate::settings::{Accel, RenderSettings};
use crate::shader::{Feature, Features};

/// Builds trees as a render would, uploads them, and compiles what traces camera rays; with counts
/// of the walk's cost if `counts_visits`.
///
/// # Errors
/// [`Error::Settings`], [`Error::Limit`], [`Error::DeviceLost`], [`Error::Shader`].
pub fn first_hits(
    device: &Device,
    scene: &Scene,
    settings: &RenderSettings,
    counts_visits: bool,
    tuning: &Tuning,
) -> Result<FirstHits> {
    settings.validate(scene)?;
    let has_packets = device.traces_packets() && settings.accel != Accel::None;
    let width = if has_packets { TreeWidth::Four } else { TreeWidth::Two };
    let buffers = SceneBuffers::build(scene, settings, width)?;
    let gpu_scene = buffers.upload(device)?;
    let features = Features::of(scene, settings).with_if(Feature::Packets, has_packets);
    let frame = buffers.frame(scene, settings);
    let stack_size = buffers.world.stack_size.max(1);
    FirstHits::new(device, &gpu_scene, features, counts_visits, stack_size, frame, tuning)
}
