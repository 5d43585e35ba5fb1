//! `shaders/first_hit.wgsl`: what camera rays meet first, for views of a scene.

use super::{PathTrace, Tuning};
use crate::Result;
use crate::gpu::{Device, GpuFirstHit, GpuFrame, GpuScene, Kernel, Readback};
use crate::settings::Crop;
use crate::shader::generated::TILE_PIXELS;
use crate::shader::{Feature, Features, generated};
use bytemuck::Zeroable;

/// Tiles of a submission, and samples of a pixel in it: 131,072 rays, a tenth of a second on
/// two processor cores, and far from the loop bounds of software drivers.
const SUBMIT_TILES: u32 = 512;
const SUBMIT_SAMPLES: u32 = 4;

/// The kernel with its buffers, and the sums so far.
pub struct FirstHits {
    kernel: Kernel,
    bind_group: wgpu::BindGroup,
    frame_buffer: wgpu::Buffer,
    hits_buffer: wgpu::Buffer,
    readback: Readback,
    frame: GpuFrame,
    workgroup_size: u32,
    /// Tiles that the buffer holds.
    region_tiles: u32,
    sample_count: u32,
    hits: Vec<GpuFirstHit>,
}

/// What the kernel has of a scene's and a render's features.
const FEATURES: [Feature; 13] = [
    Feature::Triangles,
    Feature::Spheres,
    Feature::AnchoredSpheres,
    Feature::Instances,
    Feature::Attributes,
    Feature::VertexData,
    Feature::Textures,
    Feature::Alpha,
    Feature::Lens,
    Feature::Orthographic,
    Feature::Packets,
    Feature::BruteForce,
    Feature::Sobol,
];

impl FirstHits {
    /// Compiles for what of `features` first hits need, with counts of the walk's cost if
    /// `counts_visits`. `frame`: the uniforms of the scene, its camera and its window.
    ///
    /// # Errors
    /// [`crate::Error::Shader`].
    pub fn new(
        device: &Device,
        scene: &GpuScene,
        features: Features,
        counts_visits: bool,
        stack_size: u32,
        frame: GpuFrame,
        tuning: &Tuning,
    ) -> Result<Self> {
        let needed = FEATURES
            .iter()
            .fold(Features::default(), |set, &f| set.with_if(f, features.has(f)))
            .with_if(Feature::VisitCounts, counts_visits);
        let generated = generated::wgsl(stack_size, tuning.workgroup_size);
        let kernel = Kernel::new(device, &tuning.library, "first_hit", needed, &generated)?;
        let tile_bytes = u64::from(TILE_PIXELS) * size_of::<GpuFirstHit>() as u64;
        let fits = device.info().max_binding_size / tile_bytes;
        let [width, height] = frame.window_size;
        let (across, down) = PathTrace::tiles(width, height);
        let region_tiles = fits.clamp(1, u64::from(across) * u64::from(down)) as u32;
        let hits_bytes = u64::from(region_tiles) * tile_bytes;
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
        let usage = Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST;
        let hits_buffer = buffer("first hits", hits_bytes, usage);
        let mut buffers = vec![("frame", &frame_buffer), ("first_hits", &hits_buffer)];
        buffers.extend(scene.buffers());
        let bind_group = kernel.bind(device, &buffers);
        Ok(Self {
            kernel,
            bind_group,
            frame_buffer,
            hits_buffer,
            readback: Readback::new(device, "first hits copy", hits_bytes),
            frame,
            workgroup_size: tuning.workgroup_size,
            region_tiles,
            sample_count: 0,
            hits: vec![GpuFirstHit::zeroed(); width as usize * height as usize],
        })
    }

    /// Begins anew with another camera or environment; `frame` has the size that it had before.
    ///
    /// # Panics
    /// If the window's size is another.
    pub fn restart(&mut self, frame: GpuFrame) {
        assert_eq!(frame.window_size, self.frame.window_size, "size of the window");
        self.frame = frame;
        self.sample_count = 0;
        self.hits.fill(GpuFirstHit::zeroed());
    }

