//! Runs a small kernel once over arrays: a way to call single shader functions.

use super::{Device, GpuScene, Kernel, SceneBuffers, TreeWidth};
use crate::scene::Scene;
use crate::settings::RenderSettings;
use crate::shader::{Feature, Features, Library, generated};
use crate::{Error, Result};

/// One run of an entry of a library, which may be more than the program's own: add the
/// text to a copy of [`library`](crate::shader::library).
pub struct Batch<'a> {
    /// Texts that the entry and its imports are found in.
    pub library: &'a Library,
    /// The entry; its function is `main`.
    pub entry: &'a str,
    /// What it is composed for; with a scene, in addition to what that needs.
    pub features: Features,
    /// A scene whose buffers and `frame` the entry's modules read. Its trees are for packets
    /// where `features` says so.
    pub scene: Option<(&'a Scene, &'a RenderSettings)>,
    /// Contents of its read-only storage buffers by the names of their variables.
    pub inputs: &'a [(&'a str, &'a [u8])],
    /// Its writable storage buffer, zero at first: name of the variable and bytes.
    pub output: (&'a str, usize),
    /// Workgroups along x.
    pub workgroups: u32,
}

/// A [`Batch`] that is compiled and whose arrays are on the device: to run it more than once.
pub struct PreparedBatch {
    kernel: Kernel,
    bind_group: wgpu::BindGroup,
    output: wgpu::Buffer,
    staging: wgpu::Buffer,
    workgroups: u32,
}

impl Batch<'_> {
    /// Compiles, runs, and gives the output buffer's bytes.
    ///
    /// # Errors
    /// [`Error::Shader`], [`Error::DeviceLost`]; [`Error::Limit`] for a scene.
    pub fn run(&self, device: &Device) -> Result<Vec<u8>> {
        let prepared = self.prepare(device)?;
        prepared.dispatch(device)?;
        prepared.read(device)
    }

    /// Compiles and copies to the device.
    ///
    /// # Errors
    /// [`Error::Shader`], [`Error::DeviceLost`]; [`Error::Limit`] for a scene.
    pub fn prepare(&self, device: &Device) -> Result<PreparedBatch> {
        let scene = self.scene.map(|(s, settings)| self.upload(device, s, settings));
        let scene = scene.transpose()?;
        let (features, stack_size) =
            scene.as_ref().map_or((Features::default(), 1), |s| (s.features, s.stack_size));
        let features = features.union(self.features);
        let generated = generated::wgsl(stack_size, generated::WORKGROUP_SIZE);
        let kernel = Kernel::new(device, self.library, self.entry, features, &generated)?;
        let inputs: Vec<_> = self
            .inputs
            .iter()
            .map(|(name, bytes)| (*name, device.storage_buffer(name, bytes)))
            .collect();
        use wgpu::BufferUsages as Usage;
        let (name, size) = (self.output.0, self.output.1 as u64);
        let buffer = |label, usage| {
            let label = Some(label);
            let descriptor =
                wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false };
            device.device.create_buffer(&descriptor)
        };
        let output = buffer(name, Usage::STORAGE | Usage::COPY_SRC);
        let staging = buffer("output copy", Usage::COPY_DST | Usage::MAP_READ);
        let mut buffers: Vec<(&str, &wgpu::Buffer)> = vec![(name, &output)];
        buffers.extend(inputs.iter().map(|(name, buffer)| (*name, buffer)));
        if let Some(scene) = &scene {
            buffers.push(("frame", &scene.frame));
            buffers.extend(scene.buffers.buffers().map(|(name, buffer)| (name as &str, buffer)));
        }
        let bind_group = kernel.bind(device, &buffers);
        let workgroups = self.workgroups;
        Ok(PreparedBatch { kernel, bind_group, output, staging, workgroups })
    }
}

impl PreparedBatch {
    /// Runs once and waits for the end.
    ///
    /// # Errors
    /// [`Error::DeviceLost`].
    pub fn dispatch(&self, device: &Device) -> Result<()> {
        let mut encoder = device.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.kernel.pipeline);
            pass.set_bind_group(0, &self.bind_group, &[]);
            pass.dispatch_workgroups(self.workgroups, 1, 1);
        }
        device.queue.submit([encoder.finish()]);
        device.wait()
    }

    /// The output buffer's bytes.
    ///
    /// # Errors
    /// [`Error::DeviceLost`].
    pub fn read(&self, device: &Device) -> Result<Vec<u8>> {
        let mut encoder = device.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&self.output, 0, &self.staging, 0, self.output.size());
        device.queue.submit([encoder.finish()]);
        self.staging.slice(..).map_async(wgpu::MapMode::Read, |_| ());
        device.wait()?;
        let view = self.staging.slice(..).get_mapped_range();
        let bytes = view.map_err(|e| Error::DeviceLost(format!("reading output: {e}")))?.to_vec();
        self.staging.unmap();
        Ok(bytes)
    }
}

/// A scene on the device, with its uniforms.
struct BatchScene {
    features: Features,
    stack_size: u32,
    frame: wgpu::Buffer,
    buffers: GpuScene,
}

impl Batch<'_> {
    fn upload(
        &self,
        device: &Device,
        scene: &Scene,
        settings: &RenderSettings,
    ) -> Result<BatchScene> {
        let has_packets = self.features.has(Feature::Packets);
        let width = if has_packets { TreeWidth::Four } else { TreeWidth::Two };
        let buffers = SceneBuffers::build(scene, settings, width)?;
        let frame = buffers.facts().frame(scene, settings);
        let frame = device.uniform_buffer("frame", bytemuck::bytes_of(&frame));
        let stack_size = buffers.world.stack_size.max(1);
        let buffers = buffers.upload(device)?;
        let features = Features::of(scene, settings).union(buffers.split_features());
        Ok(BatchScene { features, stack_size, frame, buffers })
    }
}
