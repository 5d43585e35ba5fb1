//! Sums of radiance of all pixels, f64.
//!
//! Blocks are added in order within a segment, which begins from zero, and whole segments in order:
//! so that processes that take whole segments each arrive, together, at the bits of one that takes
//! all of them.

use super::PixelSums;

/// Sums of radiance.
#[derive(Debug, Clone)]
pub(super) struct Sums {
    /// Of the whole segments before the one under way.
    pub(super) total: PixelSums<[f64; 3]>,
    /// Of the segment under way; empty where all is one.
    pub(super) segment: PixelSums<[f64; 3]>,
    /// Whole segments one by one, in a part that does not begin with the first: what comes before
    /// it must be known to add them up.
    pub(super) kept: Option<Vec<PixelSums<[f64; 3]>>>,
}

pub(super) fn add(a: &mut [f64; 3], b: [f64; 3]) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
}

impl Sums {
    pub(super) fn new(pixel_count: usize, has_segments: bool, keeps_them: bool) -> Self {
        let zeros = |is_needed: bool| vec![[0.0; 3]; if is_needed { pixel_count } else { 0 }];
        Self {
            total: zeros(!keeps_them),
            segment: zeros(has_segments || keeps_them),
            kept: keeps_them.then(Vec::new),
        }
    }

    /// Adds a block.
    pub(super) fn add(&mut self, i: usize, block: [f64; 3]) {
        let under_way = if self.segment.is_empty() { &mut self.total } else { &mut self.segment };
        add(&mut under_way[i], block);
    }

    /// The pixel's segment of that index is whole: the next begins.
    pub(super) fn end_segment(&mut self, i: usize, index: usize) {
        if self.segment.is_empty() {
            return;
        }
        let whole = std::mem::take(&mut self.segment[i]);
        let Some(kept) = &mut self.kept else { return add(&mut self.total[i], whole) };
        while kept.len() <= index {
            kept.push(vec![[0.0; 3]; self.segment.len()]);
        }
        kept[index][i] = whole;
    }

    /// The sum of all.
    pub(super) fn of(&self, i: usize) -> [f64; 3] {
        let mut sum = self.total.get(i).copied().unwrap_or_default();
        for segment in self.kept.iter().flatten() {
            add(&mut sum, segment[i]);
        }
        if let Some(segment) = self.segment.get(i) {
            add(&mut sum, *segment);
        }
        sum
    }

    /// Adds the segments of the part that comes next; this one is whole.
    pub(super) fn append(&mut self, next: &Self) {
        for segment in next.kept.iter().flatten() {
            for (total, more) in self.total.iter_mut().zip(segment) {
                add(total, *more);
            }
        }
        for (segment, more) in self.segment.iter_mut().zip(&next.segment) {
            add(segment, *more);
        }
    }

    /// Copies `n` pixels of another, which does not keep segments, from index `from` on.
    pub(super) fn insert(&mut self, other: &Self, to: usize, from: usize, n: usize) {
        self.total[to..to + n].copy_from_slice(&other.total[from..from + n]);
        self.segment[to..to + n].copy_from_slice(&other.segment[from..from + n]);
    }
}
