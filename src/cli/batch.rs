//! The frames of one call, one after the other.

use super::destination::Destinations;
use super::flags::RenderFlags;
use super::frames::Frame;
use super::job::Job;
use super::names::{Names, needs_camera};
use super::progress::{FramePlace, while_busy};
use super::render::{Call, run_frame};
use super::session::Session;
use super::shard::Shard;
use super::{existing, film_output, shard, talk};
use std::collections::HashMap;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;
use steradian::{Error, Result};

/// Renders all frames, each of them or only a part. The first that fails, or that a signal stops, is
/// the last.
pub(super) fn run(flags: &RenderFlags, frames: &[Frame], shard: Option<Shard>) -> Result<ExitCode> {
    let begin = Instant::now();
    let batch = Batch { flags, frames };
    let templates = [&flags.output, &flags.stats, &flags.sample_map, &flags.farm.checkpoint];
    let mut is_checked = !templates.into_iter().flatten().any(|path| needs_camera(path));
    if is_checked {
        batch.check_names(None)?;
    }
    use_threads(flags.threads)?;
    let verbosity = flags.verbosity();
    let mut session = Session::new(flags.device.as_deref(), frames.len() > 1);
    if flags.farm.checkpoint.is_some() {
        session.try_again_if_stopped()?;
    }
    let mut skipped = 0;
    for (index, frame) in frames.iter().enumerate() {
        if let Some(code) = batch.stopped(&session, index) {
            return Ok(code);
        }
        if let (Some(number), true) = (frame.number, frames.len() > 1) {
            verbosity.say(&format!("frame {number}, {} of {}", index + 1, frames.len()));
        }
        let start = Instant::now();
        let mut job = while_busy(verbosity, "reading the scene", || batch.job(frame))?;
        let camera = camera_name(&job);
        if !is_checked {
            batch.check_names(Some(&camera))?;
            is_checked = true;
        }
        let destinations = Destinations::check(flags, &batch.names(frame, Some(&camera)))?;
        if let Some(shard) = shard {
            shard::apply(&mut job, shard)?;
        }
        film_output::check(flags, shard, &destinations, &job)?;
        let place = FramePlace { number: frame.number, index, count: frames.len() };
        let (session, time) = (&session, frame.time);
        let call = Call { start, session, flags, time, shard, destinations, verbosity, place };
        if flags.frames.skip_existing && existing::is_valid(&call, &job) {
            skipped += 1;
            for path in call.destinations.paths().take(1) {
                verbosity.say(&format!("{}: there already", path.display()));
            }
            continue;
        }
        if let Some(code) = batch.stopped(session, index) {
            return Ok(code);
        }
        let code = run_frame(&call, &job)?;
        if code != ExitCode::SUCCESS {
            batch.stopped(session, index + 1);
            return Ok(code);
        }
    }
    if frames.len() > 1 {
        let duration = talk::duration(begin.elapsed().as_secs_f64());
        let rendered = frames.len() - skipped;
        verbosity.say(&format!("{rendered} frames rendered, {skipped} skipped, {duration}"));
    }
    Ok(ExitCode::SUCCESS)
}

struct Batch<'a> {
    flags: &'a RenderFlags,
    frames: &'a [Frame],
}

impl Batch<'_> {
    /// What a frame renders.
    fn job(&self, frame: &Frame) -> Result<Job> {
        let mut flags = self.flags.job.clone();
        flags.scene.frame_time = frame.time;
        if let (Some(number), true) = (frame.number, self.flags.frames.animate_seed) {
            flags.sampling.seed = flags.sampling.seed.wrapping_add(number);
        }
        Job::new(&self.flags.scene, &flags)
    }

    fn names<'a>(&'a self, frame: &Frame, camera: Option<&'a str>) -> Names<'a> {
        Names {
            // As the loader names it.
            scene: self.flags.scene.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default(),
            camera,
            frame: frame.number,
            has_others: self.flags.frames.frames.as_ref().is_some_and(|list| list.0.len() > 1),
        }
    }

    /// That every file can be made, and no two have the same name.
    fn check_names(&self, camera: Option<&str>) -> Result<()> {
        let mut known: HashMap<PathBuf, Option<u32>> = HashMap::new();
        for frame in self.frames {
            let destinations = Destinations::check(self.flags, &self.names(frame, camera))?;
            for path in destinations.paths() {
                let before = known.insert(path.to_owned(), frame.number);
                if let (Some(Some(before)), Some(number)) = (before, frame.number) {
                    return Err(Error::Settings(format!(
                        "{}: frames {before} and {number} would both be written there; \
                         give each name a place for the frame, such as ####",
                        path.display()
                    )));
                }
            }
        }
        Ok(())
    }

    /// The exit code if a signal came before frame `index`; says what is not begun.
    fn stopped(&self, session: &Session, index: usize) -> Option<ExitCode> {
        let code = session.stop_code()?;
        let left = self.frames.len() - index;
        if left > 0 {
            self.flags.verbosity().say(&format!("stopped: {left} frames not begun"));
        }
        Some(ExitCode::from(code))
    }
}

fn camera_name(job: &Job) -> String {
    let index = job.settings.camera;
    match job.scene.cameras[index].name.as_str() {
        "" => index.to_string(),
        name => name.to_owned(),
    }
}

/// Sets the size of the pool that the library's parallel loops run on.
fn use_threads(count: Option<u16>) -> Result<()> {
    let Some(count) = count else { return Ok(()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count.into());
    pool.build_global().map_err(|e| Error::Settings(format!("--threads {count}: {e}")))
}
