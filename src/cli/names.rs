//! Names of output files, with places for the scene, the camera and the frame.
//!
//! | in a name | stands for |
//! |---|---|
//! | `{scene}`, `{camera}` | their names; a camera without one is its number |
//! | `{frame}`, `{frame:04}` | the frame's number, with so many digits at least |
//! | `####`, `%04d`, `%d` | the same, where there are frames; else they are what they are |
//! | `{{`, `}}` | a brace |

use std::path::{Path, PathBuf};
use steradian::{Error, Result};

/// Digits of a number that is put before the ending.
const APPENDED_DIGITS: usize = 4;
/// Digits that a name can ask for.
const MOST_DIGITS: usize = 32;

/// What the places of a name stand for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Names<'a> {
    /// The scene's.
    pub(crate) scene: &'a str,
    /// The camera's; unknown before the scene is read.
    pub(crate) camera: Option<&'a str>,
    /// `None` where no frames were asked for.
    pub(crate) frame: Option<u32>,
    /// Whether there are other frames, from which the name must differ.
    pub(crate) has_others: bool,
}

/// Whether the name has a place for the camera.
pub(crate) fn needs_camera(template: &Path) -> bool {
    template.to_str().is_some_and(|text| text.contains("{camera}"))
}

impl Names<'_> {
    /// The name that `template` stands for.
    ///
    /// # Errors
    /// [`Error::Settings`] for places that there are not.
    pub(crate) fn expand(&self, template: &Path) -> Result<PathBuf> {
        // What is not UTF-8 has no places.
        let (path, has_frame) = match template.to_str() {
            Some(text) => {
                let wrong = |message| Error::Settings(format!("{text}: {message}"));
                let (text, has_frame) = self.expand_text(text).map_err(wrong)?;
                (PathBuf::from(text), has_frame)
            }
            None => (template.to_owned(), false),
        };
        match self.frame {
            Some(frame) if self.has_others && !has_frame => Ok(with_number(&path, frame)),
            _ => Ok(path),
        }
    }

    /// The text, and whether the frame is in it.
    fn expand_text(&self, text: &str) -> std::result::Result<(String, bool), String> {
        let mut name = String::new();
        let mut has_frame = false;
        let mut rest = text;
        while let Some(first) = rest.chars().next() {
            if let Some(after) = rest.strip_prefix("{{").or_else(|| rest.strip_prefix("}}")) {
                name.push(first);
                rest = after;
                continue;
            }
            if first == '{' {
                let (place, after) = rest[1..].split_once('}').ok_or("a { without its }")?;
                name += &self.place(place)?;
                has_frame |= place.starts_with("frame");
                rest = after;
                continue;
            }
            if let (Some(frame), Some((digits, after))) = (self.frame, mark(rest)?) {
                name += &padded(frame, digits);
                has_frame = true;
                rest = after;
                continue;
            }
            name.push(first);
            rest = &rest[first.len_utf8()..];
        }
        Ok((name, has_frame))
    }

    /// What stands between braces.
    fn place(&self, place: &str) -> std::result::Result<String, String> {
        let (word, form) = place.split_once(':').unwrap_or((place, ""));
        match word {
            "scene" if form.is_empty() => Ok(as_file_name(self.scene)),
            "camera" if form.is_empty() => Ok(as_file_name(self.camera.unwrap_or("camera"))),
            "frame" => {
                let frame = self.frame.ok_or("{frame} without --frames")?;
                Ok(padded(frame, digits(form, place)?))
            }
            _ => Err(format!(
                "{{{place}}}: places are {{scene}}, {{camera}}, {{frame}} and {{frame:04}}; \
                 a brace itself is {{{{ or }}}}"
            )),
        }
    }
}

/// A run of `#`, `%d` or `%04d` at the beginning of the text: digits, and what follows.
fn mark(text: &str) -> std::result::Result<Option<(usize, &str)>, String> {
    let after = text.trim_start_matches('#');
    let hashes = text.len() - after.len();
    if hashes > 0 {
        return Ok(Some((digits(&hashes.to_string(), &text[..hashes])?, after)));
    }
    let Some((form, after)) = text.strip_prefix('%').and_then(|rest| rest.split_once('d')) else {
        return Ok(None);
    };
    match form.bytes().all(|b| b.is_ascii_digit()) {
        true => Ok(Some((digits(form, &text[..form.len() + 2])?, after))),
        false => Ok(None),
    }
}

