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
const MAX_ZERO_ELEMENTS: u64 = 1 << 22;
/// Triangles of all meshes, each counted once however often it is placed.
const MAX_TRIANGLES: u64 = 1 << 26;
/// Placements of meshes and spheres.
const MAX_INSTANCES: u64 = 1 << 22;
/// Elements, triangles and placements that any file may have. Each element takes a byte of
/// input at least, and each triangle and each placement comes from one: a file that asks
/// for more than this, and for more than it has bytes, reads the same data again and again.
const ANY_ELEMENTS: u64 = 1 << 24;
const ANY_TRIANGLES: u64 = 1 << 22;
const ANY_INSTANCES: u64 = 1 << 20;
/// Materials: each takes about 5 KB while it is read.
const MAX_MATERIALS: usize = 1 << 16;
/// Memory that the parsed JSON may take, bytes, by [`json_memory`].
const MAX_JSON_MEMORY: u64 = 960 << 20;
/// Bytes that an object takes at most, beside its members: a node of a tree map, and three
/// times the largest structure that one is parsed to, while a list of those grows.
const JSON_OBJECT_SIZE: u64 = 1800;
/// Bytes that any other value takes at most, while a list of them grows.
const JSON_VALUE_SIZE: u64 = 64;

/// What one load has used of the limits so far.
#[derive(Default)]
pub(super) struct Budget {
    bytes: Cell<u64>,
    decoded: Cell<u64>,
    pixels: Cell<u64>,
    elements: Cell<u64>,
    zero_elements: Cell<u64>,
    triangles: Cell<u64>,
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
        let limit = self.limit(ANY_ELEMENTS, MAX_ELEMENTS);
        take(&self.elements, count, limit, "vertex attributes and indices")
    }

    /// Takes `count` triangles.
    pub(super) fn take_triangles(&self, count: u64) -> Result<(), String> {
        take(&self.triangles, count, self.limit(ANY_TRIANGLES, MAX_TRIANGLES), "triangles")
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
        take(
            &self.instances,
            count,
            self.limit(ANY_INSTANCES, MAX_INSTANCES),
            "placements of primitives",
        )
    }

    /// What this much input may ask for: one for each byte, but `any` at least and `most` at most.
    fn limit(&self, any: u64, most: u64) -> u64 {
        self.bytes.get().clamp(any, most)
    }
}

/// Refuses a JSON text whose values would take too much memory.
pub(super) fn check_json(text: &[u8]) -> Result<(), String> {
    let memory = json_memory(text);
    if memory > MAX_JSON_MEMORY {
        return Err(format!(
            "its JSON would take {memory} bytes of memory; the limit is {MAX_JSON_MEMORY}"
        ));
    }
    Ok(())
}

/// Refuses more materials than there is room for, before they are parsed.
pub(super) fn check_materials(count: usize) -> Result<(), String> {
    match count > MAX_MATERIALS {
        true => Err(format!("it has {count} materials; the limit is {MAX_MATERIALS}")),
        false => Ok(()),
    }
}

/// An upper bound on the memory of the parsed text, bytes: by the number of its objects and
/// of its values, and the length of its strings.
fn json_memory(text: &[u8]) -> u64 {
    let (mut objects, mut values, mut characters) = (0, 0, 0);
    let (mut in_string, mut is_escaped) = (false, false);
    for &byte in text {
        if in_string {
            characters += 1;
            in_string = is_escaped || byte != b'"';
            is_escaped = !is_escaped && byte == b'\\';
            continue;
        }
        match byte {
            b'"' => in_string = true,
            b'{' => objects += 1,
            // Every value but the first of a list follows a comma.
            b'[' | b',' => values += 1,
            _ => {}
        }
    }
    objects * JSON_OBJECT_SIZE + values * JSON_VALUE_SIZE + characters * 2
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
    }

    #[test]
    fn a_larger_file_may_have_more_elements() {
        let budget = Budget::default();
        assert!(budget.take_elements(ANY_ELEMENTS).is_ok());
        assert!(budget.take_elements(1).is_err());
        budget.take_bytes(ANY_ELEMENTS + 1).unwrap();
        assert!(budget.take_elements(1).is_ok());
        assert!(budget.take_elements(1).is_err());
        budget.take_bytes(MAX_BYTES - ANY_ELEMENTS - 1).unwrap();
        assert!(budget.take_elements(MAX_ELEMENTS - ANY_ELEMENTS - 1).is_ok());
        assert!(budget.take_elements(1).is_err());
        assert!(budget.take_triangles(MAX_TRIANGLES + 1).is_err());
    }

    #[test]
    fn the_memory_of_json_is_that_of_its_objects_values_and_strings() {
        assert_eq!(json_memory(b"{}"), JSON_OBJECT_SIZE);
        assert_eq!(json_memory(b"[1,2,3]"), 3 * JSON_VALUE_SIZE);
        assert_eq!(json_memory(br#"{"a,{\"[":""}"#), JSON_OBJECT_SIZE + 2 * 8);
        let many = "{},".repeat(1 << 20);
        assert!(check_json(many.as_bytes()).unwrap_err().contains("the limit is 1006632960"));
    }
}
