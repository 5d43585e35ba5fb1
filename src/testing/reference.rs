//! Statistical tests: references of many runs, with their variances.

use super::evidence::make_folder;
use super::{Blessing, ImageTest, ImageTestFailure, Passed, Rendered, TestResult};
use crate::Result;
use crate::image::compare::{ComparisonOptions, NoisyPicture, Rule, VerdictSettings};
use crate::image::{ChannelData, ExrImage, Layer, Precision, write_exr};
use crate::statistics::FALSE_ALARM;
use std::path::Path;

/// Runs of a reference. With 64 its own noise adds 1.6 % to the variance of a difference, and
/// Student's t is close to normal.
const RUNS: u32 = 64;

impl ImageTest {
    /// Asserts that `render(seed)` for seed 0 is the stored reference within noise (at one false alarm
    /// in 10,000), and that a bias of the mean of `visible_bias`, relative to it, would show. A
    /// reference is made of `render(1)` to `render(64)`, of as many samples each.
    ///
    /// # Errors
    /// Where it is not, and where there is no reference.
    pub fn statistical(
        &self,
        visible_bias: f64,
        mut render: impl FnMut(u32) -> Rendered,
    ) -> TestResult {
        let path = self.references.join(format!("{}.exr", self.name));
        if self.blessing != Blessing::Off {
            make_folder(&self.references)?;
            let runs: Vec<Rendered> = (1..=RUNS).map(render).collect();
            write_reference(&path, &runs)?;
            return Ok(Passed::Blessed);
        }
        if !path.exists() {
            let path = path.display();
            let message = format!(
                "{}: there is no reference {path}; STERADIAN_BLESS=1 makes one of {RUNS} runs",
                self.name
            );
            return Err(ImageTestFailure { message, report: None });
        }
        let visible = Rule::Limit { layer: None, metric: "visible".into(), below: visible_bias };
        let options = ComparisonOptions {
            rules: vec![Rule::Verdict, visible],
            verdict: VerdictSettings { level: FALSE_ALARM, ..VerdictSettings::default() },
            ..ComparisonOptions::default()
        };
        self.judge(&render(0), &path, &options, "is not its reference")?;
        Ok(Passed::Compared)
    }
}

/// Writes the mean of independent runs of one scene, each with its own seed, with the variance of
/// that mean in layer `variance` (`R`, `G`, `B`, and `Y` for the luminance), and attribute
/// `runs`. Metadata is that of the first run; `steradian.spp` is that of one run.
///
/// # Errors
/// [`crate::Error::Io`].
///
/// # Panics
/// With fewer than two runs, or of different sizes.
pub fn write_reference(path: &Path, runs: &[Rendered]) -> Result<()> {
    let pictures: Vec<_> = runs.iter().map(Rendered::picture).collect();
    let noisy = NoisyPicture::of_runs(&pictures);
    let mut image = ExrImage::from_picture(&noisy.mean_picture());
    let channel = |c: usize| ChannelData::F32(noisy.variance.iter().map(|v| v[c] as f32).collect());
    let mut channels: Vec<_> =
        ["R", "G", "B"].iter().enumerate().map(|(c, n)| ((*n).to_owned(), channel(c))).collect();
    let luminance = NoisyPicture::luminance_variance(&pictures);
    let luminance = luminance.iter().map(|&v| v as f32).collect();
    channels.push(("Y".into(), ChannelData::F32(luminance)));
    image.layers.push(Layer { name: "variance".into(), channels });
    image = runs[0].copy_metadata(image);
    image.metadata.remove("steradian.seed");
    image.metadata.insert("runs".into(), crate::image::Attribute::Text(runs.len().to_string()));
    write_exr(path, &image, Precision::Float)
}