    /// The part of the picture that it covers.
    pub fn window(&self) -> Crop {
        let ([x, y], [width, height]) = (self.frame.window_origin, self.frame.window_size);
        Crop { x, y, width, height }
    }

    /// Rays of every pixel so far.
    pub fn sample_count(&self) -> u32 {
        self.sample_count
    }

    /// Sums of every pixel of the window, row by row.
    pub fn hits(&self) -> &[GpuFirstHit] {
        &self.hits
    }

    /// Adds the next `samples` of every pixel and waits for them. The first call traces the ray
    /// through every pixel's centre as well.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn run(&mut self, device: &Device, samples: u32) -> Result<()> {
        let [width, height] = self.frame.window_size;
        let (across, down) = PathTrace::tiles(width, height);
        let mut first_tile = 0;
        while first_tile < across * down {
            let tiles = self.region_tiles.min(across * down - first_tile);
            self.run_region(device, first_tile, tiles, samples)?;
            let pixels = tiles * TILE_PIXELS;
            let read: Vec<GpuFirstHit> =
                self.readback.read(device, &self.hits_buffer, pixels as usize)?;
            for (i, hit) in read.iter().enumerate() {
                let i = i as u32;
                let tile = first_tile + i / TILE_PIXELS;
                let (x, y) = PathTrace::pixel(tile, i % TILE_PIXELS, across);
                if x < width && y < height {
                    self.hits[(y * width + x) as usize].add(hit, self.sample_count == 0);
                }
            }
            first_tile += tiles;
        }
        self.sample_count += samples;
        Ok(())
    }

    fn run_region(&mut self, device: &Device, first: u32, tiles: u32, samples: u32) -> Result<()> {
        let mut encoder = device.device.create_command_encoder(&Default::default());
        encoder.clear_buffer(&self.hits_buffer, 0, None);
        device.queue.submit([encoder.finish()]);
        let mut sample = 0;
        loop {
            let count = SUBMIT_SAMPLES.min(samples - sample);
            for at in (0..tiles).step_by(SUBMIT_TILES as usize) {
                self.frame.region_first_tile = first;
                self.frame.dispatch_first_tile = at;
                self.frame.dispatch_tile_count = SUBMIT_TILES.min(tiles - at);
                self.frame.sample_first = self.sample_count + sample;
                self.frame.sample_count = count;
                self.submit(device)?;
            }
            sample += count;
            if sample == samples {
                return Ok(());
            }
        }
    }

    fn submit(&self, device: &Device) -> Result<()> {
        device.queue.write_buffer(&self.frame_buffer, 0, bytemuck::bytes_of(&self.frame));
        let mut encoder = device.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.kernel.pipeline);
            pass.set_bind_group(0, &self.bind_group, &[]);
            let threads = self.frame.dispatch_tile_count * TILE_PIXELS;
            pass.dispatch_workgroups(threads.div_ceil(self.workgroup_size), 1, 1);
        }
        device.queue.submit([encoder.finish()]);
        device.wait()
    }
}

impl GpuFirstHit {
    /// Adds the sums of more rays; what the centre's ray met is there `with_centre`.
    fn add(&mut self, more: &Self, with_centre: bool) {
        for k in 0..3 {
            self.shading_normal[k] += more.shading_normal[k];
            self.geometric_normal[k] += more.geometric_normal[k];
            self.albedo[k] += more.albedo[k];
        }
        self.uv = [0, 1].map(|k| self.uv[k] + more.uv[k]);
        self.depth += more.depth;
        self.hit_count += more.hit_count;
        self.ray_count += more.ray_count;
        self.faults |= more.faults;
        if with_centre {
            self.material = more.material;
            self.node_visits = more.node_visits;
            self.primitive_visits = more.primitive_visits;
        }
    }
}
