//! What an error does to the engine: a lost device is opened again, anything else is told.

use super::Engine;
use crate::viewer::wish::Phase;
use std::sync::Arc;
use std::time::{Duration, Instant};
use steradian::renderer::PreparedScene;
use steradian::{Error, Result};

/// A device that is lost twice within this time would be lost again.
const PATIENCE: Duration = Duration::from_secs(10);

/// When devices were lost.
#[derive(Default)]
pub(super) struct Losses {
    last: Option<Instant>,
}

impl Losses {
    /// Notes a loss; whether to try again.
    fn may_try_again(&mut self, now: Instant) -> bool {
        let last = self.last.replace(now);
        last.is_none_or(|last| now.duration_since(last) > PATIENCE)
    }
}

impl Engine {
    /// After an error, a state in which the loop can go on.
    pub(super) fn recover(&mut self, error: &Error) {
        self.renderer = None;
        if !matches!(error, Error::DeviceLost(_)) {
            self.fail();
            self.say(error.to_string(), true);
            return;
        }
        if !self.losses.may_try_again(Instant::now()) {
            self.fail();
            self.say(format!("{error}; once more: R tries again"), true);
            return;
        }
        match self.rebuild() {
            Ok(()) => self.say(format!("{error}; opened again, samples begin anew"), true),
            Err(e) => {
                self.fail();
                self.say(format!("{error}; opening it again: {e}"), true);
            }
        }
    }

    /// Opens the device and puts the scene on it.
    fn rebuild(&mut self) -> Result<()> {
        self.device = None;
        self.open_device()?;
        if let (Some(stage), Some(device)) = (&mut self.stage, &self.device) {
            let scene = &stage.job.scene;
            let settings = &stage.job.settings;
            stage.prepared = Arc::new(PreparedScene::new(device.clone(), scene, settings)?);
        }
        self.resume_at = Instant::now();
        self.link.tell(|report| report.phase = Phase::Rendering);
        Ok(())
    }

    /// Nothing goes on before Restart.
    fn fail(&mut self) {
        self.device = None;
        self.stage = None;
        self.link.tell(|report| {
            report.phase = Phase::Failed;
            report.busy = None;
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_loss_soon_after_is_the_last() {
        let (mut losses, start) = (Losses::default(), Instant::now());
        assert!(losses.may_try_again(start));
        assert!(!losses.may_try_again(start + PATIENCE / 2));
        assert!(losses.may_try_again(start + PATIENCE * 2));
    }
}
