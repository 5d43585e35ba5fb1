//! Sobol direction numbers, and the WGSL that multiplies by them.

use std::fmt::Write;

/// Degree, coefficients and initial numbers of the primitive polynomials of
/// dimensions 1 to 7 (Joe and Kuo 2008, table new-joe-kuo-6.21201). Dimension 0 is
/// van der Corput's.
const POLYNOMIALS: [(u32, u32, &[u32]); 7] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
];

/// Direction numbers of a dimension: entry i is what bit i of the index adds,
/// as a fraction of 2^32.
pub(super) fn direction_numbers(dimension: usize) -> [u32; 32] {
    let mut v = [0_u32; 32];
    if dimension == 0 {
        return std::array::from_fn(|i| 1 << (31 - i));
    }
    let (degree, coefficients, initial) = POLYNOMIALS[dimension - 1];
    let s = degree as usize;
    for i in 0..32 {
        v[i] = if i < s {
            initial[i] << (31 - i)
        } else {
            // Joe and Kuo 2008, equation 2, on numbers already shifted up.
            let mut next = v[i - s] ^ (v[i - s] >> s);
            for k in 1..s {
                if coefficients >> (s - 1 - k) & 1 == 1 {
                    next ^= v[i - k];
                }
            }
            next
        };
    }
    v
}

/// `sobol_D(index)` for dimensions 1 to 7: the coordinate of the point `index` with
/// its bits reversed.
pub(super) fn wgsl() -> String {
    let mut text = String::new();
    for dimension in 1..=POLYNOMIALS.len() {
        writeln!(text, "fn sobol_{dimension}(index: u32) -> u32 {{\n    var x = 0u;").unwrap();
        for (bit, v) in direction_numbers(dimension).iter().enumerate() {
            let reversed = v.reverse_bits();
            writeln!(text, "    x ^= {reversed:#x}u & (0u - ((index >> {bit}u) & 1u));").unwrap();
        }
        writeln!(text, "    return x;\n}}").unwrap();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(dimension: usize, index: u32) -> u32 {
        let v = direction_numbers(dimension);
        (0..32).filter(|b| index >> b & 1 == 1).fold(0, |x, b| x ^ v[b])
    }

    /// Every elementary interval of volume 2^-m in one dimension holds one of 2^m
    /// points, also far along the sequence.
    #[test]
    fn each_dimension_is_stratified() {
        for dimension in 0..8 {
            for start in [0_u32, 1 << 20] {
                let mut cells = [0_u32; 1024];
                for i in 0..1024 {
                    cells[(point(dimension, start + i) >> 22) as usize] += 1;
                }
                assert!(cells.iter().all(|&c| c == 1), "dimension {dimension} from {start}");
            }
        }
    }

    /// The first two dimensions are a (0, m, 2)-net: all shapes of cell.
    #[test]
    fn the_first_pair_is_a_net() {
        for shape in 0..=8 {
            let mut cells = [0_u32; 256];
            for i in 0..256 {
                let x = u64::from(point(0, i)) << shape >> 32;
                let y = u64::from(point(1, i)) << (8 - shape) >> 32;
                cells[(x << (8 - shape) | y) as usize] += 1;
            }
            assert!(cells.iter().all(|&c| c == 1), "2^{shape} columns");
        }
    }

    /// Published first points of the sequence, which are in the order of the Gray code.
    #[test]
    fn matches_the_published_sequence() {
        let third: Vec<f64> =
            (0..8).map(|i| f64::from(point(2, i ^ i >> 1)) / 4_294_967_296.0).collect();
        assert_eq!(third, [0.0, 0.5, 0.25, 0.75, 0.625, 0.125, 0.875, 0.375]);
    }
}