/// The number of digits that a form such as `04` asks for; 1 for none.
fn digits(form: &str, place: &str) -> std::result::Result<usize, String> {
    let digits = if form.is_empty() { Some(1) } else { form.parse().ok() };
    let is_number = form.bytes().all(|b| b.is_ascii_digit());
    digits
        .filter(|count| is_number && (1..=MOST_DIGITS).contains(count))
        .ok_or_else(|| format!("{place}: a number can have 1 to {MOST_DIGITS} digits"))
}

fn padded(frame: u32, digits: usize) -> String {
    format!("{frame:0digits$}")
}

/// `picture.0007.png` of `picture.png`.
fn with_number(path: &Path, frame: u32) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(format!(".{}", padded(frame, APPENDED_DIGITS)));
    if let Some(ending) = path.extension() {
        name.push(".");
        name.push(ending);
    }
    path.with_file_name(name)
}

/// A name from a scene as a part of a file's name: never another folder, nor a hidden file.
fn as_file_name(name: &str) -> String {
    let safe = |c: char| if c.is_control() || "/\\:*?\"<>|".contains(c) { '_' } else { c };
    let name: String = name.chars().map(safe).collect();
    match name.strip_prefix('.') {
        Some(rest) => format!("_{rest}"),
        None => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expand(template: &str, frame: Option<u32>, has_others: bool) -> String {
        let names = Names { scene: "box", camera: Some("../top"), frame, has_others };
        match names.expand(Path::new(template)) {
            Ok(path) => path.to_str().unwrap().to_owned(),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn places_are_filled() {
        let cases = [
            ("a.####.png", "a.0007.png"),
            ("a#.png", "a7.png"),
            ("f%04d/%d.png", "f0007/7.png"),
            ("{scene} {camera} {frame}.exr", "box _._top 7.exr"),
            ("{frame:3}{frame:05}.exr", "00700007.exr"),
            ("{{scene}}#.exr", "{scene}7.exr"),
            ("100%.png", "100%.0007.png"),
            ("%-4d.png", "%-4d.0007.png"),
        ];
        for (template, name) in cases {
            assert_eq!(expand(template, Some(7), true), name, "{template}");
        }
    }

    #[test]
    fn the_number_goes_before_the_ending_where_there_are_others() {
        assert_eq!(expand("out/a.png", Some(12), true), "out/a.0012.png");
        assert_eq!(expand("a.b.png", Some(123_456), true), "a.b.123456.png");
        assert_eq!(expand("a", Some(1), true), "a.0001");
        assert_eq!(expand("out/a.png", Some(12), false), "out/a.png");
    }

    #[test]
    fn without_frames_marks_are_what_they_are() {
        assert_eq!(expand("a##%04d.png", None, false), "a##%04d.png");
        assert_eq!(expand("{scene}.png", None, false), "box.png");
        assert_eq!(expand("{frame}.png", None, false), "{frame}.png: {frame} without --frames");
    }

    #[test]
    fn what_is_no_place_is_told() {
        for (template, word) in [
            ("{shot}.png", "{shot}: places are {scene}"),
            ("{frame.png", "a { without its }"),
            ("{frame:x}.png", "1 to 32 digits"),
            ("{frame:0}.png", "1 to 32 digits"),
            ("{frame:99999999999999999999}.png", "1 to 32 digits"),
            ("%99999999999999999999d.png", "1 to 32 digits"),
            ("{scene:4}.png", "places are"),
        ] {
            let message = expand(template, Some(7), true);
            assert!(message.contains(word), "{template}: {message}");
        }
        let long = "#".repeat(33);
        assert!(expand(&long, Some(7), true).contains("1 to 32 digits"));
    }

    #[cfg(unix)]
    #[test]
    fn a_name_that_is_not_utf_8_gets_its_number() {
        use std::ffi::OsStr;
        use std::os::unix::ffi::OsStrExt;
        let path = Path::new(OsStr::from_bytes(b"\xff#.png"));
        let names = Names { scene: "", camera: None, frame: Some(3), has_others: true };
        let name = names.expand(path).unwrap();
        assert_eq!(name.as_os_str().as_bytes(), b"\xff#.0003.png");
    }
}
