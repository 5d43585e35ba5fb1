//! Camera rays over a scene that is on a device, without a render.

use super::{PreparedScene, Renderer};
#[cfg(doc)]
use crate::Error;
use crate::Result;
use crate::passes::{Extras, FirstHits, Tuning};
use crate::scene::Scene;
use crate::settings::RenderSettings;

impl PreparedScene {
    /// Compiles what traces camera rays. `scene` is the one that this was prepared from, but for its cameras.
    ///
    /// # Errors
    /// [`Error::Settings`], [`Error::Limit`], [`Error::DeviceLost`], [`Error::Shader`].
    pub fn first_hits(
        &self,
        scene: &Scene,
        settings: &RenderSettings,
        extras: Extras,
        tuning: &Tuning,
    ) -> Result<FirstHits> {
        settings.validate(scene)?;
        let settings = &RenderSettings { path_reuse: false, ..settings.clone() };
        let features = self.features(scene, settings);
        let frame = self.buffers.facts().frame(scene, settings);
        let (device, buffers, stack_size) = (&self.device, &self.buffers, self.stack_size);
        FirstHits::new(device, buffers, features, extras, stack_size, frame, tuning)
    }
}

impl Renderer {
    /// The scene on the device.
    pub fn prepared(&self) -> &PreparedScene {
        &self.prepared
    }
}
