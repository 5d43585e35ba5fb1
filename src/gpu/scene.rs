//! The scene's buffers.

use super::limits::{check_binding, mebibytes};
use super::materials::{Spread, TEXTURE_BUFFERS};
use super::world::{Emitter, TreeWidth, World};
use super::{
    BufferFacts, Device, DeviceInfo, GpuLight, GpuMaterial, albedos, environment, lights, materials,
};
use crate::bvh::KeptTrees;
use crate::scene::Scene;
use crate::settings::RenderSettings;
use crate::shader::Features;
use crate::shader::generated::{LIGHT_SLOTS, MATERIAL_SLOTS};
use crate::{Error, Result};

/// Everything of the scene that the device reads, still in memory.
pub struct SceneBuffers {
    /// Geometry.
    pub world: World,
    materials: materials::Materials,
    pub(super) lights: lights::Lights,
    choosing: lights::Choosing,
    environment: Option<environment::EnvironmentMap>,
    albedos: Vec<f32>,
}

/// The scene on the device, by the names of the variables that the shaders read.
pub struct GpuScene {
    buffers: Vec<(&'static str, wgpu::Buffer)>,
    bytes: u64,
    facts: BufferFacts,
    emitters: Vec<Emitter>,
    choosing: lights::Choosing,
    has_split_textures: bool,
}

const FEWER_EMITTERS: &str = "use fewer emissive triangles";
/// What every device can bind as uniforms.
const UNIFORM_BYTES: usize = 64 << 10;
const _: () = assert!(MATERIAL_SLOTS as usize * size_of::<GpuMaterial>() <= UNIFORM_BYTES);
const _: () = assert!(LIGHT_SLOTS as usize * size_of::<GpuLight>() <= UNIFORM_BYTES);

const SMALLER_MAP: &str = "reduce it with --max-environment-size";

impl SceneBuffers {
    /// Builds trees and tables.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn build(scene: &Scene, settings: &RenderSettings, width: TreeWidth) -> Result<Self> {
        Self::build_with(scene, settings, width, None)
    }

    /// [`SceneBuffers::build`] with the trees that are kept.
    ///
    /// # Errors
    /// As [`SceneBuffers::build`].
    pub fn build_with(
        scene: &Scene,
        settings: &RenderSettings,
        width: TreeWidth,
        kept: Option<&KeptTrees>,
    ) -> Result<Self> {
        let world = World::build_with(scene, settings.accel, width, kept)?;
        let features = Features::of(scene, settings);
        let has_tree = Features::has_light_tree(scene, settings);
        let choosing = lights::Choosing { selection: settings.light_selection, has_tree };
        let (lights, environment) = lighting(scene, &world.emitters, choosing);
        let albedos = albedos::build(features);
        let materials = materials::build(scene);
        Ok(Self { world, materials, lights, choosing, environment, albedos })
    }

    /// What the device would hold: names and bytes. Textures may spread over several buffers.
    pub fn sizes(&self) -> Vec<(&'static str, usize)> {
        let arrays = self.arrays().into_iter().map(|(name, _, bytes)| (name, bytes.len()));
        arrays.chain([("textures", self.materials.texture_bytes())]).collect()
    }

    /// Names of what is larger than a device of these limits can bind.
    pub fn too_large_for(&self, device: &DeviceInfo) -> Vec<&'static str> {
        let limit = device.max_binding_size;
        let arrays = self.arrays().into_iter().filter(|(_, _, bytes)| bytes.len() as u64 > limit);
        let textures = self.spread(device, limit).is_err().then_some("textures");
        arrays.map(|(name, ..)| name).chain(textures).collect()
    }

    /// How textures spread over bindings of at most `limit` bytes.
    fn spread(&self, device: &DeviceInfo, limit: u64) -> Result<Spread> {
        let bytes = self.materials.texture_bytes() as u64;
        let spread = Spread::of(bytes, limit, device.max_storage_buffers);
        let head = self.materials.descriptor_bytes() as u64;
        let has_head = |s: &Spread| match *s {
            Spread::One => true,
            Spread::Many { shift } => head <= 16 << shift,
        };
        spread.filter(has_head).ok_or_else(|| {
            Error::Limit(format!(
                "the scene's textures need {:.1} MiB, {} offers {} bindings of {:.1} MiB: \
                 bring images down with --max-texture-size",
                mebibytes(bytes),
                device.name,
                TEXTURE_BUFFERS.len(),
                mebibytes(limit),
            ))
        })
    }

    fn arrays(&self) -> Vec<(&'static str, &'static str, &[u8])> {
        let environment = self.environment.as_ref().map_or(&[][..], |e| &e.words);
        let fewer_triangles = "use fewer or instanced triangles";
        vec![
            ("nodes", fewer_triangles, bytemuck::cast_slice(&self.world.nodes)),
            ("primitives", fewer_triangles, bytemuck::cast_slice(&self.world.primitives)),
            ("attributes", fewer_triangles, bytemuck::cast_slice(&self.world.attributes)),
            ("materials", "use fewer materials", bytemuck::cast_slice(&self.materials.records)),
            ("lights", FEWER_EMITTERS, bytemuck::cast_slice(&self.lights.records)),
            ("light_tree", FEWER_EMITTERS, bytemuck::cast_slice(&self.lights.tree.words)),
            ("environment", SMALLER_MAP, bytemuck::cast_slice(environment)),
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
        let spread = self.spread(device.info(), device.texture_binding_size())?;
        let textures = self.materials.texture_buffers(spread);
        let bytes = arrays.iter().map(|(_, _, b)| b.len() as u64).sum::<u64>()
            + self.materials.texture_bytes() as u64;
        let mut buffers: Vec<_> =
            arrays.iter().map(|(name, _, b)| (*name, buffer_of(device, name, b))).collect();
        // Kernels that read several bind them all; what they do not reach may be empty.
        for (index, name) in TEXTURE_BUFFERS.into_iter().enumerate() {
            let words = textures.get(index).map_or(&[][..], |words| words);
            buffers.push((name, device.storage_buffer(name, bytemuck::cast_slice(words))));
        }
        let albedos = bytemuck::cast_slice(&self.albedos);
        buffers.push(("albedos", device.uniform_buffer("albedos", albedos)));
        device.wait()?;
        let emitters = self.world.emitters.clone();
        let has_split_textures = spread != Spread::One;
        let (facts, choosing) = (self.facts(), self.choosing);
        Ok(GpuScene { buffers, bytes, facts, emitters, choosing, has_split_textures })
    }
}

