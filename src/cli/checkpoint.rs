//! Checkpoints: a render that is stopped, or killed, goes on from its last one and ends with the bits
//! that it would have had.

use super::identity::Identity;
use super::job::Job;
use super::render::Call;
use super::shard::Shard;
use super::talk::{self, Verbosity};
use super::values;
use clap::Args;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::{Duration, Instant};
use steradian::film::{FilmFile, Sections, write_film_file};
use steradian::gpu::DeviceInfo;
use steradian::renderer::RenderHead;
use steradian::{Error, Renderer, Result};

/// Flags of long renders and of those in parts.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Long renders and farms")]
pub(crate) struct FarmFlags {
    /// Keep what is done in this file, so that --resume can go on from it
    #[arg(long, value_name = "FILE", conflicts_with_all = ["reference", "view", "pixel"])]
    pub(crate) checkpoint: Option<PathBuf>,

    /// Time between checkpoints
    #[arg(long, value_name = "TIME", requires = "checkpoint", default_value = "60s", value_parser = values::duration)]
    checkpoint_every: Duration,

    /// Go on from the checkpoint; without one, begin
    #[arg(long, requires = "checkpoint")]
    resume: bool,

    /// Only part I of N, from 0, into a .film that `steradian merge` joins with the others
    #[arg(long, value_name = "I/N", value_parser = super::shard::parse, conflicts_with_all = ["reference", "view", "pixel"])]
    pub(crate) shard: Option<Shard>,

    /// Go on from what another device or driver did, whose bits may differ
    #[arg(long, requires = "checkpoint")]
    allow_mixed_devices: bool,
}

/// The head of a checkpoint.
#[derive(Serialize, Deserialize)]
struct CheckpointHead {
    checkpoint: Identity,
    shard: Option<Shard>,
    render: RenderHead,
}

/// Writes checkpoints when they are due.
pub(crate) struct Checkpoint {
    path: PathBuf,
    interval: Duration,
    last: Instant,
    identity: Identity,
    shard: Option<Shard>,
    verbosity: Verbosity,
    is_on_disk: bool,
}

impl Checkpoint {
    /// Where the flags ask for checkpoints: goes on from the one there is, if they ask for that too.
    pub(super) fn begin(
        call: &Call,
        job: &Job,
        device: &DeviceInfo,
        renderer: &mut Renderer,
    ) -> Result<Option<Self>> {
        let flags = &call.flags.farm;
        let Some(path) = call.destinations.checkpoint.clone() else { return Ok(None) };
        let mut checkpoint = Self {
            path,
            interval: flags.checkpoint_every,
            last: Instant::now(),
            identity: Identity::new(
                job,
                call.flags.job.picture.region(),
                (&device.name, &device.driver),
            ),
            shard: call.shard,
            verbosity: call.verbosity,
            is_on_disk: false,
        };
        let path = &checkpoint.path;
        if !path.exists() {
            if flags.resume {
                call.verbosity.say(&format!("no checkpoint {} yet: beginning", path.display()));
            }
            return Ok(Some(checkpoint));
        }
        if !flags.resume {
            return Err(Error::Settings(format!(
                "{}: there is a checkpoint already; go on from it with --resume, or remove it",
                path.display()
            )));
        }
        let done = checkpoint.resume(renderer, flags.allow_mixed_devices)?;
        checkpoint.is_on_disk = true;
        let path = checkpoint.path.display();
        call.verbosity.say(&format!("going on from {path}, {:.1} % done", 100.0 * done));
        Ok(Some(checkpoint))
    }

    /// Goes on from the file; gives the share that is done.
    pub(super) fn resume(&self, renderer: &mut Renderer, allows_devices: bool) -> Result<f64> {
        let file = FilmFile::open(&self.path)?;
        let head: CheckpointHead = file.head()?;
        self.identity.check(&self.path, &head.checkpoint, allows_devices)?;
        if head.shard != self.shard {
            let message =
                "is of another part of the render; every part has a checkpoint of its own";
            return Err(Error::Settings(format!("{}: {message}", self.path.display())));
        }
        renderer.go_on(&head.render, &file)?;
        Ok(renderer.progress())
    }

    /// Whether there is a file to go on from.
    pub(super) fn is_on_disk(&self) -> bool {
        self.is_on_disk
    }

    /// Writes one if it is time. That it cannot be written ends nothing: it is said, and tried again.
    pub(super) fn keep_if_due(&mut self, renderer: &Renderer) -> Result<()> {
        if self.last.elapsed() >= self.interval {
            self.keep(renderer)?;
        }
        Ok(())
    }

    /// Writes one. `false`: it cannot be written, which was said.
    ///
    /// # Errors
    /// [`Error::DeviceLost`].
    pub(super) fn keep(&mut self, renderer: &Renderer) -> Result<bool> {
        let (head, sections) = renderer.stored()?;
        Ok(self.write(head, &sections))
    }

    /// Writes what there is.
    pub(super) fn write(&mut self, render: RenderHead, sections: &Sections) -> bool {
        let head = CheckpointHead { checkpoint: self.identity.clone(), shard: self.shard, render };
        let begin = Instant::now();
        let written = write_film_file(&self.path, &head, sections);
        self.last = Instant::now();
        let path = self.path.display();
        match written {
            Ok(()) => {
                self.is_on_disk = true;
                let seconds = talk::duration(begin.elapsed().as_secs_f64());
                self.verbosity.detail(&format!("checkpoint {path}, written in {seconds}"));
                true
            }
            Err(e) => {
                let rest = match self.is_on_disk {
                    true => "; the one of before is still there",
                    false => "",
                };
                talk::line(&format!("warning: no checkpoint: {e}{rest}"));
                false
            }
        }
    }

    /// The render is done and written: nothing is left to go on with.
    pub(super) fn remove(self) {
        // Without it there is nothing to remove, and what cannot be removed does no harm.
        let _ = std::fs::remove_file(self.path);
    }
}
