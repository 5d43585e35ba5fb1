//! The bits of a picture depend on the scene and on what its definition names, and on
//! nothing else.

use crate::common::{assert_at_most, bundled, render, settings, with_device};
use glam::Vec3;
use std::ops::Range;
use std::process::Command;
use std::sync::LazyLock;
use steradian::film::Film;
use steradian::image::read_exr;
use steradian::passes::Tuning;
use steradian::scene::Scene;
use steradian::settings::{Crop, Sampler};
use steradian::{RenderSettings, Renderer};

/// Triangles and spheres, mirror and glass; rough metal under many lights; an environment map.
const SCENES: [&str; 3] = ["cornell-spheres", "veach-mis", "environment"];

type Bits = Vec<[u32; 3]>;

const WIDTH: u32 = 24;
const HEIGHT: u32 = 16;

fn plain() -> RenderSettings {
    settings(WIDTH, HEIGHT, 4)
}

fn bits(film: &Film) -> Bits {
    film.picture().rgb.iter().map(|c| c.map(f32::to_bits)).collect()
}

/// Asserts that no pixel differs in any bit.
#[track_caller]
fn assert_same(what: &str, found: &Bits, expected: &Bits) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let changed = found.iter().zip(expected).filter(|(a, b)| a != b).count();
    let what = format!("{what}: pixels of {} that differ", found.len());
    assert_at_most("L1", &what, changed as f64, 0.0);
}

fn picture(scene: &Scene, settings: &RenderSettings) -> Bits {
    bits(&render(scene, settings))
}

/// The scenes with their pictures by plain settings, which every test compares with.
static PLAIN: LazyLock<Vec<(Scene, Bits)>> = LazyLock::new(|| {
    let render = |name: &&str| {
        let scene = bundled(name);
        let bits = picture(&scene, &plain());
        let lit = bits.iter().filter(|c| c.iter().any(|&x| x != 0)).count();
        assert!(lit * 4 >= bits.len(), "{name}: {lit} of {} pixels are lit", bits.len());
        (scene, bits)
    };
    SCENES.iter().map(render).collect()
});

#[test]
fn l1_a_second_render_has_the_same_bits() {
    for (scene, expected) in PLAIN.iter() {
        assert_same(&format!("{}, again", scene.name), &picture(scene, &plain()), expected);
        // The comparison would see another seed.
        let other = RenderSettings { seed: 1, ..plain() };
        assert!(&picture(scene, &other) != expected, "{}", scene.name);
    }
}

/// The software driver reads its number of threads when it starts: each has a process.
#[test]
fn l1_threads_of_the_driver_change_no_bit() {
    let folder = tempfile::tempdir().unwrap();
    for (name, (_, expected)) in SCENES.iter().zip(PLAIN.iter()) {
        for threads in ["1", "2"] {
            let output = folder.path().join("picture.exr");
            let scene = format!("{}/scenes/{name}/{name}.gltf", env!("CARGO_MANIFEST_DIR"));
            let status = Command::new(env!("CARGO_BIN_EXE_steradian"))
                .args(["render", &scene, "--quiet", "--spp", "4", "--resolution"])
                .arg(format!("{WIDTH}x{HEIGHT}"))
                .args(["--block", "16", "--output"])
                .arg(&output)
                .env("LP_NUM_THREADS", threads)
                .status()
                .unwrap();
            assert!(status.success(), "{name}, {threads} threads");
            let rgb = read_exr(&output).unwrap().picture().unwrap().rgb;
            let found: Bits = rgb.iter().map(|c| c.map(f32::to_bits)).collect();
            assert_same(&format!("{name}, {threads} threads"), &found, expected);
        }
    }
}

/// Asserts that the scene's picture is `expected` however the work is cut.
fn assert_tuned(scene: &Scene, expected: &Bits, tuning: &Tuning) {
    let found = with_device(|device| {
        let mut renderer = Renderer::with_tuning(device, scene, &plain(), tuning).unwrap();
        while renderer.step().unwrap() {}
        renderer.finish().unwrap();
        bits(renderer.film())
    });
    let Tuning { workgroup_size, submit_samples, submit_seconds, .. } = tuning;
    let name = &scene.name;
    let what = format!(
        "{name}, workgroups of {workgroup_size}, submissions of at most {submit_samples} samples \
         and {submit_seconds} s"
    );
    assert_same(&what, &found, expected);
}

