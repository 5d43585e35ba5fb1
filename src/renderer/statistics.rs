//! What a render counts.

use crate::bvh::TreeSources;
use crate::gpu::GpuFilmPixel;
use crate::passes::FloatEnvironment;
use crate::shader::Features;
use crate::shader::generated::{Fault, INVALID};
use serde::{Deserialize, Serialize};

/// Counts and times of a render.
#[derive(Debug, Clone, Default)]
pub struct RenderStatistics {
    /// What was compiled.
    pub features: Features,
    /// How the device computes.
    pub float_environment: Option<FloatEnvironment>,
    /// Building trees and tables.
    pub bvh_seconds: f64,
    /// Compiling the kernel, the driver's part included.
    pub compile_seconds: f64,
    /// Tracing and reading back.
    pub render_seconds: f64,
    /// Of that, keeping account of which pixels go on.
    pub stopping_seconds: f64,
    /// Times that pixels were judged.
    pub decisions: u32,
    /// Camera paths.
    pub samples: u64,
    /// Rays that looked for their nearest hit.
    pub closest_rays: u64,
    /// Rays that looked for any hit.
    pub shadow_rays: u64,
    /// Samples with a fault, in the order of [`Fault::ALL`].
    pub faults: [u64; 4],
    /// The first of them.
    pub first_fault: Option<FaultLocation>,
    /// Triangles on the device.
    pub triangle_count: usize,
    /// Spheres.
    pub sphere_count: usize,
    /// Placements of shared meshes.
    pub instance_count: usize,
    /// Nodes of all trees.
    pub node_count: usize,
    /// Cost of the top tree by the surface area heuristic.
    pub sah_cost: f64,
    /// Levels of the trees.
    pub tree_depth: u32,
    /// Where the trees came from.
    pub trees: TreeSources,
    /// Bytes of the scene on the device.
    pub device_bytes: u64,
    /// Lines of the kernel.
    pub wgsl_lines: usize,
}

/// A faulty sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultLocation {
    /// Column and row in the whole picture.
    pub pixel: (u32, u32),
    /// Sample index.
    pub sample: u32,
    /// Scattering events before it; `None` where the fault came up outside of a path.
    pub bounce: Option<u32>,
    /// Index into [`Scene::materials`](crate::scene::Scene::materials) of the surface last met; `None` before the first.
    pub material: Option<u32>,
}

impl RenderStatistics {
    /// As before the first sample.
    pub(super) fn without_counts(&self) -> Self {
        Self {
            render_seconds: 0.0,
            stopping_seconds: 0.0,
            decisions: 0,
            samples: 0,
            closest_rays: 0,
            shadow_rays: 0,
            faults: [0; 4],
            first_fault: None,
            ..self.clone()
        }
    }

    /// Adds what a block of the pixel in column and row `at` of the whole picture counted.
    pub(super) fn add_block(&mut self, at: (u32, u32), block: &GpuFilmPixel) {
        self.samples += u64::from(block.sample_count);
        self.closest_rays += u64::from(block.closest_ray_count);
        self.shadow_rays += u64::from(block.shadow_ray_count);
        if block.fault_counts == 0 {
            return;
        }
        for (total, count) in self.faults.iter_mut().zip(fault_counts(block)) {
            *total += u64::from(count);
        }
        self.first_fault.get_or_insert(FaultLocation {
            pixel: at,
            sample: block.fault_sample,
            bounce: valid(block.fault_bounce),
            material: valid(block.fault_material),
        });
    }
}

/// Samples of a block with a fault, in the order of [`Fault::ALL`].
pub(super) fn fault_counts(block: &GpuFilmPixel) -> [u32; 4] {
    Fault::ALL.map(|cause| block.fault_counts >> (8 * cause as u32) & 0xFF)
}

/// What a shader's index says.
fn valid(index: u32) -> Option<u32> {
    (index != INVALID).then_some(index)
}
