//! Directional albedos: integrals that are taken where they are needed, and interpolated.

use std::f64::consts::PI;
use std::sync::OnceLock;

/// Rows of the table lie at alpha = exp(-k / 16), down to the first one below 1e-3.
const ROWS: usize = 112;
/// Rows that take part in a value.
const STENCIL: usize = 8;
/// Cosines between which a row is a polynomial of the cosine's logarithm, or, in the last
/// piece, of the cosine.
const PIECES: [f64; 7] = [1e-4, 1e-2, 0.04, 0.1, 0.2, 0.5, 1.0];
/// Chebyshev points of a piece.
const NODES: usize = 10;

/// A function of a cosine in (0, 1] and of alpha in [1e-3, 1], to 1e-6 beside the error of the
/// integral itself.
/// Below a cosine of 1e-4 it is constant.
pub(super) struct AlbedoTable {
    integral: fn(f64, f64) -> f64,
    rows: [OnceLock<Vec<f64>>; ROWS],
}

impl AlbedoTable {
    pub(super) const fn new(integral: fn(f64, f64) -> f64) -> Self {
        Self { integral, rows: [const { OnceLock::new() }; ROWS] }
    }

    /// The function at a place.
    pub(super) fn at(&self, cos: f64, alpha: f64) -> f64 {
        let cos = cos.clamp(PIECES[0], 1.0);
        let piece = PIECES[1..PIECES.len() - 1].partition_point(|&end| end < cos);
        let (low, high) = ends(piece);
        let x = (2.0 * scaled(cos, piece) - low - high) / (high - low);

        let place = -16.0 * alpha.ln();
        let first = (place.floor() as isize - 3).clamp(0, (ROWS - STENCIL) as isize) as usize;
        let of_row = |k: usize| {
            let others = (first..first + STENCIL).filter(|&other| other != k);
            others.map(|other| (place - other as f64) / (k as f64 - other as f64)).product::<f64>()
        };
        let weights: Vec<_> = (first..first + STENCIL).map(|k| (k, of_row(k))).collect();
        let used = || weights.iter().filter(|(_, weight)| *weight != 0.0);
        let node = |j: usize| -> f64 {
            used().map(|&(k, weight)| weight * self.row(k)[piece * NODES + j]).sum()
        };
        // The barycentric formula for Chebyshev points of the first kind.
        let (mut above, mut below) = (0.0, 0.0);
        for j in 0..NODES {
            let distance = x - chebyshev(j);
            if distance == 0.0 {
                return node(j);
            }
            let sign = if j % 2 == 0 { 1.0 } else { -1.0 };
            let share = sign * angle(j).sin() / distance;
            above += share * node(j);
            below += share;
        }
        above / below
    }

    fn row(&self, k: usize) -> &[f64] {
        self.rows[k].get_or_init(|| {
            let alpha = (-(k as f64) / 16.0).exp();
            let places = (0..PIECES.len() - 1).flat_map(|p| (0..NODES).map(move |j| (p, j)));
            let cosine = |(piece, j): (usize, usize)| {
                let (low, high) = ends(piece);
                let x = 0.5 * (low + high + (high - low) * chebyshev(j));
                if piece + 2 == PIECES.len() { x } else { x.exp() }
            };
            places.map(|place| (self.integral)(cosine(place), alpha)).collect()
        })
    }
}

/// What a piece is a polynomial of.
fn scaled(cos: f64, piece: usize) -> f64 {
    if piece + 2 == PIECES.len() { cos } else { cos.ln() }
}

fn ends(piece: usize) -> (f64, f64) {
    (scaled(PIECES[piece], piece), scaled(PIECES[piece + 1], piece))
}

fn angle(j: usize) -> f64 {
    PI * (2 * j + 1) as f64 / (2 * NODES) as f64
}

fn chebyshev(j: usize) -> f64 {
    angle(j).cos()
}
