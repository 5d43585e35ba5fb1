//! Which pixels go on, decided on the device: `shaders/accumulate.wgsl` after every block, and
//! `judge`, `scan` and `compact` where pixels are judged. They make the list of active
//! pixels that the film of an adaptive render is; `dispatch_size` fits the path tracer to it.

use super::Tuning;
use crate::Result;
use crate::gpu::{Device, GpuDispatch, GpuStopping, GpuTally, Kernel, Readback, check_binding};
use crate::shader::generated::{INVALID, LIST_PADDING, RUNS, TILE_PIXELS, wgsl};
use crate::shader::{Feature, Features};
use crate::stopping::StoppingRule;
use bytemuck::Zeroable;

/// The pixels that go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ActiveList {
    /// How many they are.
    pub pixel_count: u32,
    /// Samples of the longest block that one of them takes next.
    pub block_samples: u32,
}

/// A kernel with what it binds.
struct Step {
    kernel: Kernel,
    bind_group: wgpu::BindGroup,
}

/// The kernels with their buffers.
pub struct Adaptive {
    accumulate: Step,
    judge: Step,
    scan: Step,
    compact: Step,
    dispatch_size: Step,
    tallies: wgpu::Buffer,
    runs: wgpu::Buffer,
    tally_readback: Readback,
    dispatch: wgpu::Buffer,
    dispatch_readback: Readback,
    stopping_buffer: wgpu::Buffer,
    stopping: GpuStopping,
    /// Workgroups in a row of a dispatch, at most.
    row_groups: u32,
}

