//! Reinsertion: subtrees are taken out and put where they cost least (Meister & Bittner
//! 2018, "Parallel reinsertion for bounding volume hierarchy optimization").
//!
//! Costs are sums of the areas of inner nodes. The best place of many subtrees is
//! searched at the same time in the tree as it is; then they are moved one after the
//! other, the greatest gain first, unless a move before touched the same nodes.

use super::binary::{BinaryTree, Cluster, Content};
use rayon::prelude::*;

/// A move that was found to pay.
#[derive(Clone, Copy)]
struct Move {
    gain: f32,
    from: u32,
    /// Becomes the sibling.
    to: u32,
}

/// A tree with the ways up.
struct Linked<'a> {
    slots: &'a mut [Cluster],
    /// By pair: the slot that holds it.
    parents: Vec<u32>,
}

/// Moves subtrees of `tree` in rounds; each tries as many of the largest as it has nodes, times
/// the round's share.
pub(super) fn reinsert(tree: &mut BinaryTree, shares: &[f32]) {
    let mut parents = vec![0; tree.slots.len() / 2];
    for (slot, cluster) in tree.slots.iter().enumerate() {
        if let Content::Pair(pair) = cluster.content() {
            parents[pair] = slot as u32;
        }
    }
    let count = tree.slots.len();
    let mut linked = Linked { slots: &mut tree.slots, parents };
    let mut is_touched = vec![false; count];
    for share in shares {
        let wanted = ((count as f32 * share) as usize).max(1);
        let mut moves = linked.moves(wanted);
        moves.par_sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.from.cmp(&b.from)));
        is_touched.fill(false);
        for m in moves {
            let (from, to) = (m.from as usize, m.to as usize);
            let around =
                [from, to, BinaryTree::sibling(from), linked.parent(from), linked.parent(to)];
            if around.iter().any(|&slot| is_touched[slot]) {
                continue;
            }
            around.iter().for_each(|&slot| is_touched[slot] = true);
            linked.apply(from, to);
        }
    }
}

impl Linked<'_> {
    fn parent(&self, slot: usize) -> usize {
        self.parents[BinaryTree::pair_of(slot)] as usize
    }

    /// Moves that pay of `wanted` of the largest subtrees among the first slots: those near
    /// the root came to be there.
    fn moves(&self, wanted: usize) -> Vec<Move> {
        let end = (2 * wanted + 1).min(self.slots.len());
        let mut candidates: Vec<(u32, u32)> =
            (1..end).map(|slot| (!self.slots[slot].area().to_bits(), slot as u32)).collect();
        if wanted < candidates.len() {
            candidates.select_nth_unstable(wanted);
            candidates.truncate(wanted);
        }
        candidates
            .into_par_iter()
            .with_min_len(64)
            .map_init(Vec::new, |stack, (_, slot)| self.best_move(slot as usize, stack))
            .flatten()
            .collect()
    }

    /// The best place for the subtree at `from`.
    fn best_move(&self, from: usize, stack: &mut Vec<(f32, u32)>) -> Option<Move> {
        let moved = self.slots[from];
        let area = moved.area();
        let mut best = Move { gain: 0.0, from: from as u32, to: 0 };
        let mut side = BinaryTree::sibling(from);
        let mut pivot = self.parent(from);
        // Area that is saved up to here by taking the subtree out.
        let mut saved = self.slots[pivot].area();
        // Box of the pivot without the subtree.
        let mut rest = self.slots[side];
        let mut is_first = true;
        loop {
            stack.push((saved, side as u32));
            while let Some((saved, slot)) = stack.pop() {
                if saved - area <= best.gain {
                    continue;
                }
                let at = &self.slots[slot as usize];
                let gain = saved - at.union(&moved).area();
                if gain > best.gain {
                    best = Move { gain, to: slot, ..best };
                }
                if let Content::Pair(pair) = at.content() {
                    let saved = gain + at.area();
                    if saved - area > best.gain {
                        stack.push((saved, 2 * pair as u32 + 1));
                        stack.push((saved, 2 * pair as u32 + 2));
                    }
                }
            }
            if !is_first {
                rest = rest.union(&self.slots[side]);
                saved += self.slots[pivot].area() - rest.area();
            }
            is_first = false;
            if pivot == 0 {
                break;
            }
            side = BinaryTree::sibling(pivot);
            pivot = self.parent(pivot);
        }
        (best.to != 0).then_some(best)
    }

    /// Puts the subtree at `from` beside the one at `to`: its parent's place goes to its sibling,
    /// and its pair to `to`.
    fn apply(&mut self, from: usize, to: usize) {
        let pair = BinaryTree::pair_of(from);
        let (sibling, parent) = (BinaryTree::sibling(from), self.parent(from));
        self.put(parent, self.slots[sibling]);
        self.put(sibling, self.slots[to]);
        let joined = Cluster::of_pair(pair, &self.slots[sibling], &self.slots[from]);
        self.put(to, joined);
        self.refit(to);
        self.refit(parent);
    }

    fn put(&mut self, slot: usize, cluster: Cluster) {
        self.slots[slot] = cluster;
        if let Content::Pair(pair) = cluster.content() {
            self.parents[pair] = slot as u32;
        }
    }

    /// Fits the boxes above `slot`.
    fn refit(&mut self, slot: usize) {
        let mut slot = slot;
        while slot != 0 {
            let pair = BinaryTree::pair_of(slot);
            slot = self.parents[pair] as usize;
            let old = self.slots[slot];
            let new = old.fitted(&self.slots[2 * pair + 1], &self.slots[2 * pair + 2]);
            if new.has_box_of(&old) {
                break;
            }
            self.slots[slot] = new;
        }
    }
}
