//! A scene on the device, with camera, settings and light as a wish has them.

use crate::cli::flags::EnvironmentFlags;
use crate::cli::job::{Job, set_environment};
use crate::viewer::wish::Wish;
use std::sync::Arc;
use steradian::gpu::GpuFirstHit;
use steradian::passes::{Extras, Tuning};
use steradian::renderer::PreparedScene;
use steradian::scene::{Camera, Environment};
use steradian::settings::Crop;
use steradian::view::View;
use steradian::{RenderSettings, Renderer, Result};

/// A scene on the device.
pub(super) struct Stage {
    pub(super) job: Job,
    pub(super) prepared: Arc<PreparedScene>,
    /// The scene's own, without the flags.
    pub(super) environment: Option<Environment>,
    /// The flags that it has now.
    pub(super) applied: EnvironmentFlags,
    /// Cameras of the file.
    pub(super) camera_count: usize,
    pub(super) generation: u64,
}

impl Stage {
    /// Puts camera, settings and environment of a wish in place; if that fails, all stays as it was.
    pub(super) fn apply(&mut self, wish: &Wish) -> Result<()> {
        let cameras = &mut self.job.scene.cameras;
        cameras.truncate(self.camera_count);
        let is_of_file = cameras.get(wish.base) == Some(&wish.camera);
        let camera = if is_of_file { wish.base } else { cameras.len() };
        if !is_of_file {
            cameras.push(Camera { name: "view".into(), ..wish.camera.clone() });
        }
        let settings = RenderSettings { camera, ..wish.settings.clone() };
        settings.validate(&self.job.scene)?;
        if self.applied != wish.environment {
            let before = self.job.scene.environment.take();
            self.job.scene.environment = self.environment.clone();
            if let Err(error) = self.relight(&wish.environment) {
                self.job.scene.environment = before;
                return Err(error);
            }
        }
        self.job.requested_spp = Some(settings.spp);
        self.job.settings = settings;
        Ok(())
    }

    fn relight(&mut self, flags: &EnvironmentFlags) -> Result<()> {
        set_environment(&mut self.job.scene, flags)?;
        // A turn is in the uniforms, not in the tables.
        if self.applied.without_rotation() != flags.without_rotation() {
            self.prepared = Arc::new(self.prepared.relit(&self.job.scene)?);
        }
        self.applied = flags.clone();
        Ok(())
    }

    /// A render of the scene as it is.
    pub(super) fn renderer(&self, settings: &RenderSettings, tuning: &Tuning) -> Result<Renderer> {
        Renderer::of_prepared(self.prepared.clone(), &self.job.scene, settings, tuning)
    }
}

/// What `rays` and one camera rays of every pixel meet, row by row.
pub(super) fn traced(
    stage: &Stage,
    settings: &RenderSettings,
    view: View,
    rays: u32,
    tuning: &Tuning,
) -> Result<Vec<GpuFirstHit>> {
    let (prepared, scene) = (&stage.prepared, &stage.job.scene);
    let mut hits =
        prepared.first_hits(scene, settings, Extras::visits(view == View::NodeVisits), tuning)?;
    hits.run(prepared.device(), rays)?;
    Ok(hits.hits().to_vec())
}

/// One sample of each pixel of a picture whose sides are `scale` times smaller.
pub(super) fn in_motion(settings: &RenderSettings, scale: u32) -> RenderSettings {
    let less = |n: u32| n.div_ceil(scale);
    let resolution = (less(settings.resolution.0), less(settings.resolution.1));
    let crop = settings.crop.map(|c| {
        let (x, y) = (c.x / scale, c.y / scale);
        let (width, height) = (less(c.x + c.width) - x, less(c.y + c.height) - y);
        Crop { x, y, width, height }
    });
    RenderSettings { resolution, crop, spp: 1, time: None, ..settings.clone() }
}

#[cfg(test)]
mod tests {
    use super::super::COARSEST;
    use super::*;

    #[test]
    fn pictures_in_motion_are_within_the_whole() {
        let crop = Some(Crop { x: 7, y: 5, width: 90, height: 11 });
        for scale in 1..=COARSEST {
            for crop in [None, crop] {
                let whole = RenderSettings { resolution: (97, 16), crop, ..Default::default() };
                let small = in_motion(&whole, scale);
                let (c, (width, height)) = (small.window(), small.resolution);
                assert!(c.width > 0 && c.height > 0, "{scale}");
                assert!(c.x + c.width <= width && c.y + c.height <= height, "{scale}: {c:?}");
            }
        }
    }
}
