//! Trees as data structures: valid for any boxes, the same for any number of threads, and
//! checks that find a defect. That they find every hit is with the hard cases in numerics/.

mod common;

use common::{BUILDERS, Random, World, items, random_ray, soup};
use glam::Vec3;
use steradian::bvh::{Aabb, BuildItem, Bvh, Link, PrimitiveKind};

/// Boxes as large, as small and as flat as f32 has them.
#[test]
fn extreme_boxes_make_valid_trees() {
    let mut random = Random(400);
    let tiny = f32::from_bits(1);
    for scale in [0.0, tiny, 1e-40, 1e-30, 1e-12, 1.0, 1e12, 1e30, 1e38, f32::MAX] {
        for flatness in [0.0, 1e-20, 1.0] {
            let kinds = [PrimitiveKind::Triangle, PrimitiveKind::Sphere, PrimitiveKind::Instance];
            let items: Vec<BuildItem> = (0..500)
                .map(|_| {
                    let (a, b) = (scale * random.in_cube(), scale * random.in_cube());
                    let flat = Vec3::new(1.0, flatness, 1.0);
                    let bounds = Aabb::of_points(&[a * flat, (a + 0.1 * (b - a)) * flat]);
                    BuildItem { bounds, kind: kinds[random.bits() as usize % 3] }
                })
                .filter(|item| item.bounds.min.is_finite() && item.bounds.max.is_finite())
                .collect();
            for (name, build) in BUILDERS {
                build(&items)
                    .validate(&items)
                    .unwrap_or_else(|e| panic!("{name}, scale {scale} x {flatness}: {e}"));
            }
        }
    }
}

/// Shapes that leave a builder nothing to choose by, or lead it to a path for every item.
#[test]
fn equal_and_nested_boxes_make_shallow_trees() {
    let item = |min: Vec3, max: Vec3| BuildItem {
        bounds: Aabb { min, max },
        kind: PrimitiveKind::Triangle,
    };
    let equal = vec![item(Vec3::ZERO, Vec3::ONE); 10_000];
    // All around the origin, each larger by the same step: the nearest to any is the one inside.
    let nested = |i: usize| item(Vec3::splat(-(i as f32)), Vec3::splat(i as f32));
    let nested: Vec<_> = (1..=10_000).map(nested).collect();
    // Side by side, each much larger than all before.
    let growing = |i: i32| {
        let size = 1.3_f32.powi(i);
        item(Vec3::splat(size), Vec3::splat(1.3 * size))
    };
    let growing: Vec<_> = (-250..250).map(growing).collect();
    for (shape, items) in [("equal", equal), ("nested", nested), ("growing", growing)] {
        for (name, build) in BUILDERS {
            let statistics =
                build(&items).validate(&items).unwrap_or_else(|e| panic!("{name}, {shape}: {e}"));
            // Equal ones are halved: 14 levels to single items.
            assert!(shape != "equal" || statistics.depth <= 14, "{name}: {}", statistics.depth);
        }
    }
}

#[test]
fn the_tree_does_not_depend_on_the_number_of_threads() {
    let items = items(&soup(150_000, 50_000, &mut Random(500)));
    for (name, build) in BUILDERS {
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("a thread pool").install(|| build(&items))
        });
        assert!(one == three, "{name}");
    }
}

#[test]
fn the_surface_area_heuristic_lowers_the_cost() {
    let items = items(&soup(15_000, 5_000, &mut Random(600)));
    let [sah, median] = BUILDERS.map(|(name, build)| {
        build(&items).validate(&items).unwrap_or_else(|e| panic!("{name}: {e}"))
    });
    assert!(sah.sah_cost < 0.9 * median.sah_cost, "{} {}", sah.sah_cost, median.sah_cost);
    assert_eq!(sah.leaf_sizes.iter().sum::<usize>(), sah.leaf_count);
}

/// The checks above can fail: each defect is found, and a box that is too small
/// makes rays miss what brute force hits.
#[test]
fn defects_are_found() {
    let mut random = Random(700);
    let primitives = soup(150, 50, &mut random);
    let items = items(&primitives);
    let world = World::each("sound", &primitives).swap_remove(0);
    let broken = |defect: &dyn Fn(&mut Bvh)| {
        let mut bvh = world.bvh.clone();
        defect(&mut bvh);
        bvh
    };
    let error = |defect: &dyn Fn(&mut Bvh)| {
        broken(defect).validate(&items).expect_err("the tree is broken")
    };
    // Every box of every node, made smaller by one step on one side.
    for node in 0..world.bvh.nodes.len() {
        for child in 0..2 {
            let found = error(&|bvh| {
                let word = &mut bvh.nodes[node].children[child].x;
                *word -= 1 << 16;
            });
            assert!(found.contains("not inside"), "{found}");
        }
    }
    let leaves = world.bvh.nodes.iter().flat_map(|node| node.children);
    let pair = leaves.filter_map(|child| match child.target() {
        Some(Link::Leaf { first, count: 2.., .. }) => Some(first as usize),
        _ => None,
    });
    for first in pair {
        let found = error(&|bvh| bvh.order[first + 1] = bvh.order[first]);
        assert!(found.contains("twice"), "{found}");
    }
    assert!(error(&|bvh| bvh.order.truncate(199)).contains("199"));
    assert!(error(&|bvh| bvh.depth += 1).contains("depth"));
    assert!(error(&|bvh| bvh.nodes[1].children[0].link = 0).contains("before"));
    assert!(error(&|bvh| bvh.nodes.push(bvh.nodes[0])).contains("not reached"));

    let half = World {
        bvh: broken(&|bvh| {
            for child in &mut bvh.nodes[0].children {
                let (lower, upper) = (child.lower()[0], child.upper()[0]);
                child.x = lower | (((lower + upper) / 2) << 16);
            }
        }),
        ..world
    };
    let lost = (0..10_000)
        .map(|_| random_ray(&mut random))
        .filter(|ray| half.closest::<false>(ray) != half.brute_force::<false>(ray))
        .count();
    assert!(lost > 100, "{lost} of 10000 rays");
}

#[test]
fn a_tree_over_instances_has_one_in_a_leaf() {
    let mut random = Random(800);
    let items: Vec<BuildItem> = (0..100)
        .map(|_| {
            let bounds = Aabb::of_sphere(random.in_cube(), 0.5);
            BuildItem { bounds, kind: PrimitiveKind::Instance }
        })
        .collect();
    for (name, build) in BUILDERS {
        let bvh = build(&items);
        let statistics = bvh.validate(&items).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(statistics.leaf_sizes[1], 100);
        let links = bvh.nodes.iter().flat_map(|node| node.children).map(|child| child.target());
        let leaves = links.filter(|link| {
            matches!(link, Some(Link::Leaf { kind: PrimitiveKind::Instance, count: 1, .. }))
        });
        assert_eq!(leaves.count(), 100);
    }
}
