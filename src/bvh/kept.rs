//! Trees of the scene before, for the next one of an animation.

use super::{BuildItem, Bvh};
use crate::scene::Fnv;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Items that one thread hashes at a time.
const CHUNK: usize = 1 << 14;

/// Trees by what they were built over, for one scene after the last that had them. What a scene
/// asks for in the same place as the scene before is refitted if it can be and if that pays. Which
/// rays hit what does not depend on a tree, so that no bit of a picture depends on which it is.
///
/// Its memory is 32 bytes for each node and 4 for each item.
#[derive(Debug, Default)]
pub struct KeptTrees(Mutex<State>);

/// Where trees came from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct TreeSources {
    /// Built anew.
    pub built: usize,
    /// Built over the same items before.
    pub kept: usize,
    /// Refitted to items that have moved.
    pub refitted: usize,
}

#[derive(Debug, Default)]
struct State {
    trees: HashMap<u64, Kept>,
    /// Keys of the scene before, in the order in which its trees were asked for.
    before: Vec<u64>,
    /// Those of this scene so far.
    now: Vec<u64>,
    sources: TreeSources,
    /// Tracing the scene before; 0 before there is one.
    trace_seconds: f64,
}

#[derive(Debug, Clone)]
struct Kept {
    tree: Arc<Bvh>,
    /// Of its builder.
    kind: u64,
    /// Surface area cost when it was built.
    built_cost: f64,
    build_seconds: f64,
}

impl Kept {
    fn build(items: &[BuildItem], kind: u64, build: impl FnOnce(&[BuildItem]) -> Bvh) -> Self {
        let begin = Instant::now();
        let tree = Arc::new(build(items));
        let build_seconds = begin.elapsed().as_secs_f64();
        Self { built_cost: tree.sah_cost(), tree, kind, build_seconds }
    }

    /// Refitted to the items, if what that saves now is not lost while rays pass through a tree
    /// that is worse: by the share by which its cost is above that of when it was built, of the time
    /// that tracing took. That share is known only after refitting.
    fn refit(&self, items: &[BuildItem], kind: u64, trace_seconds: f64) -> Option<Self> {
        let tree = Some(&self.tree).filter(|_| self.kind == kind)?.refitted(items)?;
        let loss = (tree.sah_cost() / self.built_cost - 1.0) * trace_seconds;
        (loss <= self.build_seconds).then(|| Self { tree: Arc::new(tree), ..self.clone() })
    }
}

impl KeptTrees {
    /// The tree that `build` makes over the items, or one from before that serves as well. `kind`
    /// tells builders apart.
    pub fn tree(
        &self,
        items: &[BuildItem],
        kind: u64,
        build: impl FnOnce(&[BuildItem]) -> Bvh,
    ) -> Arc<Bvh> {
        let key = key(items, kind);
        let (before, trace_seconds) = {
            let mut state = self.state();
            let place = state.now.len();
            state.now.push(key);
            if let Some(kept) = state.trees.get(&key) {
                let tree = kept.tree.clone();
                state.sources.kept += 1;
                return tree;
            }
            let before = state.before.get(place).and_then(|key| state.trees.get(key));
            (before.cloned(), state.trace_seconds)
        };
        let refitted = before.and_then(|kept| kept.refit(items, kind, trace_seconds));
        let is_refitted = refitted.is_some();
        let kept = refitted.unwrap_or_else(|| Kept::build(items, kind, build));
        let tree = kept.tree.clone();
        let mut state = self.state();
        state.sources.refitted += usize::from(is_refitted);
        state.sources.built += usize::from(!is_refitted);
        state.trees.insert(key, kept);
        tree
    }

    /// Ends a scene: forgets what the one before had and this one has not; says where the trees of
    /// this one came from.
    pub fn end_scene(&self) -> TreeSources {
        let mut state = self.state();
        state.before = std::mem::take(&mut state.now);
        let State { trees, before, .. } = &mut *state;
        trees.retain(|key, _| before.contains(key));
        std::mem::take(&mut state.sources)
    }

    /// Tells how long the scene was traced, which the next is expected to be.
    pub fn traced_for(&self, seconds: f64) {
        self.state().trace_seconds = seconds;
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // It is whole after each of its methods, and a tree that could not be built is not in it.
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
        assert_eq!(kept.end_scene(), TreeSources { built: 4, kept: 1, refitted: 0 });
    }

    #[test]
    fn a_tree_is_kept_for_one_more_scene() {
        let kept = KeptTrees::default();
        let (a, b) = (items(0.0), items(1.0)[..30].to_vec());
        kept.tree(&a, 0, build_sah);
        kept.tree(&b, 0, build_sah);
        assert_eq!(kept.end_scene().built, 2);
        kept.tree(&a, 0, |_| panic!("it is there"));
        assert_eq!(kept.end_scene().kept, 1);
        kept.tree(&b, 0, build_sah);
        assert_eq!(kept.end_scene().built, 1);
    }

    /// Boxes in a row, in another order.
    fn shuffled(stride: usize, shift: f32) -> Vec<BuildItem> {
        let items = items(shift);
        (0..items.len()).map(|k| items[k * stride % items.len()]).collect()
    }

    #[test]
    fn moved_items_are_refitted_where_that_pays() {
        let kept = KeptTrees::default();
        let frame = |items: &[BuildItem]| {
            let tree = kept.tree(items, 0, build_sah);
            tree.validate(items).unwrap();
            kept.end_scene()
        };
        let [built, refitted] =
            [(1, 0), (0, 1)].map(|(built, refitted)| TreeSources { built, kept: 0, refitted });
        assert_eq!(frame(&items(0.0)), built);
        assert_eq!(frame(&items(1.0)), refitted);
        kept.traced_for(1e9);
        // No worse than before, however long tracing takes.
        assert_eq!(frame(&items(2.0)), refitted);
        // Every box somewhere else: the tree is many times worse.
        assert_eq!(frame(&shuffled(7, 0.0)), built);
        kept.traced_for(0.0);
        assert_eq!(frame(&shuffled(11, 0.0)), refitted);
        // No worse than when it was refitted, but than when it was built.
        kept.traced_for(1e9);
        assert_eq!(frame(&shuffled(11, 1.0)), built);
    }

    #[test]
    fn what_was_asked_for_elsewhere_is_not_refitted() {
        let kept = KeptTrees::default();
        kept.tree(&items(0.0), 0, build_sah);
        kept.end_scene();
        assert_eq!(*kept.tree(&items(1.0), 1, build_median), build_median(&items(1.0)));
        assert_eq!(*kept.tree(&items(2.0), 0, build_sah), build_sah(&items(2.0)));
    }
}
