//! A render in a film file, and back: also in the middle of a block, so that it ends with the bits
//! that it would have had without the break.

use super::sweep::Sweep;
use super::{FaultLocation, Plan, RenderStatistics, Renderer};
use crate::film::{Film, FilmFile, FilmHead, Sections};
use crate::gpu::GpuFilmPixel;
use crate::shader::generated::TILE_PIXELS;
use crate::{Error, Result};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::time::{Duration, Instant};

/// Where a render stands: the head of its sections.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RenderHead {
    film: FilmHead,
    position: Position,
    counts: Counts,
    /// Whether all samples are taken.
    pub is_done: bool,
    /// Time that it has taken so far.
    seconds: f64,
}

/// Which samples come next.
#[derive(Debug, Clone, Serialize, Deserialize)]
enum Position {
    Fixed { region_first: u32, block_first: u32, sweep: Sweep },
    Adaptive { active_count: u32, most_samples: u32, sweep: Sweep },
}

/// What was counted.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Counts {
    /// Camera paths.
    pub samples: u64,
    /// Rays that looked for their nearest hit.
    pub closest_rays: u64,
    /// Rays that looked for any hit.
    pub shadow_rays: u64,
    /// Samples with a fault, by cause.
    pub faults: [u64; 4],
    /// The first of them.
    pub first_fault: Option<FaultLocation>,
    /// Times that pixels were judged.
    pub decisions: u32,
    /// Tracing and reading back.
    pub render_seconds: f64,
    /// Of that, keeping account of which pixels go on.
    pub stopping_seconds: f64,
}

impl RenderHead {
    /// The film's head.
    pub fn film(&self) -> &FilmHead {
        &self.film
    }

    /// What was counted.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }
}

impl Renderer {
    /// Where it stands, and the sections that [`Renderer::go_on`] needs. Not after
    /// [`Renderer::finish`] has folded an incomplete block.
    ///
    /// # Errors
    /// [`Error::DeviceLost`].
    pub fn stored(&self) -> Result<(RenderHead, Sections<'_>)> {
        let device = &self.prepared.device;
        let mut sections = self.film.sections();
        let position = match &self.plan {
            Plan::Fixed(schedule) => {
                let (region_first, block_first) = schedule.first();
                let sweep = schedule.sweep;
                if !sweep.is_new() && !sweep.is_done() {
                    let pixels = self.pass.read(device, sweep.tile_count() * TILE_PIXELS)?;
                    sections.push(("device.film".into(), bytes_of(&pixels).into()));
                }
                Position::Fixed { region_first, block_first, sweep }
            }
            Plan::Adaptive(rounds) => {
                let pixels = self.pass.read(device, self.pass.pixel_count())?;
                sections.push(("device.film".into(), bytes_of(&pixels).into()));
                for (name, bytes) in rounds.pass.stored(device)? {
                    sections.push((format!("device.{name}"), Cow::Owned(bytes)));
                }
                let (active_count, most_samples) = (rounds.active_count, rounds.most_samples);
                Position::Adaptive { active_count, most_samples, sweep: rounds.sweep }
            }
        };
        let head = RenderHead {
            film: self.film.head(),
            position,
            counts: self.counts(),
            is_done: self.is_done(),
            seconds: self.elapsed().as_secs_f64(),
        };
        Ok((head, sections))
    }

    /// Goes on where a render of the same scene and settings stood.
    ///
    /// # Errors
    /// [`Error::Io`] if the file does not fit.
    pub fn go_on(&mut self, head: &RenderHead, file: &FilmFile) -> Result<()> {
        let device = self.prepared.device.clone();
        let misfit = || file.misfit("is of another render, or of a device with other limits");
        let (mine, its) = (self.film.head(), &head.film);
        if (mine.window, mine.unit, mine.samples) != (its.window, its.unit, its.samples) {
            return Err(misfit());
        }
        let film = Film::read(file, its)?;
        match (&mut self.plan, &head.position) {
            (Plan::Fixed(schedule), Position::Fixed { region_first, block_first, sweep }) => {
                schedule.go_to(*region_first, *block_first).ok_or_else(misfit)?;
                if !sweep.is_stage_of(&schedule.sweep) {
                    return Err(misfit());
                }
                if file.has("device.film") {
                    let count = sweep.tile_count() * TILE_PIXELS;
                    let pixels: Vec<GpuFilmPixel> = file.section("device.film", count as usize)?;
                    self.pass.write(&device, &pixels);
                }
                schedule.sweep = *sweep;
            }
            (Plan::Adaptive(rounds), Position::Adaptive { active_count, most_samples, sweep }) => {
                if !sweep.is_stage_of(sweep) || *active_count > self.pass.pixel_count() {
                    return Err(misfit());
                }
                let count = self.pass.pixel_count() as usize;
                let pixels: Vec<GpuFilmPixel> = file.section("device.film", count)?;
                self.pass.write(&device, &pixels);
                rounds.pass.restore(&device, |name, bytes| {
                    file.section(&format!("device.{name}"), bytes)
                })?;
                (rounds.active_count, rounds.most_samples) = (*active_count, *most_samples);
                rounds.sweep = *sweep;
            }
            _ => return Err(misfit()),
        }
        self.film = film;
        self.take_counts(&head.counts, Duration::from_secs_f64(head.seconds.max(0.0)));
        Ok(())
    }

