//! Views in place of light: of what camera rays meet first, stripe by stripe, or of the film.

use super::Engine;
use super::stage::{in_motion, traced};
use crate::viewer::wish::Wish;
use std::time::Instant;
use steradian::gpu::GpuFirstHit;
use steradian::image::Layer;
use steradian::settings::Crop;
use steradian::shader::generated::TILE_SIDE;
use steradian::view::{Source, View, ViewPicture, of_film, of_first_hits};
use steradian::{RenderSettings, Result};

/// Rays of a pixel besides that through its centre.
pub(super) const RAYS: u32 = 4;
/// Camera rays are traced so many times as fast as paths, about.
const FASTER: f64 = 3.0;
/// Seconds that one stripe should take.
const STRIPE_SECONDS: f64 = 0.05;

/// First hits of a view, as far as they are.
pub(super) struct Glance {
    view: View,
    window: Crop,
    hits: Vec<GpuFirstHit>,
}

impl Glance {
    fn rows(&self) -> u32 {
        (self.hits.len() / self.window.width as usize) as u32
    }
}

/// The view of first hits that is wished for, if it is one of those.
pub(super) fn of_hits(wish: &Wish) -> Option<View> {
    wish.view.filter(|view| view.source() == Source::FirstHits)
}

impl Engine {
    /// The view that has to be traced yet.
    pub(super) fn unfinished_view(&self) -> Option<View> {
        let view = of_hits(&self.wish.as_ref()?.1)?;
        let stage = self.stage.as_ref()?;
        let is_done = |g: &Glance| g.view == view && g.rows() == stage.job.settings.window().height;
        (!self.glance.as_ref().is_some_and(is_done)).then_some(view)
    }

    /// Traces the next rows of a view.
    pub(super) fn trace_view(&mut self, view: View) -> Result<()> {
        let (Some(stage), Some((serial, _))) = (&self.stage, &self.wish) else { return Ok(()) };
        if Instant::now() < self.resume_at {
            return Ok(());
        }
        let window = stage.job.settings.window();
        let glance = self.glance.take().filter(|g| g.view == view && g.window == window);
        let mut glance = glance.unwrap_or(Glance { view, window, hits: Vec::new() });
        let done = glance.rows();
        let rays = f64::from(window.width) * f64::from(RAYS + 1);
        let wanted = self.samples_per_second * FASTER * STRIPE_SECONDS / rays;
        // Whole rows of tiles: rays that walk the tree together are the same as in one piece.
        let height = (wanted as u32 / TILE_SIDE).max(1) * TILE_SIDE;
        let height = height.min(window.height - done);
        let part = Crop { y: window.y + done, height, ..window };
        let settings = RenderSettings { crop: Some(part), ..stage.job.settings.clone() };
        glance.hits.extend(traced(stage, &settings, view, RAYS, &self.tuning)?);
        if glance.rows() == window.height {
            let size = (window.width, window.height);
            self.developed.overlay = of_first_hits(view, &glance.hits, size);
            self.developed.is_overlay_whole = true;
            let serial = *serial;
            self.glance = Some(glance);
            self.publish(serial, 1, |_| ());
            return Ok(());
        }
        self.glance = Some(glance);
        Ok(())
    }

    /// A small picture of a view, at once. Gives its scale.
    pub(super) fn sketch_view(&mut self, view: View) -> Result<u32> {
        self.glance = None;
        let Some(stage) = &self.stage else { return Ok(1) };
        let scale = self.coarseness(&stage.job.settings, FASTER);
        let settings = in_motion(&stage.job.settings, scale);
        let size = (settings.window().width, settings.window().height);
        let small = traced(stage, &settings, view, 1, &self.tuning)?;
        self.developed.overlay = of_first_hits(view, &small, size);
        self.developed.is_overlay_whole = false;
        Ok(scale)
    }

    /// The view of the film as it is now, if that is wished for.
    pub(super) fn look_at_film(&mut self) -> Result<()> {
        let (Some((_, wish)), Some(renderer)) = (&self.wish, &self.renderer) else { return Ok(()) };
        let Some(view) = wish.view.filter(|view| view.source() == Source::Film) else {
            return Ok(());
        };
        let (film, _) = renderer.snapshot()?;
        let nothing = || ViewPicture {
            picture: film.picture(),
            legend: "not known yet, or not with these settings".into(),
            layer: Layer { name: String::new(), channels: Vec::new() },
        };
        let shown = of_film(view, &film, wish.settings.spp);
        self.developed.overlay = Some(shown.unwrap_or_else(nothing));
        self.developed.is_overlay_whole = true;
        Ok(())
    }
}
