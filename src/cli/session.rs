//! What frames of one call share.

use super::device_render::TRY_AGAIN;
use super::drill;
use super::job::Job;
use super::signals::{EarlyStop, StopRequest};
use std::cell::{OnceCell, RefCell};
use std::sync::Arc;
use steradian::bvh::KeptTrees;
use steradian::gpu::Device;
use steradian::passes::Tuning;
use steradian::renderer::PreparedScene;
use steradian::{Renderer, Result};

/// Device with its compiled kernels, trees, and the wish to stop.
pub(super) struct Session<'a> {
    /// Name or index of the device.
    device_selector: Option<&'a str>,
    device: RefCell<Option<Arc<Device>>>,
    stop: OnceCell<StopRequest>,
    /// Whether SIGTERM before the first render asks to be tried again.
    early_stop: Option<EarlyStop>,
    /// Of the frame before; `None` where there is one frame.
    trees: Option<KeptTrees>,
}

impl<'a> Session<'a> {
    /// For one frame or more.
    pub(super) fn new(device_selector: Option<&'a str>, has_frames: bool) -> Self {
        Self {
            device_selector,
            device: RefCell::default(),
            stop: OnceCell::new(),
            early_stop: None,
            trees: has_frames.then(KeptTrees::default),
        }
    }

    /// SIGTERM before the first render begins, which has lost nothing, ends the program with the code of
    /// those that are to be tried again.
    pub(super) fn try_again_if_stopped(&mut self) -> Result<()> {
        self.early_stop = Some(EarlyStop::listen(TRY_AGAIN)?);
        Ok(())
    }

    /// The device, opened when it is first asked for.
    pub(super) fn device(&self) -> Result<Arc<Device>> {
        if let Some(device) = &*self.device.borrow() {
            return Ok(device.clone());
        }
        let device = Arc::new(Device::open_within(self.device_selector, drill::device_memory()?)?);
        self.device.replace(Some(device.clone()));
        Ok(device)
    }

    /// It was lost: the next call of [`Self::device`] opens it again.
    pub(super) fn forget_device(&self) {
        self.device.take();
    }

    /// A renderer of the job on that device.
    pub(super) fn renderer(&self, job: &Job) -> Result<Renderer> {
        let (scene, settings) = (&job.scene, &job.settings);
        let trees = self.trees.as_ref();
        let prepared = PreparedScene::with_trees(self.device()?, scene, settings, trees)?;
        Renderer::of_prepared(Arc::new(prepared), scene, settings, &Tuning::default())
    }

    /// Tells how long the frame was traced.
    pub(super) fn traced_for(&self, seconds: f64) {
        if let Some(trees) = &self.trees {
            trees.traced_for(seconds);
        }
    }

    /// The wish to stop; signals are listened to from the first call on.
    pub(super) fn stop(&self) -> Result<&StopRequest> {
        if let Some(stop) = self.stop.get() {
            return Ok(stop);
        }
        let stop = StopRequest::listen()?;
        if let Some(early) = &self.early_stop {
            early.end();
        }
        Ok(self.stop.get_or_init(|| stop))
    }

    /// The exit code of the signal that came, if any.
    pub(super) fn stop_code(&self) -> Option<u8> {
        self.stop.get()?.exit_code()
    }
}
