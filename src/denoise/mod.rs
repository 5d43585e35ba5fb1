//! Noise taken out of a finished picture: a guess, beside the picture and never in its place.

mod oidn;

pub use oidn::{LIBRARY_VARIABLE, Oidn};

use crate::image::{ChannelData, Layer};

/// What helps a denoiser to tell noise from detail; one value for each pixel.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Guides {
    /// Base colour; black where nothing is hit.
    pub albedo: Vec<[f32; 3]>,
    /// Shading normal; 0 where nothing is hit.
    pub normal: Vec<[f32; 3]>,
}

impl Guides {
    /// From the layers `albedo`, `N` and `coverage`: the background counts with its share.
    /// `None` where one is missing.
    pub fn from_layers(layers: &[Layer]) -> Option<Self> {
        let channel = |layer: &str, name: &str| {
            let layer = layers.iter().find(|l| l.name == layer)?;
            match layer.channels.iter().find(|(n, _)| n == name)? {
                (_, ChannelData::F32(values)) => Some(values),
                _ => None,
            }
        };
        let coverage = channel("coverage", "A")?;
        let of = |layer, names: [&str; 3]| {
            let [x, y, z] = names.map(|name| channel(layer, name));
            let (x, y, z) = (x?, y?, z?);
            let pixel = |(i, share): (usize, &f32)| [x[i] * share, y[i] * share, z[i] * share];
            Some(coverage.iter().enumerate().map(pixel).collect())
        };
        Some(Self { albedo: of("albedo", ["R", "G", "B"])?, normal: of("N", ["X", "Y", "Z"])? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_background_is_black_in_guides() {
        let layer = |name: &str, channels: &[&str], values: [f32; 2]| {
            let channels = channels.iter();
            let channels = channels.map(|c| ((*c).into(), ChannelData::F32(values.to_vec())));
            Layer { name: name.into(), channels: channels.collect() }
        };
        let mut layers = vec![
            layer("albedo", &["R", "G", "B"], [0.5, 0.25]),
            layer("N", &["X", "Y", "Z"], [1.0, -1.0]),
            layer("coverage", &["A"], [0.5, 0.0]),
        ];
        let guides = Guides::from_layers(&layers).unwrap();
        assert_eq!(
            (guides.albedo, guides.normal),
            (vec![[0.25; 3], [0.0; 3]], vec![[0.5; 3], [-0.0; 3]])
        );
        layers.pop();
        assert_eq!(Guides::from_layers(&layers), None);
    }
}
