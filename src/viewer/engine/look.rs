//! What is asked about the scene itself: the surface at a pixel, the tree.

use super::Engine;
use super::stage::traced;
use crate::viewer::navigate;
use crate::viewer::wish::Picked;
use std::sync::Arc;
use steradian::gpu::World;
use steradian::settings::Crop;
use steradian::view::View;
use steradian::{RenderSettings, Result};

impl Engine {
    /// Finds what the ray through a pixel of the whole picture meets.
    pub(super) fn pick(&mut self, (x, y): (u32, u32)) -> Result<()> {
        let Some(stage) = &self.stage else { return Ok(()) };
        let settings = &stage.job.settings;
        let crop = Some(Crop { x, y, width: 1, height: 1 });
        let settings = RenderSettings { crop, ..settings.clone() };
        let hits = traced(stage, &settings, View::Depth, 1, &self.tuning)?;
        let Some(hit) = hits.first().filter(|hit| hit.hit_count > 0) else {
            self.say("nothing there".into(), false);
            return Ok(());
        };
        let distance = hit.depth / hit.hit_count as f32;
        let (width, height) = settings.resolution;
        let at = |pixel: u32, side: u32| (pixel as f32 + 0.5) / side as f32 * 2.0 - 1.0;
        let camera = &stage.job.scene.cameras[settings.camera];
        let aspect_ratio = width as f32 / height as f32;
        let (origin, direction) =
            navigate::ray(camera, (at(x, width), -at(y, height)), aspect_ratio);
        let ray = (origin, origin + direction * distance);
        self.link.tell(|report| {
            let serial = report.picked.map_or(0, |p| p.serial) + 1;
            report.picked = Some(Picked { serial, ray });
        });
        Ok(())
    }

    /// Builds the tree anew, for the window: the device's own is in another form.
    pub(super) fn show_tree(&mut self) -> Result<()> {
        let Some(stage) = &self.stage else { return Ok(()) };
        if self.link.report().tree.is_some() {
            return Ok(());
        }
        let tree = World::top_tree(&stage.job.scene, stage.job.settings.accel);
        self.link.tell(|report| report.tree = Some(Arc::new(tree)));
        Ok(())
    }
}
