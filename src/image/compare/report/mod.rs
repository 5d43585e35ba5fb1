//! A run for machines and for people: JSON, and one page that needs nothing else.
//!
//! The page holds the pictures themselves, so that it can be opened from a disk, mailed, or kept as
//! the result of a CI job. Its parts are files beside this one: `report.html`, `report.css`, and three
//! scripts that decode the pictures, show them, and fill the page.

mod json;
mod pixels;

pub use json::json;

use super::{Case, Comparison, Outcome, PictureFile, Run, hdr_flip, ldr_flip, magma};
use crate::image::{OutputFormat, write_atomically};
use crate::{Error, Result};
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};

const PAGE: &str = include_str!("report.html");
const STYLE: &str = include_str!("report.css");
const SCRIPTS: [&str; 3] =
    [include_str!("decode.js"), include_str!("viewer.js"), include_str!("page.js")];

/// How a report is made.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportOptions {
    /// Title of the page.
    pub title: String,
    /// Most bytes that its pictures may take. Each case may take its share of what the worse ones
    /// have left; pictures that need more are shown smaller, and the page says so.
    pub most_bytes: usize,
    /// The command that accepts all pictures that do not pass.
    pub accept_command: String,
}

impl Default for ReportOptions {
    fn default() -> Self {
        Self {
            title: "Image comparison".into(),
            most_bytes: 9_000_000,
            accept_command: String::new(),
        }
    }
}

/// The file of a report: `path` itself if it ends in `.html`, else `report.html` in the folder
/// `path`, which is made.
///
/// # Errors
/// [`Error::Io`].
pub fn report_path(path: &Path) -> Result<PathBuf> {
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("html")) {
        return Ok(path.to_owned());
    }
    std::fs::create_dir_all(path).map_err(|e| Error::io(path, e))?;
    Ok(path.join("report.html"))
}

/// Writes the page.
///
/// # Errors
/// [`Error::Io`].
pub fn write_report(path: &Path, run: &Run, options: &ReportOptions) -> Result<()> {
    let page = page(run, options);
    write_atomically(path, |file| file.write_all(page.as_bytes()).map_err(|e| Error::io(path, e)))
}

/// The page as text.
pub fn page(run: &Run, options: &ReportOptions) -> String {
    let mut left = options.most_bytes;
    let mut pictures = Vec::new();
    for (k, case) in run.cases.iter().enumerate() {
        let share = left / (run.cases.len() - k);
        let (picture, size) = case_pictures(case, share);
        left = left.saturating_sub(size);
        pictures.push(picture);
    }
    let data = json!({
        "title": options.title,
        "run": json(run),
        "pictures": pictures,
        "magma": magma().as_slice(),
        "accept": options.accept_command,
    });
    // Within a script only `</` and `<!` end or change the text; JSON may escape `<`.
    let data = data.to_string().replace('<', "\\u003c");
    // Data last: it may hold anything.
    PAGE.replace("/*STYLE*/", STYLE)
        .replace("/*SCRIPT*/", &SCRIPTS.concat())
        .replacen("/*DATA*/", &data, 1)
}

/// The pictures of a case as large as `most_bytes` allows, and their bytes.
fn case_pictures(case: &Case, most_bytes: usize) -> (Value, usize) {
    let read = |path: &Path| PictureFile::read(path).ok();
    let (actual, expected) = (read(&case.actual), read(&case.expected));
    let comparison = match &case.outcome {
        Outcome::Compared(comparison) => Some(comparison.as_ref()),
        _ => None,
    };
    let maps = comparison.map_or(vec![], |c| flip_maps(c, actual.as_ref(), expected.as_ref()));
    let mut factor = 1;
    loop {
        let value = layers(comparison, actual.as_ref(), expected.as_ref(), &maps, factor);
        let size = value.to_string().len();
        if size <= most_bytes || factor >= 64 {
            return (value, size);
        }
        factor *= 2;
    }
}

/// The layers of both files that were compared, or all where nothing was.
fn layers(
    comparison: Option<&Comparison>,
    actual: Option<&PictureFile>,
    expected: Option<&PictureFile>,
    maps: &[(&str, Vec<f32>)],
    factor: u32,
) -> Value {
    let names: Vec<&str> = match comparison {
        Some(comparison) => comparison.layers.iter().map(|layer| layer.name.as_str()).collect(),
        None => {
            let file = actual.or(expected);
            file.map_or(vec![], |f| f.layers.iter().map(|layer| layer.name.as_str()).collect())
        }
    };
    let layer = |name: &str| {
        let encode = |file: Option<&PictureFile>| {
            let file = file?;
            let size = (file.window.width, file.window.height);
            Some(pixels::layer(file.layer(name)?, size, factor))
        };
        let size = actual.or(expected).map_or((0, 0), |f| (f.window.width, f.window.height));
        let maps: Vec<Value> = match name {
            "" => maps.iter().map(|(n, map)| pixels::map(n, map, size, factor)).collect(),
            _ => vec![],
        };
        json!({
            "name": if name.is_empty() { "colour" } else { name },
            "width": size.0, "height": size.1,
            "actual": encode(actual), "expected": encode(expected), "maps": maps,
        })
    };
    Value::Array(names.into_iter().map(layer).collect())
}

fn flip_maps(
    comparison: &Comparison,
    actual: Option<&PictureFile>,
    expected: Option<&PictureFile>,
) -> Vec<(&'static str, Vec<f32>)> {
    let is_finite = comparison.layer("").is_some_and(|layer| layer.non_finite.is_none());
    let (Some(actual), Some(expected), true) = (actual, expected, is_finite) else {
        return vec![];
    };
    let (Some(a), Some(b)) = (actual.picture(), expected.picture()) else { return vec![] };
    let mut maps = vec![("FLIP", ldr_flip(&a, &b).map)];
    if actual.format == OutputFormat::Exr {
        maps.push(("HDR FLIP", hdr_flip(&a, &b).map));
    }
    maps
}
