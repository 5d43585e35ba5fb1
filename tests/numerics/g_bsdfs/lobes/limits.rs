//! What lobes become at the ends of their parameters.

use super::{Input, list, plain, run, scene_of};
use crate::common::{Random, assert_at_most, assert_naive_fails};
use glam::Vec3;
use steradian::RenderSettings;
use steradian::scene::Material;

/// Extensions at their neutral values change no bit of what a material does.
#[test]
fn neutral_extensions_change_nothing() {
    let neutral = |m: &Material| Material {
        clearcoat: list::coat(0.0, 0.5),
        sheen: list::sheen(Vec3::ZERO, 0.5),
        iridescence: list::film(0.0, 1.3, 400.0),
        anisotropy: list::stretched(0.0, 0.5),
        diffuse_transmission: list::leaf(0.0, Vec3::ONE),
        dispersion: 0.0,
        ..m.clone()
    };
    let all = RenderSettings { all_features: true, ..plain() };
    for m in [
        list::paint(0.5),
        list::paint(0.0),
        list::metal(0.4),
        Material { metallic: 0.5, base_color: Vec3::new(0.8, 0.4, 0.1), ..list::paint(0.6) },
        list::glass(0.0, 1.5),
        list::glass(0.5, 1.5),
        Material { volume: false, transmission: 0.5, ..list::glass(0.5, 1.5) },
    ] {
        let scene = scene_of(std::slice::from_ref(&m));
        let with = scene_of(&[neutral(&m)]);
        let mut random = Random(8);
        let mut inputs = Vec::new();
        for is_front in [true, false] {
            for i in Input::new(0, is_front, 0.6).sampled(4096, &mut random) {
                inputs.push(Input { wi: random.direction(), ..i });
            }
        }
        let specialised = run(&scene, &plain(), &inputs);
        for (scene, settings) in [(&scene, &all), (&with, &plain()), (&with, &all)] {
            let other = run(scene, settings, &inputs);
            let mut differ = specialised
                .iter()
                .zip(&other)
                .filter(|(a, b)| bytemuck::bytes_of(*a) != bytemuck::bytes_of(*b));
            if let Some(first) = differ.next() {
                panic!("{} of {}: {m:?}: {first:?}", 1 + differ.count(), inputs.len());
            }
        }
    }
}

/// What a smooth base reflects under a film, over that without: at the cosine `cos_o`.
fn filmed(base: &Material, thickness: f32, cos_o: f32) -> f64 {
    let with = Material { iridescence: list::film(1.0, 1.8, thickness), ..base.clone() };
    let scene = scene_of(&[base.clone(), with]);
    let [bare, film] = [0, 1].map(|k| {
        let inputs = Input::new(k, true, cos_o).sampled(64, &mut Random(2));
        run(&scene, &plain(), &inputs)[0].weight
    });
    f64::from((film - bare).abs().max_element())
}

/// A film of no thickness is not there; one of half a micrometre is. Away from the normal
/// Schlick's reflectance of a film of index 1 is not 0, and the extension says so.
#[test]
fn a_film_of_no_thickness_is_not_there() {
    let base = Material { base_color: Vec3::new(0.9, 0.6, 0.3), ..list::metal(0.0) };
    let normal = filmed(&base, 0.0, 1.0);
    assert_at_most("G14", "metal under a film of thickness 0, at the normal: error", normal, 1e-6);
    let oblique = filmed(&base, 0.0, 0.8);
    assert_at_most("G14", "the same at the cosine 0.8: error", oblique, 0.02);
    assert_naive_fails("G14", "a film of 500 nm against none", filmed(&base, 500.0, 1.0), 0.02);
}

/// Glass of the least alpha that has a density scatters nearly where smooth glass does.
#[test]
fn rough_glass_of_the_least_alpha_is_nearly_smooth() {
    let scene = scene_of(&[list::glass(0.031_64, 1.5), list::glass(0.0, 1.5)]);
    let mut worst = 0.0_f64;
    for is_front in [true, false] {
        for cos_o in [0.95_f32, 0.8] {
            let mean = |k: usize| {
                let inputs = Input::new(k, is_front, cos_o).sampled(1 << 14, &mut Random(3));
                let outputs = run(&scene, &plain(), &inputs);
                // First moments of the scattered flux on either side.
                let mut sums = [Vec3::ZERO; 2];
                for o in &outputs {
                    assert!(o.is_delta() == (k == 1), "{o:?}");
                    sums[usize::from(o.wi.z > 0.0)] += o.wi * o.share().x / outputs.len() as f32;
                }
                sums
            };
            let (rough, smooth) = (mean(0), mean(1));
            for k in 0..2 {
                worst = worst.max(f64::from((rough[k] - smooth[k]).abs().max_element()));
            }
        }
    }
    assert_at_most(
        "G2",
        "glass of alpha 1e-3 against smooth: first moments of the flux",
        worst,
        0.02,
    );
}

/// An interface between equal indices lets all light pass, whatever its roughness.
#[test]
fn equal_indices_do_not_refract() {
    let scene = scene_of(&[list::glass(0.7, 1.5)]);
    let mut worst = 0.0_f64;
    for around in [1.5_f32, 1.5005] {
        let seen = Input { around, ..Input::new(0, true, 0.4) };
        for out in run(&scene, &plain(), &seen.sampled(1024, &mut Random(4))) {
            if out.pdf != 0.0 && out.wi.z < 0.0 {
                worst = worst.max(f64::from((out.wi + seen.wo).abs().max_element()));
                worst = worst.max(f64::from((out.share().x - 1.0).abs()));
            }
        }
    }
    assert_at_most("G8", "equal indices: bending and loss", worst, 2e-3);
}