impl Adaptive {
    /// Compiles and allocates. `frame` and `film` are the path
    /// tracer's; the window has `tile_count` tiles.
    ///
    /// # Errors
    /// [`crate::Error::Shader`], [`crate::Error::Limit`].
    pub fn new(
        device: &Device,
        rule: &StoppingRule,
        tile_count: u32,
        (frame, film): (&wgpu::Buffer, &wgpu::Buffer),
        tuning: &Tuning,
    ) -> Result<Self> {
        let pixels = tile_count as usize * TILE_PIXELS as usize;
        let has_runs = matches!(rule, StoppingRule::Calibrated(_));
        let run_floats = if has_runs { pixels * RUNS as usize } else { 1 };
        let remedy = "render parts with --crop, or without --noise";
        check_binding(device.info(), "the pixels' statistics", 4 * run_floats, remedy)?;
        use wgpu::BufferUsages as Usage;
        let buffer = |label, bytes: usize, usage| {
            device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes as u64,
                usage,
                mapped_at_creation: false,
            })
        };
        let usage = Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST;
        let tallies = buffer("tallies", pixels * size_of::<GpuTally>(), usage);
        let runs = buffer("runs", 4 * run_floats, usage);
        let tile_counts = buffer("tile counts", 4 * tile_count as usize, Usage::STORAGE);
        let dispatch = buffer("dispatch", size_of::<GpuDispatch>(), usage | Usage::INDIRECT);
        let stopping = stopping(rule, tile_count);
        let uniform = Usage::UNIFORM | Usage::COPY_DST;
        let stopping_buffer = buffer("stopping", size_of::<GpuStopping>(), uniform);
        device.queue.write_buffer(&stopping_buffer, 0, bytemuck::bytes_of(&stopping));

        let buffers = [
            ("frame", frame),
            ("film", film),
            ("stopping", &stopping_buffer),
            ("tallies", &tallies),
            ("runs", &runs),
            ("tile_counts", &tile_counts),
            ("dispatch", &dispatch),
        ];
        let features = Features::default().with_if(Feature::SeedRule, !has_runs);
        let generated = wgsl(1, tuning.workgroup_size);
        let step = |entry| {
            let kernel = Kernel::new(device, &tuning.library, entry, features, &generated)?;
            let bind_group = kernel.bind(device, &buffers);
            Ok(Step { kernel, bind_group })
        };
        Ok(Self {
            accumulate: step("accumulate")?,
            judge: step("judge")?,
            scan: step("scan")?,
            compact: step("compact")?,
            dispatch_size: step("dispatch_size")?,
            tally_readback: Readback::new(device, "tally copy", tallies.size()),
            tallies,
            runs,
            dispatch_readback: Readback::new(device, "dispatch copy", dispatch.size()),
            dispatch,
            stopping_buffer,
            stopping,
            row_groups: tuning.row_groups,
        })
    }

    /// Begins anew, with a list of all pixels.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn begin(&mut self, device: &Device) -> Result<ActiveList> {
        let untouched = GpuTally { half_width: f32::INFINITY, ..GpuTally::zeroed() };
        let count = self.tallies.size() as usize / size_of::<GpuTally>();
        let untouched = vec![untouched; count];
        device.queue.write_buffer(&self.tallies, 0, bytemuck::cast_slice(&untouched));
        self.decide(device, 0.0)
    }

    /// Pixels of the film buffer for a window of so many.
    pub fn film_pixels(tile_count: u32) -> u64 {
        (u64::from(tile_count) * u64::from(TILE_PIXELS)).next_multiple_of(LIST_PADDING.into())
    }

    /// Adds the block of every active pixel to its statistics, and empties the film for the next.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn accumulate(&self, device: &Device, active_count: u32) -> Result<()> {
        let mut encoder = device.device.create_command_encoder(&Default::default());
        let groups = active_count.div_ceil(TILE_PIXELS);
        self.accumulate.run(&mut encoder, groups, self.row_groups);
        device.queue.submit([encoder.finish()]);
        device.wait()
    }

    /// Judges all pixels and lists those that go on. `floor`: the luminance
    /// that darker pixels count as.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn decide(&mut self, device: &Device, floor: f32) -> Result<ActiveList> {
        self.stopping.floor = floor;
        device.queue.write_buffer(&self.stopping_buffer, 0, bytemuck::bytes_of(&self.stopping));
        let tiles = self.stopping.tile_count;
        let mut encoder = device.device.create_command_encoder(&Default::default());
        self.judge.run(&mut encoder, tiles, self.row_groups);
        self.scan.run(&mut encoder, 1, 1);
        self.compact.run(&mut encoder, tiles, self.row_groups);
        device.queue.submit([encoder.finish()]);
        let dispatch: Vec<GpuDispatch> = self.dispatch_readback.read(device, &self.dispatch, 1)?;
        Ok(ActiveList {
            pixel_count: dispatch[0].active_count,
            block_samples: dispatch[0].block_samples,
        })
    }

    /// Prepares the path tracer's next dispatch; its size is in the buffer that is given back.
    pub(super) fn fit_dispatch(&self, encoder: &mut wgpu::CommandEncoder) -> &wgpu::Buffer {
        self.dispatch_size.run(encoder, 1, 1);
        &self.dispatch
    }

    /// What the device knows of all pixels beside the film: names and contents of buffers.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn stored(&self, device: &Device) -> Result<Vec<(&'static str, Vec<u8>)>> {
        let read = |(name, buffer): (_, &wgpu::Buffer)| {
            let readback = Readback::new(device, name, buffer.size());
            Ok((name, readback.read(device, buffer, buffer.size() as usize)?))
        };
        self.memory().map(read).into_iter().collect()
    }

    /// Goes back to what [`Self::stored`] gave: `contents` has a buffer's bytes by its name and length.
    ///
    /// # Errors
    /// Those of `contents`.
    pub fn restore(
        &self,
        device: &Device,
        contents: impl Fn(&str, usize) -> Result<Vec<u8>>,
    ) -> Result<()> {
        for (name, buffer) in self.memory() {
            device.queue.write_buffer(buffer, 0, &contents(name, buffer.size() as usize)?);
        }
        Ok(())
    }

    /// Buffers whose contents last from one round to the next.
    fn memory(&self) -> [(&'static str, &wgpu::Buffer); 3] {
        [("tallies", &self.tallies), ("runs", &self.runs), ("dispatch", &self.dispatch)]
    }

    /// What is known of every pixel, in the order of tiles.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn tallies(&self, device: &Device) -> Result<Vec<GpuTally>> {
        let count = self.tallies.size() as usize / size_of::<GpuTally>();
        self.tally_readback.read(device, &self.tallies, count)
    }
}

impl Step {
    /// In rows of at most `row_groups`: the last one is filled up.
    fn run(&self, encoder: &mut wgpu::CommandEncoder, workgroups: u32, row_groups: u32) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.kernel.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        let columns = workgroups.clamp(1, row_groups);
        pass.dispatch_workgroups(columns, workgroups.div_ceil(columns), 1);
    }
}

/// What the kernels know of the rule.
fn stopping(rule: &StoppingRule, tile_count: u32) -> GpuStopping {
    let common = GpuStopping {
        tolerance: rule.tolerance(),
        batch: INVALID,
        tile_count,
        ..GpuStopping::zeroed()
    };
    match rule {
        StoppingRule::Seed(seed) => GpuStopping { batch: seed.batch, ..common },
        StoppingRule::Calibrated(rule) => {
            let constants = rule.constants();
            GpuStopping {
                least_samples: constants.least_samples,
                black_samples: constants.black_samples,
                factor: constants.factor,
                consistency: constants.consistency,
                outlier_weight: constants.outlier_weight,
                ..common
            }
        }
    }
}
