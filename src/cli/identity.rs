//! What a stored film is of: two that differ in it do not belong together.

use super::job::Job;
use serde::{Deserialize, Serialize};
use std::path::Path;
use steradian::settings::{Crop, RenderSettings};
use steradian::{Error, Result};

/// Scene, settings and maker of a film.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Identity {
    version: String,
    scene: String,
    scene_hash: String,
    pub(crate) settings_hash: String,
    pub(crate) device: String,
    pub(crate) driver: String,
}

impl Identity {
    /// Of a render; `crop` is that of the whole of which it may be a part.
    pub(crate) fn new(job: &Job, crop: Option<Crop>, (device, driver): (&str, &str)) -> Self {
        let settings = RenderSettings { crop, part: None, ..job.settings.clone() };
        let hash = |value: u64| format!("{value:016x}");
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            scene: job.scene.name.clone(),
            scene_hash: hash(job.scene.content_hash(settings.camera)),
            settings_hash: hash(settings.content_hash()),
            device: device.into(),
            driver: driver.into(),
        }
    }

    /// Refuses the stored film at `path`, of identity `other`, where it is of something else.
    ///
    /// # Errors
    /// [`Error::Settings`] saying what differs.
    pub(crate) fn check(&self, path: &Path, other: &Self, allows_devices: bool) -> Result<()> {
        let differs = |what: &str, mine: &str, its: &str, remedy: &str| {
            let path = path.display();
            Err(Error::Settings(format!("{path}: is of {what} {its}, not {mine}; {remedy}")))
        };
        let anew = "give the file that belongs to it, or make it anew";
        let device = |of: &Self| format!("{} ({})", of.device, of.driver);
        if self.version != other.version {
            return differs("version", &self.version, &other.version, anew);
        }
        if self.scene_hash != other.scene_hash {
            let scene = |of: &Self| format!("{:?} with contents {}", of.scene, of.scene_hash);
            return differs("scene", &scene(self), &scene(other), anew);
        }
        if self.settings_hash != other.settings_hash {
            return differs("settings", &self.settings_hash, &other.settings_hash, anew);
        }
        if !allows_devices && device(self) != device(other) {
            let remedy =
                "the bits of two devices differ: --allow-mixed-devices takes it all the same";
            return differs("device", &device(self), &device(other), remedy);
        }
        Ok(())
    }
}
