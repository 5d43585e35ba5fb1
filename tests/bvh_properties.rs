//! Trees against brute force with the same intersection functions: on random and on
//! degenerate items, on rays along boxes' planes, for closest and any hit.

use glam::Vec3;
use steradian::bvh::{
    Aabb, BuildItem, Bvh, ItemHit, Link, MAX_DEPTH, PrimitiveKind, Ray, any_hit, build_median,
    build_sah, closest_hit, sphere_hit, triangle_hit,
};

type Builder = fn(&[BuildItem]) -> Bvh;
const BUILDERS: [(&str, Builder); 2] = [("sah", build_sah), ("median", build_median)];

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / 16_777_216.0
    }

    fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f32) as usize
    }

    fn in_cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

#[derive(Clone, Copy)]
enum Primitive {
    Triangle([Vec3; 3]),
    Sphere(Vec3, f32),
}

impl Primitive {
    fn item(&self) -> BuildItem {
        match *self {
            Self::Triangle(v) => {
                BuildItem { bounds: Aabb::of_points(&v), kind: PrimitiveKind::Triangle }
            }
            Self::Sphere(center, radius) => {
                BuildItem { bounds: Aabb::of_sphere(center, radius), kind: PrimitiveKind::Sphere }
            }
        }
    }

    fn hit(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        match *self {
            Self::Triangle([a, b, c]) => triangle_hit(ray.o, ray.d, a, b, c, t_max).map(|h| h.t),
            Self::Sphere(center, radius) => {
                sphere_hit::<false>(ray.o, ray.d, center, radius, t_max)
            }
        }
    }
}

/// Primitives and their tree, which is valid.
struct World {
    name: String,
    primitives: Vec<Primitive>,
    bvh: Bvh,
}

impl World {
    fn each(name: &str, primitives: &[Primitive]) -> Vec<Self> {
        let items = items(primitives);
        let build = |(builder, build): (&str, Builder)| {
            let name = format!("{name}, {builder}");
            let bvh = build(&items);
            if let Err(error) = bvh.validate(&items) {
                panic!("{name}: {error}");
            }
            Self { name, primitives: primitives.to_vec(), bvh }
        };
        BUILDERS.into_iter().map(build).collect()
    }

    fn brute_force(&self, ray: &Ray) -> Option<ItemHit> {
        let hits = self.primitives.iter().enumerate().filter_map(|(item, primitive)| {
            primitive.hit(ray, ray.t_max).map(|t| ItemHit { t, item: item as u32 })
        });
        hits.reduce(|a, b| if b.is_before(&a) { b } else { a })
    }

    fn closest(&self, ray: &Ray) -> Option<ItemHit> {
        closest_hit(&self.bvh, ray, |kind, item, t_max| {
            let primitive = &self.primitives[item as usize];
            assert_eq!(primitive.item().kind, kind);
            primitive.hit(ray, t_max)
        })
    }

    /// Whether the tree gives what brute force gives, to the bit. Returns whether
    /// there was a hit.
    fn check(&self, ray: &Ray) -> bool {
        let expected = self.brute_force(ray);
        assert_eq!(self.closest(ray), expected, "{}: {ray:?}", self.name);
        let any = any_hit(&self.bvh, ray, |_, item, t_max| {
            self.primitives[item as usize].hit(ray, t_max)
        });
        assert_eq!(any, expected.is_some(), "{}, any hit: {ray:?}", self.name);
        expected.is_some()
    }
}

fn items(primitives: &[Primitive]) -> Vec<BuildItem> {
    primitives.iter().map(Primitive::item).collect()
}

/// `count` triangles and spheres with sizes spread over three decades.
fn soup(count: usize, random: &mut Random) -> Vec<Primitive> {
    (0..count)
        .map(|_| {
            let center = random.in_cube();
            let size = 10.0f32.powf(-0.3 - 3.0 * random.unit());
            if random.below(4) == 0 {
                Primitive::Sphere(center, size)
            } else {
                Primitive::Triangle([0; 3].map(|_| center + size * random.in_cube()))
            }
        })
        .collect()
}

