//! Speed against error: what `steradian bench` measures, without a device.
//!
//! A [`Curve`] is a method's runs at several numbers of samples: errors and seconds. From it come
//! seconds to an error, the error after a time, slopes, and ratios of methods whose rounds took
//! turns, each with an interval over the runs ([`resample`]). A [`Reference`] is the picture that
//! errors are measured against, and knows its own variance. A [`Section`] is what is reported, as
//! Markdown and as one page with plots.

mod curve;
mod document;
mod errors;
mod growth;
mod page;
mod plot;
mod reference;
mod resample;
pub mod scenes;

pub use crate::stopping::coverage::Interval;
pub use curve::{Clock, Curve, Point, Reading, Run, ratio};
pub use document::{Figure, Section, Table, markdown};
pub use errors::PictureErrors;
pub use growth::{PowerLaw, power_law};
pub use page::page;
pub use plot::{Plot, PlotPoint, Series};
pub use reference::{Difference, Reference, ReferenceParts};
pub use resample::{RESAMPLES, median, resample};
