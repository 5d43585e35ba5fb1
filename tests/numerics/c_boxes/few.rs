//! Nothing, and one to three primitives: C3.

use super::segments::large;
use crate::common::{
    Primitive, Random, Stage, World, assert_at_least, assert_at_most, random_ray, render, scene_of,
    settings,
};
use crate::traced::{Answer, Query, Walk, trace};
use glam::{DVec3, Vec3};
use steradian::bvh::{ItemHit, Ray};

/// What f64 says of one primitive: where the ray meets it, and whether it is clear that it does
/// or does not.
fn meets(primitive: &Primitive, o: DVec3, d: DVec3) -> (Option<f64>, bool) {
    const CLEAR: f64 = 1e-4;
    match *primitive {
        Primitive::Triangle(v) => {
            let [a, b, c] = v.map(|v| v.as_dvec3());
            let normal = (b - a).cross(c - a);
            let t = (a - o).dot(normal) / d.dot(normal);
            let p = o + t * d;
            let weight =
                |a: DVec3, b: DVec3| (b - a).cross(p - a).dot(normal) / normal.length_squared();
            let least = weight(a, b).min(weight(b, c)).min(weight(c, a));
            let hit = (least > 0.0 && t > 0.0).then_some(t);
            (hit, least.abs() > CLEAR && t.abs() > CLEAR)
        }
        Primitive::Sphere(center, radius) => {
            let (f, r) = (o - center.as_dvec3(), f64::from(radius));
            let (a, b) = (d.length_squared(), -f.dot(d));
            let discriminant = r * r - (f + b / a * d).length_squared();
            if discriminant < 0.0 {
                return (None, -discriminant > CLEAR * r * r);
            }
            let half = (discriminant / a).sqrt();
            let roots = [b / a - half, b / a + half];
            let hit = roots.into_iter().find(|&t| t > 0.0);
            (hit, discriminant > CLEAR * r * r && roots.iter().all(|t| t.abs() > CLEAR))
        }
    }
}

/// The first hit in (0, t_max) in f64, if no rounding decides about it.
fn clear_first(primitives: &[Primitive], ray: &Ray) -> Option<Option<(u32, f64)>> {
    const APART: f64 = 1e-4;
    let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
    let t_max = f64::from(ray.t_max);
    let mut hits = Vec::new();
    for (i, primitive) in primitives.iter().enumerate() {
        let (hit, is_clear) = meets(primitive, o, d);
        if !is_clear || hit.is_some_and(|t| (t - t_max).abs() < APART) {
            return None;
        }
        hits.extend(hit.filter(|&t| t < t_max).map(|t| (i as u32, t)));
    }
    hits.sort_by(|a, b| a.1.total_cmp(&b.1));
    let is_apart = hits.len() < 2 || hits[1].1 - hits[0].1 > APART;
    is_apart.then(|| hits.first().copied())
}

fn agrees(found: Option<(u32, f32)>, truth: Option<(u32, f64)>) -> bool {
    match (found, truth) {
        (None, None) => true,
        (Some((i, t)), Some((j, s))) => i == j && (f64::from(t) - s).abs() <= 1e-3 * s.max(1.0),
        _ => false,
    }
}

fn worlds() -> impl Iterator<Item = Vec<Primitive>> {
    let mixtures = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3)];
    mixtures.into_iter().enumerate().map(|(i, (triangles, spheres))| {
        let mut random = Random(300 + i as u64);
        large(triangles, spheres, &mut random)
    })
}

fn rays(primitives: &[Primitive], seed: u64, count: usize) -> Vec<Ray> {
    let mut random = Random(seed);
    (0..count)
        .map(|i| {
            let ray = random_ray(&mut random);
            match primitives.get(i % 4) {
                // At a primitive.
                Some(p) => Ray { d: p.item().bounds.centroid() - ray.o, t_max: f32::MAX, ..ray },
                None => ray,
            }
        })
        .collect()
}

#[test]
fn c3_few_primitives_are_hit_as_they_are() {
    let (mut clear, mut hits, mut wrong) = (0, 0, 0);
    for primitives in worlds() {
        for world in World::each(&format!("{primitives:?}"), &primitives) {
            for ray in rays(&primitives, 310, 2000) {
                let Some(truth) = clear_first(&primitives, &ray) else { continue };
                clear += 1;
                hits += u32::from(truth.is_some());
                let place = |h: ItemHit| (h.item, h.t);
                wrong += u32::from(!agrees(world.closest::<false>(&ray).map(place), truth));
                wrong += u32::from(!agrees(world.closest::<true>(&ray).map(place), truth));
                wrong += u32::from(world.is_blocked::<false>(&ray) != truth.is_some());
            }
        }
    }
    assert_at_most("C3", "of 4e4 rays at 0 to 3 primitives, not as f64", f64::from(wrong), 0.0);
    assert_at_least("C3", "of them, clear", f64::from(clear), 2e4);
    assert_at_least("C3", "of them, hits", f64::from(hits), 8e3);
}

#[test]
fn c3_few_primitives_are_hit_as_they_are_on_the_device() {
    let (mut hits, mut wrong) = (0, 0);
    for primitives in worlds() {
        let scene = scene_of(&primitives);
        let rays = rays(&primitives, 320, 1024);
        let query = |r: &Ray| Query { o: r.o, d: r.d, t_max: r.t_max, any_t_max: r.t_max };
        let queries: Vec<Query> = rays.iter().map(query).collect();
        for walk in Walk::each() {
            for (ray, answer) in rays.iter().zip(trace(&scene, walk, &queries)) {
                let Some(truth) = clear_first(&primitives, ray) else { continue };
                hits += u32::from(truth.is_some());
                let place = |a: &Answer| a.source().map(|s| (s, a.t));
                wrong += u32::from(!agrees(place(&answer), truth));
                wrong += u32::from(answer.is_blocked() != truth.is_some());
            }
        }
    }
    assert_at_most(
        "C3",
        "of 3e4 rays at 0 to 3 primitives, not as f64, device",
        f64::from(wrong),
        0.0,
    );
    assert_at_least("C3", "of them, hits", f64::from(hits), 6e3);
}

#[test]
fn c3_a_scene_of_nothing_is_its_background() {
    let mut stage = Stage::perspective(Vec3::ZERO, Vec3::NEG_Z, 1.0);
    stage.sky(0.75);
    let film = render(&stage.scene, &settings(16, 16, 4));
    let differ = film.picture().rgb.iter().filter(|&&c| c != [0.75; 3]).count();
    assert_at_most("C3", "pixels of 256 other than the background", differ as f64, 0.0);
}
