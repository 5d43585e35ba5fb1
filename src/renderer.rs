//! One render: owns the scene on the device, the kernels and the film.

mod prepared;
mod preview;
mod rounds;
mod schedule;
mod statistics;
mod stored;
mod sweep;
mod views;

pub use prepared::PreparedScene;
pub use preview::Preview;
pub use statistics::{FaultLocation, RenderStatistics};
pub use stored::{Counts, RenderHead};

#[cfg(doc)]
use crate::Error;
use crate::Result;
use crate::film::{BlockMean, Film};
use crate::gpu::{Device, GpuFilmPixel};
use crate::passes::{PathTrace, Tuning, Work};
use crate::scene::Scene;
use crate::settings::RenderSettings;
use crate::shader::generated::{TILE_PIXELS, TILE_SIDE};
use rounds::Rounds;
use schedule::Schedule;
use statistics::fault_counts;
use std::sync::Arc;
use std::time::{Duration, Instant};
use sweep::{Pace, Piece, Sweep};

/// A render under way. [`Renderer::step`] until it says that nothing is left, or
/// stop at any time; then [`Renderer::finish`] and read the film.
pub struct Renderer {
    prepared: Arc<PreparedScene>,
    settings: RenderSettings,
    pass: PathTrace,
    film: Film,
    pace: Pace,
    plan: Plan,
    statistics: RenderStatistics,
    started: Option<Instant>,
    /// Of the renders that this one goes on from.
    elapsed_before: Duration,
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
        let prepared = PreparedScene::new(device, scene, settings)?;
        Self::of_prepared(Arc::new(prepared), scene, settings, tuning)
    }

    /// A render of a scene that is on the device. `scene` is the one that it was prepared from, but
    /// for its cameras, which may be others.
    ///
    /// # Errors
    /// [`Error::Settings`], [`Error::Limit`], [`Error::Shader`], [`Error::DeviceLost`].
    pub fn of_prepared(
        prepared: Arc<PreparedScene>,
        scene: &Scene,
        settings: &RenderSettings,
        tuning: &Tuning,
    ) -> Result<Self> {
        settings.validate(scene)?;
        let device = &prepared.device;
        let begin = Instant::now();
        let features = prepared.features(scene, settings);
        let frame = prepared.buffers.facts().frame(scene, settings);
        let schedule = Schedule::new(device, settings)?;
        let pixels = match settings.stopping_rule() {
            None => u64::from(schedule.region_tiles()) * u64::from(TILE_PIXELS),
            Some(_) => Rounds::film_pixels(device, settings)?,
        };
        let (buffers, stack_size) = (&prepared.buffers, prepared.stack_size);
        let mut pass =
            PathTrace::new(device, buffers, features, stack_size, frame, pixels, tuning)?;
        pass.clear(device);
        pass.run(device, Work { tile_count: 1, ..Work::default() }, None)?;
        let plan = match settings.stopping_rule() {
            None => Plan::Fixed(schedule),
            Some(rule) => {
                Plan::Adaptive(Box::new(Rounds::new(device, &rule, settings, &pass, tuning)?))
            }
        };
        let statistics = RenderStatistics {
            features,
            compile_seconds: begin.elapsed().as_secs_f64(),
            wgsl_lines: pass.wgsl_lines(),
            ..prepared.statistics.clone()
        };
        Ok(Self {
            pace: Pace::new(device, settings.largest_block(), tuning),
            prepared,
            settings: settings.clone(),
            pass,
            film: settings.film(),
            plan,
            statistics,
            started: None,
            elapsed_before: Duration::ZERO,
        })
    }

    /// Begins anew with another seed. Times of building and compiling stay as they were.
    ///
    /// # Errors
    /// [`Error::DeviceLost`].
    pub fn restart(&mut self, seed: u32) -> Result<()> {
        self.settings.seed = seed;
        self.pass.set_seed(seed);
        self.pass.clear(&self.prepared.device);
        self.film = self.settings.film();
        self.statistics = self.statistics.without_counts();
        (self.started, self.elapsed_before) = (None, Duration::ZERO);
        match &mut self.plan {
            Plan::Fixed(schedule) => {
                *schedule = Schedule::new(&self.prepared.device, &self.settings)?
            }
            Plan::Adaptive(rounds) => rounds.restart(&self.prepared.device)?,
        }
        Ok(())
    }

    /// Traces one piece of work, of 50 to 100 ms where the device allows. `false`:
    /// all samples are taken, or the time is over.
    ///
    /// # Errors
    /// [`Error::DeviceLost`].
    pub fn step(&mut self) -> Result<bool> {
        self.started.get_or_insert_with(Instant::now);
        if self.settings.time.is_some_and(|limit| self.elapsed() >= limit) {
            return Ok(false);
        }
        let Some(piece) = self.sweep().next(&self.pace) else { return Ok(false) };
        let begin = Instant::now();
        let work = self.work(piece);
        let adaptive = match &self.plan {
            Plan::Fixed(_) => None,
            Plan::Adaptive(rounds) => Some(&rounds.pass),
        };
        self.pass.run(&self.prepared.device, work, adaptive)?;
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
            self.film.set_stops(rounds.stops(&self.prepared.device, self.film.window())?);
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
        let share = |limit: Duration| self.elapsed().as_secs_f64() / limit.as_secs_f64();
        let by_time = self.settings.time.map_or(0.0, share);
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
        let blocks = self.pass.read(&self.prepared.device, count)?;
        for (pixel, block) in (first_pixel..).zip(&blocks) {
            self.fold_pixel(pixel, block);
        }
        self.pass.clear(&self.prepared.device);
        Ok(())
    }

    fn fold_round(&mut self) -> Result<()> {
        let Plan::Adaptive(rounds) = &self.plan else { return Ok(()) };
        let blocks = self.pass.read(&self.prepared.device, rounds.active_count)?;
        for block in &blocks {
            self.fold_pixel(block.pixel, block);
        }
        let begin = Instant::now();
        let Plan::Adaptive(rounds) = &mut self.plan else { return Ok(()) };
        self.statistics.decisions +=
            u32::from(rounds.end(&self.prepared.device, &blocks, &self.film)?);
        self.statistics.stopping_seconds += begin.elapsed().as_secs_f64();
        Ok(())
    }

    /// `pixel`: its place in the order of tiles.
    fn fold_pixel(&mut self, pixel: u32, block: &GpuFilmPixel) {
        let Some((x, y)) = self.place(pixel) else { return };
        let window = self.film.window();
        self.film.add_block(x, y, BlockMean::of(block));
        self.film.add_faults(x, y, fault_counts(block));
        self.statistics.add_block((window.x + x, window.y + y), block);
    }

    /// Column and row in the window; `None` for what tiles have beyond it.
    fn place(&self, pixel: u32) -> Option<(u32, u32)> {
        let (window, traced) = (self.film.window(), self.settings.traced_window());
        let tiles_across = traced.width.div_ceil(TILE_SIDE);
        let (x, y) = PathTrace::pixel(pixel / TILE_PIXELS, pixel % TILE_PIXELS, tiles_across);
        let x = (traced.x + x).checked_sub(window.x)?;
        let y = (traced.y + y).checked_sub(window.y)?;
        (x < window.width && y < window.height).then_some((x, y))
    }
}

impl BlockMean {
    /// Of what the device has summed.
    fn of(block: &GpuFilmPixel) -> Self {
        let n = f64::from(block.sample_count.max(1));
        let mean = |c: usize| f64::from(block.first[c]) + f64::from(block.difference[c]) / n;
        Self { mean: std::array::from_fn(mean), sample_count: block.sample_count }
    }
}
