//! Choice among many lights: probabilities add up to 1 at every receiver, lights are chosen as
//! often as they say, and none that can shine on the receiver has probability 0.

use super::{draw, receiver};
use crate::common::{Call, Random, Stage, emitter, harness, lambert, with_uvs};
use glam::{Affine2, Affine3A, Vec2, Vec3, Vec4};
use steradian::RenderSettings;
use steradian::scene::{ColorSpace, Image, LightKind, Material, Mesh, Scene, TextureRef, Wrap};
use steradian::shader::{Library, library};
use steradian::statistics::{FALSE_ALARM, GoodnessOfFit, sidak};

/// Choices of a receiver.
const COUNT: usize = 1 << 16;

/// What `light_choice.wgsl` gives.
#[derive(Debug, Clone, Copy)]
struct Choice {
    index: usize,
    pmf: f32,
    pmf_again: f32,
    pmf_of_asked: f32,
}

/// With `shaders`.
fn choose(shaders: &Library, scene: &Scene, inputs: &[[Vec4; 2]]) -> Vec<Choice> {
    let mut padded = inputs.to_vec();
    padded.resize(inputs.len().next_multiple_of(64), inputs[0]);
    let settings = RenderSettings::default();
    let call = Call::new(harness!("light_choice"), &[]).with_library(shaders.clone());
    let out: Vec<Vec4> = call.on(scene, &settings).run(&padded, 1);
    let choice =
        |o: &Vec4| Choice { index: o.x as usize, pmf: o.y, pmf_again: o.z, pmf_of_asked: o.w };
    out[..inputs.len()].iter().map(choice).collect()
}

/// Probabilities of lights 0 to `count` at a place.
fn probabilities(shaders: &Library, scene: &Scene, place: Vec3, count: usize) -> Vec<f64> {
    let inputs: Vec<_> = (0..count).map(|k| [place.extend(k as f32), Vec4::splat(0.5)]).collect();
    choose(shaders, scene, &inputs).iter().map(|c| f64::from(c.pmf_of_asked)).collect()
}

/// A triangle about `center`, of a size about `size`.
fn lamp(stage: &mut Stage, center: Vec3, size: f32, random: &mut Random, material: Material) {
    let positions = (0..3).map(|_| center + size * random.in_cube()).collect();
    let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let mesh = stage.mesh(mesh, material);
    stage.place(mesh, Affine3A::IDENTITY);
}

/// What a light's corners are, of its front: none for other kinds.
type Corners = Option<([Vec3; 3], bool)>;

fn corners_of(scene: &Scene) -> Vec<Corners> {
    let of_instance = |i: &steradian::scene::Instance| {
        let mesh = &scene.meshes[i.mesh as usize];
        let material = &scene.materials[mesh.material as usize];
        let emits = material.is_emissive();
        let corners = mesh.triangles.iter().map(|t| t.map(|k| mesh.positions[k as usize]));
        let corners: Vec<_> = corners
            .filter(|[a, b, c]| emits && (*b - *a).cross(*c - *a) != Vec3::ZERO)
            .map(|c| Some((c, material.double_sided)))
            .collect();
        corners
    };
    scene.instances.iter().flat_map(of_instance).collect()
}

