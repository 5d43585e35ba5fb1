//! What is asked about the scene itself: the surface at a pixel, the tree.

use super::Engine;
use crate::viewer::wish::Picked;
use std::sync::Arc;
use steradian::Result;
use steradian::gpu::World;

impl Engine {
    /// Finds what the ray through the middle of a pixel meets.
    pub(super) fn pick(&mut self, _pixel: (u32, u32)) -> Result<()> {
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
