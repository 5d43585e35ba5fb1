//! A cube of flat boxes, and rays in the planes of those: C1 and C2, on the mirror.

use super::naive::{ExactTree, ieee, nan_propagating, without_pad};
use crate::closed_mesh::pick;
use crate::common::{
    Primitive, Random, World, assert_at_least, assert_at_most, assert_naive_fails,
};
use glam::Vec3;
use rayon::prelude::*;
use steradian::bvh::{Aabb, ItemHit, Ray};

const CELLS: usize = 16;
const STEP: f32 = 0.3;
/// So far from the origin of coordinates that planes are exact in no frame.
const CORNER: Vec3 = Vec3::new(10.1, -7.3, 3.7);

/// The faces of a cube, cut along a grid into 6 x 16 x 16 x 2 triangles.
pub(super) fn grid_cube() -> Vec<Primitive> {
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for side in [0, CELLS] {
            for (i, j) in (0..CELLS * CELLS).map(|k| (k / CELLS, k % CELLS)) {
                let corner = |di: usize, dj: usize| {
                    let mut p = [side as f32; 3];
                    p[(axis + 1) % 3] = (i + di) as f32;
                    p[(axis + 2) % 3] = (j + dj) as f32;
                    Vec3::from(p) * STEP + CORNER
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                triangles.extend([[a, b, c], [a, c, d]].map(Primitive::Triangle));
            }
        }
    }
    triangles
}

/// Kinds of rays for which a box test may meet 0 times infinity, or nothing but rounding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Along an axis, the other components 0.
    Axis,
    /// Along an axis, the other components -0.
    NegativeZeros,
    /// Along an axis, on a line of the grid.
    GridLine,
    /// One component zero, the origin on a plane of the grid across it.
    GridPlane,
    /// One component 1e-30, the origin on a plane of the grid across it.
    Tiny,
    /// At a random point of an edge of the grid, from anywhere near.
    Edge,
}

impl Kind {
    pub(super) const IN_PLANES: [Self; 5] =
        [Self::Axis, Self::NegativeZeros, Self::GridLine, Self::GridPlane, Self::Tiny];

    pub(super) fn ray(self, triangles: &[Primitive], random: &mut Random) -> Ray {
        let Primitive::Triangle([a, b, c]) = triangles[pick(random, triangles.len())] else {
            unreachable!("the grid is of triangles")
        };
        let inside = a + random.unit() * (b - a) + random.unit() * (c - a);
        let on_edge = a + random.unit() * (b - a);
        let axis = pick(random, 3);
        let sign = if pick(random, 2) == 0 { 1.0 } else { -1.0 };
        let along = |rest: f32| {
            let mut d = Vec3::splat(rest);
            d[axis] = sign;
            d
        };
        let (target, d) = match self {
            Self::Axis => (inside, along(0.0)),
            Self::NegativeZeros => (inside, along(-0.0)),
            Self::GridLine => (a, along(0.0f32.copysign(sign))),
            Self::GridPlane | Self::Tiny => {
                let mut d = random.direction();
                d[axis] = if self == Self::Tiny { 1e-30 * sign } else { 0.0f32.copysign(sign) };
                (if pick(random, 2) == 0 { a } else { on_edge }, d)
            }
            Self::Edge => {
                let o = CORNER + CELLS as f32 * STEP * (0.5 + random.in_cube());
                return Ray { o, d: on_edge - o, t_max: f32::MAX };
            }
        };
        let distance = [1.0, 3.0, 1e3][pick(random, 3)];
        Ray { o: target - distance * d, d, t_max: f32::MAX }
    }
}

/// Triangles of a ball.
const CLUSTER: usize = 8;

/// Balls about successive triangles, grown by far more than any rounding: brute force leaves out
/// those that a ray's line is not near.
struct Balls(Vec<(Vec3, f32)>);

impl Balls {
    fn new(primitives: &[Primitive]) -> Self {
        let ball = |cluster: &[Primitive]| {
            let bounds = cluster.iter().map(|p| p.item().bounds);
            let Aabb { min, max } = bounds.fold(Aabb::empty(), Aabb::union);
            (0.5 * (min + max), (0.5 * min.distance(max) + 0.05).powi(2))
        };
        Self(primitives.chunks(CLUSTER).map(ball).collect())
    }

