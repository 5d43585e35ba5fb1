//! Scenes of garbage numbers: C7. Each is refused with the name of what is wrong, or gives
//! finite hits.

use crate::closed_mesh::pick;
use crate::common::{
    Primitive, Random, World, assert_at_least, assert_at_most, random_ray, report, scene_of,
};
use crate::gltf_fixture::Fixture;
use crate::traced::{Answer, Query, Walk, trace};
use rayon::prelude::*;
use serde_json::json;
use steradian::bvh::Ray;
use steradian::gpu::{TreeWidth, World as GpuWorld};
use steradian::scene::Scene;
use steradian::settings::Accel;

const GARBAGE: [f32; 16] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    1e38,
    -1e38,
    1e16,
    1e11,
    -1e11,
    1e-40,
    -1e-40,
    f32::MIN_POSITIVE,
    0.0,
    -0.0,
    1.0,
    1.0 + f32::EPSILON,
];

/// A mesh of up to 30 triangles. `mild`: with nothing that a loader must refuse in a position.
fn fixture(random: &mut Random) -> Fixture {
    let mut fixture = Fixture::triangle();
    let is_mild = pick(random, 4) != 0;
    let first = if is_mild { 7 } else { 0 };
    let garbage = |random: &mut Random| GARBAGE[first + pick(random, GARBAGE.len() - first)];
    let share = 1 + pick(random, 8);
    let number = |random: &mut Random| {
        if pick(random, share) == 0 { garbage(random) } else { 2.0 * random.unit() - 1.0 }
    };
    let vertices = 3 + pick(random, 30);
    let positions: Vec<f32> = (0..3 * vertices).map(|_| number(random)).collect();
    let accessor = fixture.floats("VEC3", &positions);
    fixture.attribute("POSITION", accessor);
    // Repeated ones among them, and seldom one too many.
    let highest = vertices + usize::from(pick(random, 50) == 0);
    let count = 3 * (1 + pick(random, 30));
    let indices: Vec<u16> = (0..count).map(|_| pick(random, highest) as u16).collect();
    fixture.indices(&indices);
    if pick(random, 5) == 0 {
        let scale = [0; 3].map(|_| number(random));
        let translation = [0; 3].map(|_| number(random));
        fixture.json["nodes"][0]["scale"] = json!(scale);
        fixture.json["nodes"][0]["translation"] = json!(translation);
    }
    fixture
}

fn triangles(scene: &Scene) -> Vec<Primitive> {
    let of_instance = |i: &steradian::scene::Instance| {
        let mesh = &scene.meshes[i.mesh as usize];
        let place = |v: u32| i.world_from_object.transform_point3(mesh.positions[v as usize]);
        mesh.triangles.iter().map(|t| Primitive::Triangle(t.map(place))).collect::<Vec<_>>()
    };
    scene.instances.iter().flat_map(of_instance).collect()
}

fn is_finite(primitive: &Primitive) -> bool {
    matches!(primitive, Primitive::Triangle(v) if v.iter().all(|v| v.is_finite()))
}

/// Whether a triangle is too thin for f32 to tell where it is hit: its picture along a ray can
/// vanish in rounding.
fn is_sliver(primitive: &Primitive) -> bool {
    let Primitive::Triangle(v) = primitive else { return false };
    let [a, b, c] = v.map(|v| v.as_dvec3());
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    let height = (b - a).cross(c - a).length() / longest;
    height / longest < 1.0 / 4_194_304.0
}

#[derive(Default)]
struct Tally {
    accepted: u32,
    /// Refused without the name of what is wrong.
    unnamed: u32,
    /// Vertices that are not finite in a scene that was accepted.
    not_finite: u32,
    /// Rays for which t is not finite, or closest and any hit disagree, or the tree does not say
    /// what brute force does, unless one of them is a hit on a sliver.
    wrong: u32,
    /// Rays for which a hit on a sliver is not what brute force says.
    on_slivers: u32,
    hits: u32,
    sample: Vec<Primitive>,
}

