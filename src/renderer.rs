//! One render: owns the scene on the device, the kernels and the film.

mod rounds;
mod schedule;
mod statistics;
mod sweep;
mod views;

pub use statistics::{FaultLocation, RenderStatistics};
pub use views::first_hits;

#[cfg(doc)]
use crate::Error;
use crate::Result;
use crate::film::{BlockMean, Film};
use crate::gpu::{Device, GpuFilmPixel, GpuScene, SceneBuffers, TreeWidth};
use crate::passes::{FloatEnvironment, PathTrace, Tuning, Work};
use crate::scene::Scene;
use crate::settings::{Accel, RenderSettings};
use crate::shader::generated::{TILE_PIXELS, TILE_SIDE};
use crate::shader::{Feature, Features};
use rounds::Rounds;
use schedule::Schedule;
use statistics::fault_counts;
use std::sync::Arc;
use std::time::Instant;
use sweep::{Pace, Piece, Sweep};

/// A render under way. [`Renderer::step`] until it says that nothing is left, or
/// stop at any time; then [`Renderer::finish`] and read the film.
pub struct Renderer {
    device: Arc<Device>,
    settings: RenderSettings,
    /// Kept alive for the kernel's bindings.
    _scene: GpuScene,
    pass: PathTrace,
    film: Film,
    pace: Pace,
    plan: Plan,
    statistics: RenderStatistics,
    started: Option<Instant>,
}

/// Which samples come next.
enum Plan {
    /// As many for every pixel.
    Fixed(Schedule),
    /// For the pixels that are not converged.
    Adaptive(Box<Rounds>),
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

