//! Binned surface area heuristic (Wald 2007, "On fast construction of SAH-based
//! bounding volume hierarchies").
//!
//! The cost of a split is the expected work of a random ray that meets the node:
//! `TRAVERSAL_COST + (area_left * count_left + area_right * count_right) / area`,
//! in units of one primitive test. Only splits between bins are tried.

use super::builder::{
    self, Extent, Reference, SplitRule, longest_axis, partition, scan, split_median,
};
use super::{BuildItem, Bvh, TRAVERSAL_COST};
use glam::Vec3A;

/// Ranges of up to so many items use 4 and 8 bins along each axis, longer ones 16. More
/// bins than items find nothing more, and most nodes are small.
const SHORT_RANGE: usize = 6;
const MIDDLING_RANGE: usize = 32;

/// The items whose centroids are in one slice of the range.
#[derive(Clone, Copy)]
struct Bin {
    min: Vec3A,
    max: Vec3A,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY, count: 0 };

    #[inline]
    fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            count: self.count + other.count,
        }
    }

    /// Half the surface area times the count; 0 if empty.
    fn cost(&self) -> f32 {
        if self.count == 0 { 0.0 } else { half_area(self.max - self.min) * self.count as f32 }
    }
}

#[inline]
fn half_area(e: Vec3A) -> f32 {
    e.x * e.y + e.y * e.z + e.z * e.x
}

/// Maps centroids to bins.
#[derive(Clone, Copy)]
struct Binning {
    origin: Vec3A,
    scale: Vec3A,
    count: usize,
}

impl Binning {
    fn new(extent: &Extent, count: usize) -> Self {
        let size = extent.centroid_max - extent.centroid_min;
        // An axis without extent has all items in bin 0, as has one whose extent
        // is not a finite number.
        let scale = size.map(|s| if s > 0.0 { count as f32 / s } else { 0.0 });
        Self { origin: extent.centroid_min, scale, count }
    }

    /// The bins of the three axes. The conversion sends NaN and negative values to 0.
    #[inline]
    fn bins(&self, reference: &Reference) -> [usize; 3] {
        let p = (reference.centroid() - self.origin) * self.scale;
        p.to_array().map(|p| self.clamp(p))
    }

    /// The bin on one axis, by the same arithmetic.
    #[inline]
    fn bin(&self, reference: &Reference, axis: usize) -> usize {
        let centroid = reference.centroid()[axis];
        self.clamp((centroid - self.origin[axis]) * self.scale[axis])
    }

    #[inline]
    fn clamp(&self, p: f32) -> usize {
        (p as i32).clamp(0, self.count as i32 - 1) as usize
    }
}

#[derive(Clone, Copy)]
struct Split {
    binning: Binning,
    cost: f32,
    axis: usize,
    /// First bin on the right.
    bin: usize,
}

struct SurfaceArea;

impl SurfaceArea {
    /// The cheapest split between two of `BINS` bins on any axis.
    fn best_split<const BINS: usize>(references: &[Reference], extent: &Extent) -> Option<Split> {
        let binning = Binning::new(extent, BINS);
        let bins = scan(
            references,
            || [[Bin::EMPTY; BINS]; 3],
            |bins, reference| {
                for (axis, bin) in binning.bins(reference).into_iter().enumerate() {
                    let bin = &mut bins[axis][bin];
                    bin.min = bin.min.min(reference.min());
                    bin.max = bin.max.max(reference.max());
                    bin.count += 1;
                }
            },
            |a, b| std::array::from_fn(|i| std::array::from_fn(|j| a[i][j].union(b[i][j]))),
        );
        let mut best: Option<Split> = None;
        for (axis, bins) in bins.iter().enumerate() {
            let mut right_costs = [0.0; BINS];
            let mut right = Bin::EMPTY;
            for i in (1..bins.len()).rev() {
                right = right.union(bins[i]);
                right_costs[i] = right.cost();
            }
            let mut left = Bin::EMPTY;
            for i in 1..bins.len() {
                left = left.union(bins[i - 1]);
                if left.count == 0 || left.count as usize == references.len() {
                    continue;
                }
                let cost = left.cost() + right_costs[i];
                if best.is_none_or(|b| cost < b.cost) {
                    best = Some(Split { binning, cost, axis, bin: i });
                }
            }
        }
        best
    }
}

impl SplitRule for SurfaceArea {
    fn split(
        &self,
        references: &mut [Reference],
        extent: &Extent,
        leaf_size: usize,
    ) -> Option<usize> {
        let count = references.len();
        let best = if count <= SHORT_RANGE {
            Self::best_split::<4>(references, extent)
        } else if count <= MIDDLING_RANGE {
            Self::best_split::<8>(references, extent)
        } else {
            Self::best_split::<16>(references, extent)
        };
        let area = half_area(extent.max - extent.min);
        // Boxes without area, and boxes whose area is not a number that f32 holds,
        // say nothing about cost.
        let Some(best) = best.filter(|b| area > 0.0 && b.cost.is_finite()) else {
            let axis = longest_axis(extent.centroid_max - extent.centroid_min);
            return (count > leaf_size).then(|| split_median(references, axis));
        };
        if count <= leaf_size && count as f32 * area <= TRAVERSAL_COST * area + best.cost {
            return None;
        }
        Some(partition(references, |r| best.binning.bin(r, best.axis) < best.bin))
    }
}

/// Builds a tree with low surface area cost, in parallel; the same tree for any
/// number of threads. Bounds must be finite. Where a path would become deeper than
/// [`super::MAX_DEPTH`], halves replace the heuristic.
///
/// # Panics
/// If there are more than [`super::MAX_ITEMS`] items.
pub fn build_sah(items: &[BuildItem]) -> Bvh {
    builder::build(items, &SurfaceArea)
}
