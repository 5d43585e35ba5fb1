//! The simple tree, for comparison: halves along the longest axis.

use super::builder::{self, Extent, Reference, SplitRule, longest_axis, split_median};
use super::{BuildItem, Bvh};

/// Items in a leaf, if they are of one kind.
const LEAF_SIZE: usize = 4;

struct Median;

impl SplitRule for Median {
    fn split(
        &self,
        references: &mut [Reference],
        extent: &Extent,
        leaf_size: usize,
    ) -> Option<usize> {
        (references.len() > leaf_size.min(LEAF_SIZE))
            .then(|| split_median(references, longest_axis(extent.max - extent.min)))
    }
}

/// Builds a tree by splitting at the median of the centroids along the longest axis
/// of the bounding box, down to leaves of at most four items. Bounds must be finite.
///
/// # Panics
/// If there are more than [`super::MAX_ITEMS`] items.
pub fn build_median(items: &[BuildItem]) -> Bvh {
    builder::build(items, &Median)
}
