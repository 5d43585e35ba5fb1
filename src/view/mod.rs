//! Views: what a scene and a render are like, in numbers and in false colours.

mod colors;
mod of_film;
mod of_first_hits;

pub use of_film::of_film;
pub use of_first_hits::of_first_hits;

use crate::image::{Layer, Picture};

/// What can be shown instead of light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// Shading normals, on the viewer's side.
    Normals,
    /// Geometric normals, on the viewer's side.
    GeometricNormals,
    /// Base colours.
    Albedo,
    /// Distance along the ray, metres.
    Depth,
    /// Texture coordinates, set 0.
    Uv,
    /// Index of the material.
    Material,
    /// What the walk through the tree costs.
    NodeVisits,
    /// Samples of each pixel.
    SampleCount,
    /// Standard error of the mean luminance.
    StandardError,
    /// Why each pixel has no more samples.
    StopReason,
    /// Samples that are not finite, or at fault in another way.
    NonFinite,
}

/// Where a [`View`] comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// [`FirstHits`](crate::passes::FirstHits): camera rays.
    FirstHits,
    /// [`Film`](crate::film::Film): a render.
    Film,
}

/// A view of a picture's pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewPicture {
    /// False colours, linear: the sRGB transfer function gives what is meant to be seen.
    pub picture: Picture,
    /// What the colours mean, in a line.
    pub legend: String,
    /// The numbers.
    pub layer: Layer,
}

impl View {
    /// All of them.
    pub const ALL: [View; 11] = [
        View::Normals,
        View::GeometricNormals,
        View::Albedo,
        View::Depth,
        View::Uv,
        View::Material,
        View::NodeVisits,
        View::SampleCount,
        View::StandardError,
        View::StopReason,
        View::NonFinite,
    ];

    /// Where it comes from.
    pub fn source(self) -> Source {
        match self {
            View::SampleCount | View::StandardError | View::StopReason | View::NonFinite => {
                Source::Film
            }
            _ => Source::FirstHits,
        }
    }

    /// The layer of its numbers in a file.
    fn layer_name(self) -> &'static str {
        match self {
            View::Normals => "normals",
            View::GeometricNormals => "geometric_normals",
            View::Albedo => "albedo",
            View::Depth => "depth",
            View::Uv => "uv",
            View::Material => "material",
            View::NodeVisits => "node_visits",
            View::SampleCount => "sample_count",
            View::StandardError => "standard_error",
            View::StopReason => "stop_reason",
            View::NonFinite => "faults",
        }
    }
}
