//! The one error type of the library: what failed, on what, and what to do.

use std::path::PathBuf;

/// Why an operation could not be done. [`Error::exit_code`] gives the
/// program's documented exit code for it.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A scene, or a file that it refers to, cannot be used.
    #[error("{}: {message}", path.display())]
    Scene {
        /// The file at fault.
        path: PathBuf,
        /// What is wrong in it, where, and the remedy if there is one.
        message: String,
    },
    /// A scene needs more than the device offers.
    #[error("{0}")]
    Limit(String),
    /// A setting has no meaning for this scene or contradicts another.
    #[error("{0}")]
    Settings(String),
    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// No device can run the renderer.
    #[error("{0}")]
    NoDevice(String),
    /// The device failed while rendering; a retry may succeed.
    #[error("{0}")]
    DeviceLost(String),
    /// The machine has not enough of something now; a retry may succeed.
    #[error("{0}")]
    Busy(String),
    /// A composed shader did not validate: a defect of this program.
    #[error("shader {entry}: {message}")]
    Shader {
        /// The entry file.
        entry: String,
        /// The validator's message with file and line.
        message: String,
    },
}

/// Result with [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// A [`Error::Scene`] for `path`. Parts of the message may come from the file, so that
    /// control characters are escaped, and what is very long is cut.
    pub fn scene(path: impl Into<PathBuf>, message: impl Into<String>) -> Self {
        Self::Scene { path: path.into(), message: printable(&message.into()) }
    }

    /// An [`Error::Io`] for `path`.
    pub fn io(path: impl Into<PathBuf>, source: std::io::Error) -> Self {
        Self::Io { path: path.into(), source }
    }

    /// The program's exit code for this error (README, "Exit codes").
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Io { .. } | Self::Shader { .. } => 1,
            Self::Settings(_) => 2,
            Self::Scene { .. } | Self::Limit(_) => 3,
            Self::NoDevice(_) => 4,
            Self::DeviceLost(_) | Self::Busy(_) => 75,
        }
    }
}

/// Longest message about a file, characters.
const MESSAGE_LENGTH: usize = 2000;

/// The text as one line that does nothing to a terminal.
pub(crate) fn printable(text: &str) -> String {
    let mut line = String::new();
    for (i, character) in text.chars().enumerate() {
        match character {
            _ if i >= MESSAGE_LENGTH => {
                line.push('…');
                break;
            }
            c if c.is_control() => line.extend(c.escape_debug()),
            c => line.push(c),
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_one_line_without_control_characters() {
        let message = Error::scene("a.gltf", "no\u{1b}[31m\nsuch: \"ü\"").to_string();
        assert_eq!(message, "a.gltf: no\\u{1b}[31m\\nsuch: \"ü\"");
        let long = Error::scene("a.gltf", "x".repeat(1 << 20)).to_string();
        assert_eq!(long.chars().count(), "a.gltf: ".len() + MESSAGE_LENGTH + 1);
    }
}
