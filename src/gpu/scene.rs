//! The scene's buffers.

use super::limits::{check_binding, mebibytes};
use super::materials::{Spread, TEXTURE_BUFFERS};
use super::split::{Split, Splits};
use super::world::{Emitter, TreeWidth, World};
use super::{
    BufferFacts, Device, DeviceInfo, GpuLight, GpuMaterial, albedos, environment, lights, materials,
};
use crate::bvh::KeptTrees;
use crate::scene::Scene;
use crate::settings::RenderSettings;
use crate::shader::generated::{LIGHT_SLOTS, MATERIAL_SLOTS};
use crate::shader::{Feature, Features};
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
    split_features: Features,
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

    /// What a kernel for a device of these limits has to split over several bindings.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] about the first table that cannot be bound.
    pub fn split_for(&self, device: &DeviceInfo) -> Result<Features> {
        let limit = device.max_binding_size;
        let (splits, spread) = self.splits(device, limit, limit)?;
        Ok(splits.features.with_if(Feature::SplitTextures, spread != Spread::One))
    }

    /// How geometry and textures spread over bindings of at most so many bytes.
    fn splits(
        &self,
        device: &DeviceInfo,
        geometry: u64,
        textures: u64,
    ) -> Result<(Splits, Spread)> {
        let arrays = self.arrays();
        for (name, remedy, bytes) in &arrays {
            if Split::named(name).is_none() {
                check_binding(device, &format!("the scene's {name}"), bytes.len(), remedy)?;
            }
        }
        let tables = arrays.iter().map(|(name, _, bytes)| (*name, bytes.len()));
        let splits = Splits::of(tables, geometry, device)?;
        Ok((splits, self.spread(device, textures, splits.extra)?))
    }

    /// How textures spread over bindings of at most `limit` bytes, where `taken` more than usual
    /// are taken.
    fn spread(&self, device: &DeviceInfo, limit: u64, taken: u32) -> Result<Spread> {
        let bytes = self.materials.texture_bytes() as u64;
        let spread = Spread::of(bytes, limit, device.max_storage_buffers.saturating_sub(taken));
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
        let (geometry, textures) = (device.geometry_binding_size(), device.texture_binding_size());
        let (splits, spread) = self.splits(device.info(), geometry, textures)?;
        let arrays = self.arrays();
        let textures = self.materials.texture_buffers(spread);
        let bytes = arrays.iter().map(|(_, _, b)| b.len() as u64).sum::<u64>()
            + self.materials.texture_bytes() as u64;
        let mut buffers = Vec::new();
        for (name, _, contents) in arrays {
            match Split::named(name).filter(|split| splits.features.has(split.feature)) {
                Some(split) => buffers.extend(parts_of(device, split, contents)),
                None => buffers.push((name, buffer_of(device, name, contents))),
            }
        }
        // Kernels that read several bind them all; what they do not reach may be empty.
        for (index, name) in TEXTURE_BUFFERS.into_iter().enumerate() {
            let words = textures.get(index).map_or(&[][..], |words| words);
            buffers.push((name, device.storage_buffer(name, bytemuck::cast_slice(words))));
        }
        let albedos = bytemuck::cast_slice(&self.albedos);
        buffers.push(("albedos", device.uniform_buffer("albedos", albedos)));
        device.wait()?;
        let emitters = self.world.emitters.clone();
        let split_features = splits.features.with_if(Feature::SplitTextures, spread != Spread::One);
        let (facts, choosing) = (self.facts(), self.choosing);
        Ok(GpuScene { buffers, bytes, facts, emitters, choosing, split_features })
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

/// The buffers of a table that is split, one after the other: each part is a copy.
fn parts_of<'a>(
    device: &'a Device,
    split: &'static Split,
    contents: &'a [u8],
) -> impl Iterator<Item = (&'static str, wgpu::Buffer)> + 'a {
    split.bindings.iter().enumerate().map(move |(k, name)| {
        let part = split.part(contents, k);
        (*name, device.storage_buffer(name, bytemuck::cast_slice(&part)))
    })
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

    /// What of it is in several buffers.
    pub fn split_features(&self) -> Features {
        self.split_features
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
