//! Random numbers: each a pure function of (seed, pixel, sample, how many were drawn before).

use std::f64::consts::TAU;

/// Odd, near 2^64 over the golden ratio: the step of Steele, Lea and Flood's SplitMix (2014).
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

/// The numbers of one sample.
#[derive(Debug, Clone)]
pub(super) struct Random {
    state: u64,
}

/// A bijection of 64 bits in which every bit of the input moves about half of the output:
/// the finaliser of SplitMix64.
fn scramble(mut bits: u64) -> u64 {
    bits = (bits ^ bits >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    bits ^ bits >> 31
}

impl Random {
    /// `pixel`: column and row in the whole picture.
    pub(super) fn new(seed: u32, pixel: (u32, u32), sample: u32) -> Self {
        let words = [u64::from(seed), u64::from(pixel.0) << 32 | u64::from(pixel.1), sample.into()];
        // Scrambled between the words, so that no two triples begin near each other.
        Self {
            state: words.iter().fold(0, |state, word| scramble((state ^ word).wrapping_add(STEP))),
        }
    }

    /// Uniform in [0, 1), a multiple of 2^-53.
    pub(super) fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(STEP);
        (scramble(self.state) >> 11) as f64 * 2.0_f64.powi(-53)
    }

    /// Uniform in the unit disk, by area.
    pub(super) fn disk(&mut self) -> (f64, f64) {
        let (radius, angle) = (self.uniform().sqrt(), TAU * self.uniform());
        (radius * angle.cos(), radius * angle.sin())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Chi-square over 4 by 4 cells of neighbouring numbers, and over the first numbers of
    /// neighbouring samples, pixels and seeds. 15 degrees of freedom: 1e-4 of all lie above 44.3.
    #[test]
    fn numbers_are_uniform_within_a_sample_and_between_samples() {
        let first = |seed, x, sample| Random::new(seed, (x, 7), sample).uniform();
        let mut one = Random::new(1, (2, 3), 4);
        let count = 1 << 14;
        type Pairs<'a> = Box<dyn FnMut(u32) -> [f64; 2] + 'a>;
        let cases: [(&str, Pairs); 4] = [
            ("one sample", Box::new(|_| [one.uniform(), one.uniform()])),
            ("samples", Box::new(|k| [first(0, 0, 2 * k), first(0, 0, 2 * k + 1)])),
            ("pixels", Box::new(|k| [first(0, 2 * k, 0), first(0, 2 * k + 1, 0)])),
            ("seeds", Box::new(|k| [first(2 * k, 0, 0), first(2 * k + 1, 0, 0)])),
        ];
        for (what, mut pair) in cases {
            let mut cells = [0_u32; 16];
            for k in 0..count {
                let [a, b] = pair(k).map(|u| (u * 4.0) as usize);
                cells[4 * a + b] += 1;
            }
            let expected = f64::from(count) / 16.0;
            let deviation = |&n: &u32| (f64::from(n) - expected).powi(2) / expected;
            let chi_square: f64 = cells.iter().map(deviation).sum();
            assert!(chi_square < 44.3, "{what}: {chi_square}");
        }
    }
}