/// Triangles of very different power and size, one- and two-sided, some of them in one place, one
/// of no area, one of no light; spheres, points, spots; the sky and the sun. Gives also the number
/// of lights.
fn all_kinds(random: &mut Random) -> (Scene, usize) {
    let mut stage = receiver(1.0);
    for k in 0..60 {
        let radiance = 10.0_f32.powf(4.0 * random.unit() - 2.0);
        let size = 10.0_f32.powf(-1.5 * random.unit());
        let center = 3.0 * random.in_cube();
        let material = Material { double_sided: k % 3 == 0, ..emitter(radiance) };
        lamp(&mut stage, center, size, random, material);
    }
    let twin = Vec3::new(0.4, 1.0, 0.2);
    for radiance in [1.0, 1.0, 7.0] {
        lamp(&mut stage, twin, 0.3, &mut Random(5), emitter(radiance));
    }
    let line = [Vec3::ZERO, Vec3::X, 2.0 * Vec3::X].into();
    let line = Mesh { positions: line, triangles: vec![[0, 1, 2]], ..Mesh::default() };
    let line = stage.mesh(line, emitter(9.0));
    stage.place(line, Affine3A::IDENTITY);
    let triangles = 63;
    for radius in [0.02, 0.3, 1.0] {
        stage.sphere(2.0 * random.in_cube(), radius, emitter(1.0 / radius));
    }
    stage.light(LightKind::Directional { direction: Vec3::NEG_Y }, 0.3);
    stage.light(LightKind::Point { position: Vec3::new(0.2, 0.5, 0.7), range: 9.0 }, 0.5);
    let direction = Vec3::new(0.6, -0.8, 0.0);
    let position = Vec3::new(-1.0, 2.0, 0.0);
    let (cos_inner, cos_outer, range) = (0.9, 0.6, f32::INFINITY);
    stage.light(LightKind::Spot { position, direction, cos_inner, cos_outer, range }, 4.0);
    stage.sky(0.02);
    (stage.scene, triangles + 3 + 4)
}

/// Forty lamps that face down.
fn facing_down(random: &mut Random) -> (Scene, usize) {
    let mut stage = receiver(1.0);
    for _ in 0..20 {
        let center = 2.0 * random.in_cube() + 3.0 * Vec3::Y;
        stage.ceiling(center, 0.1 + 0.2 * random.unit(), emitter(1.0 + 9.0 * random.unit()));
    }
    (stage.scene, 40)
}

/// A square whose picture has light in one corner: its triangles are divided into cells. And a few
/// others, so that the tree has more than it.
fn divided(random: &mut Random) -> (Scene, usize) {
    let mut stage = receiver(1.0);
    let texel = |i: u32| if i % 64 < 8 && i / 64 < 8 { [255; 4] } else { [2, 0, 0, 255] };
    let image =
        Image { name: String::new(), width: 64, height: 64, rgba: (0..4096).map(texel).collect() };
    stage.scene.images.push(image);
    let picture = TextureRef {
        image: 0,
        color_space: ColorSpace::Linear,
        uv_set: 0,
        transform: Affine2::IDENTITY,
        wrap: [Wrap::Repeat; 2],
        nearest: true,
    };
    let screen = Material { emission_texture: Some(picture), double_sided: true, ..emitter(3.0) };
    let quad = crate::common::quad_mesh(Vec3::new(0.1, 0.8, -0.3), Vec3::X, Vec3::Y * 0.7);
    let uvs = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let quad = stage.mesh(with_uvs(quad, uvs), screen);
    stage.place(quad, Affine3A::IDENTITY);
    for _ in 0..3 {
        let center = random.in_cube() + Vec3::Y;
        lamp(&mut stage, center, 0.2, random, Material { double_sided: true, ..emitter(1.0) });
    }
    (stage.scene, 2 * 256 + 3)
}

/// Receivers everywhere: among the lights, on them, far away, and at random.
fn places(scene: &Scene, random: &mut Random) -> Vec<Vec3> {
    let mut places = vec![Vec3::ZERO, Vec3::new(0.0, 3.0, 0.0), Vec3::new(0.0, 300.0, 1.0)];
    let mut corners = corners_of(scene).into_iter().flatten();
    places.extend(corners.next().map(|([a, b, c], _)| (a + b + c) / 3.0));
    places.extend(corners.last().map(|([a, ..], _)| a));
    places.extend((0..8).map(|_| 4.0 * random.in_cube()));
    places
}

type Build = fn(&mut Random) -> (Scene, usize);
const SCENES: [(&str, Build); 3] =
    [("all kinds", all_kinds), ("facing down", facing_down), ("divided", divided)];

