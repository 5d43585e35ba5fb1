//! Pictures for the window: of the render as it stands, or coarse ones while things move.

use super::stage::in_motion;
use super::views::of_hits;
use super::{COARSEST, Engine};
use crate::viewer::wish::{Frame, Phase, Progress, Report};
use std::sync::Arc;
use std::time::{Duration, Instant};
use steradian::renderer::Preview;
use steradian::{RenderSettings, Renderer, Result};

/// Seconds that a picture in motion should take.
const MOTION_SECONDS: f64 = 0.04;
/// Buffers and a kernel that is there take less.
const COMPILE_SECONDS: f64 = 0.25;
/// Then what there is of it is shown.
const MOTION_LIMIT: Duration = Duration::from_millis(80);

impl Engine {
    /// Shows the render as it stands.
    pub(super) fn show(&mut self, wish: u64) -> Result<()> {
        let begin = Instant::now();
        let Some(renderer) = &self.renderer else { return Ok(()) };
        let preview = renderer.preview()?;
        let progress = progress(renderer, &preview);
        if progress.seconds > 0.05 {
            self.samples_per_second = progress.samples as f64 / progress.seconds;
        }
        let is_done = self.is_over;
        let is_paused = self.wish.as_ref().is_some_and(|(_, w)| w.is_paused);
        self.developed.keep(preview);
        self.look_at_film()?;
        let change = |report: &mut Report| {
            report.progress = progress;
            report.busy = None;
            report.phase = match (is_done, is_paused) {
                (true, _) => Phase::Done,
                (false, true) => Phase::Paused,
                _ => Phase::Rendering,
            };
        };
        match self.wish.as_ref().and_then(|(_, wish)| of_hits(wish)) {
            // Samples change nothing of it.
            Some(_) => self.link.tell(change),
            None => self.publish(wish, 1, change),
        }
        self.developed.paid(begin.elapsed());
        Ok(())
    }

    /// The same samples in another exposure.
    pub(super) fn show_again(&mut self) -> Result<()> {
        if let Some((serial, _)) = self.wish {
            let scale = self.developed.scale();
            self.publish(serial, scale, |_| ());
        }
        Ok(())
    }

    /// The same samples in another way.
    pub(super) fn change_view(&mut self) -> Result<()> {
        self.developed.overlay = None;
        self.glance = None;
        let Some((serial, wish)) = self.wish.clone() else { return Ok(()) };
        match of_hits(&wish) {
            Some(view) => {
                let scale = self.sketch_view(view)?;
                self.publish(serial, scale, |_| ());
                Ok(())
            }
            None if self.renderer.is_some() => self.show(serial),
            None => self.show_motion(),
        }
    }

    /// By how much the sides of a picture are divided that is traced in a moment; `speed`: how many
    /// times as fast as paths.
    pub(super) fn coarseness(&self, settings: &RenderSettings, speed: f64) -> u32 {
        let window = settings.window();
        let wanted = f64::from(window.width) * f64::from(window.height)
            / (self.samples_per_second * speed * MOTION_SECONDS).max(1.0);
        (wanted.sqrt().ceil() as u32).clamp(1, COARSEST)
    }

    /// One sample of every pixel of a smaller picture.
    pub(super) fn show_motion(&mut self) -> Result<()> {
        let (Some(stage), Some((serial, wish))) = (&self.stage, &self.wish) else { return Ok(()) };
        self.link.busy(Some("compiling shaders"));
        let (serial, is_paused) = (*serial, wish.is_paused);
        let phase = if is_paused { Phase::Paused } else { Phase::Rendering };
        if let Some(view) = of_hits(wish) {
            self.developed.forget();
            let scale = self.sketch_view(view)?;
            self.publish(serial, scale, |report| {
                report.busy = None;
                report.phase = phase;
            });
            return Ok(());
        }
        let scale = self.coarseness(&stage.job.settings, 1.0);
        let settings = in_motion(&stage.job.settings, scale);
        let mut renderer = stage.renderer(&settings, &self.tuning)?;
        self.has_compiled = renderer.statistics().compile_seconds > COMPILE_SECONDS;
        let deadline = Instant::now() + MOTION_LIMIT;
        while renderer.step()? && Instant::now() < deadline {}
        let preview = renderer.preview()?;
        let progress = Progress { spp: (0, 0), converged: None, ..progress(&renderer, &preview) };
        if progress.seconds > 0.005 {
            self.samples_per_second = progress.samples as f64 / progress.seconds;
        }
        self.developed.overlay = None;
        self.developed.keep_backdrop(preview, scale);
        self.publish(serial, scale, |report| {
            report.busy = None;
            report.progress = progress;
            report.phase = phase;
        });
        Ok(())
    }

    /// Hands the newest picture to the window, and with it what else is new.
    pub(super) fn publish(
        &mut self,
        wish_serial: u64,
        scale: u32,
        change: impl FnOnce(&mut Report),
    ) {
        let Some((_, wish)) = &self.wish else { return };
        let Some((size, rgba)) = self.developed.develop(&wish.display) else { return };
        let camera = wish.camera.clone();
        let is_whole = self.developed.is_whole();
        let has_compiled = std::mem::take(&mut self.has_compiled);
        let legend = self.developed.overlay.as_ref().map(|view| view.legend.clone());
        let (window, resolution) = (wish.settings.window(), wish.settings.resolution);
        self.link.tell(|report| {
            let serial = report.frame.as_ref().map_or(0, |f| f.serial) + 1;
            let rgba = Arc::new(rgba);
            let wish = wish_serial;
            let frame = Frame {
                size,
                rgba,
                serial,
                camera,
                wish,
                scale,
                window,
                resolution,
                is_whole,
                has_compiled,
            };
            report.frame = Some(frame);
            report.legend = legend;
            change(report);
        });
    }
}

fn progress(renderer: &Renderer, preview: &Preview) -> Progress {
    let (s, counts) = (&preview.statistics, &preview.sample_counts);
    let least = counts.iter().copied().min().unwrap_or(0);
    let most = counts.iter().copied().max().unwrap_or(0);
    Progress {
        spp: (least, most),
        seconds: s.render_seconds,
        samples: s.samples,
        rays: s.closest_rays + s.shadow_rays,
        converged: renderer.converged(),
        relmse: renderer.film().estimated_error().map(|e| e.relmse),
        faults: s.faults.iter().sum(),
    }
}
