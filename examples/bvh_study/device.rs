//! Rays per second of the shaders' traversal on the device.

use crate::clock::own_seconds;
use bytemuck::{Pod, Zeroable};
use steradian::bvh::Ray;
use steradian::gpu::{Batch, Device};
use steradian::scene::Scene;
use steradian::shader::{Feature, Features, library};
use steradian::{RenderSettings, Result};

/// Threads of a workgroup.
const WORKGROUP: usize = 64;
/// Processor time of a measurement, seconds at least.
const LONG: f64 = 1.0;

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Input {
    origin: [f32; 3],
    t_max: f32,
    direction: [f32; 3],
    padding: u32,
}

/// Which walk.
#[derive(Clone, Copy)]
pub(crate) struct Walk {
    pub(crate) packets: bool,
    pub(crate) any: bool,
}

/// Rays traced in a second of processor time, and the distances: of the nearest hit, or with
/// `any` 0 where something was hit and 1 where nothing was.
pub(crate) fn rays_per_second(
    device: &Device,
    scene: &Scene,
    rays: &[Ray],
    walk: Walk,
) -> Result<(f64, Vec<f32>)> {
    let rays = &rays[..rays.len() / WORKGROUP * WORKGROUP];
    let input = |ray: &Ray| Input {
        origin: ray.o.into(),
        t_max: ray.t_max.min(f32::MAX),
        direction: ray.d.into(),
        padding: 0,
    };
    let inputs: Vec<_> = rays.iter().map(input).collect();
    let traced = match walk.any {
        true => "select(1.0, 0.0, trace_any(ray, true))",
        false => "trace_closest(ray, true).t",
    };
    let mut library = library();
    library.insert("trace_rays", include_str!("trace.wgsl").replace("TRACED", traced).into());
    let features = Features::default().with_if(Feature::Packets, walk.packets);
    let settings = RenderSettings::default();
    let batch = Batch {
        library: &library,
        entry: "trace_rays",
        features,
        scene: Some((scene, &settings)),
        inputs: &[("inputs", bytemuck::cast_slice(&inputs))],
        output: ("outputs", rays.len() * size_of::<f32>()),
        workgroups: (rays.len() / WORKGROUP) as u32,
    };
    let batch = batch.prepare(device)?;
    // The first compiles.
    batch.dispatch(device)?;
    let (begin, mut runs) = (own_seconds(), 0);
    let seconds = loop {
        batch.dispatch(device)?;
        runs += 1;
        let seconds = own_seconds() - begin;
        if seconds > LONG || seconds.is_nan() {
            break seconds;
        }
    };
    let distances = bytemuck::pod_collect_to_vec(&batch.read(device)?);
    Ok((rays.len() as f64 * f64::from(runs) / seconds, distances))
}
