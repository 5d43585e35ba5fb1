//! How far pictures are from each other, and whether noise explains it.
//!
//! [`Comparison`] is the whole: two files as [`PictureFile`]s, every [`Metrics`] of every layer, the
//! [`NoiseVerdict`] where the files tell of their noise, and [`Rule`]s that decide. [`Run`] does it
//! for a folder, and [`report`] shows a run as one page. [`PictureComparison`] is the same question
//! asked of pictures in memory that consist of independent runs.

mod comparison;
mod file;
mod flip;
mod metrics;
mod noise;
mod noisy;
pub mod report;
mod rule;
mod run;
mod statistical;
mod verdict;

use flip::magma_bytes;

pub use comparison::{Comparison, ComparisonOptions, LayerComparison, Location, NonFinite};
pub use file::{PictureFile, PictureLayer};
pub use flip::{Flip, FlipExposures, hdr_flip, ldr_flip, magma};
pub use metrics::{Metrics, RelMse, mse, relmse};
pub use noise::Noise;
pub use noisy::NoisyPicture;
pub use rule::{Failure, Rule};
pub use run::{Case, CaseStatus, Outcome, Run};
pub use statistical::{ChannelComparison, ComparisonSettings, PictureComparison, Region};
pub use verdict::{NoiseVerdict, PixelFinding, PlaneVerdict, VerdictSettings};
