//! Whether two picture files of known noise show the same thing.
//!
//! As in [`super::PictureComparison`], up to four tests a channel look for a difference of four kinds:
//! in the mean of the whole, in a tile, in one pixel, and in many pixels at once. It differs in
//! what it takes for the noise, because a file of one render knows little of it: the pieces of a
//! render with few samples are few, they tell of the luminance only, and a pixel that has not met
//! a rare light looks certain of too small a mean. So there are two views of the noise:
//!
//! - *shown*: each picture's own variance;
//! - *predicted*: the picture of more samples tells, sample by sample, what to expect of the other.
//!   Where it consists of independent runs of no more samples than the other has (a reference made
//!   for it), the prediction has its exact distribution, Student's t. Where it is one longer render,
//!   its points are more even than those of the shorter one, and it predicts too little.
//!
//! In red, green and blue a file of one render knows the noise of its luminance only. That does for
//! the mean and for tiles. Single pixels are tested in luminance: a rare red path in a green
//! pixel would hardly show in it.
//!
//! A difference counts only where it is beyond both. A rare light that one pixel met is explained by
//! the noise that the pixel shows, one that it missed by the noise that the reference predicts.
//!
//! Too small a variance raises alarms, too large a one does not: pictures may share their random
//! numbers, and variances may be overestimated. For that, many pixels at once are judged by their
//! share of small p-values only, where [`super::PictureComparison`] asks for a uniform distribution.

mod plane;

use super::PictureFile;
use super::noise::{LUMINANCE, Noise};
use crate::statistics::sidak;
use plane::{Input, Term};
pub use plane::{PixelFinding, PlaneVerdict};
use serde::Serialize;

/// What is asked of the verdict.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VerdictSettings {
    /// Rate of false alarms of the whole comparison.
    pub level: f64,
    /// Pixels along the side of a tile.
    pub tile: u32,
    /// Relative difference that rounding explains.
    pub rounding: f64,
}

impl Default for VerdictSettings {
    /// One false alarm in 1000 comparisons, tiles of 8 x 8 pixels, and for the rounding of a
    /// render in f32 128 units of 2^-24.
    fn default() -> Self {
        Self { level: 1e-3, tile: 8, rounding: 128.0 / 16_777_216.0 }
    }
}

/// What the statistical comparison of two files found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseVerdict {
    /// No test found a difference.
    pub agrees: bool,
    /// Chance of a finding as improbable as the least probable one, over all tests together,
    /// between pictures of the same thing.
    pub p_value: f64,
    /// Rate of false alarms that was asked for.
    pub level: f64,
    /// What the noise was taken from.
    pub basis: &'static str,
    /// Pixels along the side of a tile.
    pub tile: u32,
    /// Columns of tiles.
    pub tile_columns: u32,
    /// Red, green and blue, or the luminance alone.
    pub planes: Vec<PlaneVerdict>,
}

impl NoiseVerdict {
    /// Compares the colours of two files of the same size and window. `None` where one of them
    /// has no colour or no noise.
    pub fn of(
        actual: &PictureFile,
        expected: &PictureFile,
        settings: &VerdictSettings,
    ) -> Option<Self> {
        let (a, b) = (actual.picture()?, expected.picture()?);
        let (noise_a, noise_b) = (actual.noise.as_ref()?, expected.noise.as_ref()?);
        let prediction = Prediction::of(noise_a, noise_b);
        let planes = prediction.planes();
        let tests: usize = planes.iter().map(|plane| if plane.has_pixels { 4 } else { 2 }).sum();
        let planes = planes.into_iter().map(|plane| {
            let value = |p: &[f32; 3]| match plane.channel {
                Some(c) => f64::from(p[c]),
                None => (0..3).map(|k| LUMINANCE[k] * f64::from(p[k])).sum(),
            };
            let input = Input {
                name: plane.name,
                actual: a.rgb.iter().map(value).collect(),
                reference: b.rgb.iter().map(value).collect(),
                views: prediction.views(plane.channel, a.rgb.len()),
                width: a.width,
                height: a.height,
                has_pixels: plane.has_pixels,
            };
            PlaneVerdict::of(&input, settings, sidak(settings.level, tests))
        });
        let planes: Vec<PlaneVerdict> = planes.collect();
        let least = planes.iter().map(PlaneVerdict::least_p).fold(1.0, f64::min);
        Some(Self {
            agrees: planes.iter().all(|plane| plane.alarms.is_empty()),
            // 1 - (1 - p)^tests, without loss of digits.
            p_value: -(tests as f64 * (-least).ln_1p()).exp_m1(),
            level: settings.level,
            basis: prediction.basis(),
            tile: settings.tile,
            tile_columns: a.width.div_ceil(settings.tile),
            planes,
        })
    }