        let features = Features::of(scene, settings).with_if(Feature::Packets, has_packets);
        let begin = Instant::now();
        let frame = buffers.frame(scene, settings);
        let stack_size = buffers.world.stack_size.max(1);
        let schedule = Schedule::new(&device, settings)?;
        let pixels = match settings.stopping_rule() {
            None => u64::from(schedule.region_tiles()) * u64::from(TILE_PIXELS),
            Some(_) => Rounds::film_pixels(&device, settings)?,
        };
        let mut pass =
            PathTrace::new(&device, &gpu_scene, features, stack_size, frame, pixels, tuning)?;
        pass.clear(&device);
        pass.run(&device, Work { tile_count: 1, ..Work::default() }, None)?;
        let plan = match settings.stopping_rule() {
            None => Plan::Fixed(schedule),
            Some(rule) => {
                Plan::Adaptive(Box::new(Rounds::new(&device, &rule, settings, &pass, tuning)?))
            }
        };
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
            pace: Pace::new(&device, settings.largest_block(), tuning),
            device,
            settings: settings.clone(),
            _scene: gpu_scene,
            pass,
            film: Film::new(settings.window(), settings.samples_per_block()),
            plan,
            statistics,
            started: None,
        })
    }

    /// Begins anew with another seed. Times of building and compiling stay as they were.
    ///
    /// # Errors
    /// [`Error::DeviceLost`].
    pub fn restart(&mut self, seed: u32) -> Result<()> {
        self.settings.seed = seed;
        self.pass.set_seed(seed);
        self.pass.clear(&self.device);
        self.film = Film::new(self.film.window(), self.settings.samples_per_block());
        self.statistics = self.statistics.without_counts();
        self.started = None;
        match &mut self.plan {
            Plan::Fixed(schedule) => *schedule = Schedule::new(&self.device, &self.settings)?,
            Plan::Adaptive(rounds) => rounds.restart(&self.device)?,
        }
        Ok(())
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
        let Some(piece) = self.sweep().next(&self.pace) else { return Ok(false) };
        let begin = Instant::now();
        let work = self.work(piece);
        let adaptive = match &self.plan {
            Plan::Fixed(_) => None,
            Plan::Adaptive(rounds) => Some(&rounds.pass),
        };
        self.pass.run(&self.device, work, adaptive)?;
        self.pace.learn(piece, begin.elapsed().as_secs_f64());
        match &mut self.plan {
            Plan::Fixed(schedule) => schedule.sweep.advance(piece),
            Plan::Adaptive(rounds) => rounds.sweep.advance(piece),
        }
        if self.sweep().is_done() {
            self.fold()?;
        }
        self.statistics.render_seconds += begin.elapsed().as_secs_f64();
        Ok(true)
    }

    /// Folds a block that is under way, so that [`Renderer::film`] has every sample.
    ///
    /// # Errors
    /// [`Error::DeviceLost`].
    pub fn finish(&mut self) -> Result<()> {
        if !self.sweep().is_new() && !self.sweep().is_done() {
            self.fold()?;
        }
        if let Plan::Adaptive(rounds) = &self.plan {
            self.film.set_stops(rounds.stops(&self.device, self.film.window())?);
        }
        Ok(())
    }

    /// The sums so far.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// Counts and times so far.
    pub fn statistics(&self) -> &RenderStatistics {
        &self.statistics
    }

    /// Share of the samples, of the pixels, or of the time, that is done; 0 to 1.
    pub fn progress(&self) -> f64 {
        let by_time = match (self.settings.time, self.started) {
            (Some(limit), Some(start)) => start.elapsed().as_secs_f64() / limit.as_secs_f64(),
            _ => 0.0,
        };
        let by_samples = match &self.plan {
            Plan::Fixed(schedule) => schedule.progress(),
            Plan::Adaptive(rounds) => rounds.progress(),
        };
        by_time.max(by_samples).min(1.0)
    }

    fn sweep(&self) -> &Sweep {
        match &self.plan {
            Plan::Fixed(schedule) => &schedule.sweep,
            Plan::Adaptive(rounds) => &rounds.sweep,
        }
    }

    fn work(&self, piece: Piece) -> Work {
        let (region_first_tile, block_first) = match &self.plan {
            Plan::Fixed(schedule) => schedule.first(),
            // Every pixel on the list knows its own first sample.
            Plan::Adaptive(_) => (0, 0),
        };
        Work {
            region_first_tile,
            first_tile: piece.first_tile,
            tile_count: piece.tile_count,
            sample_first: block_first + piece.first_sample,
            sample_count: piece.sample_count,
        }
    }

    /// Reads the block under way back and folds it into the film.
    fn fold(&mut self) -> Result<()> {
        match self.plan {
            Plan::Fixed(_) => self.fold_region(),
            Plan::Adaptive(_) => self.fold_round(),
        }
    }

    fn fold_region(&mut self) -> Result<()> {
        let Plan::Fixed(schedule) = &mut self.plan else { return Ok(()) };
        let first_pixel = schedule.first().0 * TILE_PIXELS;
        let count = schedule.sweep.tile_count() * TILE_PIXELS;
        if schedule.sweep.is_done() {
            schedule.next_region();
        }
        let blocks = self.pass.read(&self.device, count)?;
        for (pixel, block) in (first_pixel..).zip(&blocks) {
            self.fold_pixel(pixel, block);
        }
        self.pass.clear(&self.device);
        Ok(())
    }

    fn fold_round(&mut self) -> Result<()> {
        let Plan::Adaptive(rounds) = &self.plan else { return Ok(()) };
        let blocks = self.pass.read(&self.device, rounds.active_count)?;
        for block in &blocks {
            self.fold_pixel(block.pixel, block);
        }
        let begin = Instant::now();
        let Plan::Adaptive(rounds) = &mut self.plan else { return Ok(()) };
        self.statistics.decisions += u32::from(rounds.end(&self.device, &blocks, &self.film)?);
        self.statistics.stopping_seconds += begin.elapsed().as_secs_f64();
        Ok(())
    }

    /// `pixel`: its place in the order of tiles.
    fn fold_pixel(&mut self, pixel: u32, block: &GpuFilmPixel) {
        let window = self.film.window();
        let tiles_across = window.width.div_ceil(TILE_SIDE);
        let (x, y) = PathTrace::pixel(pixel / TILE_PIXELS, pixel % TILE_PIXELS, tiles_across);
        if x >= window.width || y >= window.height {
            return;
        }
        let mean = BlockMean {
            mean: std::array::from_fn(|c| {
                let share = f64::from(block.difference[c]) / f64::from(block.sample_count.max(1));
                f64::from(block.first[c]) + share
            }),
            sample_count: block.sample_count,
        };
        self.film.add_block(x, y, mean);
        self.film.add_faults(x, y, fault_counts(block));
        self.statistics.add_block((window.x + x, window.y + y), block);
    }
}
