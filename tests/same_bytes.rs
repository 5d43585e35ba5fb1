//! The bits of a picture depend on the scene and on what its definition names, and on
//! nothing else.

mod common;

use common::{bundled, render, settings};
use glam::Vec3;
use steradian::RenderSettings;
use steradian::film::Film;
use steradian::scene::Scene;
use steradian::settings::{Crop, Sampler};

/// Triangles and spheres, mirror and glass; rough metal under many lights; an environment map.
const SCENES: [&str; 3] = ["cornell-spheres", "veach-mis", "environment"];

fn bits(film: &Film) -> Vec<[u32; 3]> {
    film.picture().rgb.iter().map(|c| c.map(f32::to_bits)).collect()
}

/// Renders, and asserts that there is something in the picture.
fn picture(scene: &Scene, settings: &RenderSettings) -> Vec<[u32; 3]> {
    let bits = bits(&render(scene, settings));
    let lit = bits.iter().filter(|c| c.iter().any(|&x| x != 0)).count();
    assert!(lit * 4 >= bits.len(), "{}: {lit} of {} pixels are lit", scene.name, bits.len());
    bits
}

#[test]
fn a_second_render_has_the_same_bits() {
    for name in SCENES {
        let scene = bundled(name);
        let settings = settings(16, 16, 4);
        let first = picture(&scene, &settings);
        assert_eq!(first, picture(&scene, &settings), "{name}");
        // The comparison would see another seed.
        assert_ne!(first, picture(&scene, &RenderSettings { seed: 1, ..settings }), "{name}");
    }
}

/// What a shader leaves out for a scene changes no bit of the picture.
#[test]
fn the_shader_for_everything_gives_the_same_bits() {
    for name in SCENES {
        let scene = bundled(name);
        let needed = settings(16, 16, 4);
        let all = RenderSettings { all_features: true, ..needed.clone() };
        assert_eq!(picture(&scene, &needed), picture(&scene, &all), "{name}");
    }
}

/// A crop is cut from the whole picture, also where tiles of the two do not coincide.
#[test]
fn a_crop_is_a_part_of_the_whole() {
    for name in SCENES {
        let scene = bundled(name);
        let whole = settings(24, 16, 4);
        let pixels = bits(&render(&scene, &whole));
        let crop = Crop { x: 5, y: 3, width: 13, height: 9 };
        let part = bits(&render(&scene, &RenderSettings { crop: Some(crop), ..whole }));
        let expected: Vec<_> = (crop.y..crop.y + crop.height)
            .flat_map(|y| (crop.x..crop.x + crop.width).map(move |x| (y * 24 + x) as usize))
            .map(|i| pixels[i])
            .collect();
        assert_eq!(part, expected, "{name}");
    }
}

/// Sample k of a pixel is the same however many follow: with so few samples that f32 and f64
/// sums are exact, the first n of 2n samples can be told from the sums.
#[test]
fn fewer_samples_are_the_first_of_more() {
    for sampler in [Sampler::Sobol, Sampler::Independent] {
        let scene = bundled("cornell-spheres");
        let sums = |spp: u32, block_size: u32| -> Vec<Vec3> {
            let settings = RenderSettings { sampler, block_size, ..settings(16, 16, spp) };
            let film = render(&scene, &settings);
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