    /// The largest share of the picture's mean, over its channels, of which a bias could stay
    /// unseen: a larger one raises an alarm with probability 0.84 or more.
    pub fn visible_bias(&self) -> f64 {
        self.planes.iter().map(|plane| plane.visible_bias).fold(0.0, f64::max)
    }
}

/// What is compared: a channel, or the luminance.
struct Plane {
    name: &'static str,
    channel: Option<usize>,
    has_pixels: bool,
}

/// How the noise of two pictures is told.
struct Prediction<'a> {
    a: &'a Noise,
    b: &'a Noise,
    /// The one that predicts the other, and the other.
    roles: Option<(&'a Noise, &'a Noise)>,
    /// The prediction has Student's distribution.
    is_exact: bool,
    /// In three channels, not in luminance alone.
    in_color: bool,
}

impl<'a> Prediction<'a> {
    fn of(a: &'a Noise, b: &'a Noise) -> Self {
        let known = a.samples(0).zip(b.samples(0));
        let roles = match (a, b) {
            // Both are known well.
            (Noise::Runs { .. }, Noise::Runs { .. }) => None,
            (Noise::Runs { .. }, _) => known.map(|_| (a, b)),
            (_, Noise::Runs { .. }) => known.map(|_| (b, a)),
            _ => known.map(|(n_a, n_b)| if n_a > n_b { (a, b) } else { (b, a) }),
        };
        let is_exact = match roles {
            Some((Noise::Runs { spp: Some(spp), .. }, Noise::Pieces { samples, .. })) => {
                samples.iter().all(|n| n >= spp)
            }
            _ => false,
        };
        let in_color = match (a, b, roles) {
            (Noise::Runs { .. }, Noise::Runs { .. }, _) => true,
            (_, _, Some((Noise::Runs { luminance, .. }, _))) => luminance.is_some(),
            _ => false,
        };
        Self { a, b, roles, is_exact, in_color }
    }

    fn planes(&self) -> Vec<Plane> {
        let channel = |(c, name), has_pixels| Plane { name, channel: Some(c), has_pixels };
        let channels = || ["red", "green", "blue"].into_iter().enumerate();
        let luminance = Plane { name: "luminance", channel: None, has_pixels: true };
        match (self.in_color, self.roles) {
            // Every channel's noise is known.
            (true, None) => channels().map(|c| channel(c, true)).collect(),
            (true, Some(_)) => channels().map(|c| channel(c, false)).chain([luminance]).collect(),
            (false, _) => vec![luminance],
        }
    }

    fn basis(&self) -> &'static str {
        match (self.roles, self.is_exact) {
            (None, _) if self.in_color => "independent runs of both",
            (None, _) => "the noise that each shows",
            (Some(_), true) => "independent runs of the reference, and the noise that each shows",
            (Some(_), false) => "the longer render, and the noise that each shows",
        }
    }

    /// The views of the noise of a channel, or of the luminance.
    fn views(&self, channel: Option<usize>, pixels: usize) -> Vec<Vec<Term>> {
        let variance = |noise: &Noise, i: usize| match (noise, channel) {
            (Noise::Runs { variance, .. }, Some(c)) => variance[i][c],
            (Noise::Pieces { .. }, Some(c)) => noise.luminance(i) * self.channel_share(c, i),
            (_, None) => noise.luminance(i),
        };
        let shown = |noise: &Noise| Term {
            variance: (0..pixels).map(|i| variance(noise, i)).collect(),
            degrees: noise.degrees(),
        };
        let mut views = vec![vec![shown(self.a), shown(self.b)]];
        if let Some((long, short)) = self.roles {
            let predicted = |i: usize| {
                let ratio = long.samples(i).zip(short.samples(i)).map_or(1.0, |(l, s)| l / s);
                variance(long, i) * (1.0 + ratio)
            };
            let variance = (0..pixels).map(predicted).collect();
            views.push(vec![Term { variance, degrees: long.degrees() }]);
        }
        views
    }

    /// Variance of a channel over that of the luminance, as the reference has it.
    fn channel_share(&self, c: usize, i: usize) -> f64 {
        match self.roles {
            Some((Noise::Runs { variance, luminance: Some(luminance), .. }, _))
                if luminance[i] > 0.0 =>
            {
                variance[i][c] / luminance[i]
            }
            // All of the luminance's noise may be this channel's.
            _ => LUMINANCE[c].powi(-2),
        }
    }
}
