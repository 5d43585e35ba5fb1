//! From a picture's radiance to the colours of a display.

use super::{ToneCurve, srgb_from_linear};
use rayon::prelude::*;
use std::sync::LazyLock;

/// In place of a pixel that is not finite, which no picture file for displays can hold.
const NOT_FINITE: [u8; 3] = [255, 0, 255];

/// Exposure and tone curve.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DisplayTransform {
    /// Exposure in stops: radiance is multiplied by 2 to this power.
    pub exposure_ev: f32,
    /// What follows.
    pub tone_curve: ToneCurve,
}

impl DisplayTransform {
    /// Linear display colour, each component in [0, 1], of radiance in linear Rec. 709; NaN where
    /// a component is NaN.
    pub fn linear(&self, rgb: [f32; 3]) -> [f32; 3] {
        self.tone_curve.map(rgb.map(|value| value * self.scale()))
    }

    /// No more than the largest number: 0 stays 0.
    fn scale(&self) -> f32 {
        self.exposure_ev.exp2().min(f32::MAX)
    }

    /// sRGB with 8 bits and full alpha, the very bytes that [`write_png`](super::write_png)
    /// stores; magenta for a pixel that is not finite. On all threads.
    pub fn srgb8(&self, rgb: &[[f32; 3]]) -> Vec<[u8; 4]> {
        let (scale, codes) = (self.scale(), &*CODES);
        let encode = |pixel: &[f32; 3]| {
            let is_finite = pixel.iter().all(|value| value.is_finite());
            let [r, g, b] = if is_finite {
                self.tone_curve.map(pixel.map(|value| value * scale)).map(|v| codes.of(v))
            } else {
                NOT_FINITE
            };
            [r, g, b, 255]
        };
        rgb.par_iter().with_min_len(4096).map(encode).collect()
    }
}

/// Numbers of [0, 1] are told apart by their leading bits: 7 of the mantissa. Then few
/// buckets hold more than one code.
const BUCKET_SHIFT: u32 = f32::MANTISSA_DIGITS - 1 - 7;

/// Codes by linear value: a table instead of a power, a tenth of the time.
struct Codes {
    /// Code of the smallest number of a bucket.
    first: Vec<u8>,
    /// Bits of the smallest number of each code; beyond the last there is none.
    least: [u32; 257],
}

static CODES: LazyLock<Codes> = LazyLock::new(|| {
    let one = 1.0_f32.to_bits();
    let code = |bits: u32| srgb8_by_formula(f32::from_bits(bits));
    // Positive floats are ordered as their bits are.
    let least_of = |wanted: usize| {
        let (mut low, mut high) = (0, one);
        while low < high {
            let middle = low + (high - low) / 2;
            if usize::from(code(middle)) >= wanted { high = middle } else { low = middle + 1 }
        }
        low
    };
    Codes {
        first: (0..=one >> BUCKET_SHIFT).map(|bucket| code(bucket << BUCKET_SHIFT)).collect(),
        least: std::array::from_fn(|k| if k < 256 { least_of(k) } else { u32::MAX }),
    }
});

fn srgb8_by_formula(linear: f32) -> u8 {
    (srgb_from_linear(linear) * 255.0).round() as u8
}

impl Codes {
    /// [`srgb8_by_formula`] for a number of [0, 1].
    fn of(&self, linear: f32) -> u8 {
        // -0 is 0.
        let bits = (linear + 0.0).to_bits();
        let mut code = self.first[(bits >> BUCKET_SHIFT) as usize];
        while bits >= self.least[usize::from(code) + 1] {
            code += 1;
        }
        code
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{BitDepth, Picture, PngOptions, write_png};

    /// Where codes change, and a sample of everything between.
    #[test]
    fn the_table_is_the_formula() {
        let one = 1.0_f32.to_bits();
        let at_steps = CODES.least[..256].iter().flat_map(|&bits| {
            let range = bits.saturating_sub(3)..=(bits + 3).min(one);
            range.collect::<Vec<_>>()
        });
        for bits in at_steps.chain((0..=one).step_by(4099)).chain([one]) {
            let linear = f32::from_bits(bits);
            assert_eq!(CODES.of(linear), srgb8_by_formula(linear), "{linear}");
        }
        assert_eq!([-0.0, 0.0, 1.0].map(|v| CODES.of(v)), [0, 0, 255]);
    }

    #[test]
    fn the_bytes_are_those_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let rgb: Vec<[f32; 3]> = (0..64 * 64)
            .map(|i| [i as f32 / 800.0, (i % 64) as f32 / 64.0, 1.0 / (i + 1) as f32])
            .collect();
        let picture = Picture::new(64, 64, rgb);
        for tone_curve in ToneCurve::ALL {
            let exposure_ev = -0.7;
            let options = PngOptions { exposure_ev, tone_curve, ..PngOptions::default() };
            assert_eq!(options.depth, BitDepth::Eight);
            write_png(&path, &picture, &options).unwrap();
            let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
            let mut reader = ::png::Decoder::new(file).read_info().unwrap();
            let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut bytes).unwrap();
            let shown = DisplayTransform { exposure_ev, tone_curve }.srgb8(&picture.rgb);
            let shown: Vec<u8> = shown.iter().flat_map(|c| [c[0], c[1], c[2]]).collect();
            assert!(shown == bytes, "{tone_curve:?}");
        }
    }

    #[test]
    fn what_is_not_finite_is_magenta() {
        let transform = DisplayTransform { exposure_ev: 200.0, tone_curve: ToneCurve::Agx };
        let pixels = [[f32::NAN, 0.0, 0.0], [0.0, f32::INFINITY, 0.0], [0.0; 3], [1e-3; 3]];
        let shown = transform.srgb8(&pixels);
        assert_eq!(shown[0], [255, 0, 255, 255]);
        assert_eq!(shown[1], shown[0]);
        assert_eq!(shown[2], [0, 0, 0, 255]);
        assert_eq!(shown[3], [255; 4]);
    }
}
