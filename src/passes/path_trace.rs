//! `shaders/path_trace.wgsl`: traces samples of tiles into the film buffer.

use super::Tuning;
use crate::Result;
use crate::gpu::{Device, GpuFilmPixel, GpuFrame, GpuScene, Kernel};
use crate::shader::generated::{INVALID, TILE_PIXELS, TILE_SIDE};
use crate::shader::{Features, generated};
use bytemuck::Zeroable;

/// One dispatch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Work {
    /// First tile of the region that the film buffer holds.
    pub region_first_tile: u32,
    /// First tile, counted within the region.
    pub first_tile: u32,
    /// Tiles.
    pub tile_count: u32,
    /// First sample index.
    pub sample_first: u32,
    /// Samples of each pixel.
    pub sample_count: u32,
}

/// The kernel with its buffers.
pub struct PathTrace {
    kernel: Kernel,
    bind_group: wgpu::BindGroup,
    frame_buffer: wgpu::Buffer,
    film_buffer: wgpu::Buffer,
    staging: wgpu::Buffer,
    frame: GpuFrame,
    workgroup_size: u32,
    wgsl_lines: usize,
}

impl PathTrace {
    /// Tiles across and down a window.
    pub fn tiles(width: u32, height: u32) -> (u32, u32) {
        (width.div_ceil(TILE_SIDE), height.div_ceil(TILE_SIDE))
    }

    /// Bytes of the film buffer for so many tiles.
    pub fn film_bytes(tile_count: u32) -> u64 {
        u64::from(tile_count) * u64::from(TILE_PIXELS) * size_of::<GpuFilmPixel>() as u64
    }

    /// Column and row within the window of the pixel at `local` of a tile; the
    /// inverse of `tile_pixel` in `film/tile.wgsl`.
    pub fn pixel(tile: u32, local: u32, tiles_across: u32) -> (u32, u32) {
        let x = (local & 3) | (local >> 1 & 4);
        let y = (local >> 2 & 1) | (local >> 3 & 6);
        (tile % tiles_across * TILE_SIDE + x, tile / tiles_across * TILE_SIDE + y)
    }

    /// Compiles for `features` and allocates the film for regions of `region_tiles`.
    ///
    /// # Errors
    /// [`crate::Error::Shader`].
    pub fn new(
        device: &Device,
        scene: &GpuScene,
        features: Features,
        stack_size: u32,
        frame: GpuFrame,
        region_tiles: u32,
        tuning: &Tuning,
    ) -> Result<Self> {
        let library = &tuning.library;
        let generated = generated::wgsl(stack_size, tuning.workgroup_size);
        let composed = crate::shader::compose(library, "path_trace", features, &generated)?;
        let kernel = Kernel::new(device, library, "path_trace", features, &generated)?;
        let buffer = |label, size, usage| {
            device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        use wgpu::BufferUsages as Usage;
        let frame_buffer =
            buffer("frame", size_of::<GpuFrame>() as u64, Usage::UNIFORM | Usage::COPY_DST);
        let film_bytes = Self::film_bytes(region_tiles);
        let film_buffer =
            buffer("film", film_bytes, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST);
        let staging = buffer("film copy", film_bytes, Usage::COPY_DST | Usage::MAP_READ);
        let mut buffers = vec![("frame", &frame_buffer), ("film", &film_buffer)];
        buffers.extend(scene.buffers());
        let bind_group = kernel.bind(device, &buffers);
        let pass = Self {
            kernel,
            bind_group,
            frame_buffer,
            film_buffer,
            staging,
            frame,
            workgroup_size: tuning.workgroup_size,
            wgsl_lines: composed.origins.len(),
        };
        Ok(pass)
    }

    /// Lines of the composed shader.
    pub fn wgsl_lines(&self) -> usize {
        self.wgsl_lines
    }

    /// Empties the film buffer.
    pub fn clear(&self, device: &Device) {
        let empty = GpuFilmPixel {
            fault_sample: INVALID,
            fault_bounce: INVALID,
            fault_material: INVALID,
            ..GpuFilmPixel::zeroed()
        };
        let pixels = self.film_buffer.size() as usize / size_of::<GpuFilmPixel>();
        device.queue.write_buffer(&self.film_buffer, 0, bytemuck::cast_slice(&vec![empty; pixels]));
    }

    /// Traces one piece of work and waits for it.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn run(&mut self, device: &Device, work: Work) -> Result<()> {
        self.frame.region_first_tile = work.region_first_tile;
        self.frame.dispatch_first_tile = work.first_tile;
        self.frame.dispatch_tile_count = work.tile_count;
        self.frame.sample_first = work.sample_first;
        self.frame.sample_count = work.sample_count;
        device.queue.write_buffer(&self.frame_buffer, 0, bytemuck::bytes_of(&self.frame));
        let mut encoder = device.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.kernel.pipeline);
            pass.set_bind_group(0, &self.bind_group, &[]);
            let threads = work.tile_count * TILE_PIXELS;
            pass.dispatch_workgroups(threads.div_ceil(self.workgroup_size), 1, 1);
        }
        device.queue.submit([encoder.finish()]);
        device.wait()
    }

    /// The film buffer's first `tile_count` tiles, one pixel after the other.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn read(&self, device: &Device, tile_count: u32) -> Result<Vec<GpuFilmPixel>> {
        let bytes = Self::film_bytes(tile_count);
        let mut encoder = device.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&self.film_buffer, 0, &self.staging, 0, bytes);
        device.queue.submit([encoder.finish()]);
        let slice = self.staging.slice(0..bytes);
        slice.map_async(wgpu::MapMode::Read, |_| ());
        device.wait()?;
        let view = slice
            .get_mapped_range()
            .map_err(|e| crate::Error::DeviceLost(format!("reading the film: {e}")))?;
        let pixels = bytemuck::cast_slice(&view).to_vec();
        drop(view);
        self.staging.unmap();
        Ok(pixels)
    }
}
