//! A tree of the lights that have a place, for choosing one by how much it may give to a receiver
//! (A. Conty Estevez and C. Kulla 2018, "Importance sampling of many lights with adaptive tree
//! splitting"; Pharr, Jakob and Humphreys, 4th ed., section 12.6.3). `light/tree.wgsl` walks it.

mod bounds;
mod build;

use crate::shader::generated::{INVALID, LIGHT_NODE_DOUBLE_SIDED, LIGHT_NODE_LEAF};
pub(super) use bounds::LightBounds;
use build::{Node, NodeKind};

/// `vec4`s of a pair, two for each of the two: see `light/tree.wgsl`.
const PAIR: usize = 4;
/// Relative to the brightest light's: what is dimmer counts as this.
const LEAST_INTENSITY: f64 = 1e-30;

/// `light_tree`.
#[derive(Default)]
pub(super) struct LightTree {
    /// Pairs, the root's first, then each light's way to it: bit k says which of the pair on level k.
    pub(super) words: Vec<[u32; 4]>,
    /// The index in `words` at which the ways begin.
    pub(super) trails: u32,
}

impl LightTree {
    /// Over the lights that have bounds, by their indices.
    pub(super) fn new(lights: &[Option<LightBounds>]) -> Self {
        let chosen = lights.iter().zip(0..).filter_map(|(b, i)| Some(((*b)?, i))).collect();
        let nodes = build::build(chosen);
        let mut tree = Flat { nodes, words: Vec::new(), trails: vec![INVALID; lights.len()] };
        tree.flatten();
        let trails = tree.words.len() as u32;
        let mut ways =
            tree.trails.chunks(4).map(|c| [0, 1, 2, 3].map(|k| *c.get(k).unwrap_or(&INVALID)));
        tree.words.extend(&mut ways);
        Self { words: tree.words, trails }
    }
}

struct Flat {
    nodes: Vec<Node>,
    words: Vec<[u32; 4]>,
    trails: Vec<u32>,
}

impl Flat {
    fn flatten(&mut self) {
        let Some(root) = self.nodes.len().checked_sub(1) else {
            self.words = vec![[0; 4]; PAIR];
            return;
        };
        let intensities = self.nodes.iter().filter(|n| matches!(n.kind, NodeKind::Light(_)));
        let brightest = intensities.map(|n| n.bounds.intensity).fold(0.0, f64::max);
        if let NodeKind::Light(index) = self.nodes[root].kind {
            // Beside a light that is none.
            self.words = vec![[0; 4]; PAIR];
            self.words[..2].copy_from_slice(&record(&self.nodes[root].bounds, brightest));
            self.words[1][3] |= LIGHT_NODE_LEAF | index as u32;
            self.trails[index] = 0;
            return;
        }
        self.place(root, 0, 0, brightest);
    }

    /// Appends the pair of node `at`, on `level`, and all below it; gives its index.
    fn place(&mut self, at: usize, level: u32, trail: u32, brightest: f64) -> u32 {
        let NodeKind::Pair(pair) = self.nodes[at].kind else { unreachable!("a light has no pair") };
        let base = self.words.len();
        self.words.resize(base + PAIR, [0; 4]);
        for (k, node) in pair.into_iter().enumerate() {
            let [first, mut second] = record(&self.nodes[node].bounds, brightest);
            let trail = trail | (k as u32) << level;
            second[3] |= match self.nodes[node].kind {
                NodeKind::Light(index) => {
                    self.trails[index] = trail;
                    LIGHT_NODE_LEAF | index as u32
                }
                NodeKind::Pair(_) => self.place(node, level + 1, trail, brightest),
            };
            self.words[base + 2 * k] = first;
            self.words[base + 2 * k + 1] = second;
        }
        base as u32
    }
}

/// Two words of four: centre and radius; axis, relative intensity, cosines, and the link's bits.
fn record(b: &LightBounds, brightest: f64) -> [[u32; 4]; 2] {
    let center = b.center().as_vec3();
    // Of a sphere that still holds the box when its centre is rounded.
    let radius = (b.radius() + center.as_dvec3().distance(b.center())) as f32;
    let intensity = (b.intensity / brightest).max(LEAST_INTENSITY) as f32;
    // Down by more than the errors of axis and arithmetic: no light is taken for one that faces away.
    let below = |angle: f64, steps: f64| ((angle.cos() * 32767.0).floor() - steps).max(-32767.0);
    let cosines = [below(b.cone.angle, 2.0), below(b.emission_angle, 33.0)];
    let flags = if b.is_double_sided { LIGHT_NODE_DOUBLE_SIDED } else { 0 };
    let [x, y, z] = b.cone.axis.to_array().map(|e| (e * 32767.0).round());
    let z_and_intensity = pack([z, 0.0]) | intensity.to_bits() & 0xffff_0000;
    [
        center.extend(radius.next_up()).to_array().map(f32::to_bits),
        [pack([x, y]), z_and_intensity, pack(cosines), flags],
    ]
}

/// As `unpack2x16snorm` reads it.
fn pack([a, b]: [f64; 2]) -> u32 {
    let half = |v: f64| u32::from(v as i16 as u16);
    half(a) | half(b) << 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn ball(i: u32) -> LightBounds {
        let x = f64::from(i);
        let at = DVec3::new((x * 12.9898).sin(), (x * 78.233).sin(), (x * 37.719).sin());
        LightBounds::ball(at, 0.001, 1.0 + (x * 0.7).sin())
    }

    /// Follows a way from the root; the light at its end.
    fn follow(tree: &LightTree, mut trail: u32) -> u32 {
        let mut base = 0;
        loop {
            let link = tree.words[base + 2 * (trail & 1) as usize + 1][3];
            if link & LIGHT_NODE_LEAF != 0 {
                return link & !LIGHT_NODE_LEAF & !LIGHT_NODE_DOUBLE_SIDED;
            }
            base = (link & !LIGHT_NODE_DOUBLE_SIDED) as usize;
            trail >>= 1;
        }
    }

    fn trail(tree: &LightTree, light: usize) -> u32 {
        tree.words[tree.trails as usize + light / 4][light % 4]
    }

    #[test]
    fn ways_lead_to_their_lights() {
        for n in [1, 2, 3, 600] {
            let lights: Vec<_> = (0..n).map(|i| (i % 5 != 3).then(|| ball(i))).collect();
            let tree = LightTree::new(&lights);
            for (i, light) in lights.iter().enumerate() {
                let trail = trail(&tree, i);
                match light {
                    Some(_) => assert_eq!(follow(&tree, trail), i as u32),
                    None => assert_eq!(trail, INVALID),
                }
            }
        }
        let none = LightTree::new(&[None, None]);
        assert_eq!((none.words.len(), none.trails), (PAIR + 1, PAIR as u32));
    }

    /// And half of them where another is.
    #[test]
    fn a_hundred_thousand_lights_have_their_ways() {
        let lights: Vec<_> = (0..100_000).map(|i| Some(ball(i / 2))).collect();
        let tree = LightTree::new(&lights);
        assert_eq!(tree.trails, 4 * 99_999);
        for i in 0..lights.len() {
            assert_eq!(follow(&tree, trail(&tree, i)), i as u32);
        }
    }
}
