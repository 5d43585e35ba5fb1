//! Agglomeration: neighbours along a space-filling curve that are nearest to each other are
//! joined, until one is left (Meister & Bittner 2018, "Parallel locally-ordered clustering
//! for bounding volume hierarchy construction").
//!
//! The distance of two clusters is the area of the box that holds both, to 17 bits. Of equal
//! distances the pair counts whose first index is even, then the one with fewer places between
//! its clusters, then the first: this order is total and the same from both sides, so some pair is
//! mutual in every round, and where all distances are equal half of the clusters are.

use super::binary::{BinaryTree, Cluster};
use rayon::prelude::*;

/// Clusters that one task looks at.
const CHUNK: usize = 1 << 13;

/// Rounds join one in so many clusters at least. Where fewer are mutual, as of boxes one inside the
/// other, all are joined to what is beside them on the curve.
const SLOWEST: usize = 64;

/// The tree of all `clusters`, which are in the order of the curve and not none. Looks for
/// neighbours up to `radius` places away.
pub(super) fn agglomerate(mut clusters: Vec<Cluster>, radius: usize) -> BinaryTree {
    let mut slots = vec![Cluster::default(); 2 * clusters.len() - 1];
    // Pairs from here on are taken: those near the root get low indices.
    let mut first_taken = clusters.len() - 1;
    let mut next = Vec::new();
    while clusters.len() > 1 {
        let mut partners = nearest(&clusters, radius);
        let mut counts = roles(&partners);
        let joins = |counts: &[[usize; 2]]| counts.iter().map(|[joins, _]| joins).sum::<usize>();
        if joins(&counts) * SLOWEST < clusters.len() {
            partners = along_curve(clusters.len());
            counts = roles(&partners);
        }
        let total = joins(&counts);
        let first_pair = first_taken - total;
        next.clear();
        next.resize(clusters.len() - total, Cluster::default());
        // Every chunk writes its own part of both.
        let mut tasks = Vec::with_capacity(counts.len());
        let mut pairs = &mut slots[2 * first_pair + 1..2 * first_taken + 1];
        let mut kept = &mut next[..];
        let mut pair = first_pair;
        for (chunk, [joins, joined]) in counts.into_iter().enumerate() {
            let begin = chunk * CHUNK;
            let end = (begin + CHUNK).min(clusters.len());
            let (own_pairs, other_pairs) = pairs.split_at_mut(2 * joins);
            let (own_kept, other_kept) = kept.split_at_mut(end - begin - joined);
            tasks.push((begin..end, pair, own_pairs, own_kept));
            (pairs, kept) = (other_pairs, other_kept);
            pair += joins;
        }
        tasks.into_par_iter().for_each(|(range, mut pair, pairs, kept)| {
            let mut pairs = pairs.chunks_exact_mut(2);
            let mut kept = kept.iter_mut();
            for i in range {
                let cluster = match role(&partners, i) {
                    Role::Joined => continue,
                    Role::Stays => clusters[i],
                    Role::Joins => {
                        let (a, b) = (clusters[i], clusters[partners[i] as usize]);
                        pairs.next().expect("one for each merge").copy_from_slice(&[a, b]);
                        pair += 1;
                        Cluster::of_pair(pair - 1, &a, &b)
                    }
                };
                *kept.next().expect("one for each that stays") = cluster;
            }
        });
        first_taken = first_pair;
        std::mem::swap(&mut clusters, &mut next);
    }
    slots[0] = clusters[0];
    BinaryTree { slots }
}

/// Each with the one beside it.
fn along_curve(count: usize) -> Vec<u32> {
    let beside = |i: usize| if i ^ 1 < count { i ^ 1 } else { 0 };
    (0..count).map(|i| beside(i) as u32).collect()
}

/// Of each chunk: clusters that join the one behind them, and those that are joined.
fn roles(partners: &[u32]) -> Vec<[usize; 2]> {
    let chunks = (0..partners.len().div_ceil(CHUNK)).into_par_iter();
    let count = |chunk: usize| {
        let mut counts = [0; 2];
        for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(partners.len()) {
            let role = role(partners, i);
            counts[0] += usize::from(role == Role::Joins);
            counts[1] += usize::from(role == Role::Joined);
        }
        counts
    };
    chunks.map(count).collect()
}

#[derive(Clone, Copy, PartialEq)]
enum Role {
    /// Has a partner behind it whose partner it is.
    Joins,
    /// Is that partner.
    Joined,
    Stays,
}

