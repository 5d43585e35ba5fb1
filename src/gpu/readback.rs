//! From the device's buffers back to the host.

use super::Device;
use crate::{Error, Result};
use bytemuck::Pod;

/// A buffer that the device copies into and the host reads.
pub struct Readback {
    staging: wgpu::Buffer,
}

impl Readback {
    /// For up to `bytes` bytes of what `label` names.
    pub fn new(device: &Device, label: &str, bytes: u64) -> Self {
        let staging = device.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Self { staging }
    }

    /// The first `count` elements of `source` after all that was submitted before.
    ///
    /// # Errors
    /// [`Error::DeviceLost`].
    pub fn read<T: Pod>(
        &self,
        device: &Device,
        source: &wgpu::Buffer,
        count: usize,
    ) -> Result<Vec<T>> {
        let bytes = (count * size_of::<T>()) as u64;
        let mut encoder = device.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(source, 0, &self.staging, 0, bytes);
        device.queue.submit([encoder.finish()]);
        let slice = self.staging.slice(0..bytes);
        slice.map_async(wgpu::MapMode::Read, |_| ());
        device.wait()?;
        let view =
            slice.get_mapped_range().map_err(|e| Error::DeviceLost(format!("reading: {e}")))?;
        let elements = bytemuck::cast_slice(&view).to_vec();
        drop(view);
        self.staging.unmap();
        Ok(elements)
    }
}