/// A ray from about the cube towards the primitives, of random length.
fn random_ray(random: &mut Random) -> Ray {
    let o = 2.0 * random.in_cube();
    let d = random.in_cube() - o;
    let t_max = if random.below(2) == 0 { f32::MAX } else { 2.0 * random.unit() };
    Ray { o, d, t_max }
}

#[test]
fn random_mixtures_equal_brute_force() {
    let mut hits = 0;
    for seed in 0..20 {
        let mut random = Random(seed);
        let primitives = soup(1 + 20 * seed as usize, &mut random);
        for world in World::each(&format!("seed {seed}"), &primitives) {
            for _ in 0..22_000 {
                hits += u32::from(world.check(&random_ray(&mut random)));
            }
        }
    }
    assert!((88_000..792_000).contains(&hits), "{hits} of 880000 hit");
}

/// 6 x 16 x 16 x 2 triangles: the faces of a cube, cut along a grid, far enough from the
/// origin of coordinates that planes are not exact in any frame.
fn grid_cube() -> Vec<Primitive> {
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for side in [0.0f32, 16.0] {
            for i in 0..16 {
                for j in 0..16 {
                    let corner = |di: usize, dj: usize| {
                        let mut p = [side; 3];
                        p[(axis + 1) % 3] = (i + di) as f32;
                        p[(axis + 2) % 3] = (j + dj) as f32;
                        Vec3::from(p) * 0.3 + Vec3::new(10.1, -7.3, 3.7)
                    };
                    let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    triangles.extend([[a, b, c], [a, c, d]].map(Primitive::Triangle));
                }
            }
        }
    }
    triangles
}

#[test]
fn rays_in_the_planes_of_flat_boxes_equal_brute_force() {
    let primitives = grid_cube();
    let mut random = Random(100);
    let [mut hits, mut rays] = [0, 0];
    for world in World::each("grid", &primitives) {
        for i in 0..15_000 {
            let Primitive::Triangle(v) = primitives[random.below(primitives.len())] else {
                unreachable!("the grid is of triangles")
            };
            let target = match i % 3 {
                0 => v[0],
                1 => v[0] + random.unit() * (v[1] - v[0]),
                _ => (v[0] + v[1] + v[2]) / 3.0,
            };
            let axis = random.below(3);
            let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
            let mut d = [0.0f32 * sign; 3];
            d[axis] = sign;
            match i % 5 {
                // Along an axis, with zeros of both signs.
                0 | 1 => {}
                // With one zero component, from a plane of the grid.
                2 => d[(axis + 1) % 3] = random.unit(),
                // With a component too small to divide by.
                3 => d[(axis + 1) % 3] = 1e-30 * sign,
                _ => d = (target - Vec3::new(12.5, -4.9, 6.1)).into(),
            }
            let d = Vec3::from(d);
            let distance = if i % 2 == 0 { 3.0 } else { 1e3 };
            let o = if i % 5 == 4 { target - d } else { target - distance * d };
            rays += 1;
            hits += u32::from(world.check(&Ray { o, d, t_max: f32::MAX }));
        }
    }
    assert!(hits > rays / 2, "{hits} of {rays} hit");
}

#[test]
fn few_primitives_are_enough() {
    let mut random = Random(200);
    for world in World::each("nothing", &[]) {
        assert_eq!(world.bvh.nodes.len(), 1);
        for _ in 0..100 {
            assert!(!world.check(&random_ray(&mut random)));
        }
    }
    for count in 1..=20 {
        let primitives = soup(count, &mut random);
        for world in World::each(&format!("{count} primitives"), &primitives) {
            for i in 0..500 {
                let mut ray = random_ray(&mut random);
                if i % 2 == 0 {
                    let bounds = primitives[i % count].item().bounds;
                    ray = Ray { d: bounds.centroid() - ray.o, t_max: f32::MAX, ..ray };
                }
                world.check(&ray);
            }
        }
    }
}

