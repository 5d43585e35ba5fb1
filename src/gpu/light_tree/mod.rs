//! A tree of the lights that have a place, for choosing one by how much it may give to a receiver
//! (A. Conty Estevez and C. Kulla 2018, "Importance sampling of many lights with adaptive tree
//! splitting"; Pharr, Jakob and Humphreys, 4th ed., section 12.6.3). `light/tree.wgsl` walks it.

mod bounds;
mod build;

use crate::shader::generated::{INVALID, LIGHT_NODE_BOTH_SIDES, LIGHT_NODE_LEAF};
pub(super) use bounds::LightBounds;
use build::{Node, NodeKind};
use glam::{DVec2, DVec3};

/// Relative to the brightest light's: what is dimmer counts as this.
const LEAST_INTENSITY: f64 = 1e-30;

/// `light_tree`, whose form is told in `light/tree.wgsl`.
#[derive(Default)]
pub(super) struct LightTree {
    /// Unit, slots of two, ways to the lights.
    pub(super) words: Vec<[u32; 4]>,
    /// The index in `words` at which the ways begin.
    pub(super) trails: u32,
}

impl LightTree {
    /// Over the lights that have bounds, by their indices.
    pub(super) fn new(lights: &[Option<LightBounds>]) -> Self {
        let chosen = lights.iter().zip(0..).filter_map(|(b, i)| Some(((*b)?, i))).collect();
        let nodes = build::build(chosen);
        let intensities = nodes.iter().filter(|n| matches!(n.kind, NodeKind::Light(_)));
        let brightest = intensities.map(|n| n.bounds.intensity).fold(0.0, f64::max);
        let (origin, side) = nodes.last().map_or((DVec3::ZERO, 0.0), |root| {
            (root.bounds.min, (root.bounds.max - root.bounds.min).max_element())
        });
        let unit = 1.0 / if side > 0.0 { side } else { 1.0 };
        // What the device computes with.
        let unit = [origin.x, origin.y, origin.z, unit].map(|x| x as f32);
        let mut flat = Flat {
            nodes,
            unit: unit.map(f64::from),
            brightest,
            slots: vec![[[0; 4]; 2]],
            trails: vec![INVALID; lights.len()],
        };
        flat.flatten();
        let mut words = vec![unit.map(f32::to_bits)];
        words.extend(flat.slots.into_iter().flatten());
        let trails = words.len() as u32;
        let four = |c: &[u32]| [0, 1, 2, 3].map(|k| *c.get(k).unwrap_or(&INVALID));
        words.extend(flat.trails.chunks(4).map(four));
        Self { words, trails }
    }
}

struct Flat {
    nodes: Vec<Node>,
    unit: [f64; 4],
    brightest: f64,
    slots: Vec<[[u32; 4]; 2]>,
    trails: Vec<u32>,
}

impl Flat {
    fn flatten(&mut self) {
        let Some(root) = self.nodes.len().checked_sub(1) else { return };
        match self.nodes[root].kind {
            NodeKind::Pair(pair) => self.place(0, pair.map(Some), 0, 0),
            // Beside a light that is none.
            NodeKind::Light(_) => self.place(0, [Some(root), None], 0, 0),
        }
    }

    /// Writes a pair on `level` into its slot, and all below it into new ones.
    fn place(&mut self, slot: usize, pair: [Option<usize>; 2], level: u32, trail: u32) {
        let first = self.slots.len();
        self.slots.resize(first + 2, [[0; 4]; 2]);
        let mut link = first as u32;
        let (mut words, mut intensities) = ([0; 8], [0; 2]);
        for k in 0..2 {
            let Some(at) = pair[k] else { continue };
            let bounds = self.nodes[at].bounds;
            words[3 * k..3 * k + 3].copy_from_slice(&self.record(&bounds));
            intensities[k] =
                ((bounds.intensity / self.brightest).max(LEAST_INTENSITY) as f32).to_bits();
            if bounds.is_double_sided {
                link |= LIGHT_NODE_BOTH_SIDES << k;
            }
            let trail = trail | (k as u32) << level;
            match self.nodes[at].kind {
                NodeKind::Light(index) => {
                    link |= LIGHT_NODE_LEAF << k;
                    self.slots[first + k][0][0] = index as u32;
                    self.trails[index] = trail;
                }
                NodeKind::Pair(pair) => {
                    self.place(first + k, pair.map(Some), level + 1, trail);
                }
            }
        }
        words[6] = intensities[0] & 0xffff_0000 | intensities[1] >> 16;
        words[7] = link;
        let half = |k: usize| [0, 1, 2, 3].map(|j| words[4 * k + j]);
        self.slots[slot] = [half(0), half(1)];
    }