#[test]
fn l1_workgroup_sizes_change_no_bit() {
    // A kernel each: both sizes for the scene of triangles and spheres.
    for (k, workgroup_size) in [(0, 32), (0, 128), (2, 128)] {
        let (scene, expected) = &PLAIN[k];
        assert_tuned(scene, expected, &Tuning { workgroup_size, ..Tuning::default() });
    }
}

/// One sample at a time, two, a tile at a time, and all of it at once.
#[test]
fn l2_submissions_change_no_bit() {
    for (scene, expected) in PLAIN.iter() {
        for (submit_samples, submit_seconds) in [(1, 0.075), (2, 0.075), (4, 1e-9), (4, 60.0)] {
            let tuning = Tuning { submit_samples, submit_seconds, ..Tuning::default() };
            assert_tuned(scene, expected, &tuning);
        }
    }
}

/// What a shader leaves out for a scene changes no bit of the picture.
fn check_shader_for_everything(scenes: Range<usize>) {
    for (scene, expected) in &PLAIN[scenes] {
        let all = RenderSettings { all_features: true, ..plain() };
        let what = format!("{}, every feature compiled", scene.name);
        assert_same(&what, &picture(scene, &all), expected);
    }
}

/// The scene that leaves most out. Mesa compiles the shader for everything for half a minute.
#[test]
fn l1_the_shader_for_everything_gives_the_same_bits() {
    check_shader_for_everything(0..1);
}

#[test]
#[ignore = "tier N: about 1 minute"]
fn l1_the_shader_for_everything_gives_the_same_bits_of_other_scenes() {
    check_shader_for_everything(1..SCENES.len());
}

/// A crop is cut from the whole picture, also where tiles of the two do not coincide.
#[test]
fn l2_a_crop_is_a_part_of_the_whole() {
    for (scene, whole) in PLAIN.iter() {
        let crop = Crop { x: 5, y: 3, width: 13, height: 9 };
        let part = picture(scene, &RenderSettings { crop: Some(crop), ..plain() });
        let rows = whole.chunks(WIDTH as usize).skip(crop.y as usize).take(crop.height as usize);
        let columns = crop.x as usize..(crop.x + crop.width) as usize;
        let expected: Bits = rows.flat_map(|row| row[columns.clone()].iter().copied()).collect();
        assert_same(&format!("{}, a crop", scene.name), &part, &expected);
    }
}

/// Sample k of a pixel is the same however many follow: with so few samples that f32 and f64
/// sums are exact, the first n of 2n samples can be told from the sums.
#[test]
fn i7_fewer_samples_are_the_first_of_more() {
    for sampler in [Sampler::Sobol, Sampler::Independent] {
        let scene = &PLAIN[0].0;
        let sums = |spp: u32, block_size: u32| -> Vec<Vec3> {
            let settings = RenderSettings { sampler, block_size, ..settings(16, 16, spp) };
            let film = render(scene, &settings);
            film.picture().rgb.iter().map(|c| Vec3::from(*c) * spp as f32).collect()
        };
        // No sample is negative: sums of more samples are never less, beyond rounding.
        let (four, eight) = (sums(4, 1), sums(8, 1));
        let rounding = 16.0 * f32::EPSILON;
        for (a, b) in four.iter().zip(&eight) {
            assert!((*b - *a * (1.0 - rounding)).min_element() >= 0.0, "{sampler:?}: {a} > {b}");
        }
        assert!(four.iter().zip(&eight).any(|(a, b)| a != b));
        // Blocks are the unit of f32 sums, and change nothing else.
        for (a, b) in sums(8, 8).iter().zip(&eight) {
            assert!((*a - *b).abs().max_element() <= rounding * b.max_element(), "{a} {b}");
        }
    }
}
