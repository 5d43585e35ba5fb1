//! Usual box tests over the exact boxes of a tree, for comparison.

use crate::common::World;
use glam::Vec3;
use steradian::bvh::{Aabb, ItemHit, Link, Ray};

/// Ray parameters between which a ray is inside a box, or NaN.
type Slab = fn(&Ray, &Aabb) -> (f32, f32);

fn planes(ray: &Ray, inverse: Vec3, bounds: &Aabb) -> (Vec3, Vec3) {
    ((bounds.min - ray.o) * inverse, (bounds.max - ray.o) * inverse)
}

/// The reciprocal of zero is infinite, and the least and the greatest of a number and NaN are the
/// number.
pub(super) fn ieee(ray: &Ray, bounds: &Aabb) -> (f32, f32) {
    let (a, b) = planes(ray, ray.d.recip(), bounds);
    let (mut near, mut far) = (0.0f32, ray.t_max);
    for i in 0..3 {
        near = near.max(a[i].min(b[i]));
        far = far.min(a[i].max(b[i]));
    }
    (near, far)
}

/// As [`ieee`], but NaN wins.
pub(super) fn nan_propagating(ray: &Ray, bounds: &Aabb) -> (f32, f32) {
    let (a, b) = planes(ray, ray.d.recip(), bounds);
    if (a + b).is_nan() && (a.is_nan() || b.is_nan()) {
        (f32::NAN, f32::NAN)
    } else {
        ieee(ray, bounds)
    }
}

/// Components of zero replaced, and nothing added for rounding.
pub(super) fn without_pad(ray: &Ray, bounds: &Aabb) -> (f32, f32) {
    let d = ray.d.map(|c| if c.abs() < 1e-30 { 1e-30f32.copysign(c) } else { c });
    let (a, b) = planes(ray, d.recip(), bounds);
    (a.min(b).max_element().max(0.0), a.max(b).min_element().min(ray.t_max))
}

/// A tree with the exact boxes of its children.
pub(super) struct ExactTree<'a> {
    world: &'a World,
    boxes: Vec<[Aabb; 2]>,
}

impl<'a> ExactTree<'a> {
    pub(super) fn new(world: &'a World) -> Self {
        let mut boxes = vec![[Aabb::empty(); 2]; world.bvh.nodes.len()];
        // Children come after their parents.
        for node in (0..boxes.len()).rev() {
            boxes[node] = world.bvh.nodes[node].children.map(|child| match child.target() {
                Some(Link::Inner { node }) => {
                    let [a, b] = boxes[node as usize];
                    a.union(b)
                }
                Some(Link::Leaf { first, count, .. }) => {
                    let order = &world.bvh.order[first as usize..(first + count) as usize];
                    let bounds = |&i: &u32| world.primitives[i as usize].item().bounds;
                    order.iter().map(bounds).fold(Aabb::empty(), Aabb::union)
                }
                None => unreachable!("the tree is valid"),
            });
        }
        Self { world, boxes }
    }

    /// The first hit, with boxes passed over that begin behind it.
    pub(super) fn closest(&self, ray: &Ray, slab: Slab) -> Option<ItemHit> {
        let mut best: Option<ItemHit> = None;
        let mut pending = vec![0_usize];
        while let Some(node) = pending.pop() {
            let children = self.world.bvh.nodes[node].children.iter().zip(&self.boxes[node]);
            let mut inner: Vec<(f32, usize)> = Vec::new();
            for (child, bounds) in children {
                let (near, far) = slab(ray, bounds);
                let end = best.map_or(ray.t_max, |b| b.t);
                if !(near <= far && near <= end) {
                    continue;
                }
                match child.target() {
                    Some(Link::Inner { node }) => inner.push((near, node as usize)),
                    Some(Link::Leaf { first, count, .. }) => {
                        let order = &self.world.bvh.order[first as usize..(first + count) as usize];
                        let items = order.iter().map(|&i| i as usize);
                        let hit = self.world.first_of::<false>(ray, items);
                        let first = best.into_iter().chain(hit);
                        best = first.reduce(|a, b| if b.is_before(&a) { b } else { a });
                    }
                    None => unreachable!("the tree is valid"),
                }
            }
            inner.sort_by(|a, b| b.0.total_cmp(&a.0));
            pending.extend(inner.into_iter().map(|(_, node)| node));
        }
        best
    }
}
