//! F9, F10 and F12: which light is chosen, scenes with nothing to choose, and lights that no ray
//! can meet.

use super::{ALBEDO, receiver};
use crate::common::{
    Call, Estimate, Random, Stage, assert_at_least, assert_at_most, assert_naive_fails,
    assert_truth, emitter, grey, harness, lambert, quad_mesh, render, settings, with_uvs,
};
use glam::{Affine2, Affine3A, Vec2, Vec3, Vec4};
use std::f64::consts::PI;
use steradian::RenderSettings;
use steradian::scene::{ColorSpace, Image, LightKind, Material, Scene, TextureRef, Wrap};
use steradian::settings::{LightSelection, Strategy};
use steradian::statistics::{FALSE_ALARM, GoodnessOfFit, sidak};

/// Squares side by side that emit these radiances; with 0, by a black texture: their power is
/// known when the texture has been read.
fn lamps(radiances: &[f32]) -> Scene {
    let mut stage = receiver(1.0);
    let rgba = vec![[0, 0, 0, 255]];
    stage.scene.images.push(Image { name: "black".into(), width: 1, height: 1, rgba });
    let black = TextureRef {
        image: 0,
        color_space: ColorSpace::Srgb,
        uv_set: 0,
        transform: Affine2::IDENTITY,
        wrap: [Wrap::Repeat; 2],
        nearest: true,
    };
    for (k, &radiance) in radiances.iter().enumerate() {
        let quad = quad_mesh(Vec3::new(k as f32, 1.0, 0.0), Vec3::X * 0.4, Vec3::Z * 0.4);
        let material = match radiance > 0.0 {
            true => emitter(radiance),
            false => Material { emission_texture: Some(black), ..emitter(1.0) },
        };
        let mesh = stage.mesh(with_uvs(quad, [Vec2::splat(0.5); 4]), material);
        stage.place(mesh, Affine3A::IDENTITY);
    }
    stage.scene
}

/// A chosen light.
#[derive(Debug, Clone, Copy)]
struct Pick {
    index: usize,
    cdf: f32,
    pmf: f32,
    light_count: usize,
}

fn pick(scene: &Scene, numbers: &[f32]) -> Vec<Pick> {
    let mut padded = numbers.to_vec();
    padded.resize(numbers.len().next_multiple_of(64), 0.0);
    let by_power =
        RenderSettings { light_selection: LightSelection::Power, ..RenderSettings::default() };
    let out: Vec<Vec4> =
        Call::new(harness!("light_pick"), &[]).on(scene, &by_power).run(&padded, 1);
    let pick =
        |o: &Vec4| Pick { index: o.x as usize, cdf: o.y, pmf: o.z, light_count: o.w as usize };
    out[..numbers.len()].iter().map(pick).collect()
}

/// A square is two lights. The usual search ends at the first sum that is not below u.
#[test]
fn f9_no_light_without_power_is_chosen() {
    const COUNT: usize = 1 << 16;
    let one_below = 1.0_f32.next_down();
    let cases: [&[f32]; 7] = [
        &[1.0, 0.0, 0.0],
        &[0.0, 1.0, 0.0],
        &[0.0, 0.0, 1.0],
        &[1e-20, 1.0],
        &[1.0, 1e-20],
        &[1e20, 0.0, 1e-20],
        &[3.0, 0.0, 2.0, 0.5, 0.0],
    ];
    let (mut black, mut naive_black, mut least) = (0, 0, 1.0_f64);
    for (k, radiances) in cases.iter().enumerate() {
        let scene = lamps(radiances);
        let mut random = Random(80 + k as u64);
        let numbers: Vec<f32> = (0..COUNT).map(|_| random.unit()).collect();
        let picks = pick(&scene, &numbers);
        let mut edges = vec![0.0, one_below, one_below.next_down()];
        for p in &picks {
            let edge = [p.cdf.next_down().max(0.0), p.cdf, p.cdf.next_up()];
            if !edges.contains(&p.cdf.next_up()) {
                edges.extend(edge);
            }
        }
        let has_power = |p: &Pick| radiances[p.index / 2] > 0.0 && p.pmf > 0.0;
        black += picks.iter().filter(|p| !has_power(p)).count();
        for (u, p) in edges.iter().zip(pick(&scene, &edges)) {
            assert!(p.light_count == 2 * radiances.len(), "{p:?}");
            // Also the interval is the right one.
            assert!(p.cdf <= *u && *u <= p.cdf + p.pmf, "{u}: {p:?}");
            black += usize::from(!has_power(&p));
        }
        let mut observed = vec![0; 2 * radiances.len()];
        let mut expected = vec![0.0; 2 * radiances.len()];
        for p in &picks {
            observed[p.index] += 1;
            expected[p.index] = f64::from(p.pmf) * COUNT as f64;
        }
        let fit = GoodnessOfFit::of(&observed, &expected);
        println!("{radiances:?}: {fit}");
        least = least.min(fit.p_value);
        let sum: f32 = radiances.iter().sum();
        let ends = radiances.iter().scan(0.0_f32, |s, r| {
            *s += r / sum;
            Some(*s)
        });
        let ends: Vec<f32> = ends.collect();
        let naive = ends.iter().position(|end| *end >= 0.0).unwrap();
        naive_black += usize::from(radiances[naive] == 0.0);
    }
    assert_at_most("F9", "lights without power that were chosen, 7 scenes", black as f64, 0.0);
    let what = "scenes in which the first sum >= u chooses a light without power";
    assert_naive_fails("F9", what, naive_black as f64, 1.0);
    let what = "7 chi-square tests of 65,536 choices of lights: least p-value";
    assert_at_least("F9", what, least, sidak(FALSE_ALARM, cases.len()));
}

