//! One render: owns the scene on the device, the kernel and the film.

mod schedule;

use crate::film::{BlockMean, Film};
use crate::gpu::{Device, GpuFilmPixel, GpuScene, SceneBuffers, TreeWidth};
use crate::passes::{FloatEnvironment, PathTrace, Tuning};
use crate::scene::Scene;
use crate::settings::{Accel, RenderSettings};
use crate::shader::generated::{Fault, INVALID, TILE_PIXELS};
use crate::shader::{Feature, Features};
use crate::{Error, Result};
use schedule::Schedule;
use std::sync::Arc;
use std::time::Instant;

/// A render under way. [`Renderer::step`] until it says that nothing is left, or
/// stop at any time; then [`Renderer::finish`] and read the film.
pub struct Renderer {
    device: Arc<Device>,
    settings: RenderSettings,
    /// Kept alive for the kernel's bindings.
    _scene: GpuScene,
    pass: PathTrace,
    film: Film,
    schedule: Schedule,
    statistics: RenderStatistics,
    /// Whether the film buffer holds samples that the film does not.
    has_pending: bool,
    started: Option<Instant>,
}

/// Counts and times of a render.
#[derive(Debug, Clone, Default)]
pub struct RenderStatistics {
    /// What was compiled.
    pub features: Features,
    /// How the device computes.
    pub float_environment: Option<FloatEnvironment>,
    /// Building trees and tables.
    pub bvh_seconds: f64,
    /// Compiling the kernel, the driver's part included.
    pub compile_seconds: f64,
    /// Tracing and reading back.
    pub render_seconds: f64,
    /// Camera paths.
    pub samples: u64,
    /// Rays that looked for their nearest hit.
    pub closest_rays: u64,
    /// Rays that looked for any hit.
    pub shadow_rays: u64,
    /// Samples with a fault, in the order of [`Fault::ALL`].
    pub faults: [u64; 4],
    /// The first of them.
    pub first_fault: Option<FaultLocation>,
    /// Triangles on the device.
    pub triangle_count: usize,
    /// Spheres.
    pub sphere_count: usize,
    /// Placements of shared meshes.
    pub instance_count: usize,
    /// Nodes of all trees.
    pub node_count: usize,
    /// Cost of the top tree by the surface area heuristic.
    pub sah_cost: f64,
    /// Levels of the trees.
    pub tree_depth: u32,
    /// Bytes of the scene on the device.
    pub device_bytes: u64,
    /// Lines of the kernel.
    pub wgsl_lines: usize,
}

/// A faulty sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FaultLocation {
    /// Column and row in the whole picture.
    pub pixel: (u32, u32),
    /// Sample index.
    pub sample: u32,
    /// Scattering events before it; `None` where the fault came up outside of a path.
    pub bounce: Option<u32>,
    /// Index into [`Scene::materials`] of the surface last met; `None` before the first.
    pub material: Option<u32>,
}

impl Renderer {
    /// Builds trees, uploads and compiles.
    ///
    /// # Errors
    /// [`Error::Settings`], [`Error::Limit`], [`Error::DeviceLost`].
    pub fn new(device: Arc<Device>, scene: &Scene, settings: &RenderSettings) -> Result<Self> {
        Self::with_tuning(device, scene, settings, &Tuning::default())
    }

    /// [`Renderer::new`] with other than the usual ways to cut work, or with other shaders.
    ///
    /// # Errors
    /// As [`Renderer::new`]; [`Error::Shader`] for a library that does not compile.
    pub fn with_tuning(
        device: Arc<Device>,
        scene: &Scene,
        settings: &RenderSettings,
        tuning: &Tuning,
    ) -> Result<Self> {
        settings.validate(scene)?;
        let begin = Instant::now();
        let has_packets = device.traces_packets() && settings.accel != Accel::None;
        let width = if has_packets { TreeWidth::Four } else { TreeWidth::Two };
        let buffers = SceneBuffers::build(scene, settings, width)?;
        let bvh_seconds = begin.elapsed().as_secs_f64();
        let gpu_scene = buffers.upload(&device)?;

        let window = settings.window();
        let features = Features::of(scene, settings).with_if(Feature::Packets, has_packets);
        let schedule = Schedule::new(&device, settings, tuning)?;
        let begin = Instant::now();
        let frame = buffers.frame(scene, settings);
        let stack_size = buffers.world.stack_size.max(1);
        let region = schedule.region_tiles();
        let mut pass =
            PathTrace::new(&device, &gpu_scene, features, stack_size, frame, region, tuning)?;
        pass.clear(&device);
        pass.run(&device, Schedule::warm_up())?;
        let compile_seconds = begin.elapsed().as_secs_f64();

        let world = buffers.world.statistics();
        let statistics = RenderStatistics {
            features,
            float_environment: Some(FloatEnvironment::of(&device)?),
            bvh_seconds,
            compile_seconds,
            triangle_count: world.triangle_count,
            sphere_count: world.sphere_count,
            instance_count: world.instance_count,
            node_count: world.node_count,
            sah_cost: world.sah_cost,
            tree_depth: world.tree_depth,
            device_bytes: gpu_scene.bytes(),
            wgsl_lines: pass.wgsl_lines(),
            ..Default::default()
        };
        Ok(Self {
            device,
            settings: settings.clone(),
            _scene: gpu_scene,
            pass,
            film: Film::new(window),
            schedule,
            statistics,
            has_pending: false,
            started: None,
        })
    }

