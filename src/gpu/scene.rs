//! The scene's buffers.

use super::limits::check_binding;
use super::world::{TreeWidth, World};
use super::{Device, environment, lights, materials};
use crate::Result;
use crate::scene::Scene;
use crate::settings::RenderSettings;

/// Everything of the scene that the device reads, still in memory.
pub struct SceneBuffers {
    /// Geometry.
    pub world: World,
    materials: materials::Materials,
    pub(super) lights: lights::Lights,
    environment: Option<environment::EnvironmentMap>,
}

/// The scene on the device, by the names of the variables that the shaders read.
pub struct GpuScene {
    buffers: Vec<(&'static str, wgpu::Buffer)>,
    bytes: u64,
}

impl SceneBuffers {
    /// Builds trees and tables.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn build(scene: &Scene, settings: &RenderSettings, width: TreeWidth) -> Result<Self> {
        let world = World::build(scene, settings.accel, width)?;
        let environment = scene.environment.as_ref().map(environment::build);
        let integral = environment.as_ref().map_or(0.0, |e| e.luminous_integral);
        let lights = lights::build(scene, &world.emitters, integral);
        Ok(Self { world, materials: materials::build(scene), lights, environment })
    }

    /// What the device would hold: name and bytes of each buffer.
    pub fn sizes(&self) -> Vec<(&'static str, usize)> {
        self.arrays().into_iter().map(|(name, _, bytes)| (name, bytes.len())).collect()
    }

    fn arrays(&self) -> Vec<(&'static str, &'static str, &[u8])> {
        let environment = self.environment.as_ref().map_or(&[][..], |e| &e.words);
        let fewer_triangles = "use fewer or instanced triangles";
        let fewer_texels = "use smaller images";
        vec![
            ("nodes", fewer_triangles, bytemuck::cast_slice(&self.world.nodes)),
            ("primitives", fewer_triangles, bytemuck::cast_slice(&self.world.primitives)),
            ("attributes", fewer_triangles, bytemuck::cast_slice(&self.world.attributes)),
            ("materials", "use fewer materials", bytemuck::cast_slice(&self.materials.records)),
            ("lights", "use fewer emissive triangles", bytemuck::cast_slice(&self.lights.records)),
            ("textures", fewer_texels, bytemuck::cast_slice(&self.materials.textures)),
            ("environment", fewer_texels, bytemuck::cast_slice(environment)),
        ]
    }

    /// Copies everything to the device.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] before anything is copied, [`crate::Error::DeviceLost`].
    pub fn upload(&self, device: &Device) -> Result<GpuScene> {
        let arrays = self.arrays();
        for (name, remedy, bytes) in &arrays {
            check_binding(device.info(), &format!("the scene's {name}"), bytes.len(), remedy)?;
        }
        let bytes = arrays.iter().map(|(_, _, b)| b.len() as u64).sum();
        let buffers =
            arrays.iter().map(|(name, _, b)| (*name, device.storage_buffer(name, b))).collect();
        device.wait()?;
        Ok(GpuScene { buffers, bytes })
    }
}

impl GpuScene {
    /// Buffers by the names of the shaders' variables.
    pub fn buffers(&self) -> impl Iterator<Item = (&'static str, &wgpu::Buffer)> {
        self.buffers.iter().map(|(name, buffer)| (*name, buffer))
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}
