//! The uniforms of a render.

use super::camera::gpu_camera;
use super::lights::Lights;
use super::{GpuFrame, SceneBuffers, environment};
use crate::scene::{Environment, Scene};
use crate::settings::RenderSettings;
use crate::shader::generated::{INVALID, TILE_SIDE};

/// What the uniforms say of a scene's buffers.
#[derive(Debug, Clone, Copy)]
pub struct BufferFacts {
    environment_pmf: f32,
    light_count: u32,
    finite_light_count: u32,
    finite_light_share: f32,
    light_tree_trails: u32,
    triangle_count: u32,
    sphere_count: u32,
    attribute_base: u32,
    attribute_stride: u32,
}

impl SceneBuffers {
    /// What the uniforms say of these buffers.
    pub fn facts(&self) -> BufferFacts {
        let world = self.world.statistics();
        let facts = BufferFacts {
            environment_pmf: 0.0,
            light_count: 0,
            finite_light_count: 0,
            finite_light_share: 0.0,
            light_tree_trails: 0,
            triangle_count: world.triangle_count as u32,
            sphere_count: world.sphere_count as u32,
            attribute_base: self.world.attribute_base,
            attribute_stride: self.world.attribute_stride,
        };
        facts.with_lights(&self.lights)
    }
}

impl BufferFacts {
    /// The same with other lights.
    pub(super) fn with_lights(self, lights: &Lights) -> Self {
        Self {
            environment_pmf: lights.environment_pmf,
            light_count: lights.records.len() as u32,
            finite_light_count: lights.finite_count as u32,
            finite_light_share: lights.finite_share,
            light_tree_trails: lights.tree.trails,
            ..self
        }
    }

    /// The uniforms that do not change between dispatches; the others are 0.
    pub fn frame(&self, scene: &Scene, settings: &RenderSettings) -> GpuFrame {
        let window = settings.traced_window();
        let tiles_across = window.width.div_ceil(TILE_SIDE);
        let ([x, y, z], environment_size) = environment_frame(scene.environment.as_ref());
        GpuFrame {
            camera: gpu_camera(&scene.cameras[settings.camera], settings.resolution),
            environment_x: x,
            environment_y: y,
            environment_z: z,
            environment_size,
            environment_pmf: self.environment_pmf,
            light_count: self.light_count,
            resolution: settings.resolution.into(),
            window_origin: [window.x, window.y],
            window_size: [window.width, window.height],
            tiles_across,
            region_first_tile: 0,
            dispatch_first_tile: 0,
            sample_first: 0,
            sample_count: 0,
            seed: settings.seed,
            // A path that is wanted for one term alone ends with that.
            max_bounces: [settings.max_bounces, settings.only_bounce]
                .into_iter()
                .flatten()
                .min()
                .unwrap_or(INVALID),
            only_bounce: settings.only_bounce.unwrap_or(INVALID),
            light_samples: settings.light_samples,
            triangle_count: self.triangle_count,
            sphere_count: self.sphere_count,
            attribute_base: self.attribute_base,
            attribute_stride: self.attribute_stride,
            dispatch_tile_count: 0,
            block_unit: settings.samples_per_block(),
            largest_block: settings.largest_block(),
            sample_limit: settings.spp,
            environment_block: scene.environment.as_ref().map_or(1, environment::block),
            finite_light_count: self.finite_light_count,
            finite_light_share: self.finite_light_share,
            light_tree_trails: self.light_tree_trails,
            light_candidates: settings.light_candidates,
        }
    }
}

/// Rows of the rotation into the map's space, and the map's size.
fn environment_frame(map: Option<&Environment>) -> ([[f32; 4]; 3], [u32; 2]) {
    let Some(map) = map else { return ([[0.0; 4]; 3], [0; 2]) };
    let m = map.environment_from_world;
    let rows = [m.row(0), m.row(1), m.row(2)].map(|r| r.extend(0.0).to_array());
    (rows, [map.width, map.height])
}
