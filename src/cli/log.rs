//! The log: what is said on standard error, for people or for programs, and the same in a file.

use super::values::Word;
use serde_json::{Map, Value, json};
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};
use steradian::{Error, Result};

/// Form of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LogFormat {
    /// Sentences.
    Text,
    /// One JSON object a line.
    Json,
}

/// Words of `--log-format`.
pub(crate) const LOG_FORMATS: &[Word<LogFormat>] = &[
    ("text", LogFormat::Text, "lines for people"),
    ("json", LogFormat::Json, "one JSON object a line: time, level, message, and more"),
];

/// How grave a line is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Level {
    /// For `--verbose`.
    Debug,
    /// Progress and results.
    Info,
    /// The picture may not be what was wanted.
    Warning,
    /// The end.
    Error,
}

/// Members of a line beside its message.
pub(crate) type Fields = Map<String, Value>;

/// Signs of life while something of unknown length is under way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Busy {
    /// On a terminal; else lines.
    Spinner,
    /// At intervals.
    Lines,
    /// None.
    Nothing,
}

struct Log {
    format: LogFormat,
    file: Option<Mutex<File>>,
    busy: Busy,
}

/// Before it is set, text for people.
static LOG: OnceLock<Log> = OnceLock::new();

/// Decides about all lines to come, once. The file begins anew, and gets every line, whether or not
/// it is shown.
pub(crate) fn set_up(format: LogFormat, file: Option<&Path>, busy: Busy) -> Result<()> {
    let create = |path: &Path| File::create(path).map_err(|e| Error::io(path, e));
    let file = file.map(create).transpose()?.map(Mutex::new);
    // A second call does nothing: there is one command in a process.
    let _ = LOG.set(Log { format, file, busy });
    Ok(())
}

/// What may be shown meanwhile; of [`Busy::Spinner`] a bar, too.
pub(crate) fn busy() -> Busy {
    LOG.get().map_or(Busy::Spinner, |log| log.busy)
}

/// One line.
pub(crate) fn emit(level: Level, is_shown: bool, message: &str, fields: Fields) {
    let format = LOG.get().map_or(LogFormat::Text, |log| log.format);
    let file = LOG.get().and_then(|log| log.file.as_ref());
    if !is_shown && file.is_none() {
        return;
    }
    let line = match format {
        LogFormat::Text => format!("{message}\n"),
        LogFormat::Json => format!("{}\n", object(level, message, fields)),
    };
    // There is nowhere to tell of a failure.
    if is_shown {
        let _ = std::io::stderr().write_all(line.as_bytes());
    }
    if let Some(file) = file {
        let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = file.write_all(line.as_bytes());
    }
}

/// The level that the beginning of a text tells.
pub(crate) fn level_of(text: &str) -> Level {
    match text {
        text if text.starts_with("error: ") => Level::Error,
        text if text.starts_with("warning: ") => Level::Warning,
        _ => Level::Info,
    }
}

fn object(level: Level, message: &str, mut fields: Fields) -> Value {
    let (word, prefix) = match level {
        Level::Debug => ("debug", ""),
        Level::Info => ("info", ""),
        Level::Warning => ("warning", "warning: "),
        Level::Error => ("error", "error: "),
    };
    let time = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |t| t.as_secs_f64());
    fields.insert("time".into(), json!((time * 1e3).round() / 1e3));
    fields.insert("level".into(), json!(word));
    fields.insert("message".into(), json!(message.strip_prefix(prefix).unwrap_or(message)));
    Value::Object(fields)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_object_has_level_and_message_apart() {
        let text = "warning: 3 \"pixels\"\nare black";
        let value = object(level_of(text), text, Fields::new());
        assert_eq!(value["level"], "warning");
        assert_eq!(value["message"], "3 \"pixels\"\nare black");
        assert!(value["time"].as_f64().unwrap() > 1.7e9);
        assert_eq!(value.to_string().lines().count(), 1);
        assert_eq!(level_of("error: no"), Level::Error);
        assert_eq!(level_of("no error: "), Level::Info);
    }
}
