//! Joins WGSL modules into one text.
//!
//! Whole lines only: `#import path` puts a module in once, in place of its first
//! import; `#if NAME`, `#if !NAME`, `#else`, `#endif` keep or drop lines by
//! [`Features`]. There are no namespaces: names begin with their module's noun.

use super::{Feature, Features, Library};
use crate::{Error, Result};
use std::collections::BTreeSet;

/// A composed text.
#[derive(Debug, Clone)]
pub struct Composed {
    /// WGSL.
    pub text: String,
    /// Where each line of `text` came from.
    pub origins: Vec<LineOrigin>,
}

/// A line of a file of `shaders/`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LineOrigin {
    /// Path without the ending.
    pub file: String,
    /// Counted from 1.
    pub line: usize,
}

impl Composed {
    /// `file.wgsl:line` of a line of the text, counted from 1.
    pub fn locate(&self, line: usize) -> String {
        match self.origins.get(line.wrapping_sub(1)) {
            Some(o) => format!("{}.wgsl:{}", o.file, o.line),
            None => format!("line {line}"),
        }
    }
}

/// Composes `entry` from `library` for `features`. `generated` is the text behind
/// `#import generated`.
pub fn compose(
    library: &Library,
    entry: &str,
    features: Features,
    generated: &str,
) -> Result<Composed> {
    let mut composer = Composer {
        library,
        features,
        generated,
        imported: BTreeSet::new(),
        composed: Composed { text: String::new(), origins: Vec::new() },
    };
    composer.import(entry).map_err(|message| Error::Shader { entry: entry.to_owned(), message })?;
    Ok(composer.composed)
}

struct Composer<'a> {
    library: &'a Library,
    features: Features,
    generated: &'a str,
    imported: BTreeSet<String>,
    composed: Composed,
}

/// An open `#if`.
struct Condition {
    /// Whether its lines are kept; false inside a dropped outer one.
    keeps: bool,
    /// Whether the surrounding lines are kept.
    outer: bool,
    has_else: bool,
}

impl Composer<'_> {
    fn import(&mut self, path: &str) -> std::result::Result<(), String> {
        if !self.imported.insert(path.to_owned()) {
            return Ok(());
        }
        let text = match (path, self.library.get(path)) {
            ("generated", _) => self.generated,
            (_, Some(text)) => text.as_ref(),
            (_, None) => return Err(format!("no module {path}")),
        };
        let mut open: Vec<Condition> = Vec::new();
        for (i, line) in text.lines().enumerate() {
            let at = |message: String| format!("{path}.wgsl:{}: {message}", i + 1);
            let keeps = open.last().is_none_or(|c| c.keeps);
            let mut words = line.split_whitespace();
            match (words.next(), words.next(), words.next()) {
                (Some("#import"), Some(module), None) => {
                    if keeps {
                        self.import(module).map_err(at)?;
                    }
                }
                (Some("#if"), Some(name), None) => {
                    let wanted = !name.starts_with('!');
                    let feature = Feature::from_name(name.trim_start_matches('!'))
                        .ok_or_else(|| at(format!("no feature {name}")))?;
                    let holds = self.features.has(feature) == wanted;
                    open.push(Condition { keeps: keeps && holds, outer: keeps, has_else: false });
                }
                (Some("#else"), None, _) => {
                    let c = open.last_mut().ok_or_else(|| at("#else without #if".into()))?;
                    if c.has_else {
                        return Err(at("second #else".into()));
                    }
                    c.has_else = true;
                    c.keeps = c.outer && !c.keeps;
                }
                (Some("#endif"), None, _) => {
                    open.pop().ok_or_else(|| at("#endif without #if".into()))?;
                }
                (Some(word), ..) if word.starts_with('#') => {
                    return Err(at(format!("cannot read {line:?}")));
                }
                _ => {
                    if keeps {
                        self.composed.text.push_str(line);
                        self.composed.text.push('\n');
                        let origin = LineOrigin { file: path.to_owned(), line: i + 1 };
                        self.composed.origins.push(origin);
                    }
                }
            }
        }
        if open.is_empty() { Ok(()) } else { Err(format!("{path}.wgsl: #if without #endif")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(files: &[(&'static str, &'static str)], features: Features) -> Result<Composed> {
        let library = files.iter().map(|&(path, text)| (path, text.into())).collect();
        compose(&library, "main", features, "const G = 1;\n")
    }

    #[test]
    fn imports_once_and_maps_lines() {
        let files = [
            ("main", "#import a\n#import b\nfn m() {}\n"),
            ("a", "#import generated\nfn a() {}\n"),
            ("b", "#import a\n\nfn b() {}\n"),
        ];
        let c = run(&files, Features::default()).unwrap();
        assert_eq!(c.text, "const G = 1;\nfn a() {}\n\nfn b() {}\nfn m() {}\n");
        assert_eq!(c.locate(4), "b.wgsl:3");
        assert_eq!(c.locate(5), "main.wgsl:3");
    }

    #[test]
    fn conditions_nest() {
        let text =
            "#if GGX\nx\n#if !LENS\ny\n#else\nz\n#endif\n#else\n#if LENS\nw\n#endif\nv\n#endif\n";
        let lines = |f: Features| run(&[("main", text)], f).unwrap().text.replace('\n', "");
        assert_eq!(lines(Features::default()), "v");
        assert_eq!(lines(Features::default().with(Feature::Ggx)), "xy");
        assert_eq!(lines(Features::default().with(Feature::Ggx).with(Feature::Lens)), "xz");
        assert_eq!(lines(Features::default().with(Feature::Lens)), "wv");
    }

    #[test]
    fn a_dropped_import_is_not_read() {
        let c = run(&[("main", "#if GGX\n#import missing\n#endif\n")], Features::default());
        assert_eq!(c.unwrap().text, "");
    }

    #[test]
    fn errors_name_file_and_line() {
        let cases = [
            ("#import gone\n", "main.wgsl:1: no module gone"),
            ("\n#if NOPE\n#endif\n", "main.wgsl:2: no feature NOPE"),
            ("#if GGX\n", "main.wgsl: #if without #endif"),
            ("#endif\n", "main.wgsl:1: #endif without #if"),
            ("#else\n", "main.wgsl:1: #else without #if"),
            ("#define X 1\n", "main.wgsl:1: cannot read"),
        ];
        for (text, expected) in cases {
            let message = run(&[("main", text)], Features::default()).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
