//! Trees of the scene before, for the next one of an animation.

use super::{BuildItem, Bvh};
use crate::scene::Fnv;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Items that one thread hashes at a time.
const CHUNK: usize = 1 << 14;

/// Trees by what they were built over. A tree is a function of its items, so that one that is kept
/// is the one that would be built: no bit depends on which it is.
///
/// A tree is kept for one scene after the last that had it. Its memory is 32 bytes for each node
/// and 4 for each item.
#[derive(Debug, Default)]
pub struct KeptTrees(Mutex<HashMap<u64, Kept>>);

#[derive(Debug)]
struct Kept {
    tree: Arc<Bvh>,
    is_of_this_scene: bool,
}

impl KeptTrees {
    /// The tree that `build` makes over the items, from before if there was one. `kind` tells
    /// builders apart.
    pub fn tree(
        &self,
        items: &[BuildItem],
        kind: u64,
        build: impl FnOnce(&[BuildItem]) -> Bvh,
    ) -> Arc<Bvh> {
        let key = key(items, kind);
        if let Some(kept) = self.trees().get_mut(&key) {
            kept.is_of_this_scene = true;
            return kept.tree.clone();
        }
        let tree = Arc::new(build(items));
        self.trees().insert(key, Kept { tree: tree.clone(), is_of_this_scene: true });
        tree
    }

    /// Forgets what the scene before this one had and this one has not.
    pub fn end_scene(&self) {
        self.trees().retain(|_, kept| std::mem::take(&mut kept.is_of_this_scene));
    }

    /// Trees that are kept.
    pub fn count(&self) -> usize {
        self.trees().len()
    }

    fn trees(&self) -> std::sync::MutexGuard<'_, HashMap<u64, Kept>> {
        // A map is whole after each of its methods.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Hash of everything that a builder knows of its items.
fn key(items: &[BuildItem], kind: u64) -> u64 {
    let part = |items: &[BuildItem]| {
        let mut hash = Fnv::default();
        for BuildItem { bounds, kind } in items {
            hash.bytes(bytemuck::bytes_of(&bounds.min));
            hash.bytes(bytemuck::bytes_of(&bounds.max));
            hash.bytes(&[*kind as u8]);
        }
        hash.value()
    };
    let parts: Vec<u64> = items.par_chunks(CHUNK).map(part).collect();
    let mut hash = Fnv::default();
    hash.bytes(bytemuck::cast_slice(&[kind, items.len() as u64]));
    hash.bytes(bytemuck::cast_slice(&parts));
    hash.value()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{Aabb, PrimitiveKind, build_median, build_sah};
    use glam::Vec3;

    fn items(shift: f32) -> Vec<BuildItem> {
        let item = |k: u32| {
            let at = Vec3::new(k as f32, (k * k % 7) as f32, shift);
            let bounds = Aabb { min: at, max: at + 0.5 };
            BuildItem { bounds, kind: PrimitiveKind::Triangle }
        };
        (0..40).map(item).collect()
    }

    #[test]
    fn equal_items_have_one_tree_and_others_their_own() {
        let kept = KeptTrees::default();
        let (same, moved) = (items(0.0), items(f32::MIN_POSITIVE));
        let first = kept.tree(&same, 0, build_sah);
        assert_eq!(*first, build_sah(&same));
        let again = kept.tree(&same, 0, |_| panic!("it is there"));
        assert!(Arc::ptr_eq(&first, &again));
        assert_eq!(*kept.tree(&moved, 0, build_sah), build_sah(&moved));
        assert_eq!(*kept.tree(&same, 1, build_median), build_median(&same));
        let mut spheres = items(0.0);
        spheres[3].kind = PrimitiveKind::Sphere;
        assert_eq!(*kept.tree(&spheres, 0, build_sah), build_sah(&spheres));
        assert_eq!(kept.count(), 4);
    }

    #[test]
    fn a_tree_is_kept_for_one_more_scene() {
        let kept = KeptTrees::default();
        kept.tree(&items(0.0), 0, build_sah);
        kept.tree(&items(1.0), 0, build_sah);
        kept.end_scene();
        assert_eq!(kept.count(), 2);
        kept.tree(&items(0.0), 0, |_| panic!("it is there"));
        kept.end_scene();
        assert_eq!(kept.count(), 1);
        kept.end_scene();
        assert_eq!(kept.count(), 0);
    }
}
