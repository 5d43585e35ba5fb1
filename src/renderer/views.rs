//! Camera rays over a scene that is on a device, without a render.

use super::PreparedScene;
#[cfg(doc)]
use crate::Error;
use crate::Result;
use crate::passes::{FirstHits, Tuning};
use crate::scene::Scene;
use crate::settings::RenderSettings;

impl PreparedScene {
    /// Compiles what traces camera rays; with counts of the walk's cost if `counts_visits`.
    /// `scene` is the one that this was prepared from, but for its cameras.
    ///
    /// # Errors
    /// [`Error::Settings`], [`Error::Limit`], [`Error::DeviceLost`], [`Error::Shader`].
    pub fn first_hits(
        &self,
        scene: &Scene,
        settings: &RenderSettings,
        counts_visits: bool,
        tuning: &Tuning,
    ) -> Result<FirstHits> {
        settings.validate(scene)?;
        let settings = &RenderSettings { path_reuse: false, ..settings.clone() };
        let features = self.features(scene, settings);
        let frame = self.buffers.facts().frame(scene, settings);
        let (device, buffers, stack_size) = (&self.device, &self.buffers, self.stack_size);
        FirstHits::new(device, buffers, features, counts_visits, stack_size, frame, tuning)
    }
}
