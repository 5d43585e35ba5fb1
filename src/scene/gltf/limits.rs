//! Upper limits on what one file may make the loader hold in memory. They are
//! checked before anything is decoded, so that a small crafted file cannot ask
//! for much.

use std::cell::Cell;

/// Bytes of all files and data URIs of one scene: what a GLB's 32-bit length can say.
const MAX_BYTES: u64 = 1 << 32;
/// Bytes of all decompressed buffer views: a stream can stand for a hundred times its length.
pub(super) const MAX_DECODED: u64 = 1 << 30;
/// Pixels of all images of one scene; 1 GiB decoded.
const MAX_PIXELS: u64 = 1 << 28;
/// Width and height of one image.
pub(super) const MAX_IMAGE_SIDE: u32 = 1 << 15;
/// Elements of all accessors read: vertices times attributes, and indices.
/// 2 GiB at most, where all of them are four-component vectors.
const MAX_ELEMENTS: u64 = 1 << 27;
/// Elements that are zero because their accessor has no data: those cost a file nothing.
const MAX_ZERO_ELEMENTS: u64 = 1 << 24;
/// Placements of meshes and spheres.
const MAX_INSTANCES: u64 = 1 << 22;

/// What one load has used of the limits so far.
#[derive(Default)]
pub(super) struct Budget {
    bytes: Cell<u64>,
    decoded: Cell<u64>,
    pixels: Cell<u64>,
    elements: Cell<u64>,
    zero_elements: Cell<u64>,
    instances: Cell<u64>,
}

impl Budget {
    /// Takes `count` bytes of input; the error says which limit is exceeded.
    pub(super) fn take_bytes(&self, count: u64) -> Result<(), String> {
        take(&self.bytes, count, MAX_BYTES, "bytes of input files")
    }

    /// Takes `count` bytes of decompressed data.
    pub(super) fn take_decoded(&self, count: u64) -> Result<(), String> {
        take(&self.decoded, count, MAX_DECODED, "bytes of decompressed data")
    }

    /// Takes the pixels of an image.
    pub(super) fn take_pixels(&self, width: u32, height: u32) -> Result<(), String> {
        take(&self.pixels, u64::from(width) * u64::from(height), MAX_PIXELS, "pixels of images")
    }

    /// Takes `count` accessor elements.
    pub(super) fn take_elements(&self, count: u64) -> Result<(), String> {
        take(&self.elements, count, MAX_ELEMENTS, "vertex attributes and indices")
    }

    /// Takes `count` accessor elements that no data stands behind.
    pub(super) fn take_zero_elements(&self, count: u64) -> Result<(), String> {
        take(&self.zero_elements, count, MAX_ZERO_ELEMENTS, "vertex attributes without data")
    }

    /// Whether `count` placements could still be taken.
    pub(super) fn has_room_for_instances(&self, count: u64) -> Result<(), String> {
        let used = self.instances.get();
        let result = self.take_instances(count);
        self.instances.set(used);
        result
    }

    /// Takes `count` placements.
    pub(super) fn take_instances(&self, count: u64) -> Result<(), String> {
        take(&self.instances, count, MAX_INSTANCES, "placements of primitives")
    }
}

fn take(used: &Cell<u64>, count: u64, limit: u64, what: &str) -> Result<(), String> {
    let total = used.get().saturating_add(count);
    if total > limit {
        return Err(format!("with this, the scene has {total} {what}; the limit is {limit}"));
    }
    used.set(total);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_refuses_what_goes_beyond_it_and_keeps_count() {
        let budget = Budget::default();
        assert!(budget.take_pixels(1 << 14, 1 << 13).is_ok());
        assert!(budget.take_pixels(1 << 14, 1 << 13).is_ok());
        let message = budget.take_pixels(1, 1).unwrap_err();
        assert!(message.contains("the limit is 268435456"), "{message}");
        assert!(budget.take_elements(u64::MAX).is_err());
        assert!(budget.take_elements(MAX_ELEMENTS).is_ok());
    }
}
