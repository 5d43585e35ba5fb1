//! Image tests for `cargo test`: exact, same bytes, and statistical.
//!
//! A test renders a picture, says what made it ([`Rendered`]), and asks an [`ImageTest`]:
//!
//! - [`ImageTest::exact`]: bit by bit the stored *golden* picture. Goldens are kept per device and
//!   driver, because another driver rounds otherwise. On a driver without a golden of its own
//!   the picture is held to another driver's statistically, and the test says so; it
//!   fails instead where `STERADIAN_REQUIRE_GOLDEN` is set.
//! - [`ImageTest::same_bytes`]: several ways to one picture give the same bits. Nothing is stored.
//! - [`ImageTest::statistical`]: the stored *reference*, the mean of many runs with its variance,
//!   within noise; and noise so low that a bias of a stated size would show.
//!
//! What is missing fails. With the environment variable `STERADIAN_BLESS=1` a test stores what it
//! rendered; a golden is replaced only on the device and driver that made it. `STERADIAN_BLESS=new`
//! adds a golden for one more driver. When a test fails, both pictures as EXR and PNG, the
//! map of the errors, and a report are kept below `target/image-tests` (or
//! `STERADIAN_TEST_OUTPUT`), and the message says where.
//!
//! Any renderer can use it:
//!
//! ```
//! use steradian::image::Picture;
//! use steradian::testing::{Blessing, ImageTest, Rendered};
//!
//! let render = |brightness: f32| {
//!     let row = |y: u32| (0..16).map(move |x| [brightness * x as f32 / 16.0, 0.5, y as f32]);
//!     let picture = Picture::new(16, 8, (0..8).flat_map(row).collect());
//!     Rendered::new(picture, "my adapter", "my driver 1.2").with("seed", "7")
//! };
//! # let folder = tempfile::tempdir().unwrap();
//! # let folder = folder.path();
//! let test = ImageTest::new("ramp").references_in(folder).output_in(folder);
//! // Missing: fails.
//! assert!(test.exact(&render(1.0)).is_err());
//! // As with STERADIAN_BLESS=1 in the environment: stores it.
//! test.clone().blessing(Blessing::Replace).exact(&render(1.0)).unwrap();
//! // From now on every bit counts.
//! test.exact(&render(1.0)).unwrap();
//! let failure = test.exact(&render(1.001)).unwrap_err();
//! assert!(failure.report.unwrap().exists());
//! ```

mod evidence;
mod golden;
mod reference;
mod rendered;

pub use reference::write_reference;
pub use rendered::Rendered;

use crate::image::compare::ComparisonOptions;
use std::env;
use std::fmt;
use std::path::{Path, PathBuf};

/// Whether a test stores what it rendered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Blessing {
    /// It compares.
    Off,
    /// It stores a picture where there is none, or replaces one that the same device and driver made.
    Replace,
    /// It also stores the first golden of one more driver.
    New,
}

/// An image test of a name.
#[derive(Debug, Clone)]
pub struct ImageTest {
    name: String,
    references: PathBuf,
    output: PathBuf,
    blessing: Blessing,
    requires_golden: bool,
}

/// How a test passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Passed {
    /// As it was meant.
    Compared,
    /// The picture was stored.
    Blessed,
    /// There is no golden of this driver, and the picture is another one's within noise.
    WithinNoise,
}

/// Why a test failed, and where the evidence is. `Debug` prints it in lines, for `unwrap`.
#[derive(Clone, PartialEq, Eq)]
pub struct ImageTestFailure {
    /// What is wrong and what to do.
    pub message: String,
    /// The report, if there was something to compare.
    pub report: Option<PathBuf>,
}

impl fmt::Display for ImageTestFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
        match &self.report {
            Some(report) => write!(f, "\nreport: {}", report.display()),
            None => Ok(()),
        }
    }
}

impl fmt::Debug for ImageTestFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl std::error::Error for ImageTestFailure {}

impl From<crate::Error> for ImageTestFailure {
    fn from(error: crate::Error) -> Self {
        Self { message: error.to_string(), report: None }
    }
}

/// What a test came to.
pub type TestResult = Result<Passed, ImageTestFailure>;

impl ImageTest {
    /// A test that keeps its pictures in `tests/goldens` of the package, and evidence in
    /// `target/image-tests`. The name stands in file names.
    pub fn new(name: &str) -> Self {
        let package = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from).unwrap_or_default();
        let output = env::var_os("STERADIAN_TEST_OUTPUT").map(PathBuf::from);
        let blessing = match env::var("STERADIAN_BLESS").as_deref() {
            Ok("new") => Blessing::New,
            Ok("" | "0") | Err(_) => Blessing::Off,
            Ok(_) => Blessing::Replace,
        };
        Self {
            name: name.to_owned(),
            references: package.join("tests/goldens"),
            output: output.unwrap_or_else(|| package.join("target/image-tests")),
            blessing,
            requires_golden: env::var_os("STERADIAN_REQUIRE_GOLDEN").is_some_and(|v| v != "0"),
        }
    }

    /// Another folder of goldens and references.
    pub fn references_in(mut self, folder: impl AsRef<Path>) -> Self {
        self.references = folder.as_ref().to_owned();
        self
    }

    /// Another folder for the evidence of failures.
    pub fn output_in(mut self, folder: impl AsRef<Path>) -> Self {
        self.output = folder.as_ref().to_owned();
        self
    }

    /// Whether to store, in place of what the environment says.
    pub fn blessing(mut self, blessing: Blessing) -> Self {
        self.blessing = blessing;
        self
    }

    /// Whether a driver without a golden fails, in place of what the environment says.
    pub fn requires_golden(mut self, requires: bool) -> Self {
        self.requires_golden = requires;
        self
    }

    /// Asserts that all pictures, each with the name of the way that it was made, have the bits of the
    /// first one.
    ///
    /// # Errors
    /// Where one differs, or there are fewer than two.
    pub fn same_bytes(&self, ways: &[(&str, &Rendered)]) -> TestResult {
        let [(first_name, first), others @ ..] = ways else { return Err(too_few()) };
        if others.is_empty() {
            return Err(too_few());
        }
        for (name, picture) in others {
            if !picture.has_bits_of(first) {
                let message = format!("{}: {name} differs from {first_name}", self.name);
                return Err(self.keep(&message, picture, first, &ComparisonOptions::default()));
            }
        }
        Ok(Passed::Compared)
    }
}

fn too_few() -> ImageTestFailure {
    ImageTestFailure { message: "same_bytes needs two pictures at least".into(), report: None }
}