    /// Traces one piece of work, of 50 to 100 ms where the device allows. `false`:
    /// all samples are taken, or the time is over.
    ///
    /// # Errors
    /// [`Error::DeviceLost`].
    pub fn step(&mut self) -> Result<bool> {
        let started = *self.started.get_or_insert_with(Instant::now);
        if self.settings.time.is_some_and(|limit| started.elapsed() >= limit) {
            return Ok(false);
        }
        let Some(work) = self.schedule.next() else { return Ok(false) };
        let begin = Instant::now();
        self.pass.run(&self.device, work)?;
        self.has_pending = true;
        let seconds = begin.elapsed().as_secs_f64();
        if self.schedule.advance(work, seconds) {
            self.fold(true)?;
        }
        self.statistics.render_seconds += begin.elapsed().as_secs_f64();
        Ok(true)
    }

    /// Folds a block that is under way, so that [`Renderer::film`] has every sample.
    ///
    /// # Errors
    /// [`Error::DeviceLost`].
    pub fn finish(&mut self) -> Result<()> {
        if self.has_pending { self.fold(false) } else { Ok(()) }
    }

    /// The sums so far.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// Counts and times so far.
    pub fn statistics(&self) -> &RenderStatistics {
        &self.statistics
    }

    /// Share of the samples, or of the time, that is done; 0 to 1.
    pub fn progress(&self) -> f64 {
        let by_time = match (self.settings.time, self.started) {
            (Some(limit), Some(start)) => start.elapsed().as_secs_f64() / limit.as_secs_f64(),
            _ => 0.0,
        };
        by_time.max(self.schedule.progress()).min(1.0)
    }

    /// Reads the region's block back and folds it into the film.
    fn fold(&mut self, is_whole: bool) -> Result<()> {
        let (first_tile, tile_count) = self.schedule.folded_region();
        let (across, _) = PathTrace::tiles(self.film.window().width, self.film.window().height);
        let pixels = self.pass.read(&self.device, tile_count)?;
        let is_block = is_whole && self.schedule.is_full_block();
        for (tile, of_tile) in (first_tile..).zip(pixels.chunks_exact(TILE_PIXELS as usize)) {
            for (local, pixel) in (0..).zip(of_tile) {
                let (x, y) = PathTrace::pixel(tile, local, across);
                if x < self.film.window().width && y < self.film.window().height {
                    self.fold_pixel(x, y, pixel, is_block);
                }
            }
        }
        if is_block && self.schedule.ended_round() {
            self.film.end_round();
        }
        self.pass.clear(&self.device);
        self.has_pending = false;
        Ok(())
    }

    fn fold_pixel(&mut self, x: u32, y: u32, pixel: &GpuFilmPixel, is_block: bool) {
        let block = BlockMean {
            mean: std::array::from_fn(|c| {
                let share = f64::from(pixel.difference[c]) / f64::from(pixel.sample_count.max(1));
                f64::from(pixel.first[c]) + share
            }),
            sample_count: pixel.sample_count,
        };
        self.film.add_block(x, y, block, is_block);
        let s = &mut self.statistics;
        s.samples += u64::from(pixel.sample_count);
        s.closest_rays += u64::from(pixel.closest_ray_count);
        s.shadow_rays += u64::from(pixel.shadow_ray_count);
        if pixel.fault_counts == 0 {
            return;
        }
        for cause in Fault::ALL {
            s.faults[cause as usize] += u64::from(pixel.fault_counts >> (8 * cause as u32) & 0xFF);
        }
        let window = self.settings.window();
        s.first_fault.get_or_insert(FaultLocation {
            pixel: (window.x + x, window.y + y),
            sample: pixel.fault_sample,
            bounce: valid(pixel.fault_bounce),
            material: valid(pixel.fault_material),
        });
    }
}

/// What a shader's index says.
fn valid(index: u32) -> Option<u32> {
    (index != INVALID).then_some(index)
}

impl RenderSettings {
    /// Checks what cannot be rendered.
    ///
    /// # Errors
    /// [`Error::Settings`] naming the setting and what it may be.
    pub fn validate(&self, scene: &Scene) -> Result<()> {
        let (width, height) = self.resolution;
        let range = 1..=65_535;
        let window = self.window();
        let right = u64::from(window.x) + u64::from(window.width);
        let bottom = u64::from(window.y) + u64::from(window.height);
        let wrong = if !range.contains(&width) || !range.contains(&height) {
            format!("resolution {width}x{height}: each side must be 1 to 65535 pixels")
        } else if window.width == 0 || window.height == 0 {
            "crop: width and height must be at least 1".into()
        } else if right > u64::from(width) || bottom > u64::from(height) {
            format!("crop: reaches to {right},{bottom}, outside the picture of {width}x{height}")
        } else if self.spp == 0 {
            "spp must be at least 1".into()
        } else if !self.block_size.is_power_of_two() || self.block_size > 128 {
            format!("block {}: must be a power of two up to 128", self.block_size)
        } else if self.light_samples == 0 {
            "light samples must be at least 1".into()
        } else if self.camera >= scene.cameras.len() {
            let n = scene.cameras.len();
            format!("camera {}: the scene has {n}, counted from 0", self.camera)
        } else {
            return Ok(());
        };
        Err(Error::Settings(wrong))
    }
}