fn role(partners: &[u32], i: usize) -> Role {
    let partner = partners[i] as usize;
    if partners[partner] as usize != i {
        Role::Stays
    } else if i < partner {
        Role::Joins
    } else {
        Role::Joined
    }
}

/// Clusters whose neighbours are searched together: their boxes fit the first cache.
const BLOCK: usize = 1 << 10;
/// Low bits of a pair's rank, below those of its area: whether the pair is behind the cluster that
/// asks, the places between its two, and whether the index of its first is odd.
const BEHIND: i32 = 1;
const PLACES_SHIFT: u32 = 1;
const PLACES_MASK: i32 = 15;
const ODD_SHIFT: u32 = 5;
const AREA_MASK: i32 = i32::MAX << (ODD_SHIFT + 1) & i32::MAX;
/// As far as a rank tells.
pub(super) const MAX_RADIUS: usize = PLACES_MASK as usize;

/// For each cluster the nearest of those up to `radius` places before and behind it.
fn nearest(clusters: &[Cluster], radius: usize) -> Vec<u32> {
    debug_assert!((1..=MAX_RADIUS).contains(&radius));
    let mut partners = vec![0; clusters.len()];
    partners.par_chunks_mut(BLOCK).enumerate().with_min_len(8).for_each_init(
        Search::default,
        |search, (block, partners)| {
            let begin = block * BLOCK;
            let first = begin.saturating_sub(radius);
            let last = (begin + partners.len() + radius).min(clusters.len());
            search.run(&clusters[first..last], first, radius);
            for (k, partner) in partners.iter_mut().enumerate() {
                let rank = search.least[begin - first + k];
                let places = (rank >> PLACES_SHIFT & PLACES_MASK) as usize;
                let i = begin + k;
                *partner = (if rank & BEHIND != 0 { i + places } else { i - places }) as u32;
            }
        },
    );
    partners
}

/// The nearest neighbours in one block. One array a coordinate, so that loops are over vectors.
#[derive(Default)]
struct Search {
    low: [Vec<f32>; 3],
    high: [Vec<f32>; 3],
    ranks: Vec<i32>,
    /// The least rank of each cluster's pairs.
    least: Vec<i32>,
}

impl Search {
    /// Finds the `least` for `clusters`, of which the first is number `first`.
    fn run(&mut self, clusters: &[Cluster], first: usize, radius: usize) {
        for axis in 0..3 {
            self.low[axis].clear();
            self.low[axis].extend(clusters.iter().map(|c| c.bounds().min[axis]));
            self.high[axis].clear();
            self.high[axis].extend(clusters.iter().map(|c| c.bounds().max[axis]));
        }
        self.least.clear();
        self.least.resize(clusters.len(), i32::MAX);
        for places in 1..=radius.min(clusters.len() - 1) {
            self.rank(first, places);
            for (least, rank) in self.least.iter_mut().zip(&self.ranks) {
                *least = (*least).min(rank | BEHIND);
            }
            for (least, rank) in self.least[places..].iter_mut().zip(&self.ranks) {
                *least = (*least).min(*rank);
            }
        }
    }

    /// Ranks of the pairs of a cluster and the one so many `places` behind it.
    fn rank(&mut self, first: usize, places: usize) {
        let count = self.least.len() - places;
        self.ranks.resize(count, 0);
        let [lx, ly, lz] = self.low.each_ref().map(|a| [&a[..count], &a[places..][..count]]);
        let [hx, hy, hz] = self.high.each_ref().map(|a| [&a[..count], &a[places..][..count]]);
        let ranks = &mut self.ranks[..count];
        for i in 0..count {
            let x = greater(hx[0][i], hx[1][i]) - lesser(lx[0][i], lx[1][i]);
            let y = greater(hy[0][i], hy[1][i]) - lesser(ly[0][i], ly[1][i]);
            let z = greater(hz[0][i], hz[1][i]) - lesser(lz[0][i], lz[1][i]);
            // Areas are not negative, so their bits are in their order; infinite ones and what
            // is not a number come last.
            let area = (x * y + y * z + z * x).to_bits() as i32 & AREA_MASK;
            let odd = ((first + i) as i32 & 1) << ODD_SHIFT;
            ranks[i] = area | odd | (places as i32) << PLACES_SHIFT;
        }
    }
}

/// The minimum, in one instruction.
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The maximum, in one instruction.
fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