/// Greatest distance from 1 of the sum of all lights' probabilities.
fn worst_sum(shaders: &Library) -> f64 {
    let mut random = Random(101);
    let mut worst = 0.0_f64;
    for (_, build) in SCENES {
        let (scene, count) = build(&mut random);
        for place in places(&scene, &mut random) {
            let sum: f64 = probabilities(shaders, &scene, place, count).iter().sum();
            worst = worst.max((sum - 1.0).abs());
        }
    }
    worst
}

/// Products of up to 31 shares and their sum: 64 units of 2^-24.
const SUM_ERROR: f64 = 64.0 / 16_777_216.0;

#[test]
fn probabilities_of_all_lights_add_up_to_one() {
    let worst = worst_sum(&library());
    println!("{worst:e}");
    assert!(worst < SUM_ERROR, "{worst:e}");
}

/// Least p-value, relative to its level, of the chi-square tests of all scenes and receivers.
fn worst_fit(shaders: &Library) -> f64 {
    let mut random = Random(102);
    let mut fits = Vec::new();
    for (name, build) in SCENES {
        let (scene, count) = build(&mut random);
        for place in places(&scene, &mut random) {
            let number = |r: &mut Random| Vec4::new(r.unit(), r.unit(), r.unit(), 0.0);
            let inputs: Vec<_> =
                (0..COUNT).map(|_| [place.extend(0.0), number(&mut random)]).collect();
            let mut observed = vec![0; count];
            for c in choose(shaders, &scene, &inputs) {
                assert!(c.pmf > 0.0, "{name}, {place}: {c:?}");
                let is_same = c.pmf == c.pmf_again;
                assert!(is_same, "{name}, {place}: {c:?} is found again with another number");
                observed[c.index] += 1;
            }
            let expected = probabilities(shaders, &scene, place, count);
            let expected: Vec<f64> = expected.iter().map(|p| p * COUNT as f64).collect();
            let fit = GoodnessOfFit::of(&observed, &expected);
            println!("{name}, {place}: {fit}");
            fits.push(fit.p_value);
        }
    }
    fits.iter().copied().fold(1.0, f64::min) / sidak(FALSE_ALARM, fits.len())
}

#[test]
fn lights_are_chosen_as_often_as_they_say() {
    assert!(worst_fit(&library()) >= 1.0);
}

/// Triangles in view of a receiver, and how many of them have no probability. Also where the
/// receiver is 1e-4 radians above the light's plane, and for lights of 1e-20 of the others' power.
fn in_view(shaders: &Library) -> (usize, usize) {
    let mut random = Random(103);
    let (mut scene, count) = all_kinds(&mut random);
    for material in scene.materials.iter_mut().skip(1).step_by(7) {
        material.emission *= 1e-20;
    }
    let corners = corners_of(&scene);
    let mut places = places(&scene, &mut random);
    for ([a, b, c], _) in corners.iter().copied().flatten() {
        let n = (b - a).cross(c - a).normalize();
        let along = (b - c).normalize();
        places.push(a + along * 2.0 + n * 2e-4);
    }
    let (mut seen, mut lost) = (0, 0);
    for place in places {
        for (corner, p) in corners.iter().zip(probabilities(shaders, &scene, place, count)) {
            let Some(([a, b, c], both)) = *corner else { continue };
            let [a, b, c] = [a, b, c].map(|v| v.as_dvec3());
            let facing = (b - a).cross(c - a).dot(place.as_dvec3() - a);
            let is_seen = facing > 0.0 || both && facing != 0.0;
            seen += usize::from(is_seen);
            lost += usize::from(is_seen && p <= 0.0);
        }
    }
    (seen, lost)
}

#[test]
fn lights_in_view_have_a_probability() {
    let (seen, lost) = in_view(&library());
    assert!(seen > 1000 && lost == 0, "{lost} of {seen}");
}

