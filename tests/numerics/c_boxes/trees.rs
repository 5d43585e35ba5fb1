//! Trees over items that are hard to split, and over random ones: C4, C5 and C8.

use crate::common::{
    BUILDERS, Primitive, Random, Stage, World, assert_at_least, assert_at_most, emitter,
    random_ray, report, scene_of, settings, soup, with_device,
};
use crate::traced::{Query, Walk, trace};
use glam::{Affine3A, Vec3};
use rayon::prelude::*;
use std::time::Instant;
use steradian::bvh::{MAX_DEPTH, Ray};
use steradian::scene::Mesh;
use steradian::settings::Strategy;
use steradian::shader::generated::Fault;
use steradian::{RenderSettings, Renderer};

const CORNERS: [Vec3; 3] =
    [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -0.9, 0.1), Vec3::new(0.1, 1.0, 0.2)];

/// Builds with both builders, tells the time, and asserts that the depth is bounded.
fn build_coincident(count: usize) {
    let many = vec![Primitive::Triangle(CORNERS).item(); count];
    for (name, build) in BUILDERS {
        let begin = Instant::now();
        let bvh = build(&many);
        let what = format!("seconds to build {count:e} coincident triangles, {name}");
        report("C4", &what, begin.elapsed().as_secs_f64());
        let statistics = bvh.validate(&many).unwrap_or_else(|e| panic!("{name}: {e}"));
        let what = format!("depth of the tree over {count:e} coincident triangles, {name}");
        assert_at_most("C4", &what, f64::from(statistics.depth), 32.0 + (count as f64).log2());
    }
}

#[test]
fn c4_coincident_triangles_are_split_by_index() {
    build_coincident(100_000);
    for world in World::each("coincident", &vec![Primitive::Triangle(CORNERS); 1000]) {
        let ray = Ray { o: Vec3::Z, d: Vec3::NEG_Z, t_max: f32::MAX };
        let hit = world.closest::<false>(&ray).map(|h| h.item);
        assert_eq!(hit, Some(0), "{}: the first of equal hits", world.name);
    }
}

#[test]
#[ignore = "tier N: about 1 minute"]
fn c4_a_million_coincident_triangles() {
    build_coincident(1_000_000);
}

/// The picture of 1e5 coincident triangles is that of one. A driver that ends loops early cannot
/// test them all at a pixel: the render must then say so.
#[test]
fn c4_a_picture_of_coincident_triangles() {
    let strategy = Strategy::Bsdf;
    let settings = RenderSettings { strategy, max_bounces: Some(0), ..settings(16, 16, 1) };
    let picture = |count: usize| {
        let mut stage = Stage::perspective(Vec3::new(0.3, 0.2, 4.0), Vec3::ZERO, 0.6);
        let mesh = Mesh {
            positions: CORNERS.into(),
            triangles: vec![[0, 1, 2]; count],
            ..Mesh::default()
        };
        let mesh = stage.mesh(mesh, emitter(1.0));
        stage.place(mesh, Affine3A::IDENTITY);
        with_device(|device| {
            let mut renderer = Renderer::new(device, &stage.scene, &settings).unwrap();
            while renderer.step().unwrap() {}
            renderer.finish().unwrap();
            (renderer.film().picture().rgb, renderer.statistics().faults)
        })
    };
    let (one, faults) = picture(1);
    assert_eq!(faults, [0; 4]);
    let lit = one.iter().filter(|c| c[0] > 0.0).count();
    assert_at_least("C4", "lit pixels of 256", lit as f64, 50.0);
    let (many, faults) = picture(100_000);
    let cut_off = faults[Fault::LoopBound as usize];
    report("C4", "pixels of 256 with a loop that the driver cut off", cut_off as f64);
    assert_eq!(faults.iter().sum::<u64>(), cut_off);
    let differ = one.iter().zip(&many).filter(|(a, b)| a != b).count();
    let what = "pixels that differ from one triangle's, 1e5 coincident, less those cut off";
    assert_at_most("C4", what, differ as f64 - cut_off as f64, 0.0);
}

fn wedge(size: f32) -> Primitive {
    Primitive::Triangle([Vec3::ZERO, Vec3::X, Vec3::Y].map(|v| size * (v + Vec3::ONE)))
}

/// Sizes from 1e-30 to 1e30, each a little larger than the one before.
fn progression(count: usize) -> Vec<Primitive> {
    let size = |i: usize| 10.0f32.powf(60.0 * i as f32 / count as f32 - 30.0);
    (0..count).map(|i| wedge(size(i))).collect()
}

/// At wedges of all sizes from 2^-50 to 2^50.
fn wedge_ray(random: &mut Random) -> Ray {
    let size = 2.0f32.powf(100.0 * random.unit() - 50.0);
    let o = size * 2.0 * random.in_cube();
    let d = size * (Vec3::ONE + random.in_cube()) - o;
    Ray { o, d: d.normalize(), t_max: f32::MAX }
}