#[test]
fn coincident_items_are_split_by_index() {
    let triangle = Primitive::Triangle([Vec3::X, Vec3::Y, Vec3::Z]);
    let many = vec![triangle.item(); 100_000];
    for (name, build) in BUILDERS {
        let statistics = build(&many).validate(&many).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(statistics.depth <= 17, "{name}: depth {}", statistics.depth);
    }
    for world in World::each("coincident", &vec![triangle; 100]) {
        let hit = world.closest(&Ray { o: Vec3::ZERO, d: Vec3::ONE, t_max: f32::MAX });
        assert_eq!(hit.map(|h| h.item), Some(0), "{}: the first of equal hits", world.name);
    }
}

/// Two coincident quads in four orders, one of them so large that its vertices are
/// known to 1e-2 only: the lower index wins always, whatever the tree.
#[test]
fn ties_go_to_the_lowest_index() {
    let mut random = Random(250);
    for (size, slope, offset) in [(9.0, 0.1, 0.0), (9.0, 0.1, 1e3), (9e4, 0.0, 0.3)] {
        let point = |x: f32, z: f32| Vec3::new(x, slope * x + offset, z);
        let corner = |x: f32, z: f32| point(size * x, size * z);
        let (a, b) = (corner(-1.0, -1.0), corner(1.0, -1.0));
        let (c, d) = (corner(1.0, 1.0), corner(-1.0, 1.0));
        let quad = [Primitive::Triangle([a, b, c]), Primitive::Triangle([a, c, d])];
        let fill = soup(40, &mut random);
        for order in 0..4 {
            let mut primitives = Vec::new();
            for i in 0..4 {
                primitives.push(quad[(i + order) % 2]);
                primitives.extend(&fill[10 * i..10 * i + 10 * (i + order) / 6]);
            }
            for world in World::each(&format!("order {order}"), &primitives) {
                for _ in 0..10_000 {
                    let target = point(9.0 * random.unit(), 9.0 * random.unit());
                    let o = target + 3.0 * random.in_cube();
                    world.check(&Ray { o, d: random.in_cube(), t_max: f32::MAX });
                }
            }
        }
    }
}

/// Sizes in a geometric progression: the surface area heuristic alone would peel
/// off one item at a level.
#[test]
fn depth_is_bounded() {
    let at = |size: f32| {
        Primitive::Triangle([Vec3::ZERO, Vec3::X, Vec3::Y].map(|v| size * (v + Vec3::ONE)))
    };
    let powers: Vec<Primitive> = (-60..=60).map(|i| at(2.0f32.powi(i))).collect();
    for world in World::each("powers of two", &powers) {
        assert!(world.bvh.depth <= MAX_DEPTH);
        let mut random = Random(300);
        for _ in 0..5_000 {
            let size = 2.0f32.powf(100.0 * random.unit() - 50.0);
            let o = size * 2.0 * random.in_cube();
            let d = size * (Vec3::ONE + random.in_cube()) - o;
            world.check(&Ray { o, d: d.normalize(), t_max: f32::MAX });
        }
    }
    let progression: Vec<BuildItem> =
        (0..100_000).map(|i| at(10.0f32.powf(60.0 * i as f32 / 1e5 - 30.0)).item()).collect();
    for (name, build) in BUILDERS {
        build(&progression).validate(&progression).unwrap_or_else(|e| panic!("{name}: {e}"));
    }
}

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
                    BuildItem { bounds, kind: kinds[random.below(3)] }
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

#[test]
fn the_tree_does_not_depend_on_the_number_of_threads() {
    let items = items(&soup(200_000, &mut Random(500)));
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
    let items = items(&soup(20_000, &mut Random(600)));
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
    let primitives = soup(200, &mut random);
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
        .filter(|ray| half.closest(ray) != half.brute_force(ray))
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
