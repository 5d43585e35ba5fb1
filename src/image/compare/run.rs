//! Two files, or two folders of files paired by name.

use super::{Comparison, ComparisonOptions, PictureFile};
use crate::image::{OutputFormat, write_atomically};
use crate::{Error, Result};
use std::collections::BTreeSet;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// All pairs of a call, the worst first.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The pairs.
    pub cases: Vec<Case>,
}

/// A pair of files.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Path within the folders, or the name of the file.
    pub name: String,
    /// The picture in question.
    pub actual: PathBuf,
    /// The picture that it should be.
    pub expected: PathBuf,
    /// What came of it.
    pub outcome: Outcome,
}

/// What came of a pair.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Both could be compared.
    Compared(Box<Comparison>),
    /// There is nothing to compare with.
    MissingExpected,
    /// The expected picture has no actual one.
    MissingActual,
    /// One of them cannot be read, or they are not of one kind; says why.
    Unusable(String),
}

/// An outcome in a word, ordered from bad to good.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum CaseStatus {
    /// Could not be compared.
    Unusable,
    /// No actual picture, or no expected one.
    Missing,
    /// A rule does not hold.
    Differs,
    /// All rules hold.
    Same,
}

impl CaseStatus {
    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Unusable => "unusable",
            Self::Missing => "missing",
            Self::Differs => "differs",
            Self::Same => "same",
        }
    }
}

impl Case {
    /// Compares two files.
    pub fn of(name: &str, actual: &Path, expected: &Path, options: &ComparisonOptions) -> Self {
        let outcome = match compare(actual, expected, options) {
            Ok(outcome) => outcome,
            Err(error) => Outcome::Unusable(error.to_string()),
        };
        let (actual, expected) = (actual.to_owned(), expected.to_owned());
        Self { name: name.to_owned(), actual, expected, outcome }
    }

    /// The outcome in a word.
    pub fn status(&self) -> CaseStatus {
        match &self.outcome {
            Outcome::Compared(comparison) if comparison.passes() => CaseStatus::Same,
            Outcome::Compared(_) => CaseStatus::Differs,
            Outcome::MissingExpected | Outcome::MissingActual => CaseStatus::Missing,
            Outcome::Unusable(_) => CaseStatus::Unusable,
        }
    }

    /// Why it does not pass, one line each.
    pub fn reasons(&self) -> Vec<String> {
        match &self.outcome {
            Outcome::Compared(comparison) => {
                let failures = comparison.failures.iter();
                failures.map(|f| format!("{}: {}", f.rule, f.finding)).collect()
            }
            Outcome::MissingExpected => {
                vec![format!("there is no expected picture {}", self.expected.display())]
            }
            Outcome::MissingActual => {
                vec![format!("there is no actual picture {}", self.actual.display())]
            }
            Outcome::Unusable(message) => vec![message.clone()],
        }
    }

    /// Order of badness: status, then how far off.
    fn badness(&self) -> (CaseStatus, f64) {
        let error = match &self.outcome {
            Outcome::Compared(comparison) => {
                let color = comparison.layer("").or(comparison.layers.first());
                let metric = |name| color.and_then(|layer| layer.metrics.get(name));
                let error = metric("flip.mean").or(metric("rmse")).unwrap_or(0.0);
                if error.is_nan() { f64::INFINITY } else { error }
            }
            _ => 0.0,
        };
        (self.status(), -error)
    }

    /// Makes the actual picture the expected one.
    ///
    /// # Errors
    /// [`Error::Settings`] where a value is not finite, the picture cannot be read, or the one to
    /// be replaced was made by another device or driver. [`Error::Io`].
    pub fn accept(&self) -> Result<()> {
        let name = self.name.as_str();
        let actual = PictureFile::read(&self.actual)?;
        let values = actual.layers.iter().flat_map(|layer| &layer.channels);
        if values.flat_map(|(_, values)| values).any(|value| !value.is_finite()) {
            let message = format!("{name}: has values that are not finite, and is not accepted");
            return Err(Error::Settings(message));
        }
        if self.expected.exists()
            && let Ok(expected) = PictureFile::read(&self.expected)
        {
            for key in ["device", "driver"] {
                if let Some((a, b)) = actual.setting(key).zip(expected.setting(key))
                    && a != b
                {
                    return Err(Error::Settings(format!(
                        "{name}: the expected picture is of {key} \"{b}\", this one of \"{a}\", and is not \
                         accepted in its place; delete {} first if that is meant",
                        self.expected.display()
                    )));
                }
            }
        }
        let bytes = std::fs::read(&self.actual).map_err(|e| Error::io(&self.actual, e))?;
        if let Some(folder) = self.expected.parent().filter(|f| !f.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
        }
        write_atomically(&self.expected, |file| {
            file.write_all(&bytes).map_err(|e| Error::io(&self.expected, e))
        })
    }
}

