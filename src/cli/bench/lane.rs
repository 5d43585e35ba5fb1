//! What takes turns: our renderer with its settings, or another program.

use super::clock::Stopwatch;
use std::sync::Arc;
use steradian::image::Picture;
use steradian::passes::Tuning;
use steradian::renderer::{PreparedScene, RenderStatistics};
use steradian::scene::Scene;
use steradian::{RenderSettings, Renderer, Result};

/// One render.
pub(super) struct Taken {
    pub(super) picture: Picture,
    pub(super) wall: f64,
    pub(super) cpu: f64,
    /// Samples of a pixel in the mean.
    pub(super) samples: f64,
}

/// A method.
pub(super) trait Lane {
    /// Its name.
    fn name(&self) -> &str;

    /// Points of its curve; those after them are left out.
    fn points(&self) -> usize;

    /// Renders point `point` of its curve with a seed.
    fn take(&mut self, point: usize, seed: u32) -> Result<Taken>;

    /// What a render at the last point counted; `None` where that is not known.
    fn counts(&self) -> Option<&RenderStatistics>;
}

/// Our renderer.
pub(super) struct Ours {
    name: String,
    pixels: f64,
    renderers: Vec<Renderer>,
}

impl Ours {
    /// With settings for each point; compiles.
    pub(super) fn new(
        name: &str,
        prepared: &Arc<PreparedScene>,
        scene: &Scene,
        points: &[RenderSettings],
    ) -> Result<Self> {
        let tuning = Tuning::default();
        let renderer = |settings| Renderer::of_prepared(prepared.clone(), scene, settings, &tuning);
        let window = points[0].window();
        Ok(Self {
            name: name.into(),
            pixels: f64::from(window.width) * f64::from(window.height),
            renderers: points.iter().map(renderer).collect::<Result<_>>()?,
        })
    }

    /// Seconds that the first compilation took.
    pub(super) fn compile_seconds(&self) -> f64 {
        self.renderers[0].statistics().compile_seconds
    }

    /// relMSE of the last render at the last point, by the spread of its own samples.
    pub(super) fn estimated_error(&self) -> Option<f64> {
        self.renderers.last()?.film().estimated_error().map(|error| error.relmse)
    }
}

impl Lane for Ours {
    fn name(&self) -> &str {
        &self.name
    }

    fn points(&self) -> usize {
        self.renderers.len()
    }

    fn take(&mut self, point: usize, seed: u32) -> Result<Taken> {
        let renderer = &mut self.renderers[point];
        let watch = Stopwatch::start();
        renderer.restart(seed)?;
        while renderer.step()? {}
        renderer.finish()?;
        let picture = renderer.film().picture();
        let (wall, cpu) = watch.read();
        let samples = renderer.statistics().samples as f64 / self.pixels;
        Ok(Taken { picture, wall, cpu, samples })
    }

    fn counts(&self) -> Option<&RenderStatistics> {
        self.renderers.last().map(Renderer::statistics)
    }
}
