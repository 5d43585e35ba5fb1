//! Splits lights in two until each is alone: binned, by the surface area orientation heuristic.

use super::bounds::LightBounds;
use glam::DVec3;

/// Planes tried along an axis, and one.
const BINS: usize = 12;
/// Levels below the root: a light's way fits into so many bits, and is never all ones.
pub(super) const MAX_DEPTH: u32 = 31;

/// A light or a pair.
pub(super) struct Node {
    pub(super) bounds: LightBounds,
    pub(super) kind: NodeKind,
}

pub(super) enum NodeKind {
    /// Index of the light.
    Light(usize),
    /// Indices of the nodes.
    Pair([usize; 2]),
}

/// A tree over `lights`, bounds and index of each; the root is the last node. Empty without lights.
pub(super) fn build(mut lights: Vec<(LightBounds, usize)>) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(2 * lights.len());
    if !lights.is_empty() {
        split(&mut lights, 0, &mut nodes);
    }
    nodes
}

fn split(lights: &mut [(LightBounds, usize)], depth: u32, nodes: &mut Vec<Node>) -> usize {
    if let [(bounds, index)] = *lights {
        nodes.push(Node { bounds, kind: NodeKind::Light(index) });
        return nodes.len() - 1;
    }
    // Halving is always deep enough for what is left.
    let halving = usize::BITS - (lights.len() - 1).leading_zeros();
    let middle = match depth + halving < MAX_DEPTH {
        true => partition(lights),
        false => None,
    };
    let middle = middle.unwrap_or_else(|| halve(lights));
    let (first, second) = lights.split_at_mut(middle);
    let pair = [split(first, depth + 1, nodes), split(second, depth + 1, nodes)];
    let bounds = nodes[pair[0]].bounds.union(nodes[pair[1]].bounds);
    nodes.push(Node { bounds, kind: NodeKind::Pair(pair) });
    nodes.len() - 1
}

fn centers(lights: &[(LightBounds, usize)]) -> (DVec3, DVec3) {
    let at = lights.iter().map(|(b, _)| b.center());
    at.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)))
}

/// Sorted along the longest axis; the number in the first half.
fn halve(lights: &mut [(LightBounds, usize)]) -> usize {
    let (low, high) = centers(lights);
    let axis = (high - low).max_position();
    let key = |l: &(LightBounds, usize)| l.0.center()[axis];
    lights.sort_by(|a, b| key(a).total_cmp(&key(b)).then(a.1.cmp(&b.1)));
    lights.len() / 2
}

/// Orders the lights by the cheapest plane; the number before it. `None` where all are in one place.
fn partition(lights: &mut [(LightBounds, usize)]) -> Option<usize> {
    let (low, high) = centers(lights);
    let extent = high - low;
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in (0..3).filter(|&k| extent[k] > 0.0) {
        let mut bins: [Option<LightBounds>; BINS] = [None; BINS];
        for (bounds, _) in &*lights {
            let bin = &mut bins[bin(bounds, axis, low, extent)];
            *bin = Some(bin.map_or(*bounds, |b| b.union(*bounds)));
        }
        // A plane across a short side makes two thin boxes of what could be two compact ones.
        let thinness = extent.max_element() / extent[axis];
        let cost = |b: &[Option<LightBounds>]| {
            b.iter().flatten().copied().reduce(LightBounds::union).map(|b| b.cost(thinness))
        };
        for plane in 1..BINS {
            let (Some(a), Some(b)) = (cost(&bins[..plane]), cost(&bins[plane..])) else { continue };
            if best.is_none_or(|(least, ..)| a + b < least) {
                best = Some((a + b, axis, plane));
            }
        }
    }
    let (_, axis, plane) = best?;
    // Stable: the same lights make the same tree.
    lights.sort_by_key(|(b, _)| bin(b, axis, low, extent) >= plane);
    Some(lights.partition_point(|(b, _)| bin(b, axis, low, extent) < plane))
}

fn bin(bounds: &LightBounds, axis: usize, low: DVec3, extent: DVec3) -> usize {
    let place = (bounds.center()[axis] - low[axis]) / extent[axis];
    ((place * BINS as f64) as usize).min(BINS - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn depth_and_lights(nodes: &[Node], at: usize) -> (u32, Vec<usize>) {
        match nodes[at].kind {
            NodeKind::Light(i) => (0, vec![i]),
            NodeKind::Pair(pair) => {
                let [(a, mut x), (b, y)] = pair.map(|k| depth_and_lights(nodes, k));
                x.extend(y);
                (1 + a.max(b), x)
            }
        }
    }

    fn check(lights: Vec<LightBounds>) -> u32 {
        let n = lights.len();
        let sum: f64 = lights.iter().map(|l| l.intensity).sum();
        let nodes = build(lights.into_iter().zip(0..).collect());
        assert_eq!(nodes.len(), 2 * n - 1);
        let (depth, mut found) = depth_and_lights(&nodes, nodes.len() - 1);
        found.sort_unstable();
        assert!(found.iter().copied().eq(0..n), "each light is in the tree once");
        let root = &nodes.last().unwrap().bounds;
        assert!((root.intensity / sum - 1.0).abs() < 1e-9);
        depth
    }

    #[test]
    fn each_light_is_a_leaf() {
        let ball = |i: i32| {
            let x = f64::from(i);
            LightBounds::ball(DVec3::new(x.sin(), (2.3 * x).cos(), (x * x).sin()), 0.01, 1.0 + x)
        };
        for n in [1, 2, 3, 17, 500] {
            check((0..n).map(ball).collect());
        }
    }

    #[test]
    fn lights_in_one_place_are_halved() {
        let depth = check(vec![LightBounds::ball(DVec3::ONE, 0.0, 1.0); 1000]);
        assert_eq!(depth, 10);
    }

    /// Distances that grow twofold make binning take one light off at a time.
    #[test]
    fn no_way_is_longer_than_its_bits() {
        let ball = |i: i32| LightBounds::ball(DVec3::X * 2.0_f64.powi(i), 0.0, 4.0_f64.powi(-i));
        let depth = check((0..900).map(ball).collect());
        assert!((20..=MAX_DEPTH).contains(&depth), "{depth}");
    }

    #[test]
    fn no_lights_no_tree() {
        assert!(build(Vec::new()).is_empty());
    }
}
