//! Exact tests: goldens per device and driver.

use super::evidence::make_folder;
use super::{Blessing, ImageTest, ImageTestFailure, Passed, Rendered, TestResult};
use crate::image::compare::{Comparison, ComparisonOptions, PictureFile, Rule};
use std::path::{Path, PathBuf};

impl ImageTest {
    /// Asserts that the picture is the golden one of its device and driver, bit by bit.
    ///
    /// # Errors
    /// Where it is not, where there is no golden at all, and where blessing is refused.
    pub fn exact(&self, actual: &Rendered) -> TestResult {
        let folder = self.references.join(&self.name);
        let own = folder.join(format!("{}.exr", slug(&actual.origin())));
        let goldens = goldens(&folder);
        let failure = |message: String| Err(ImageTestFailure { message, report: None });
        let has_own = goldens.contains(&own);
        match (self.blessing, has_own, goldens.is_empty()) {
            (Blessing::Off, ..) => {}
            (Blessing::Replace, true, _) | (Blessing::Replace, _, true) | (Blessing::New, ..) => {
                make_folder(&folder)?;
                actual.write(&own)?;
                return Ok(Passed::Blessed);
            }
            (Blessing::Replace, false, false) => {
                return failure(format!(
                    "{}: blessing refused: there are goldens of {}, and this is {}. Bless where they were \
                     made, or with STERADIAN_BLESS=new add one for this driver",
                    self.name,
                    names(&goldens),
                    actual.origin(),
                ));
            }
        }
        if has_own {
            return self.exact_with(actual, &own);
        }
        let Some(other) = goldens.first() else {
            return failure(format!(
                "{}: there is no golden in {}; STERADIAN_BLESS=1 makes one",
                self.name,
                folder.display()
            ));
        };
        if self.requires_golden {
            return failure(format!(
                "{}: there is no golden of {}, only of {}; STERADIAN_BLESS=new adds one",
                self.name,
                actual.origin(),
                names(&goldens),
            ));
        }
        self.within_noise(actual, other)
    }

    fn exact_with(&self, actual: &Rendered, golden: &Path) -> TestResult {
        let rules = vec![Rule::Exact { layer: None }];
        let options = ComparisonOptions { rules, ..ComparisonOptions::default() };
        self.judge(actual, golden, &options, "is not its golden picture")?;
        Ok(Passed::Compared)
    }

    /// On another driver: the same seed gives nearly the same samples, so the noise of both
    /// explains the difference, or there is more to it.
    fn within_noise(&self, actual: &Rendered, golden: &Path) -> TestResult {
        let rules = vec![Rule::Verdict];
        let options = ComparisonOptions { rules, ..ComparisonOptions::default() };
        let made_by = names(std::slice::from_ref(&golden.to_owned()));
        eprintln!(
            "{}: no golden of {}; compared within noise with that of {made_by}",
            self.name,
            actual.origin(),
        );
        self.judge(
            actual,
            golden,
            &options,
            "differs from another driver's golden by more than noise",
        )?;
        Ok(Passed::WithinNoise)
    }

    /// Fails with evidence where a rule does not hold.
    pub(super) fn judge(
        &self,
        actual: &Rendered,
        expected: &Path,
        options: &ComparisonOptions,
        what: &str,
    ) -> Result<Comparison, ImageTestFailure> {
        let file = actual.file(expected)?;
        let compared = Comparison::of(&file, &PictureFile::read(expected)?, options);
        let reasons = match &compared {
            Ok(comparison) if comparison.passes() => return Ok(compared?),
            Ok(comparison) => {
                let lines = comparison.failures.iter();
                lines.map(|f| format!("\n  {}: {}", f.rule, f.finding)).collect::<String>()
            }
            Err(error) => format!("\n  {error}"),
        };
        let message = format!("{}: {what} ({}){reasons}", self.name, expected.display());
        Err(self.keep_beside(&message, Ok(()), actual, expected, options))
    }
}

/// The goldens of a test, by name.
fn goldens(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let is_golden = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "exr");
    let mut goldens: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_golden).collect();
    goldens.sort();
    goldens
}

/// Devices and drivers of goldens, as their files say.
fn names(goldens: &[PathBuf]) -> String {
    let origin = |path: &PathBuf| match PictureFile::read(path) {
        Ok(file) => {
            let get = |name| file.setting(name).unwrap_or("unknown").to_owned();
            format!("{}, {}", get("device"), get("driver"))
        }
        Err(error) => error.to_string(),
    };
    goldens.iter().map(origin).collect::<Vec<_>>().join("; ")
}

/// A file name of letters, digits, dots and hyphens.
fn slug(text: &str) -> String {
    let mut slug = String::new();
    for c in text.to_lowercase().chars() {
        if c.is_ascii_alphanumeric() || c == '.' {
            slug.push(c);
        } else if !slug.ends_with('-') {
            slug.push('-');
        }
    }
    slug.trim_matches('-').to_owned()
}
