//! Light from infinity: lookup, and directions drawn by its brightness.

use super::random::Random;
use crate::scene::Environment;
use glam::{DMat3, DVec3};
use std::f64::consts::{PI, TAU};

/// A map with the means to draw bright directions.
#[derive(Debug)]
pub(super) struct Sky<'a> {
    map: &'a Environment,
    environment_from_world: DMat3,
    /// Sums, over cells of the map row by row, of brightness times solid angle; a cell is
    /// the area of a texel. One entry a cell and a 0 before them.
    cumulative: Vec<f64>,
}

impl<'a> Sky<'a> {
    pub(super) fn new(map: &'a Environment) -> Self {
        let rotation = map.environment_from_world.to_cols_array().map(f64::from);
        let environment_from_world = DMat3::from_cols_array(&rotation);
        let mut sky = Self { map, environment_from_world, cumulative: vec![0.0] };
        let mut sum = 0.0;
        for y in 0..i64::from(map.height) {
            for x in 0..i64::from(map.width) {
                // Within a cell the filter reaches as far as the eight neighbours.
                let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
                let brightness: f64 = around.map(|(x, y)| sky.texel(x, y).element_sum()).sum();
                sum += brightness * sky.solid_angle(y as usize);
                sky.cumulative.push(sum);
            }
        }
        sky
    }

    fn texel(&self, x: i64, y: i64) -> DVec3 {
        let (width, height) = (i64::from(self.map.width), i64::from(self.map.height));
        let row = y.clamp(0, height - 1) * width;
        self.map.radiance[(row + x.rem_euclid(width)) as usize].as_dvec3()
    }

    /// Cosine of the angle from the pole to the upper edge of a row.
    fn edge(&self, row: usize) -> f64 {
        (PI * row as f64 / f64::from(self.map.height)).cos()
    }

    /// Of each cell of a row.
    fn solid_angle(&self, row: usize) -> f64 {
        TAU / f64::from(self.map.width) * (self.edge(row) - self.edge(row + 1))
    }

    /// Place in the map, in cells from the upper left corner.
    fn place(&self, direction: DVec3) -> (f64, f64) {
        let e = (self.environment_from_world * direction).normalize();
        let x = (e.z.atan2(e.x) / TAU + 0.5) * f64::from(self.map.width);
        let y = e.y.clamp(-1.0, 1.0).acos() / PI * f64::from(self.map.height);
        (x, y)
    }

    /// Radiance from a unit direction of the world.
    pub(super) fn radiance(&self, direction: DVec3) -> DVec3 {
        let (x, y) = self.place(direction);
        // Texel centres lie at half numbers.
        let (x, y) = (x - 0.5, y - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let in_row = |row| {
            let (left, right) =
                (self.texel(column as i64, row), self.texel(column as i64 + 1, row));
            left.lerp(right, x - column)
        };
        let filtered = in_row(row as i64).lerp(in_row(row as i64 + 1), y - row);
        filtered * f64::from(self.map.intensity)
    }

    /// A direction of the world and its density per solid angle; `None` under a black sky.
    pub(super) fn sample(&self, random: &mut Random) -> Option<(DVec3, f64)> {
        let (width, whole) = (self.map.width as usize, *self.cumulative.last()?);
        let wanted = random.uniform() * whole;
        // The first cell whose sum exceeds it; a black cell adds nothing and is never that.
        let cell = self.cumulative.partition_point(|&sum| sum <= wanted).checked_sub(1)?;
        if cell + 1 == self.cumulative.len() {
            return None;
        }
        let (x, y) = (cell % width, cell / width);
        let phi = TAU * ((x as f64 + random.uniform()) / width as f64 - 0.5);
        let (above, below) = (self.edge(y), self.edge(y + 1));
        let cos = above + (below - above) * random.uniform();
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let e = DVec3::new(sin * phi.cos(), cos, sin * phi.sin());
        let direction = (self.environment_from_world.inverse() * e).normalize();
        Some((direction, self.cell_pdf(x, y)))
    }

    /// Density with which [`sample`](Self::sample) gives a direction.
    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        let (x, y) = self.place(direction);
        let (last_column, last_row) = (self.map.width as usize - 1, self.map.height as usize - 1);
        self.cell_pdf((x as usize).min(last_column), (y as usize).min(last_row))
    }

    fn cell_pdf(&self, x: usize, y: usize) -> f64 {
        let cell = y * self.map.width as usize + x;
        let whole = self.cumulative[self.cumulative.len() - 1];
        if whole == 0.0 {
            return 0.0;
        }
        (self.cumulative[cell + 1] - self.cumulative[cell]) / (whole * self.solid_angle(y))
    }
}
