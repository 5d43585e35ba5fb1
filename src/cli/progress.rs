//! How far a render is: a bar on a terminal, a line now and then elsewhere, or what a farm reads.

use super::log::{self, Busy, Fields, Level};
use super::talk::{self, Verbosity};
use super::values::Word;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use std::io::IsTerminal;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};
use steradian::Result;

/// Steps of the bar.
const RESOLUTION: f64 = 1000.0;
/// Time between lines.
const INTERVAL: Duration = Duration::from_secs(5);
/// The same for Open Job Description, whose readers show the last one alone.
const OPENJD_INTERVAL: Duration = Duration::from_secs(1);

/// How progress is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ProgressKind {
    /// A bar for people at a terminal, lines for others.
    Auto,
    /// A bar; nothing where there is no terminal.
    Bar,
    /// Lines on standard error.
    Lines,
    /// Lines of Open Job Description on standard output.
    OpenJd,
    /// Nothing.
    None,
}

/// Words of `--progress`.
pub(crate) const PROGRESS_KINDS: &[Word<ProgressKind>] = &[
    ("auto", ProgressKind::Auto, "a bar on a terminal, lines elsewhere"),
    ("bar", ProgressKind::Bar, "a bar"),
    ("lines", ProgressKind::Lines, "a line every five seconds"),
    ("openjd", ProgressKind::OpenJd, "openjd_progress and openjd_status on standard output"),
    ("none", ProgressKind::None, "nothing"),
];

/// Which of the frames of a call.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct FramePlace {
    /// Its number; `None` where no frames were asked for.
    pub(crate) number: Option<u32>,
    /// Frames before it.
    pub(crate) index: usize,
    /// All frames.
    pub(crate) count: usize,
}

/// Calls `work`, of unknown length, with signs of life.
pub(super) fn while_busy<T>(
    verbosity: Verbosity,
    message: &'static str,
    work: impl FnOnce() -> T,
) -> T {
    if verbosity == Verbosity::Quiet || log::busy() == Busy::Nothing {
        return work();
    }
    if !std::io::stderr().is_terminal() || log::busy() == Busy::Lines {
        return with_lines(message, work);
    }
    let spinner = ProgressBar::new_spinner().with_message(message);
    spinner.enable_steady_tick(Duration::from_millis(100));
    let result = work();
    spinner.finish_and_clear();
    result
}

/// Calls `work`; says at intervals that it goes on.
fn with_lines<T>(message: &str, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let (working, end) = mpsc::channel::<()>();
    thread::scope(|scope| {
        scope.spawn(move || {
            // Nothing is ever sent: the channel closes when the work ends.
            while end.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
                let elapsed = talk::duration(start.elapsed().as_secs_f64());
                talk::line(&format!("{message}, {elapsed} elapsed"));
            }
        });
        let _working = working;
        work()
    })
}

/// Progress of one frame.
pub(super) struct Progress {
    start: Instant,
    place: FramePlace,
    form: Form,
}

enum Form {
    Bar(ProgressBar),
    Lines { last: Instant },
    OpenJd { last: Instant },
    Silent,
}

impl Progress {
    /// Begins at nothing done.
    pub(super) fn start(kind: ProgressKind, verbosity: Verbosity, place: FramePlace) -> Self {
        let start = Instant::now();
        let is_quiet = verbosity == Verbosity::Quiet;
        let has_bar = std::io::stderr().is_terminal() && log::busy() == Busy::Spinner;
        let form = match kind {
            ProgressKind::OpenJd => Form::OpenJd { last: start },
            ProgressKind::None => Form::Silent,
            _ if is_quiet => Form::Silent,
            ProgressKind::Auto if has_bar => Form::Bar(bar()),
            ProgressKind::Bar => Form::Bar(bar()),
            ProgressKind::Auto | ProgressKind::Lines => Form::Lines { last: start },
        };
        let progress = Self { start, place, form };
        if let Form::OpenJd { .. } = progress.form {
            let status = match place.number {
                Some(number) => format!("frame {number}, {} of {}", place.index + 1, place.count),
                None => "rendering".into(),
            };
            // Farms go on without it.
            let _ = talk::data(&format!("openjd_status: {status}\n{}", progress.openjd(0.0)));
        }
        progress
    }