    fn near(&self, ray: &Ray) -> impl Iterator<Item = usize> {
        let (o, d) = (ray.o, ray.d.normalize());
        let is_near = move |(center, radius_squared): &(Vec3, f32)| {
            (*center - o).cross(d).length_squared() <= *radius_squared
        };
        let near = self.0.iter().enumerate().filter(move |(_, ball)| is_near(ball));
        near.flat_map(|(i, _)| i * CLUSTER..(i + 1) * CLUSTER)
    }
}

/// Of `count` rays of a kind at the grid cube, how many hit by brute force, and for how many
/// `is_right` denies that the trees say the same.
fn tally<const FUSED: bool>(
    worlds: &[World],
    kind: Kind,
    count: u64,
    is_right: impl Fn(&World, &Ray, Option<ItemHit>) -> bool + Sync,
) -> (f64, f64) {
    const CHUNK: u64 = 1000;
    let primitives = &worlds[0].primitives;
    let balls = Balls::new(primitives);
    let chunk = |chunk: u64| {
        let mut random = Random(Random((kind as u64) << 32 | chunk).bits());
        let (mut hits, mut wrong) = (0, 0);
        for _ in 0..CHUNK {
            let ray = kind.ray(primitives, &mut random);
            let expected = worlds[0].first_of::<FUSED>(&ray, balls.near(&ray));
            hits += u32::from(expected.is_some());
            wrong += u32::from(!worlds.iter().all(|w| is_right(w, &ray, expected)));
        }
        [hits, wrong]
    };
    let sum = |a: [u32; 2], b: [u32; 2]| [a[0] + b[0], a[1] + b[1]];
    let [hits, wrong] = (0..count / CHUNK).into_par_iter().map(chunk).reduce(|| [0; 2], sum);
    (f64::from(hits), f64::from(wrong))
}

/// A tree by the surface area heuristic in plain arithmetic; an eighth as many rays in fused
/// arithmetic, and at the tree split by medians.
fn judge(case: &str, kind: Kind, count: u64) {
    let worlds = World::each("grid", &grid_cube());
    let (sah, median) = worlds.split_at(1);
    let few = count / 8;
    let what = |n: u64, how: &str| format!("of {n} rays {kind:?}, not as brute force, {how}");
    let (hits, wrong) = tally::<false>(sah, kind, count, World::is_right::<false>);
    assert_at_most(case, &what(count, "plain"), wrong, 0.0);
    assert_at_least(case, "of them, hits", hits, count as f64 / 2.0);
    let (_, wrong) = tally::<true>(sah, kind, few, World::is_right::<true>);
    assert_at_most(case, &what(few, "fused"), wrong, 0.0);
    let (_, wrong) = tally::<false>(median, kind, few, World::is_right::<false>);
    assert_at_most(case, &what(few, "plain, split by medians"), wrong, 0.0);
}

#[test]
fn c1_rays_in_box_planes_lose_no_hit() {
    Kind::IN_PLANES.into_iter().for_each(|kind| judge("C1", kind, 200_000));
}

#[test]
fn c1_usual_box_tests_lose_hits() {
    let worlds = &World::each("grid", &grid_cube())[..1];
    let tree = ExactTree::new(&worlds[0]);
    for kind in [Kind::GridLine, Kind::GridPlane] {
        for (name, slab) in [("IEEE", ieee as fn(&Ray, &Aabb) -> _), ("NaN", nan_propagating)] {
            let keeps = |_: &World, r: &Ray, e: Option<ItemHit>| {
                tree.closest(r, slab).is_some() || e.is_none()
            };
            let (hits, lost) = tally::<false>(worlds, kind, 10_000, keeps);
            let what = format!("1/0 and {name} min and max, share of hits lost, {kind:?}");
            assert_naive_fails("C1", &what, lost / hits, 0.1);
        }
    }
}

#[test]
fn c2_flat_boxes_are_not_passed_over() {
    judge("C2", Kind::Edge, 200_000);
    let worlds = &World::each("grid", &grid_cube())[..1];
    let tree = ExactTree::new(&worlds[0]);
    let same = |_: &World, r: &Ray, e: Option<ItemHit>| tree.closest(r, without_pad) == e;
    let (hits, wrong) = tally::<false>(worlds, Kind::Edge, 20_000, same);
    assert_naive_fails("C2", "no pad, share of edge rays with a wrong hit", wrong / hits, 1e-3);
}
