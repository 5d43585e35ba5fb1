//! Trees of any builder in one form, and what they cost.

use glam::Vec3;
use steradian::bvh::{Aabb, Bvh, Link, Ray, triangle_hit};

/// A tree with two children a node and boxes in f32. The first node is the root.
pub(crate) struct Tree {
    pub(crate) nodes: Vec<[(Aabb, Child); 2]>,
    /// Triangles in the order of the leaves.
    pub(crate) order: Vec<u32>,
}

/// What a box leads to.
#[derive(Clone, Copy)]
pub(crate) enum Child {
    Inner(u32),
    /// First index into [`Tree::order`] and how many.
    Leaf(u32, u32),
}

/// What a set of rays touches, on average.
#[derive(Clone, Copy, Default)]
pub(crate) struct Touched {
    pub(crate) nodes: f64,
    pub(crate) triangles: f64,
}

impl From<&Bvh> for Tree {
    /// With the boxes as the device sees them.
    fn from(bvh: &Bvh) -> Self {
        let plane = |q: [u32; 3]| bvh.grid_min + Vec3::from(q.map(|q| q as f32)) * bvh.grid_scale;
        let nodes = bvh.nodes.iter().map(|node| {
            node.children.map(|c| {
                let bounds = Aabb { min: plane(c.lower()), max: plane(c.upper()) };
                let child = match c.target().expect("a link of a builder") {
                    Link::Inner { node } => Child::Inner(node),
                    Link::Leaf { first, count, .. } => Child::Leaf(first, count),
                };
                (bounds, child)
            })
        });
        Self { nodes: nodes.collect(), order: bvh.order.clone() }
    }
}

impl Tree {
    /// Expected work of a ray that meets the root's box, in triangle tests: `node` is the cost
    /// of visiting a node.
    pub(crate) fn sah_cost(&self, node: f64) -> f64 {
        let area = |b: &Aabb| f64::from(b.surface_area());
        let root = area(&self.nodes[0][0].0.union(self.nodes[0][1].0));
        let costs = self.nodes.iter().flatten().map(|(bounds, child)| match *child {
            Child::Inner(_) => node * area(bounds),
            Child::Leaf(_, 0) => 0.0,
            Child::Leaf(_, count) => area(bounds) * f64::from(count),
        });
        node + costs.sum::<f64>() / root
    }

    /// Triangles in a leaf, on average.
    pub(crate) fn leaf_size(&self) -> f64 {
        let leaf = |child: &Child| matches!(child, Child::Leaf(_, 1..));
        let leaves = self.nodes.iter().flatten().filter(|(_, child)| leaf(child)).count();
        self.order.len() as f64 / leaves as f64
    }

    /// What rays touch until their nearest hit, and those hits: triangle and distance.
    pub(crate) fn walk(&self, triangles: &[[Vec3; 3]], rays: &[Ray]) -> (Touched, Vec<(u32, f32)>) {
        let (mut nodes, mut tests) = (0_u64, 0_u64);
        let hits = rays.iter().map(|ray| {
            let (hit, counts) = self.closest(triangles, ray);
            nodes += counts[0];
            tests += counts[1];
            hit
        });
        let hits = hits.collect();
        let mean = |count: u64| count as f64 / rays.len() as f64;
        (Touched { nodes: mean(nodes), triangles: mean(tests) }, hits)
    }

    fn closest(&self, triangles: &[[Vec3; 3]], ray: &Ray) -> ((u32, f32), [u64; 2]) {
        let inverse = ray.d.recip();
        let (mut hit, mut counts) = ((u32::MAX, ray.t_max), [0; 2]);
        let (mut stack, mut node) = (Vec::with_capacity(64), 0);
        loop {
            counts[0] += 1;
            let mut next: Option<(u32, f32)> = None;
            for (bounds, child) in &self.nodes[node as usize] {
                let Some(t) = entry(bounds, ray.o, inverse, hit.1) else { continue };
                match *child {
                    Child::Inner(below) => match next {
                        Some((other, other_t)) => {
                            let nearer = t < other_t;
                            stack.push(if nearer { other } else { below });
                            next = Some((if nearer { below } else { other }, t.min(other_t)));
                        }
                        None => next = Some((below, t)),
                    },
                    Child::Leaf(first, count) => {
                        counts[1] += u64::from(count);
                        for &item in &self.order[first as usize..(first + count) as usize] {
                            let [a, b, c] = triangles[item as usize];
                            let found = triangle_hit(ray.o, ray.d, a, b, c, hit.1);
                            hit = found.map_or(hit, |found| (item, found.t));
                        }
                    }
                }
            }
            node = match next {
                Some((near, _)) => near,
                None => match stack.pop() {
                    Some(below) => below,
                    None => return (hit, counts),
                },
            };
        }
    }
}

fn entry(bounds: &Aabb, o: Vec3, inverse: Vec3, t_max: f32) -> Option<f32> {
    let (a, b) = ((bounds.min - o) * inverse, (bounds.max - o) * inverse);
    let near = a.min(b).max_element().max(0.0);
    let far = a.max(b).min_element().min(t_max);
    // Wide enough for flat boxes.
    (near <= far * 1.000001).then_some(near)
}
