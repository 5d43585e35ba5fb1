//! D7: spheres that cannot be, and spheres too small for their place.

use crate::common::{Random, Stage, assert_at_most, lambert, report};
use crate::gltf_fixture::{Fixture, has_notice};
use crate::probe::{Found, Probe, probe_primitives};
use glam::Vec3;
use serde_json::{Value, json};
use steradian::scene::Treatment;

fn sphere(radius: Value, x: f64) -> Fixture {
    let mut fixture = Fixture::triangle();
    let extras = json!({"steradian": {"sphere": {"radius": radius}}});
    fixture.json["meshes"][0]["extras"] = extras;
    fixture.json["nodes"][0] = json!({"mesh": 0, "name": "ball", "translation": [x, 0.0, 0.0]});
    fixture
}

#[test]
fn d7_radii_that_are_none_are_refused() {
    let mut accepted = 0.0;
    // JSON has no NaN; a null is none, and a number beyond f32 becomes infinite.
    for radius in [json!(0.0), json!(-0.0), json!(-1.0), json!(1e39), json!(null), json!("NaN")] {
        let message = sphere(radius.clone(), 0.0).refusal();
        if !message.contains("mesh 0: ") {
            accepted += 1.0;
        }
    }
    // A radius that only the node's scale makes too large or too small for f32.
    for (radius, scale) in [(1e38, 1e5), (1e-38, 1e-10)] {
        let mut fixture = sphere(json!(radius), 0.0);
        fixture.json["nodes"][0]["scale"] = json!([scale, scale, scale]);
        let message = fixture.refusal();
        if !message.contains("radius in the world") {
            accepted += 1.0;
        }
    }
    assert_at_most("D7", "impossible radii of 8 without a message", accepted, 0.0);
}

#[test]
fn d7_spheres_too_small_for_their_place_are_noted() {
    let mut wrong = 0.0;
    for (radius, x, is_noted) in [
        (1.0, 1e5, true),
        (1e-6, 1e3, true),
        (0.1, 1e3, true),
        (1.0, 1e3, false),
        (100.0, 1e5, false),
        (1e-6, 0.0, false),
        (1e7, 1e7, false),
    ] {
        let scene = sphere(json!(radius), x).scene();
        if has_notice(&scene, Treatment::Approximated, "too small") != is_noted {
            wrong += 1.0;
        }
    }
    assert_at_most("D7", "spheres of 7 with a wrong message or none", wrong, 0.0);
}

/// What the message is about: rays that start inward from the surface, uniform over the
/// hemisphere, whose next hit is less than half as far as it should be, or none.
#[test]
fn d7_short_chords_in_small_spheres_far_away() {
    for distance in [1e1_f32, 1e2, 1e3, 1e4, 1e5] {
        let mut random = Random(18);
        let center = distance * Vec3::new(0.6, -0.48, 0.64);
        let mut stage = Stage::perspective(Vec3::ZERO, center, 1.0);
        stage.sphere(center, 1.0, lambert(0.5));
        let probe = |_| {
            let o = center + 3.0 * random.direction();
            let cosine = random.unit().max(1e-6);
            let (s, c) = (std::f32::consts::TAU * random.unit()).sin_cos();
            let sine = (1.0 - cosine * cosine).sqrt();
            let scattered = Vec3::new(s * sine, c * sine, -cosine);
            Probe { scattered, ..Probe::new(o, center - o) }.of_primitives(0, 1)
        };
        let probes: Vec<_> = (0..1 << 16).map(probe).collect();
        let found = probe_primitives(&stage.scene, &probes);
        let is_lost = |(p, f): &(&Probe, &Found)| {
            let chord = 2.0 * -p.scattered.z;
            f.again().is_none_or(|t| t < 0.5 * chord)
        };
        let lost = probes.iter().zip(&found).filter(is_lost).count() as f64;
        let what = format!("share of inward rays cut short, |C| / R = {distance:e}, 65536 rays");
        report("D7", &what, lost / probes.len() as f64);
    }
}