    /// A node's three words. Cone and sphere are wide enough for the rounding of all of it.
    fn record(&self, b: &LightBounds) -> [u32; 3] {
        let [x, y, z, unit] = self.unit;
        let center = (b.center() - DVec3::new(x, y, z)) * unit;
        let steps = (center * 65535.0).round().clamp(DVec3::ZERO, DVec3::splat(65535.0));
        let radius = b.radius() * unit + (steps / 65535.0).distance(center) + 1e-6;
        let radius = radius.max(LEAST_RADIUS);
        let axis = octahedral(b.cone.axis).to_array().map(|e| (e * 127.0).round());
        // Of octahedral axes in 8 bits: the test below.
        let angle = (b.cone.angle + AXIS_ERROR).min(std::f64::consts::PI);
        let sine = ((0.5 * angle).sin() * 127.0).ceil();
        let cosine = (b.emission_angle.cos() * 127.0 - 0.5).floor().max(-127.0);
        let word = |v: f64| v as u32;
        let byte = |v: f64| u32::from(v as i8 as u8);
        [
            word(steps.x) | word(steps.y) << 16,
            word(steps.z) | half_above(radius) << 16,
            byte(axis[0]) | byte(axis[1]) << 8 | byte(sine) << 16 | byte(cosine) << 24,
        ]
    }
}

/// The least half that no device flushes to 0, in units of the longest side of the box about all.
const LEAST_RADIUS: f64 = 1.0 / 16384.0;

/// Radians.
const AXIS_ERROR: f64 = 0.018;

/// The bits of a half that is no less than `x`, from [`LEAST_RADIUS`] up to 2.
fn half_above(x: f64) -> u32 {
    let exponent = x.log2().floor() as i32;
    let steps = (x * 2.0_f64.powi(10 - exponent)).ceil() as u32;
    // The leading bit is counted with the exponent.
    (((exponent + 14) as u32) << 10) + steps
}

/// A unit vector on the square from -1 to 1: a folded octahedron (Cigolle et al. 2014).
fn octahedral(v: DVec3) -> DVec2 {
    let e = v.truncate() / v.abs().element_sum();
    let sign = |x: f64| if x >= 0.0 { 1.0 } else { -1.0 };
    match v.z >= 0.0 {
        true => e,
        false => DVec2::new((1.0 - e.y.abs()) * sign(e.x), (1.0 - e.x.abs()) * sign(e.y)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shader::generated::LIGHT_NODE_SLOTS;

    fn ball(i: u32) -> LightBounds {
        let x = f64::from(i);
        let at = DVec3::new((x * 12.9898).sin(), (x * 78.233).sin(), (x * 37.719).sin());
        LightBounds::ball(at, 0.001, 1.0 + (x * 0.7).sin())
    }

    /// Follows a way from the root; the light at its end.
    fn follow(tree: &LightTree, mut trail: u32) -> u32 {
        let mut slot = 0;
        loop {
            let link = tree.words[2 * slot as usize + 2][3];
            slot = (link & LIGHT_NODE_SLOTS) + (trail & 1);
            if link & LIGHT_NODE_LEAF << (trail & 1) != 0 {
                return tree.words[2 * slot as usize + 1][0];
            }
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
        assert_eq!((none.words.len(), none.trails), (4, 3));
    }

    /// And half of them where another is.
    #[test]
    fn a_hundred_thousand_lights_have_their_ways() {
        let lights: Vec<_> = (0..100_000).map(|i| Some(ball(i / 2))).collect();
        let tree = LightTree::new(&lights);
        assert_eq!(tree.trails, 1 + 2 * 199_999);
        for i in 0..lights.len() {
            assert_eq!(follow(&tree, trail(&tree, i)), i as u32);
        }
    }

    #[test]
    fn packed_axes_are_within_the_margin_of_their_cones() {
        let unfold = |e: DVec2| {
            let z = 1.0 - e.abs().element_sum();
            let t = (-z).max(0.0);
            let sign = |x: f64| if x >= 0.0 { 1.0 } else { -1.0 };
            DVec3::new(e.x - t * sign(e.x), e.y - t * sign(e.y), z).normalize()
        };
        let mut worst = 0.0_f64;
        for i in 0..100_000 {
            let v = ball(i).center().normalize();
            let e = octahedral(v).to_array().map(|e| (e * 127.0).round() / 127.0);
            worst = worst.max(unfold(e.into()).angle_between(v));
        }
        assert!(worst < AXIS_ERROR && worst > 0.5 * AXIS_ERROR, "{worst}");
    }

    #[test]
    fn halves_are_just_above() {
        for k in 0..2000 {
            let x = LEAST_RADIUS * 2.0_f64.powf(0.0075 * f64::from(k));
            let bits = half_above(x);
            let y = f64::from(1024 + (bits & 1023)) * 2.0_f64.powi((bits >> 10) as i32 - 25);
            assert!(y >= x && y <= x * (1.0 + 1.0 / 1024.0), "{x} {y}");
        }
    }
}
