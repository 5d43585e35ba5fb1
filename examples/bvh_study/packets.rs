//! What packets of rays touch in a tree of four children a node, in the form that the
//! device reads.

use crate::tree::Touched;
use glam::Vec3;
use steradian::bvh::{
    BvhChild, LEAF_BIT, LEAF_COUNT_MASK, LEAF_COUNT_SHIFT, LEAF_FIRST_MASK, Ray, triangle_hit,
};

/// A tree of triangles alone, as `World` has it.
pub(crate) struct WideTree<'a> {
    /// A record of two words, then nodes of four.
    pub(crate) nodes: &'a [[u32; 4]],
    /// Three words a triangle.
    pub(crate) primitives: &'a [[u32; 4]],
}

impl WideTree<'_> {
    /// Nodes and triangles of a packet of `lanes` rays on average, of the nearest hits of `rays`;
    /// with `any`, of any hit.
    pub(crate) fn walk(&self, rays: &[Ray], lanes: usize, any: bool) -> Touched {
        let mut counts = [0_u64; 2];
        for packet in rays.chunks_exact(lanes) {
            self.packet(packet, any, &mut counts);
        }
        let [nodes, triangles] = counts.map(|c| c as f64 / (rays.len() / lanes) as f64);
        Touched { nodes, triangles }
    }

    fn packet(&self, rays: &[Ray], any: bool, counts: &mut [u64; 2]) {
        let real = |w: &[u32; 4]| Vec3::new(w[0] as f32, w[1] as f32, w[2] as f32);
        let bits = |w: &[u32; 4]| Vec3::from([w[0], w[1], w[2]].map(f32::from_bits));
        let (min, scale) = (bits(&self.nodes[0]), bits(&self.nodes[1]));
        let inverses: Vec<Vec3> = rays.iter().map(|ray| ray.d.recip()).collect();
        let mut t: Vec<f32> = rays.iter().map(|ray| ray.t_max).collect();
        let mut stack = vec![self.nodes[0][3]];
        while let Some(link) = stack.pop() {
            if link & LEAF_BIT != 0 {
                let count = link >> LEAF_COUNT_SHIFT & LEAF_COUNT_MASK;
                for i in 0..count {
                    let at = 3 * ((link & LEAF_FIRST_MASK) + i) as usize;
                    let [a, b, c] = std::array::from_fn(|k| bits(&self.primitives[at + k]));
                    counts[1] += 1;
                    for lane in 0..rays.len() {
                        let (o, d) = (rays[lane].o, rays[lane].d);
                        if let Some(hit) = triangle_hit(o, d, a, b, c, t[lane]) {
                            t[lane] = if any { -1.0 } else { hit.t };
                        }
                    }
                }
                if any && t.iter().all(|&t| t < 0.0) {
                    return;
                }
                continue;
            }
            counts[0] += 1;
            let mut met = Vec::with_capacity(4);
            for words in &self.nodes[link as usize..link as usize + 4] {
                let [x, y, z, link] = *words;
                let child = BvhChild { x, y, z, link };
                let plane = |q: [u32; 3]| min + real(&[q[0], q[1], q[2], 0]) * scale;
                let (low, high) = (plane(child.lower()), plane(child.upper()));
                let nearest = (0..rays.len()).filter_map(|lane| {
                    let (a, b) = (
                        (low - rays[lane].o) * inverses[lane],
                        (high - rays[lane].o) * inverses[lane],
                    );
                    let lower = child.lower()[0] <= child.upper()[0];
                    let near = a.min(b).max_element().max(0.0);
                    let far = a.max(b).min_element().min(t[lane]);
                    (lower && near <= far * 1.000001).then_some(near)
                });
                if let Some(near) = nearest.min_by(f32::total_cmp) {
                    met.push((near, link));
                }
            }
            met.sort_by(|a, b| b.0.total_cmp(&a.0));
            stack.extend(met.iter().map(|m| m.1));
        }
    }
}