/// Bytes of the uniform buffer that the table of this name fits in, if it is short enough.
fn uniform_bytes(name: &str) -> usize {
    match name {
        "materials" => MATERIAL_SLOTS as usize * size_of::<GpuMaterial>(),
        "lights" => LIGHT_SLOTS as usize * size_of::<GpuLight>(),
        _ => 0,
    }
}

fn buffer_of(device: &Device, name: &str, bytes: &[u8]) -> wgpu::Buffer {
    match uniform_bytes(name) {
        size if size > 0 && bytes.len() <= size => device.table_buffer(name, bytes, size),
        _ => device.storage_buffer(name, bytes),
    }
}

/// The tables of all lights, the environment's among them.
fn lighting(
    scene: &Scene,
    emitters: &[Emitter],
    choosing: lights::Choosing,
) -> (lights::Lights, Option<environment::EnvironmentMap>) {
    let environment = scene.environment.as_ref().map(environment::build);
    let integral = environment.as_ref().map_or(0.0, |e| e.luminous_integral);
    (lights::build(scene, emitters, integral, choosing), environment)
}

impl GpuScene {
    /// The same geometry and materials in the environment that `scene` has now.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] before anything is copied, [`crate::Error::DeviceLost`].
    pub fn relit(&self, device: &Device, scene: &Scene) -> Result<Self> {
        let (lights, map) = lighting(scene, &self.emitters, self.choosing);
        let records: &[u8] = bytemuck::cast_slice(&lights.records);
        let words = bytemuck::cast_slice(map.as_ref().map_or(&[][..], |e| &e.words));
        let (mut buffers, mut bytes) = (self.buffers.clone(), self.bytes);
        let tree: &[u8] = bytemuck::cast_slice(&lights.tree.words);
        for (name, remedy, contents) in [
            ("lights", FEWER_EMITTERS, records),
            ("light_tree", FEWER_EMITTERS, tree),
            ("environment", SMALLER_MAP, words),
        ] {
            check_binding(device.info(), &format!("the scene's {name}"), contents.len(), remedy)?;
            if let Some((_, buffer)) = buffers.iter_mut().find(|(n, _)| *n == name) {
                let made = buffer_of(device, name, contents);
                bytes = bytes.saturating_sub(buffer.size()) + made.size();
                *buffer = made;
            }
        }
        device.wait()?;
        let facts = self.facts.with_lights(&lights);
        let emitters = self.emitters.clone();
        Ok(Self { buffers, bytes, facts, emitters, ..*self })
    }

    /// What the uniforms say of the buffers.
    pub fn facts(&self) -> &BufferFacts {
        &self.facts
    }

    /// Whether the textures are in several buffers.
    pub fn has_split_textures(&self) -> bool {
        self.has_split_textures
    }

    /// Whether the table of this name can be read as uniforms.
    pub fn is_uniform(&self, name: &str) -> bool {
        let is_uniform = |b: &wgpu::Buffer| b.usage().contains(wgpu::BufferUsages::UNIFORM);
        self.buffers.iter().any(|(n, buffer)| *n == name && is_uniform(buffer))
    }

    /// Buffers by the names of the shaders' variables.
    pub fn buffers(&self) -> impl Iterator<Item = (&'static str, &wgpu::Buffer)> {
        self.buffers.iter().map(|(name, buffer)| (*name, buffer))
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}