/// Lights of no power, or none: exactly black, and finite.
#[test]
fn f10_scenes_without_light_are_black() {
    let dark = receiver(1.0);
    let mut spent = receiver(1.0);
    spent.ceiling(Vec3::Y, 0.5, emitter(0.0));
    spent.light(LightKind::Directional { direction: Vec3::NEG_Y }, 0.0);
    spent.light(LightKind::Point { position: Vec3::Y, range: f32::INFINITY }, 0.0);
    let mut night = receiver(1.0);
    night.sky(0.0);
    let textured = Stage { scene: lamps(&[0.0, 0.0]) };
    // A kernel each. Without light samples nothing but a sky could be found.
    let mut worst = 0.0_f64;
    let mut look = |stage: &Stage, strategy| {
        let settings = RenderSettings { strategy, ..settings(8, 8, 4) };
        let most = grey(&render(&stage.scene, &settings)).into_iter().fold(0.0, f64::max);
        worst = worst.max(most);
    };
    look(&night, Strategy::Bsdf);
    [dark, spent, night, textured].iter().for_each(|stage| look(stage, Strategy::Mis));
    assert_at_most(
        "F10",
        "scenes without light, with light samples and without: radiance",
        worst,
        0.0,
    );
}

/// An environment alone, and beside lights that are black.
#[test]
fn f10_an_environment_alone() {
    for has_black_lights in [false, true] {
        let mut stage =
            if has_black_lights { Stage { scene: lamps(&[0.0]) } } else { receiver(1.0) };
        // Out of the way: black lamps still hide the sky.
        stage.scene.meshes.iter_mut().skip(1).for_each(|m| {
            m.positions.iter_mut().for_each(|p| p.y = -1.0);
        });
        stage.sky(1.0);
        let what = format!("white sky, black lights {has_black_lights}: largest relative error");
        // Without light samples black lights are black surfaces.
        if !has_black_lights {
            let paths = RenderSettings { strategy: Strategy::Bsdf, ..settings(8, 8, 16) };
            let errors = grey(&render(&stage.scene, &paths)).into_iter();
            let errors = errors.map(|l| (l / f64::from(ALBEDO) - 1.0).abs());
            assert_at_most("F10", &what, errors.fold(0.0, f64::max), 1e-6);
        }
        let estimate = Estimate::of_pixels(&render(&stage.scene, &settings(16, 16, 256)));
        assert_truth(&what, estimate, ALBEDO.into(), 0.002);
    }
}

/// One sample of lights without extent is exact, whatever the strategy weighs: no ray can meet
/// them.
#[test]
fn f12_lights_without_extent_are_exact_with_mis() {
    let mut worst = 0.0_f64;
    let mut check = |kind: LightKind, intensity: f32, irradiance: f64| {
        let mut stage = Stage::orthographic(Vec3::Y * 0.01, Vec3::ZERO, 1e-9);
        stage.floor(Vec3::new(0.2, 0.0, 0.1), 1.0, lambert(ALBEDO));
        stage.light(kind, intensity);
        let truth = f64::from(ALBEDO) / PI * irradiance;
        for strategy in [Strategy::Mis, Strategy::Light] {
            let settings = RenderSettings { strategy, ..settings(4, 4, 1) };
            for pixel in grey(&render(&stage.scene, &settings)) {
                worst = worst.max((pixel / truth - 1.0).abs());
            }
        }
    };
    for position in [Vec3::new(0.0, 1.0, 0.0), Vec3::new(1.5, 2.0, -0.5), Vec3::new(-3.0, 0.4, 0.2)]
    {
        let p = position.as_dvec3();
        let irradiance = 2.0 * p.y / p.length().powi(3);
        check(LightKind::Point { position, range: f32::INFINITY }, 2.0, irradiance);
    }
    for degrees in [0.0_f64, 60.0, 89.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let direction = Vec3::new(sin as f32, -cos as f32, 0.0);
        let d = direction.as_dvec3();
        check(LightKind::Directional { direction }, 2.0, -2.0 * d.y / d.length());
    }
    let what = "point and directional lights at one sample, MIS and light: largest relative error";
    assert_at_most("F12", what, worst, 1e-6);
}
