//! `shaders/path_trace.wgsl`: traces samples of tiles into the film buffer.

use super::{Adaptive, Tuning};
use crate::Result;
use crate::gpu::{Device, GpuFilmPixel, GpuFrame, GpuScene, Kernel, Readback};
use crate::shader::generated::{INVALID, TILE_PIXELS, TILE_SIDE};
use crate::shader::{Features, generated};
use bytemuck::Zeroable;

/// One dispatch.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
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
    readback: Readback,
    frame: GpuFrame,
    workgroup_size: u32,
    wgsl_lines: usize,
}

impl PathTrace {
    /// Tiles across and down a window.
    pub fn tiles(width: u32, height: u32) -> (u32, u32) {
        (width.div_ceil(TILE_SIDE), height.div_ceil(TILE_SIDE))
    }

    /// Bytes of a tile in the film buffer.
    pub const TILE_BYTES: u64 = TILE_PIXELS as u64 * size_of::<GpuFilmPixel>() as u64;

    /// Column and row within the window of the pixel at `local` of a tile; the
    /// inverse of `tile_pixel` in `film/tile.wgsl`.
    pub fn pixel(tile: u32, local: u32, tiles_across: u32) -> (u32, u32) {
        let x = (local & 3) | (local >> 1 & 4);
        let y = (local >> 2 & 1) | (local >> 3 & 6);
        (tile % tiles_across * TILE_SIDE + x, tile / tiles_across * TILE_SIDE + y)
    }

    /// The inverse: place in the order of tiles of a pixel of the window.
    pub fn index(x: u32, y: u32, tiles_across: u32) -> usize {
        let local = (x & 3) | (x & 4) << 1 | (y & 1) << 2 | (y & 6) << 3;
        let tile = y / TILE_SIDE * tiles_across + x / TILE_SIDE;
        (tile * TILE_PIXELS + local) as usize
    }

    /// Compiles for `features` and allocates a film of `film_pixels`.
    ///
    /// # Errors
    /// [`crate::Error::Shader`].
    pub fn new(
        device: &Device,
        scene: &GpuScene,
        features: Features,
        stack_size: u32,
        frame: GpuFrame,
        film_pixels: u64,
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
        let film_bytes = film_pixels * size_of::<GpuFilmPixel>() as u64;
        let film_buffer =
            buffer("film", film_bytes, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST);
        let mut buffers = vec![("frame", &frame_buffer), ("film", &film_buffer)];
        buffers.extend(scene.buffers());
        let bind_group = kernel.bind(device, &buffers);
        let pass = Self {
            kernel,
            bind_group,
            frame_buffer,
            film_buffer,
            readback: Readback::new(device, "film copy", film_bytes),
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
        self.write(device, &vec![empty; self.pixel_count() as usize]);
    }

    /// Pixels that the film buffer holds.
    pub fn pixel_count(&self) -> u32 {
        (self.film_buffer.size() / size_of::<GpuFilmPixel>() as u64) as u32
    }

    /// Replaces the film buffer's first pixels.
    pub fn write(&self, device: &Device, pixels: &[GpuFilmPixel]) {
        device.queue.write_buffer(&self.film_buffer, 0, bytemuck::cast_slice(pixels));
    }

    /// Random numbers from here on are of that seed.
    pub fn set_seed(&mut self, seed: u32) {
        self.frame.seed = seed;
    }

    /// The uniforms and the film, for kernels that work on the same.
    pub fn buffers(&self) -> (&wgpu::Buffer, &wgpu::Buffer) {
        (&self.frame_buffer, &self.film_buffer)
    }

    /// Traces one piece of work and waits for it; with `adaptive`, of the pixels on its list.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn run(&mut self, device: &Device, work: Work, adaptive: Option<&Adaptive>) -> Result<()> {
        self.frame.region_first_tile = work.region_first_tile;
        self.frame.dispatch_first_tile = work.first_tile;
        self.frame.dispatch_tile_count = work.tile_count;
        self.frame.sample_first = work.sample_first;
        self.frame.sample_count = work.sample_count;
        device.queue.write_buffer(&self.frame_buffer, 0, bytemuck::bytes_of(&self.frame));
        let mut encoder = device.device.create_command_encoder(&Default::default());
        let fitted = adaptive.map(|a| a.fit_dispatch(&mut encoder));
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.kernel.pipeline);
            pass.set_bind_group(0, &self.bind_group, &[]);
            if let Some(size) = fitted {
                pass.dispatch_workgroups_indirect(size, 0);
            } else {
                let threads = work.tile_count * TILE_PIXELS;
                pass.dispatch_workgroups(threads.div_ceil(self.workgroup_size), 1, 1);
            }
        }
        device.queue.submit([encoder.finish()]);
        device.wait()
    }

    /// The film buffer's first `count` pixels.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn read(&self, device: &Device, count: u32) -> Result<Vec<GpuFilmPixel>> {
        self.readback.read(device, &self.film_buffer, count as usize)
    }
}
