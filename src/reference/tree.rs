//! A tree of bounding boxes, split at the median of the longest axis.

use super::geometry::Ray;
use glam::DVec3;

/// Primitives of a leaf at most.
const LEAF_SIZE: usize = 4;

/// An axis-aligned box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

/// Boxes within boxes; the leaves hold indices of primitives.
#[derive(Debug)]
pub(super) struct Tree {
    bounds: Bounds,
    content: Content,
}

#[derive(Debug)]
enum Content {
    Leaf(Vec<usize>),
    Halves(Box<[Tree; 2]>),
}

impl Bounds {
    fn of(all: impl Iterator<Item = Bounds>) -> Bounds {
        let nothing = Bounds { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        all.fold(nothing, |a, b| Bounds { low: a.low.min(b.low), high: a.high.max(b.high) })
    }

    fn center(&self) -> DVec3 {
        self.low * 0.5 + self.high * 0.5
    }

    /// Where the ray is inside for the first time from 0 on; `None` if never.
    fn entry(&self, ray: &Ray) -> Option<f64> {
        let (mut first, mut last) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
            let sides = [self.low[axis] - origin, self.high[axis] - origin];
            if direction == 0.0 {
                if sides[0] > 0.0 || sides[1] < 0.0 {
                    return None;
                }
                continue;
            }
            let [a, b] = sides.map(|side| side / direction);
            first = first.max(a.min(b));
            last = last.min(a.max(b));
        }
        (first <= last).then_some(first)
    }
}

impl Tree {
    /// Over primitives with these bounds.
    pub(super) fn new(bounds: &[Bounds]) -> Self {
        Self::over((0..bounds.len()).collect(), bounds)
    }

    fn over(mut primitives: Vec<usize>, bounds: &[Bounds]) -> Self {
        let whole = Bounds::of(primitives.iter().map(|&p| bounds[p]));
        if primitives.len() <= LEAF_SIZE {
            return Self { bounds: whole, content: Content::Leaf(primitives) };
        }
        let size = whole.high - whole.low;
        let axis = (0..3).fold(0, |a, b| if size[b] > size[a] { b } else { a });
        let middle = primitives.len() / 2;
        let at = |p: usize| bounds[p].center()[axis];
        primitives.select_nth_unstable_by(middle, |&p, &q| at(p).total_cmp(&at(q)));
        let above = primitives.split_off(middle);
        let halves = Box::new([Self::over(primitives, bounds), Self::over(above, bounds)]);
        Self { bounds: whole, content: Content::Halves(halves) }
    }

    /// Calls `test` with every primitive whose box the ray enters, roughly from near to far.
    /// It returns how far from the origin the ray still matters.
    pub(super) fn visit(&self, ray: &Ray, test: &mut impl FnMut(usize) -> f64) {
        let mut limit = f64::INFINITY;
        if let Some(entry) = self.bounds.entry(ray) {
            self.visit_inside(ray, entry, &mut limit, test);
        }
    }

    fn visit_inside(
        &self,
        ray: &Ray,
        entry: f64,
        limit: &mut f64,
        test: &mut impl FnMut(usize) -> f64,
    ) {
        if entry > *limit {
            return;
        }
        match &self.content {
            Content::Leaf(primitives) => primitives.iter().for_each(|&p| *limit = test(p)),
            Content::Halves(halves) => {
                let mut order = halves.each_ref().map(|half| (half.bounds.entry(ray), half));
                if order[1].0 < order[0].0 {
                    order.swap(0, 1);
                }
                for (entry, half) in order {
                    if let Some(entry) = entry {
                        half.visit_inside(ray, entry, limit, test);
                    }
                }
            }
        }
    }
}
