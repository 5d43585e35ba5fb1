//! Order along a space-filling curve (Morton 1966): bits of the axes in turns, the longest axis
//! first, so that cells are as near to cubes as they can be.

use super::{Aabb, BuildItem, MAX_ITEMS};
use glam::Vec3;
use rayon::prelude::*;

/// Bits of an item's index below those of its cell.
const INDEX_BITS: u32 = MAX_ITEMS.ilog2();
/// Bits of a cell's code.
const CODE_BITS: u32 = u64::BITS - INDEX_BITS;
/// Bits of a coordinate that one table turns into a code's.
const TABLE_BITS: u32 = 8;
/// Most bits of one axis: f32 tells no more cells apart.
const MAX_AXIS_BITS: u32 = 24;

/// A curve through a box.
struct Curve {
    min: Vec3,
    /// Cells per unit of length.
    scale: [f64; 3],
    /// Cells of each axis, less one.
    last: [u32; 3],
    /// By axis and byte of the cell's number: its bits at their places in the code.
    tables: [[[u64; 1 << TABLE_BITS]; MAX_AXIS_BITS.div_ceil(TABLE_BITS) as usize]; 3],
}

impl Curve {
    fn new(bounds: Aabb) -> Self {
        let extent = [0, 1, 2].map(|k| f64::from(bounds.max[k]) - f64::from(bounds.min[k]));
        let mut cell = extent;
        // Axes of the code's bits, the highest first.
        let mut axes = Vec::new();
        let mut bits = [0; 3];
        while axes.len() < CODE_BITS as usize {
            let open = (0..3).filter(|&k| bits[k] < MAX_AXIS_BITS);
            let Some(longest) = open.max_by(|&a, &b| cell[a].total_cmp(&cell[b])) else { break };
            cell[longest] /= 2.0;
            bits[longest] += 1;
            axes.push(longest);
        }
        let mut tables = [[[0; 1 << TABLE_BITS]; 3]; 3];
        let mut seen = bits;
        for (place, &axis) in axes.iter().enumerate() {
            seen[axis] -= 1;
            let (table, bit) = (seen[axis] / TABLE_BITS, seen[axis] % TABLE_BITS);
            for (byte, code) in tables[axis][table as usize].iter_mut().enumerate() {
                *code |= (byte as u64 >> bit & 1) << (u64::BITS - 1 - place as u32);
            }
        }
        let cells = bits.map(|b| (1_u32 << b) as f64);
        let scale = [0, 1, 2].map(|k| if extent[k] > 0.0 { cells[k] / extent[k] } else { 0.0 });
        Self { min: bounds.min, scale, last: bits.map(|b| (1 << b) - 1), tables }
    }

    fn code(&self, p: [f32; 3]) -> u64 {
        let mut code = 0;
        for (axis, p) in p.into_iter().enumerate() {
            let x = (f64::from(p) - f64::from(self.min[axis])) * self.scale[axis];
            let cell = (x as u32).min(self.last[axis]);
            for (k, table) in self.tables[axis].iter().enumerate() {
                code |= table[(cell >> (TABLE_BITS * k as u32) & 0xFF) as usize];
            }
        }
        code
    }
}

/// Indices of `items`, which are inside `bounds`, in the order of the curve through the middles of
/// their boxes; in one cell, by index.
pub(super) fn order(items: &[BuildItem], bounds: Aabb) -> Vec<u32> {
    let curve = Curve::new(bounds);
    let key = |(index, item): (usize, &BuildItem)| {
        curve.code(item.bounds.centroid().to_array()) | index as u64
    };
    let mut keys: Vec<u64> = items.par_iter().enumerate().map(key).collect();
    keys.par_sort_unstable();
    keys.into_par_iter().map(|key| (key & (MAX_ITEMS as u64 - 1)) as u32).collect()
}
