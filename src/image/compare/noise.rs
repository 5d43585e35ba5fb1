//! What a picture's file says of its noise.

use crate::film::runs;
use crate::image::{ChannelData, ExrImage};
use std::collections::BTreeMap;

/// Weights of red, green and blue in luminance, Rec. 709.
pub(super) const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// The variance of every pixel's mean, and what it was estimated from.
#[derive(Debug, Clone, PartialEq)]
pub enum Noise {
    /// Independent runs, each with a seed of its own: channels `variance.R`, `variance.G`,
    /// `variance.B` and attribute `runs`.
    Runs {
        /// Of the mean of all runs, in every channel.
        variance: Vec<[f64; 3]>,
        /// Of the luminance (channel `variance.Y`), where it is known.
        luminance: Option<Vec<f64>>,
        /// How many there were, at least 2.
        runs: u32,
        /// Samples per pixel of one run, where this renderer made them (attribute
        /// `steradian.spp`): then one run tells what to expect of a picture.
        spp: Option<u32>,
    },
    /// Consecutive pieces of one render: channels `noise.standard_error` (of the luminance) and
    /// `noise.samples`, attribute `steradian.block`.
    Pieces {
        /// Of the luminance.
        variance: Vec<f64>,
        /// Pieces of the pixel that has fewest, at least 2.
        pieces: u32,
        /// Samples of every pixel.
        samples: Vec<u32>,
    },
}

impl Noise {
    /// From a file's layers; `None` where it has none of either kind, or its pixels share paths.
    pub(super) fn of(
        image: &ExrImage,
        metadata: &BTreeMap<String, String>,
    ) -> Result<Option<Self>, String> {
        // Errors that are alike in neighbouring pixels are not what the verdict takes them for.
        if metadata.get("steradian.path_reuse").is_some_and(|shared| shared == "true") {
            return Ok(None);
        }
        let floats = |layer, name| match image.channel(layer, name) {
            Some(ChannelData::F32(values)) => Some(values),
            _ => None,
        };
        let number = |name: &str| metadata.get(name).and_then(|text| text.parse::<u32>().ok());
        let wide = |values: &[f32], name: &str| -> Result<Vec<f64>, String> {
            match values.iter().position(|&v| !(v >= 0.0 && v.is_finite())) {
                Some(i) => Err(format!("{name} of pixel {i} is {}, no variance", values[i])),
                None => Ok(values.iter().map(|&v| f64::from(v)).collect()),
            }
        };
        let channels = ["R", "G", "B"].map(|name| floats("variance", name));
        if let [Some(r), Some(g), Some(b)] = channels {
            let runs = number("runs").filter(|&n| n > 1);
            let runs = runs.ok_or("has a layer variance, but no attribute runs of 2 or more")?;
            let (r, g, b) =
                (wide(r, "variance.R")?, wide(g, "variance.G")?, wide(b, "variance.B")?);
            let variance = r.iter().zip(&g).zip(&b).map(|((&r, &g), &b)| [r, g, b]).collect();
            let luminance = floats("variance", "Y").map(|y| wide(y, "variance.Y")).transpose()?;
            return Ok(Some(Self::Runs {
                variance,
                luminance,
                runs,
                spp: number("steradian.spp"),
            }));
        }
        let error = floats("noise", "standard_error");
        let (Some(error), Some(ChannelData::U32(samples)), Some(block)) =
            (error, image.channel("noise", "samples"), number("steradian.block"))
        else {
            return Ok(None);
        };
        let error = wide(error, "noise.standard_error")?;
        let (_, pieces) = runs(samples.iter().min().copied().unwrap_or(0) / block.max(1));
        if pieces < 2 {
            return Ok(None);
        }
        let variance = error.iter().map(|e| e * e).collect();
        Ok(Some(Self::Pieces { variance, pieces: pieces as u32, samples: samples.clone() }))
    }

    /// Degrees of freedom of each variance.
    pub(super) fn degrees(&self) -> f64 {
        match self {
            Self::Runs { runs, .. } => f64::from(*runs) - 1.0,
            Self::Pieces { pieces, .. } => f64::from(*pieces) - 1.0,
        }
    }

    /// Samples behind the mean of a pixel, where they are known.
    pub(super) fn samples(&self, pixel: usize) -> Option<f64> {
        match self {
            Self::Runs { runs, spp, .. } => spp.map(|spp| f64::from(spp) * f64::from(*runs)),
            Self::Pieces { samples, .. } => Some(f64::from(samples[pixel])),
        }
    }

    /// Variance of a pixel's luminance. Where runs give their channels alone, the largest that
    /// these allow: all three in step.
    pub(super) fn luminance(&self, pixel: usize) -> f64 {
        match self {
            Self::Pieces { variance, .. } => variance[pixel],
            Self::Runs { luminance: Some(luminance), .. } => luminance[pixel],
            Self::Runs { variance, .. } => {
                let deviation = |c: usize| LUMINANCE[c] * variance[pixel][c].sqrt();
                (0..3).map(deviation).sum::<f64>().powi(2)
            }
        }
    }
}
