//! How far a render is: a bar on a terminal, a line now and then elsewhere.

use super::talk::{self, Verbosity};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};
use steradian::Result;

/// Steps of the bar.
const RESOLUTION: f64 = 1000.0;
/// Time between lines.
const INTERVAL: Duration = Duration::from_secs(5);

/// Calls `work`, of unknown length, with signs of life.
pub(super) fn while_busy<T>(
    verbosity: Verbosity,
    message: &'static str,
    work: impl FnOnce() -> T,
) -> T {
    if verbosity == Verbosity::Quiet {
        return work();
    }
    if !std::io::stderr().is_terminal() {
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

/// Progress on standard error.
pub(super) struct Progress {
    start: Instant,
    form: Form,
}

enum Form {
    Bar(ProgressBar),
    Lines { last: Instant },
    Silent,
}

impl Progress {
    /// Begins at nothing done.
    pub(super) fn start(verbosity: Verbosity) -> Self {
        let start = Instant::now();
        let form = if verbosity == Verbosity::Quiet {
            Form::Silent
        } else if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(RESOLUTION as u64);
            let template = "{bar:40} {percent:>3} %  {elapsed} elapsed, {eta} left";
            // The template is ours: were it wrong, the default one would do.
            bar.set_style(
                ProgressStyle::with_template(template)
                    .unwrap_or_else(|_| ProgressStyle::default_bar()),
            );
            Form::Bar(bar)
        } else {
            Form::Lines { last: start }
        };
        Self { start, form }
    }

    /// The share `done` of the work, 0 to 1, is done.
    pub(super) fn update(&mut self, done: f64) {
        match &mut self.form {
            Form::Bar(bar) => bar.set_position((done * RESOLUTION) as u64),
            Form::Lines { last } if last.elapsed() >= INTERVAL => {
                *last = Instant::now();
                talk::line(&status(done, self.start.elapsed().as_secs_f64()));
            }
            Form::Lines { .. } | Form::Silent => {}
        }
    }

    /// Does what may write lines.
    pub(super) fn break_for(self, work: impl FnOnce() -> Result<()>) -> Result<Self> {
        match &self.form {
            Form::Bar(bar) => bar.suspend(work)?,
            Form::Lines { .. } | Form::Silent => work()?,
        }
        Ok(self)
    }

    /// Removes the bar: lines can be written again.
    pub(super) fn end(self) {
        if let Form::Bar(bar) = self.form {
            bar.finish_and_clear();
        }
    }
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
}
