//! A render on a device that may be lost, with its checkpoints.

use super::checkpoint::Checkpoint;
use super::drill::Drill;
use super::job::Job;
use super::picture_layers::PictureLayers;
use super::progress::while_busy;
use super::render::Call;
use super::report::{self, Outcome};
use super::{memory, talk};
use std::process::ExitCode;
use std::sync::Arc;
use steradian::gpu::Device;
use steradian::{Error, Renderer, Result};

/// Stopped, with a checkpoint that the same command with `--resume` goes on from (sysexits.h:
/// EX_TEMPFAIL).
pub(super) const TRY_AGAIN: u8 = 75;
/// 128 and the number of SIGTERM, by which schedulers end what they will start again.
const TERMINATED: u8 = 143;

/// Device and renderer of one call.
pub(super) struct DeviceRender<'a> {
    call: &'a Call<'a>,
    job: &'a Job,
    pub(super) device: Arc<Device>,
    pub(super) renderer: Renderer,
    layers: PictureLayers,
    drill: Drill,
    has_lost_device: bool,
}

fn build(call: &Call, job: &Job) -> Result<(Arc<Device>, Renderer, PictureLayers)> {
    let device = call.session.device()?;
    let info = device.info();
    report::job(call.verbosity, job, &format!("{} {} ({})", info.index, info.name, info.driver));
    let renderer = while_busy(call.verbosity, "building trees, compiling shaders", || {
        call.session.renderer(job)
    })?;
    let layers = PictureLayers::new(call, job, renderer.prepared())?;
    Ok((device, renderer, layers))
}

impl<'a> DeviceRender<'a> {
    /// Opens the device and builds.
    pub(super) fn open(call: &'a Call<'a>, job: &'a Job) -> Result<Self> {
        let drill = Drill::from_environment()?;
        memory::check(job, call.flags.layers.denoise.is_some())?;
        let (device, renderer, layers) = build(call, job)?;
        Ok(Self { call, job, device, renderer, layers, drill, has_lost_device: false })
    }

    /// One step of the render. A device that is lost is opened again, once.
    pub(super) fn step(&mut self, checkpoint: &mut Option<Checkpoint>) -> Result<bool> {
        self.drill.step(&self.device);
        match self.renderer.step() {
            Err(Error::DeviceLost(message)) => self.recover(message, checkpoint).map(|()| true),
            result => result,
        }
    }

    fn recover(&mut self, message: String, checkpoint: &mut Option<Checkpoint>) -> Result<()> {
        if self.has_lost_device {
            return self.give_up(message, checkpoint);
        }
        self.has_lost_device = true;
        self.call.session.forget_device();
        talk::line(&format!("warning: {message}; opening the device again"));
        let (device, renderer, layers) = build(self.call, self.job)?;
        let lost = std::mem::replace(&mut self.renderer, renderer);
        (self.device, self.layers) = (device, layers);
        let is_taken_over = self.renderer.take_over(lost)?;
        match checkpoint {
            Some(checkpoint) if !is_taken_over && checkpoint.is_on_disk() => {
                checkpoint.resume(&mut self.renderer, true).map(|_| ())
            }
            _ => Ok(()),
        }
    }

    fn give_up(&mut self, message: String, checkpoint: &mut Option<Checkpoint>) -> Result<()> {
        let lost_twice = format!("{message}, for the second time");
        let Some(checkpoint) = checkpoint else { return Err(Error::DeviceLost(lost_twice)) };
        if let Some((head, sections)) = self.renderer.stored_without_device() {
            checkpoint.write(head, &sections);
        }
        let rest =
            if checkpoint.is_on_disk() { "; --resume goes on from the checkpoint" } else { "" };
        Err(Error::DeviceLost(format!("{lost_twice}{rest}")))
    }

    /// Writes what there is as it would be if the render ended here.
    pub(super) fn write_snapshot(&self) -> Result<()> {
        let (film, statistics) = self.renderer.snapshot()?;
        let outcome = Outcome {
            film: &film,
            statistics: &statistics,
            is_snapshot: true,
            ..self.outcome(None)
        };
        match self.call.write(&outcome) {
            Ok(()) => self.call.verbosity.say("snapshot written"),
            Err(e) => talk::line(&format!("warning: no snapshot: {e}")),
        }
        Ok(())
    }

    fn outcome(&self, stop_code: Option<u8>) -> Outcome<'_> {
        let info = self.device.info();
        Outcome {
            job: self.job,
            device: &info.name,
            driver: &info.driver,
            film: self.renderer.film(),
            statistics: self.renderer.statistics(),
            layers: Some(&self.layers),
            is_snapshot: false,
            stop_code,
        }
    }

    /// Ends the render: a checkpoint of what is not done, then the files.
    pub(super) fn conclude(
        mut self,
        mut checkpoint: Option<Checkpoint>,
        signal: Option<u8>,
    ) -> Result<ExitCode> {
        // A signal that comes with the last step changes nothing.
        let mut stop_code = signal.filter(|_| !self.renderer.is_done());
        if let Some(checkpoint) = &mut checkpoint
            && stop_code.is_some()
            && checkpoint.keep(&self.renderer)?
            && stop_code == Some(TERMINATED)
        {
            stop_code = Some(TRY_AGAIN);
        }
        self.renderer.finish()?;
        let concluded = self.call.conclude(&self.outcome(stop_code));
        if let (Err(_), None, Some(checkpoint)) = (&concluded, stop_code, &mut checkpoint) {
            checkpoint.keep(&self.renderer)?;
        }
        let code = concluded?;
        if stop_code.is_none()
            && let Some(checkpoint) = checkpoint
        {
            checkpoint.remove();
        }
        Ok(code)
    }
}