    /// As [`Renderer::stored`] after the device was lost: as of the beginning of the block under way.
    /// `None` where pixels stop one by one, of which only the device knew.
    pub fn stored_without_device(&self) -> Option<(RenderHead, Sections<'_>)> {
        let Plan::Fixed(schedule) = &self.plan else { return None };
        let (region_first, block_first) = schedule.first();
        let sweep = schedule.sweep.begun_anew();
        let head = RenderHead {
            film: self.film.head(),
            position: Position::Fixed { region_first, block_first, sweep },
            counts: self.counts(),
            is_done: self.is_done(),
            seconds: self.elapsed().as_secs_f64(),
        };
        Some((head, self.film.sections()))
    }

    /// Goes on where `lost`, a render of the same scene and settings whose device was lost, stood at
    /// the beginning of the block under way. `false`: it begins anew, since pixels stop one by one,
    /// of which only that device knew.
    ///
    /// # Errors
    /// [`Error::Settings`] if it is another render.
    pub fn take_over(&mut self, lost: Self) -> Result<bool> {
        let misfit = || Error::Settings("the other render is cut in another way".into());
        let (counts, elapsed) = (lost.counts(), lost.elapsed());
        let (Plan::Fixed(schedule), Plan::Fixed(its)) = (&mut self.plan, &lost.plan) else {
            return Ok(false);
        };
        let (region_first, block_first) = its.first();
        schedule.go_to(region_first, block_first).ok_or_else(misfit)?;
        self.film = lost.film;
        self.take_counts(&counts, elapsed);
        Ok(true)
    }

    fn counts(&self) -> Counts {
        Counts::of(&self.statistics)
    }

    fn take_counts(&mut self, counts: &Counts, elapsed: Duration) {
        counts.put_into(&mut self.statistics);
        self.elapsed_before = elapsed;
        self.started = None;
    }

    /// Time since the first step, with that of the renders that it goes on from.
    pub(super) fn elapsed(&self) -> Duration {
        self.elapsed_before + self.started.as_ref().map_or(Duration::ZERO, Instant::elapsed)
    }
}

impl Counts {
    /// Of a render.
    pub fn of(s: &RenderStatistics) -> Self {
        Self {
            samples: s.samples,
            closest_rays: s.closest_rays,
            shadow_rays: s.shadow_rays,
            faults: s.faults,
            first_fault: s.first_fault,
            decisions: s.decisions,
            render_seconds: s.render_seconds,
            stopping_seconds: s.stopping_seconds,
        }
    }

    /// Replaces the counts there.
    pub fn put_into(&self, s: &mut RenderStatistics) {
        s.samples = self.samples;
        s.closest_rays = self.closest_rays;
        s.shadow_rays = self.shadow_rays;
        s.faults = self.faults;
        s.first_fault = self.first_fault;
        s.decisions = self.decisions;
        s.render_seconds = self.render_seconds;
        s.stopping_seconds = self.stopping_seconds;
    }

    /// Adds those of another part of the same render.
    pub fn add(&mut self, other: &Self) {
        self.samples += other.samples;
        self.closest_rays += other.closest_rays;
        self.shadow_rays += other.shadow_rays;
        self.faults.iter_mut().zip(other.faults).for_each(|(a, b)| *a += b);
        self.first_fault = self.first_fault.or(other.first_fault);
        self.decisions += other.decisions;
        self.render_seconds += other.render_seconds;
        self.stopping_seconds += other.stopping_seconds;
    }
}

fn bytes_of(pixels: &[GpuFilmPixel]) -> Vec<u8> {
    bytemuck::cast_slice(pixels).to_vec()
}