fn judge(chunk: u64, count: u64) -> Tally {
    let mut random = Random(Random(700 << 32 | chunk).bits());
    let mut tally = Tally::default();
    for _ in 0..count {
        let scene = match fixture(&mut random).load() {
            Ok(scene) => scene,
            Err(error) => {
                let message = error.to_string();
                let names = ["mesh 0", "node 0", "its scene", "not glTF"];
                tally.unnamed += u32::from(!names.iter().any(|n| message.contains(n)));
                continue;
            }
        };
        tally.accepted += 1;
        let primitives = triangles(&scene);
        tally.not_finite += primitives.iter().filter(|p| !is_finite(p)).count() as u32;
        for width in [TreeWidth::Two, TreeWidth::Four] {
            GpuWorld::build(&scene, Accel::Bvh, width).unwrap();
        }
        for world in World::each("garbage", &primitives) {
            for i in 0..12 {
                let mut ray = random_ray(&mut random);
                if i % 2 == 0 {
                    let target = primitives[pick(&mut random, primitives.len())];
                    ray = Ray { d: target.item().bounds.centroid() - ray.o, ..ray };
                }
                let expected = world.brute_force::<false>(&ray);
                let found = world.closest::<false>(&ray);
                let mut hits = found.iter().chain(&expected);
                let is_sound = found.is_none_or(|h| h.t.is_finite())
                    && world.is_blocked::<false>(&ray) == found.is_some();
                let excused = hits.any(|h| is_sliver(&primitives[h.item as usize]));
                tally.hits += u32::from(expected.is_some());
                tally.wrong += u32::from(!is_sound || (found != expected && !excused));
                tally.on_slivers += u32::from(found != expected && excused);
            }
        }
        if tally.sample.len() < 60 {
            tally.sample.extend(primitives);
        }
    }
    tally
}

#[test]
fn c7_garbage_is_refused_or_gives_finite_hits() {
    const SCENES: u64 = 10_000;
    const CHUNK: u64 = 250;
    let tallies: Vec<Tally> =
        (0..SCENES / CHUNK).into_par_iter().map(|chunk| judge(chunk, CHUNK)).collect();
    let sum = |f: fn(&Tally) -> u32| f64::from(tallies.iter().map(f).sum::<u32>());
    let accepted = sum(|t| t.accepted);
    assert_at_least("C7", "of 1e4 garbage scenes, accepted", accepted, 1e3);
    assert_at_least("C7", "of 1e4 garbage scenes, refused", SCENES as f64 - accepted, 1e3);
    assert_at_most("C7", "refused without a name", sum(|t| t.unnamed), 0.0);
    assert_at_most("C7", "accepted vertices that are not finite", sum(|t| t.not_finite), 0.0);
    assert_at_most("C7", "rays with an unsound hit, or not as brute force", sum(|t| t.wrong), 0.0);
    report("C7", "rays not as brute force at slivers beyond 2^22 : 1", sum(|t| t.on_slivers));
    assert_at_least("C7", "rays that hit", sum(|t| t.hits), 1e3);

    // The accepted ones of many scenes together, on the device.
    let sample: Vec<Primitive> = tallies.into_iter().flat_map(|t| t.sample).collect();
    let scene = scene_of(&sample);
    let mut random = Random(710);
    let queries: Vec<Query> = (0..1 << 14)
        .map(|_| {
            let o = random_ray(&mut random).o;
            let target = sample[pick(&mut random, sample.len())];
            Query::new(o, target.item().bounds.centroid() - o)
        })
        .collect();
    for walk in Walk::each() {
        let is_sound = |a: &Answer| {
            let is_finite = a.t.is_finite() && a.u.is_finite() && a.v.is_finite();
            is_finite && a.is_blocked() == a.source().is_some()
        };
        let unsound = trace(&scene, walk, &queries).iter().filter(|a| !is_sound(a)).count();
        let what = format!("of 16384 rays at garbage, unsound hits, device, {walk:?}");
        assert_at_most("C7", &what, unsound as f64, 0.0);
    }
}