fn compare(actual: &Path, expected: &Path, options: &ComparisonOptions) -> Result<Outcome> {
    let is_missing = |path: &Path| {
        std::fs::metadata(path).is_err_and(|error| error.kind() == ErrorKind::NotFound)
    };
    if is_missing(actual) {
        return Ok(Outcome::MissingActual);
    }
    if is_missing(expected) {
        return Ok(Outcome::MissingExpected);
    }
    let (actual, expected) = (PictureFile::read(actual)?, PictureFile::read(expected)?);
    Ok(Outcome::Compared(Box::new(Comparison::of(&actual, &expected, options)?)))
}

impl Run {
    /// Compares two files, or all PNG and EXR files below two folders.
    ///
    /// # Errors
    /// [`Error::Settings`] if one is a file and the other a folder, or there is no picture at all.
    pub fn of(actual: &Path, expected: &Path, options: &ComparisonOptions) -> Result<Self> {
        match (actual.is_dir(), expected.is_dir()) {
            (true, true) => {}
            (false, false) => {
                let name = actual.file_name().unwrap_or_default().to_string_lossy().into_owned();
                return Ok(Self { cases: vec![Case::of(&name, actual, expected, options)] });
            }
            (true, false) => {
                let message = "is a folder and the other is not: give two files or two folders";
                return Err(Error::Settings(format!("{} {message}", actual.display())));
            }
            (false, true) => {
                let message = "is a folder and the other is not: give two files or two folders";
                return Err(Error::Settings(format!("{} {message}", expected.display())));
            }
        }
        let mut names = BTreeSet::new();
        for folder in [actual, expected] {
            pictures(folder, Path::new(""), &mut names)?;
        }
        if names.is_empty() {
            let (a, b) = (actual.display(), expected.display());
            return Err(Error::Settings(format!("there is no .png or .exr in {a} or {b}")));
        }
        let cases = names.iter().map(|name| {
            let file = |folder: &Path| folder.join(name);
            Case::of(&name.to_string_lossy(), &file(actual), &file(expected), options)
        });
        Ok(Self::from_cases(cases.collect()))
    }

    /// Puts the worst case first.
    pub fn from_cases(mut cases: Vec<Case>) -> Self {
        cases.sort_by(|a, b| {
            let ((status_a, error_a), (status_b, error_b)) = (a.badness(), b.badness());
            status_a.cmp(&status_b).then(error_a.total_cmp(&error_b)).then(a.name.cmp(&b.name))
        });
        Self { cases }
    }

    /// The worst status of all.
    pub fn status(&self) -> CaseStatus {
        self.cases.iter().map(Case::status).min().unwrap_or(CaseStatus::Unusable)
    }

    /// Whether every case passes.
    pub fn passes(&self) -> bool {
        self.status() == CaseStatus::Same
    }
}

/// Adds the pictures below `folder/inside` by their paths in `folder`. Hidden ones are left out.
fn pictures(folder: &Path, inside: &Path, names: &mut BTreeSet<PathBuf>) -> Result<()> {
    let path = folder.join(inside);
    let entries = std::fs::read_dir(&path).map_err(|e| Error::io(&path, e))?;
    for entry in entries {
        let entry = entry.map_err(|e| Error::io(&path, e))?;
        let name = inside.join(entry.file_name());
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        if entry.path().is_dir() {
            pictures(folder, &name, names)?;
        } else if OutputFormat::from_path(&name).is_ok() {
            names.insert(name);
        }
    }
    Ok(())
}
