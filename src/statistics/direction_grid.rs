//! Histograms of directions for chi-square tests.

use super::{GoodnessOfFit, integrate_rectangle};
use std::f64::consts::{PI, TAU};

/// Relative error of a cell's probability. For N draws it adds at most N times its square
/// to the statistic: nothing beside that statistic's own spread.
const RELATIVE: f64 = 1e-5;

/// Error of a cell's probability that does not matter however small the probability is.
const ABSOLUTE: f64 = 1e-9;

/// Probability that may be missing from the cells by quadrature alone.
const MISSING: f64 = 1e-4;

/// The sphere or a cap of it, cut into cells between circles of latitude around an axis
/// and meridians. Directions need not be of unit length.
#[derive(Debug, Clone)]
pub struct DirectionGrid {
    /// Two tangents and the axis, orthonormal.
    frame: [[f64; 3]; 3],
    /// Polar angles between the rows, ascending from 0, radians.
    polar: Vec<f64>,
    columns: usize,
}

impl DirectionGrid {
    /// Rows of equal solid angle over the whole sphere.
    pub fn sphere(axis: [f64; 3], rows: usize, columns: usize) -> Self {
        let polar = |q: f64| 2.0 * q.sqrt().asin();
        Self::new(axis, (0..=rows).map(|k| polar(k as f64 / rows as f64)).collect(), columns)
    }

    /// Rows of equal solid angle over the hemisphere around `axis`. A direction below
    /// it is a miss, which the density has to account for.
    pub fn hemisphere(axis: [f64; 3], rows: usize, columns: usize) -> Self {
        let polar = |q: f64| (1.0 - q).acos();
        Self::new(axis, (0..=rows).map(|k| polar(k as f64 / rows as f64)).collect(), columns)
    }

    /// Rows over the whole sphere that narrow towards `axis`, for densities with a peak
    /// there: half of them lie within the angle `width` (radians, below π), and
    /// tan(θ/2) grows as in the distribution of GGX half vectors.
    pub fn around(axis: [f64; 3], width: f64, rows: usize, columns: usize) -> Self {
        let scale = (0.5 * width).tan();
        let polar = |q: f64| 2.0 * (scale * q.sqrt()).atan2((1.0 - q).sqrt());
        Self::new(axis, (0..=rows).map(|k| polar(k as f64 / rows as f64)).collect(), columns)
    }

    /// Rows between the angles `polar` from `axis`, ascending from 0 to at most π.
    ///
    /// # Panics
    /// If the angles are not so, or there are no cells.
    pub fn new(axis: [f64; 3], polar: Vec<f64>, columns: usize) -> Self {
        assert!(polar.len() > 1 && columns > 0, "a grid without cells");
        assert!(polar.windows(2).all(|w| w[0] < w[1]), "polar angles must ascend");
        assert!(polar[0] == 0.0 && polar[polar.len() - 1] <= PI + 1e-12, "angles from 0 to π");
        Self { frame: frame(axis), polar, columns }
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        (self.polar.len() - 1) * self.columns
    }

    /// The cell of a direction, `None` outside the grid.
    pub fn cell(&self, direction: [f64; 3]) -> Option<usize> {
        let [x, y, z] = self.frame.map(|axis| dot(axis, direction));
        // Unlike acos, exact for small angles too.
        let angle = x.hypot(y).atan2(z);
        let row = self.polar.partition_point(|&edge| edge <= angle) - 1;
        let last = self.polar.len() - 2;
        // The last edge belongs to the last row.
        let row = if angle == self.polar[last + 1] { last } else { row };
        let turn = y.atan2(x) / TAU;
        let column = ((turn - turn.floor()) * self.columns as f64) as usize;
        (row <= last).then(|| row * self.columns + column.min(self.columns - 1))
    }

    /// Draws in every cell, and draws that missed the grid or are `None`.
    pub fn count(&self, draws: impl IntoIterator<Item = Option<[f64; 3]>>) -> (Vec<u64>, u64) {
        let (mut counts, mut missed) = (vec![0; self.cell_count()], 0);
        for draw in draws {
            match draw.and_then(|direction| self.cell(direction)) {
                Some(cell) => counts[cell] += 1,
                None => missed += 1,
            }
        }
        (counts, missed)
    }

    /// Probability of every cell: the integral of `pdf` (per steradian, of unit
    /// directions) over it, computed in f64 to about 1e-5 of it.
    pub fn probabilities(&self, pdf: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
        // dω = sin θ dθ dφ.
        let density = |theta: f64, phi: f64| theta.sin() * pdf(self.direction(theta, phi));
        let step = TAU / self.columns as f64;
        let mut cells = Vec::with_capacity(self.cell_count());
        for row in self.polar.windows(2) {
            for column in 0..self.columns {
                let phi = (column as f64 * step, (column + 1) as f64 * step);
                let theta = (row[0], row[1]);
                cells.push(integrate_rectangle(&density, theta, phi, RELATIVE, ABSOLUTE));
            }
        }
        cells
    }

    /// Tests that `draws` have the density `pdf`, per steradian of unit directions.
    /// `None`, and a direction outside the grid, is a failed draw: what `pdf` leaves
    /// of 1 is its probability, so a density that is too small everywhere fails. One that
    /// integrates to more than 1 fails in [`GoodnessOfFit::expected_share`].
    ///
    /// Where `pdf` is 0 in a whole cell no draw may fall. Directions computed in f32 lie
    /// on either side of a boundary of their support; choose rows that straddle it.
    pub fn test(
        &self,
        draws: impl IntoIterator<Item = Option<[f64; 3]>>,
        pdf: impl Fn([f64; 3]) -> f64,
    ) -> GoodnessOfFit {
        let (mut counts, missed) = self.count(draws);
        let total = (counts.iter().sum::<u64>() + missed) as f64;
        let mut expected = self.probabilities(pdf);
        let left = 1.0 - expected.iter().sum::<f64>();
        if missed > 0 || left > MISSING {
            counts.push(missed);
            expected.push(left.max(0.0));
        }
        expected.iter_mut().for_each(|e| *e *= total);
        GoodnessOfFit::of(&counts, &expected)
    }

    fn direction(&self, theta: f64, phi: f64) -> [f64; 3] {
        let local = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
        [0, 1, 2].map(|k| (0..3).map(|i| local[i] * self.frame[i][k]).sum())
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn normalized(a: [f64; 3]) -> [f64; 3] {
    a.map(|c| c / dot(a, a).sqrt())
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Two tangents and `axis`, right-handed; for the z axis the tangents are x and y.
fn frame(axis: [f64; 3]) -> [[f64; 3]; 3] {
    let z = normalized(axis);
    let helper = if z[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let y = normalized(cross(z, helper));
    [cross(y, z), y, z]
}
