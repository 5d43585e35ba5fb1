//! Runs a small kernel once over arrays: a way to call single shader functions.

use super::{Device, Kernel};
use crate::shader::{Features, Library};
use crate::{Error, Result};

/// One run of an entry of a library, which may be more than the program's own: add the
/// text to a copy of [`library`](crate::shader::library).
pub struct Batch<'a> {
    /// Texts that the entry and its imports are found in.
    pub library: &'a Library,
    /// The entry; its function is `main`.
    pub entry: &'a str,
    /// What it is composed for.
    pub features: Features,
    /// Contents of its read-only storage buffers by the names of their variables.
    pub inputs: &'a [(&'a str, &'a [u8])],
    /// Its writable storage buffer, zero at first: name of the variable and bytes.
    pub output: (&'a str, usize),
    /// Workgroups along x.
    pub workgroups: u32,
}

impl Batch<'_> {
    /// Compiles, runs, and gives the output buffer's bytes.
    ///
    /// # Errors
    /// [`Error::Shader`], [`Error::DeviceLost`].
    pub fn run(&self, device: &Device) -> Result<Vec<u8>> {
        let generated = crate::shader::generated::wgsl(1);
        let kernel = Kernel::new(device, self.library, self.entry, self.features, &generated)?;
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
        let mut buffers: Vec<_> = inputs.iter().map(|(name, buffer)| (*name, buffer)).collect();
        buffers.push((name, &output));
        let bind_group = kernel.bind(device, &buffers);

        let mut encoder = device.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&kernel.pipeline);
            pass.set_bind_group(0, &bind_group, &[]);
            pass.dispatch_workgroups(self.workgroups, 1, 1);
        }
        encoder.copy_buffer_to_buffer(&output, 0, &staging, 0, size);
        device.queue.submit([encoder.finish()]);
        staging.slice(..).map_async(wgpu::MapMode::Read, |_| ());
        device.wait()?;
        let view = staging
            .slice(..)
            .get_mapped_range()
            .map_err(|e| Error::DeviceLost(format!("reading {name}: {e}")))?;
        Ok(view.to_vec())
    }
}