/// The shaders with one line of the tree's changed.
fn broken(from: &str, to: &str) -> Library {
    let mut shaders = library();
    let text = shaders["light/tree"].replace(from, to);
    assert!(text != shaders["light/tree"], "{from} is not there");
    shaders.insert("light/tree", text.into());
    shaders
}

/// The three checks above see what they are for.
#[test]
fn defects_of_the_tree_are_seen() {
    let forgets_the_sky = broken("var pmf = frame.finite_light_share;", "var pmf = 1.0;");
    let sum = worst_sum(&forgets_the_sky);
    assert!(sum > SUM_ERROR, "{sum:e}");
    let keeps_a_shift =
        broken("select((x - pair.first) / share, x / share,", "select(x / share, x / share,");
    let fit = worst_fit(&keeps_a_shift);
    assert!(fit < 1.0, "{fit:e}");
    let sees_one_side = broken("cosine = abs(cosine);", "");
    assert!(in_view(&sees_one_side).1 > 0);
    let culls_early = broken("least > cone.w", "least > cone.w + 0.1");
    assert!(in_view(&culls_early).1 > 0);
}

/// A ray that finds a light has the density of the light sample that found it.
#[test]
fn light_samples_and_rays_agree_on_densities() {
    let mut random = Random(104);
    for (name, build) in SCENES {
        let (mut scene, _) = build(&mut random);
        // Of lights in one place a ray meets whichever it will.
        if name == "all kinds" {
            scene.instances.drain(62..64);
        }
        let places: Vec<Vec3> = (0..8192).map(|_| 2.0 * random.in_cube()).collect();
        let (mut met, mut worst) = (0, 0.0_f32);
        for d in draw(&scene, &places, &mut random) {
            // Hidden ones meet another light.
            if d.pdf > 0.0 && !d.is_blocked && d.meets_emitter && d.met_pdf > 0.0 {
                met += 1;
                worst = worst.max((d.met_pdf / d.pdf - 1.0).abs());
            }
        }
        println!("{name}: {met} met, {worst:e}");
        assert!(met > 200, "{name}: {met}");
        // The rest is in a sphere's own density, which conditions the rounding of the direction.
        assert!(worst < 1e-3, "{name}: {worst:e}");
    }
}

/// Nothing to choose: black, not a light of probability 0.
#[test]
fn many_lights_without_power_give_no_samples() {
    let mut stage = receiver(1.0);
    let black = Image { name: String::new(), width: 1, height: 1, rgba: vec![[0, 0, 0, 255]] };
    stage.scene.images.push(black);
    let texture = TextureRef {
        image: 0,
        color_space: ColorSpace::Srgb,
        uv_set: 0,
        transform: Affine2::IDENTITY,
        wrap: [Wrap::Repeat; 2],
        nearest: true,
    };
    let dark = Material { emission_texture: Some(texture), ..emitter(1.0) };
    for k in 0..20 {
        let quad = crate::common::quad_mesh(Vec3::new(k as f32, 1.0, 0.0), Vec3::X, Vec3::Z);
        let mesh = stage.mesh(with_uvs(quad, [Vec2::splat(0.5); 4]), dark.clone());
        stage.place(mesh, Affine3A::IDENTITY);
    }
    let numbers = |r: &mut Random| [Vec4::ZERO, Vec4::new(r.unit(), r.unit(), r.unit(), 0.0)];
    let mut random = Random(105);
    let inputs: Vec<_> = (0..256).map(|_| numbers(&mut random)).collect();
    assert!(choose(&library(), &stage.scene, &inputs).iter().all(|c| c.pmf == 0.0));
    // One of them shines: it is always the one.
    let bright = stage.quad(Vec3::Y, Vec3::X, Vec3::Z, lambert(0.5));
    stage.scene.meshes[bright as usize].triangles.truncate(1);
    let material = stage.scene.meshes[bright as usize].material;
    stage.scene.materials[material as usize] = emitter(1.0);
    for c in choose(&library(), &stage.scene, &inputs) {
        assert!((c.index, c.pmf) == (40, 1.0), "{c:?}");
    }
}
