//! E4: the shadow of a unit sphere that touches a floor.

use crate::common::{Random, Stage, assert_at_most, lambert, report, settings};
use crate::probe::{Probe, probe_tree, segments};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;
use steradian::RenderSettings;
use steradian::scene::{LightKind, Scene};

/// The sphere on a floor of this half side, and a light from 45 degrees above +x.
fn scene(half: f32) -> Scene {
    let mut stage = Stage::perspective(Vec3::new(3.0, 1.0, 3.0), Vec3::ZERO, 1.0);
    stage.sphere(Vec3::Y, 1.0, lambert(0.0));
    stage.floor(Vec3::ZERO, half, lambert(0.5));
    let direction = Vec3::new(-1.0, -1.0, 0.0).normalize();
    stage.light(LightKind::Directional { direction }, 1.0);
    stage.scene
}

/// How far outside the sphere the ray towards the light passes: below 0 is shadow.
fn clearance(p: DVec3) -> f64 {
    let toward = DVec3::new(1.0, 1.0, 0.0).normalize();
    let f = p - DVec3::Y;
    (f - f.dot(toward) * toward).length() - 1.0
}

/// From above a point of the floor, below the sphere, down.
fn down_at(x: f32, z: f32) -> (Vec3, Vec3) {
    let gap = 1.0 - (1.0 - f64::from(x).powi(2) - f64::from(z).powi(2)).max(0.0).sqrt();
    (Vec3::new(x, 0.5 * gap as f32, z), -Vec3::Y)
}

/// A light without extent: the radiance is 0 in the shadow and E cos / pi times the albedo
/// outside. Points at 1e-4 to 1e-1 from the contact, and as far from the shadow's edge.
#[test]
fn e4_a_contact_shadow_is_where_it_should_be() {
    let scene = scene(0.6);
    let mut random = Random(28);
    let mut points = Vec::new();
    for i in 0..1 << 16 {
        let distance = 1e-4 * 1000f32.powf(random.unit());
        let (s, c) = (std::f32::consts::TAU * random.unit()).sin_cos();
        if i % 2 == 0 {
            points.push((distance * c, distance * s));
        } else {
            // The shadow is an ellipse about (-1, 0) with half axes sqrt(2) and 1.
            let z = 0.5 * s;
            let edge = -1.0 + 2f32.sqrt() * (1.0 - z * z).sqrt();
            points.push((edge + if i % 4 == 1 { distance } else { -distance }, z));
        }
    }
    let inputs: Vec<_> = points.iter().map(|&(x, z)| (down_at(x, z), [0.5, 0.5])).collect();
    let found = segments(&scene, &settings(8, 8, 1), &inputs);
    let cosine = std::f64::consts::FRAC_1_SQRT_2;
    let (mut wrong, mut error, mut lit) = (0.0, 0.0_f64, 0);
    for (f, &(x, z)) in found.iter().zip(&points) {
        let is_lit = clearance(DVec3::new(f64::from(x), 0.0, f64::from(z))) > 0.0;
        wrong += f64::from(u8::from(f.is_visible() != Some(is_lit)));
        if f.is_visible() == Some(true) {
            lit += 1;
            error = error.max((f64::from(f.irradiance) / cosine - 1.0).abs());
        }
    }
    assert!(lit > 10_000, "{lit}");
    assert_at_most("E4", "wrong points of 65536 in and about a contact shadow", wrong, 0.0);
    assert_at_most("E4", "relative error of the lit radiance", error, 1e-6);
}

/// Under an even sky the sphere leaves the share 1 - (1 + d²)^-1.5 of it at distance d from
/// the contact. Rays are drawn where the sky can be, and counted.
#[test]
fn e4_the_sky_beside_a_contact() {
    let scene = scene(0.2);
    for (distance, is_judged, rays) in
        [(1e-1_f64, true, 1 << 18), (1e-2, true, 1 << 18), (1e-3, false, 4096), (1e-4, false, 4096)]
    {
        let mut random = Random(29);
        let (origin, down) = down_at(distance as f32, 0.0);
        // The sky begins below an elevation of twice the slope of the sphere's tangent cone.
        let highest = (2.5 * distance).min(1.0);
        let probe = |_| {
            let up = highest * f64::from(random.unit());
            let (s, c) = (TAU * f64::from(random.unit())).sin_cos();
            let across = (1.0 - up * up).sqrt();
            let scattered = Vec3::new((s * across) as f32, (c * across) as f32, up as f32);
            Probe { scattered, ..Probe::new(origin, down) }
        };
        let probes: Vec<_> = (0..rays).map(probe).collect();
        // Density of the draw: 1 / (2 pi highest); a ray counts cos / pi.
        let weight = |p: &Probe| f64::from(p.scattered.z) * 2.0 * highest;
        let shares: Vec<f64> = probe_tree(&scene, &probes)
            .iter()
            .zip(&probes)
            .map(|(f, p)| if f.again().is_none() { weight(p) } else { 0.0 })
            .collect();
        let estimate = crate::common::Estimate::of(&shares);
        // (1 + d²)^-1.5 without cancellation.
        let truth = -(-1.5 * (distance * distance).ln_1p()).exp_m1();
        let what = format!("error of the sky's share {distance:e} from a contact");
        if is_judged {
            let chance = 3.0 * estimate.standard_error / truth;
            assert_at_most("E4", &format!("3 standard errors, {what}"), chance, 0.01);
            assert_at_most("E4", &what, (estimate.mean / truth - 1.0).abs(), 0.01);
        } else {
            report("E4", &format!("{what}, of all sky"), (estimate.mean - truth).abs());
        }
    }
}

/// The settings only choose light samples.
#[test]
fn e4_the_picture_in_the_gap_is_black() {
    for distance in [1e-4_f32, 1e-3, 1e-2, 1e-1] {
        let eye = down_at(distance, 0.0).0;
        let mut stage = Stage::orthographic(eye, eye - Vec3::Y, 0.1 * distance);
        let contents = scene(0.6);
        let camera = stage.scene.cameras.remove(0);
        let scene = Scene { cameras: vec![camera], ..contents };
        let settings = RenderSettings { max_bounces: Some(1), ..settings(16, 16, 16) };
        let film = crate::common::render(&scene, &settings);
        let brightest = crate::common::grey(&film).into_iter().fold(0.0, f64::max);
        assert_at_most(
            "E4",
            &format!("brightest pixel {distance:e} from a contact"),
            brightest,
            0.0,
        );
    }
}