    /// The share `done` of the work, 0 to 1, is done.
    pub(super) fn update(&mut self, done: f64) {
        let (text, fields) = match &self.form {
            Form::Lines { last } if last.elapsed() >= INTERVAL => {
                (status(done, self.start.elapsed().as_secs_f64()), self.fields(done))
            }
            Form::OpenJd { last } if last.elapsed() >= OPENJD_INTERVAL => {
                (self.openjd(done), Fields::new())
            }
            Form::Bar(bar) => return bar.set_position((done * RESOLUTION) as u64),
            _ => return,
        };
        match &mut self.form {
            Form::Lines { last } => {
                *last = Instant::now();
                log::emit(Level::Info, true, &text, fields);
            }
            Form::OpenJd { last } => {
                *last = Instant::now();
                let _ = talk::data(&text);
            }
            Form::Bar(_) | Form::Silent => {}
        }
    }

    /// Does what may write lines.
    pub(super) fn break_for(self, work: impl FnOnce() -> Result<()>) -> Result<Self> {
        match &self.form {
            Form::Bar(bar) => bar.suspend(work)?,
            Form::Lines { .. } | Form::OpenJd { .. } | Form::Silent => work()?,
        }
        Ok(self)
    }

    /// Removes the bar: lines can be written again.
    pub(super) fn end(self) {
        match &self.form {
            Form::Bar(bar) => bar.finish_and_clear(),
            Form::OpenJd { .. } => drop(talk::data(&self.openjd(1.0))),
            Form::Lines { .. } | Form::Silent => {}
        }
    }

    /// Of all frames, 0 to 1.
    fn done_of_all(&self, done: f64) -> f64 {
        (self.place.index as f64 + done) / self.place.count.max(1) as f64
    }

    fn openjd(&self, done: f64) -> String {
        format!("openjd_progress: {:.2}\n", 100.0 * self.done_of_all(done))
    }

    /// Members of a line of progress.
    fn fields(&self, done: f64) -> Fields {
        let elapsed = self.start.elapsed().as_secs_f64();
        let left = (done > 0.0).then(|| elapsed * (1.0 - done) / done);
        let FramePlace { number, index, count } = self.place;
        let fields = [
            ("event", json!("progress")),
            ("frame", json!(number)),
            ("frame_place", json!(index + 1)),
            ("frame_count", json!(count)),
            ("done", json!(done)),
            ("done_of_all", json!(self.done_of_all(done))),
            ("seconds_elapsed", json!(elapsed)),
            ("seconds_left", json!(left)),
        ];
        fields.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::new(RESOLUTION as u64);
    let template = "{bar:40} {percent:>3} %  {elapsed} elapsed, {eta} left";
    // The template is ours: were it wrong, the default one would do.
    bar.set_style(
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()),
    );
    bar
}

fn status(done: f64, elapsed: f64) -> String {
    let left = match done {
        0.0 => "unknown".to_owned(),
        _ => talk::duration(elapsed * (1.0 - done) / done),
    };
    format!("{:.0} %, {} elapsed, {left} left", done * 100.0, talk::duration(elapsed))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_estimates_the_time_left() {
        assert_eq!(status(0.25, 30.0), "25 %, 30 s elapsed, 1 min 30 s left");
        assert_eq!(status(0.0, 5.0), "0 %, 5.0 s elapsed, unknown left");
        assert_eq!(status(1.0, 5.0), "100 %, 5.0 s elapsed, 0.00 s left");
    }

    #[test]
    fn progress_is_of_this_frame_and_of_all() {
        let place = FramePlace { number: Some(30), index: 2, count: 4 };
        let progress = Progress::start(ProgressKind::None, Verbosity::Normal, place);
        assert_eq!(progress.openjd(0.5), "openjd_progress: 62.50\n");
        let fields = progress.fields(0.5);
        assert_eq!(fields["done"], 0.5);
        assert_eq!(fields["done_of_all"], 0.625);
        assert_eq!([&fields["frame"], &fields["frame_place"], &fields["frame_count"]], [30, 3, 4]);
        let elapsed = fields["seconds_elapsed"].as_f64().unwrap();
        assert_eq!(fields["seconds_left"].as_f64().unwrap(), elapsed);
        assert!(progress.fields(0.0)["seconds_left"].is_null());
    }
}
