//! `shaders/first_hit.wgsl`: what camera rays meet first, for views of a scene.

use super::{PathTrace, Tuning};
use crate::Result;
use crate::gpu::{Device, GpuFirstHit, GpuFrame, GpuScene, Kernel, Readback};
use crate::settings::Crop;
use crate::shader::generated::{INVALID, TILE_PIXELS};
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
    ids: Option<RayIds>,
    frame: GpuFrame,
    workgroup_size: u32,
    /// Tiles that the buffer holds.
    region_tiles: u32,
    sample_count: u32,
    hits: Vec<GpuFirstHit>,
}

/// What the rays of a pixel met, one by one.
struct RayIds {
    buffer: wgpu::Buffer,
    readback: Readback,
    /// Rays of a pixel.
    rays: u32,
    ids: Vec<RayId>,
}

/// What a ray met: the primitive's index in scene order, or [`generated::INVALID`], and the offset
/// of the instance's record. [`Objects`](crate::gpu::Objects) knows what they mean.
pub type RayId = [u32; 2];

/// What first hits tell beside their sums.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Extras {
    /// What the centre's walk cost.
    pub visits: bool,
    /// What each of so many rays of a pixel met; 0 for none.
    pub ray_ids: u32,
}

impl Extras {
    /// The walk's cost, if `visits`.
    pub fn visits(visits: bool) -> Self {
        Self { visits, ray_ids: 0 }
    }
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
    /// Compiles for what of `features` first hits need. `frame`: the uniforms of the scene, its
    /// camera and its window.
    ///
    /// # Errors
    /// [`crate::Error::Shader`].
    pub fn new(
        device: &Device,
        scene: &GpuScene,
        features: Features,
        extras: Extras,
        stack_size: u32,
        frame: GpuFrame,
        tuning: &Tuning,
    ) -> Result<Self> {
        let needed = FEATURES
            .iter()
            .fold(Features::default(), |set, &f| set.with_if(f, features.has(f)))
            .with_if(Feature::VisitCounts, extras.visits)
            .with_if(Feature::RayIds, extras.ray_ids > 0);
        let generated = generated::wgsl(stack_size, tuning.workgroup_size);
        let kernel = Kernel::new(device, &tuning.library, "first_hit", needed, &generated)?;
        let tile_bytes = u64::from(TILE_PIXELS) * size_of::<GpuFirstHit>() as u64;
        let id_bytes = u64::from(TILE_PIXELS * extras.ray_ids) * size_of::<RayId>() as u64;
        let fits = device.info().max_binding_size / tile_bytes.max(id_bytes);
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
        let frame = GpuFrame { sample_limit: extras.ray_ids, ..frame };
        let ids = (extras.ray_ids > 0).then(|| {
            let bytes = u64::from(region_tiles) * id_bytes;
            RayIds {
                buffer: buffer("ray ids", bytes, Usage::STORAGE | Usage::COPY_SRC),
                readback: Readback::new(device, "ray ids copy", bytes),
                rays: extras.ray_ids,
                ids: Vec::new(),
            }
        });
        if let Some(ids) = &ids {
            buffers.push(("ray_ids", &ids.buffer));
        }
        buffers.extend(scene.buffers());
        let bind_group = kernel.bind(device, &buffers);
        Ok(Self {
            kernel,
            bind_group,
            frame_buffer,
            hits_buffer,
            readback: Readback::new(device, "first hits copy", hits_bytes),
            ids,
            frame,
            workgroup_size: tuning.workgroup_size,
            region_tiles,
            sample_count: 0,
            hits: vec![GpuFirstHit::zeroed(); width as usize * height as usize],
        })
    }

    /// Begins anew with another camera, environment or window.
    pub fn restart(&mut self, frame: GpuFrame) {
        self.frame = GpuFrame { sample_limit: self.frame.sample_limit, ..frame };
        self.sample_count = 0;
        let [width, height] = frame.window_size;
        self.hits.clear();
        self.hits.resize(width as usize * height as usize, GpuFirstHit::zeroed());
    }

    /// Begins anew in another part of the picture.
    pub fn move_to(&mut self, window: Crop) {
        self.restart(GpuFrame {
            window_origin: [window.x, window.y],
            window_size: [window.width, window.height],
            tiles_across: PathTrace::tiles(window.width, window.height).0,
            ..self.frame
        });
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

    /// What each ray met: the rays of a pixel together, pixels row by row. Empty unless they were
    /// asked for.
    pub fn ray_ids(&self) -> &[RayId] {
        self.ids.as_ref().map_or(&[], |ids| &ids.ids)
    }

    /// Adds the next `samples` of every pixel and waits for them. The first call traces the ray
    /// through every pixel's centre as well.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    ///
    /// # Panics
    /// If there are more rays than those that were to be told apart.
    pub fn run(&mut self, device: &Device, samples: u32) -> Result<()> {
        let [width, height] = self.frame.window_size;
        if let Some(ids) = &mut self.ids {
            assert!(self.sample_count + samples <= ids.rays, "rays that are told apart");
            let pixels = width as usize * height as usize;
            ids.ids.resize(pixels * ids.rays as usize, [INVALID; 2]);
        }
        let (across, down) = PathTrace::tiles(width, height);
        let mut first_tile = 0;
        while first_tile < across * down {
            let tiles = self.region_tiles.min(across * down - first_tile);
            self.run_region(device, first_tile, tiles, samples)?;
            let pixels = tiles * TILE_PIXELS;
            let read: Vec<GpuFirstHit> =
                self.readback.read(device, &self.hits_buffer, pixels as usize)?;
            let place = |i: usize| {
                let i = i as u32;
                let tile = first_tile + i / TILE_PIXELS;
                let (x, y) = PathTrace::pixel(tile, i % TILE_PIXELS, across);
                (x < width && y < height).then_some((y * width + x) as usize)
            };
            for (i, hit) in read.iter().enumerate() {
                if let Some(pixel) = place(i) {
                    self.hits[pixel].add(hit, self.sample_count == 0);
                }
            }
            if let Some(ids) = &mut self.ids {
                let rays = ids.rays as usize;
                let count = pixels as usize * rays;
                let read: Vec<RayId> = ids.readback.read(device, &ids.buffer, count)?;
                for (i, of_pixel) in read.chunks_exact(rays).enumerate() {
                    if let Some(pixel) = place(i) {
                        ids.ids[pixel * rays..][..rays].copy_from_slice(of_pixel);
                    }
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
            self.position[k] += more.position[k];
        }
        self.uv = [0, 1].map(|k| self.uv[k] + more.uv[k]);
        self.depth += more.depth;
        self.axial_depth += more.axial_depth;
        self.hit_count += more.hit_count;
        self.ray_count += more.ray_count;
        self.faults |= more.faults;
        if with_centre {
            self.material = more.material;
            self.source = more.source;
            self.instance = more.instance;
            self.weights = more.weights;
            self.centre_depth = more.centre_depth;
            self.node_visits = more.node_visits;
            self.primitive_visits = more.primitive_visits;
        }
    }
}