/// The surface area heuristic alone would peel off one item at a level.
#[test]
fn c5_sizes_in_a_progression_do_not_make_a_tree_deep() {
    let powers: Vec<Primitive> = (-60..=60).map(|i| wedge(2.0f32.powi(i))).collect();
    let mut random = Random(500);
    for world in World::each("wedges of 2^-60 to 2^60", &powers) {
        let depth = f64::from(world.bvh.depth);
        assert_at_most("C5", &format!("depth, {}", world.name), depth, f64::from(MAX_DEPTH));
        let (mut hits, mut wrong) = (0, 0);
        for _ in 0..20_000 {
            let ray = wedge_ray(&mut random);
            let expected = world.brute_force::<false>(&ray);
            hits += u32::from(expected.is_some());
            wrong += u32::from(!world.is_right::<false>(&ray, expected));
            wrong += u32::from(!world.is_right::<true>(&ray, world.brute_force::<true>(&ray)));
        }
        let what = format!("of 4e4 rays, {}, not as brute force", world.name);
        assert_at_most("C5", &what, f64::from(wrong), 0.0);
        assert_at_least("C5", "of 2e4 of them, hits", f64::from(hits), 2e3);
    }
    let many = progression(100_000);
    for world in World::each("1e5 wedges over 60 decades", &many) {
        let depth = f64::from(world.bvh.depth);
        assert_at_most("C5", &format!("depth, {}", world.name), depth, f64::from(MAX_DEPTH));
        let is_wrong = |_: &u32| {
            let ray = wedge_ray(&mut random);
            !world.is_right::<false>(&ray, world.brute_force::<false>(&ray))
        };
        let wrong = (0..40).filter(is_wrong).count();
        let what = format!("of 40 rays, {}, not as brute force", world.name);
        assert_at_most("C5", &what, wrong as f64, 0.0);
    }
}

/// A full stack would be a fault.
#[test]
fn c5_the_stack_is_large_enough_on_the_device() {
    let powers: Vec<Primitive> = (-60..=60).map(|i| wedge(2.0f32.powi(i))).collect();
    let scene = scene_of(&powers);
    let mut random = Random(501);
    let queries: Vec<Query> = (0..1 << 15)
        .map(|_| {
            let ray = wedge_ray(&mut random);
            Query::new(ray.o, ray.d)
        })
        .collect();
    let expected = trace(&scene, Walk::BruteForce, &queries);
    for walk in Walk::over_trees() {
        let answers = trace(&scene, walk, &queries);
        let differ = answers.iter().zip(&expected).filter(|(a, b)| a != b).count();
        let what = format!("of 32768 rays at wedges, not as brute force, device, {walk:?}");
        assert_at_most("C5", &what, differ as f64, 0.0);
    }
    let hits = expected.iter().filter(|a| a.source().is_some()).count();
    assert_at_least("C5", "of them, hits", hits as f64, 3e3);

    let queries = &queries[..1024];
    let progression = progression(4000);
    let scene = scene_of(&progression);
    let expected = trace(&scene, Walk::BruteForce, queries);
    for walk in Walk::over_trees() {
        let answers = trace(&scene, walk, queries);
        let differ = answers.iter().zip(&expected).filter(|(a, b)| a != b).count();
        let what = format!("of 1024 rays at 4e3 wedges, not as brute force, device, {walk:?}");
        assert_at_most("C5", &what, differ as f64, 0.0);
    }
}

/// Triangles first; from 1 to 400 of both.
fn mixture(seed: u64) -> Vec<Primitive> {
    let count = 1 + 20 * seed as usize;
    soup(count - count / 4, count / 4, &mut Random(800 + seed))
}

#[test]
fn c8_random_mixtures_equal_brute_force() {
    const RAYS: u32 = 25_000;
    let of_scene = |seed: u64| {
        let mut random = Random(Random(820 + seed).bits());
        let (mut hits, mut wrong) = (0, 0);
        for world in World::each(&format!("seed {seed}"), &mixture(seed)) {
            for i in 0..RAYS {
                let ray = random_ray(&mut random);
                let expected = world.brute_force::<false>(&ray);
                hits += u32::from(expected.is_some());
                wrong += u32::from(!world.is_right::<false>(&ray, expected));
                if i % 8 == 0 {
                    let expected = world.brute_force::<true>(&ray);
                    wrong += u32::from(!world.is_right::<true>(&ray, expected));
                }
            }
        }
        [hits, wrong]
    };
    let sum = |a: [u32; 2], b: [u32; 2]| [a[0] + b[0], a[1] + b[1]];
    let [hits, wrong] = (0..20).into_par_iter().map(of_scene).reduce(|| [0; 2], sum);
    let what = "of 1e6 rays in 20 mixtures, both builders, closest or any hit not as brute force";
    assert_at_most("C8", what, f64::from(wrong), 0.0);
    assert_at_least("C8", "of them, hits", f64::from(hits), 1e5);
}

#[test]
fn c8_random_mixtures_equal_brute_force_on_the_device() {
    let mut random = Random(840);
    let [mut rays, mut hits] = [0, 0];
    let mut wrong: Vec<(Walk, u32)> = Walk::over_trees().map(|w| (w, 0)).collect();
    for seed in [0, 5, 12, 19] {
        let scene = scene_of(&mixture(seed));
        let queries: Vec<Query> = (0..1 << 15)
            .map(|_| {
                let Ray { o, d, t_max } = random_ray(&mut random);
                Query { o, d, t_max, any_t_max: t_max }
            })
            .collect();
        let expected = trace(&scene, Walk::BruteForce, &queries);
        rays += queries.len();
        hits += expected.iter().filter(|a| a.is_blocked()).count();
        for (walk, wrong) in &mut wrong {
            let answers = trace(&scene, *walk, &queries);
            *wrong += answers.iter().zip(&expected).filter(|(a, b)| a != b).count() as u32;
        }
    }
    for (walk, wrong) in wrong {
        let what = format!("of {rays} rays in 4 mixtures, not as brute force, device, {walk:?}");
        assert_at_most("C8", &what, f64::from(wrong), 0.0);
    }
    assert_at_least("C8", "of them, hits", hits as f64, 1e4);
}
