//! Standard output and standard error. A reader that has gone away is not an
//! error worth a message, let alone a panic.

use super::log::{self, Fields, Level, level_of};
use std::io::{ErrorKind, Write};
use steradian::{Error, Result};

/// How much is said.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Verbosity {
    /// Errors and warnings.
    Quiet,
    /// Also progress, the result, and what of the scene is not rendered as it says.
    Normal,
    /// Also how it was done.
    Verbose,
}

/// One line to standard error.
pub(crate) fn line(text: &str) {
    log::emit(level_of(text), true, text, Fields::new());
}

/// Text, complete with line ends, to standard output.
pub(crate) fn data(text: &str) -> Result<()> {
    let mut output = std::io::stdout().lock();
    match output.write_all(text.as_bytes()).and_then(|()| output.flush()) {
        // `steradian info scene.glb | head` is no failure.
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::io("standard output", e)),
        _ => Ok(()),
    }
}

impl Verbosity {
    /// A line that `--quiet` leaves out.
    pub(crate) fn say(self, text: &str) {
        log::emit(level_of(text), self >= Self::Normal, text, Fields::new());
    }

    /// A line for `--verbose`.
    pub(crate) fn detail(self, text: &str) {
        log::emit(Level::Debug, self >= Self::Verbose, text, Fields::new());
    }
}

/// `value` with three significant digits and the prefix that suits it: 4120000 is "4.12 M".
pub(crate) fn with_prefix(value: f64) -> String {
    let prefixes = ["", " k", " M", " G", " T"];
    let mut scaled = value;
    let mut index = 0;
    // 999.5 and more would be written with four digits.
    while scaled >= 999.5 && index + 1 < prefixes.len() {
        scaled /= 1000.0;
        index += 1;
    }
    let decimals = match scaled {
        s if index == 0 && s.fract() == 0.0 => 0,
        s if s < 9.995 => 2,
        s if s < 99.95 => 1,
        _ => 0,
    };
    format!("{scaled:.decimals$}{}", prefixes[index])
}

/// A time for people: "0.02 s", "3.4 s", "2 min 5 s", "1 h 3 min".
pub(crate) fn duration(seconds: f64) -> String {
    let whole = seconds.max(0.0).round() as u64;
    match whole {
        0 => format!("{:.2} s", seconds.max(0.0)),
        1..10 => format!("{seconds:.1} s"),
        10..60 => format!("{whole} s"),
        60..3600 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
    }
}

/// A size for people: "640 B", "12.5 KiB", "128.0 MiB".
pub(crate) fn size(bytes: u64) -> String {
    match bytes {
        0..1024 => format!("{bytes} B"),
        1024..1_048_576 => format!("{:.1} KiB", bytes as f64 / 1024.0),
        _ => format!("{:.1} MiB", bytes as f64 / 1_048_576.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits_and_a_prefix() {
        let cases = [
            (0.0, "0"),
            (12.0, "12"),
            (1.234, "1.23"),
            (999.0, "999"),
            (999.6, "1.00 k"),
            (4_120_000.0, "4.12 M"),
            (99_960_000.0, "100 M"),
            (2.5e15, "2500 T"),
        ];
        for (value, text) in cases {
            assert_eq!(with_prefix(value), text);
        }
    }

    #[test]
    fn durations_change_units() {
        let cases = [
            (-1.0, "0.00 s"),
            (0.018, "0.02 s"),
            (3.44, "3.4 s"),
            (9.6, "10 s"),
            (125.0, "2 min 5 s"),
            (3780.0, "1 h 3 min"),
        ];
        for (seconds, text) in cases {
            assert_eq!(duration(seconds), text);
        }
    }

    #[test]
    fn sizes_change_units() {
        assert_eq!([size(640), size(12_800), size(1 << 27)], ["640 B", "12.5 KiB", "128.0 MiB"]);
    }
}
