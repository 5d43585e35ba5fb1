//! No lobe makes light; values are the same both ways; no number is not finite.

use super::{Input, Output, list, plain, run, scene_of};
use crate::common::{Estimate, Random, assert_at_most, report};
use glam::Vec3;
use steradian::RenderSettings;
use steradian::scene::{Material, Scene};

const COSINES: [f32; 6] = [1.0, 0.8, 0.5, 0.25, 0.1, 0.02];

/// Mean share of flux that goes on, by 16 lattices of 2048 points shifted at random.
fn albedo(scene: &Scene, settings: &RenderSettings, seen: Input, seed: u64) -> Estimate {
    const POINTS: usize = 2048;
    let mut random = Random(seed);
    let mut inputs = Vec::new();
    for _ in 0..16 {
        let shift = [random.unit(), random.unit(), random.unit()].map(f64::from);
        for k in 0..POINTS {
            // The lattice of the real root of x⁴ = x + 1 (Roberts 2018).
            let at = |step: f64, shift: f64| {
                ((k as f64 * step + shift).fract() as f32).min(1.0_f32.next_down())
            };
            let u = Vec3::new(
                at(0.819_172_513_396_164_4, shift[0]),
                at(0.671_043_606_703_789_3, shift[1]),
                at(0.549_700_477_901_970_3, shift[2]),
            );
            inputs.push(Input { u, ..seen });
        }
    }
    let outputs = run(scene, settings, &inputs);
    let mean = |part: &[Output]| {
        part.iter().map(|o| f64::from(o.share().max_element())).sum::<f64>() / POINTS as f64
    };
    Estimate::of(&outputs.chunks(POINTS).map(mean).collect::<Vec<_>>())
}

/// The furnace table of one list of materials: asserts of those that conserve energy, tells of others.
fn furnace(all: &[(&str, Material, bool)], settings: &RenderSettings, allowed: f64) -> f64 {
    let materials: Vec<Material> = all.iter().map(|(_, m, _)| m.clone()).collect();
    let scene = scene_of(&materials);
    let mut worst = f64::MIN;
    for (k, (name, _, conserves)) in all.iter().enumerate() {
        for is_front in [true, false] {
            let mut most = 0.0_f64;
            let mut line = String::new();
            for (c, cos_o) in COSINES.into_iter().enumerate() {
                let e =
                    albedo(&scene, settings, Input::new(k, is_front, cos_o), (k * 16 + c) as u64);
                line += &format!(" {:.4}±{:.4}", e.mean, e.standard_error);
                most = most.max(e.mean);
                if *conserves {
                    worst = worst.max(e.mean - 1.0 - 4.0 * e.standard_error);
                    assert!(
                        e.mean <= 1.0 + 4.0 * e.standard_error + allowed,
                        "{name}, front {is_front}, cos {cos_o}: {e:?}"
                    );
                }
            }
            println!("{name}, front {is_front}:{line}");
            let side = if is_front { "front" } else { "back" };
            report("G4", &format!("{name}, {side}: largest directional albedo"), most);
        }
    }
    worst
}

#[test]
fn g4_extensions_make_no_light() {
    let worst = furnace(&list::all(), &plain(), 1e-4);
    assert_at_most("G4", "extensions' lobes: albedo above 1 + 4 SE", worst, 1e-4);
}

/// Over roughness and index: glass from both sides, as a volume and as a sheet.
#[test]
fn g8_rough_glass_makes_no_light() {
    let mut all = Vec::new();
    for roughness in [0.05_f32, 0.224, 0.55, 1.0] {
        for ior in [1.0_f32, 1.0001, 1.002, 1.5, 2.4] {
            all.push(("glass", list::glass(roughness, ior), true));
            all.push(("pane", Material { volume: false, ..list::glass(roughness, ior) }, true));
        }
    }
    let worst = furnace(&all, &plain(), 1e-4);
    assert_at_most("G8", "rough glass and panes, 40 materials: albedo above 1 + 4 SE", worst, 1e-4);
}

/// With the compensation a white metal keeps all light, to the table's error.
#[test]
fn g4_compensated_metal_keeps_all_light() {
    let roughness = [0.1_f32, 0.3, 0.5, 0.8, 1.0];
    let materials: Vec<Material> = roughness.into_iter().map(list::metal).collect();
    let scene = scene_of(&materials);
    let settings = RenderSettings { energy_compensation: true, ..plain() };
    let mut worst = 0.0_f64;
    for (k, roughness) in roughness.into_iter().enumerate() {
        for (c, cos_o) in COSINES.into_iter().enumerate() {
            let e = albedo(&scene, &settings, Input::new(k, true, cos_o), c as u64);
            println!("roughness {roughness}, cos {cos_o}: {e:?}");
            worst = worst.max((e.mean - 1.0).abs() - 4.0 * e.standard_error);
        }
    }
    assert_at_most("G4", "compensated white metal: distance of the albedo from 1", worst, 4e-3);
    let e = albedo(&scene, &plain(), Input::new(4, true, 0.8), 1);
    assert!(e.mean < 0.5, "without compensation alpha 1 loses half: {e:?}");
}

/// f(wo, wi) = f(wi, wo) above the surface, and through it with the square of the index.
#[test]
fn g5_lobes_are_reciprocal() {
    const COUNT: usize = 1 << 13;
    let all = list::all();
    let scene = scene_of(&list::materials());
    let mut errors = Vec::new();
    for (k, (name, m, _)) in all.iter().enumerate() {
        // A coat takes its share by wo alone.
        if m.clearcoat.is_some() {
            continue;
        }
        for is_front in [true, false] {
            let mut random = Random(90 + k as u64);
            let mut inputs = Vec::new();
            for _ in 0..COUNT {
                let wo = random.direction();
                let wo = if wo.z < 0.0 { -wo } else { wo };
                inputs.push(Input { wo, wi: random.direction(), ..Input::new(k, is_front, 1.0) });
            }
            let outputs = run(&scene, &plain(), &inputs);
            // The other way: what is below is above for it, and the handedness of the frame stays.
            let back: Vec<Input> = inputs
                .iter()
                .map(|i| {
                    let turned = |w: Vec3| if i.wi.z < 0.0 { Vec3::new(w.x, w.y, -w.z) } else { w };
                    let is_front = if i.wi.z < 0.0 { 1.0 - i.is_front } else { i.is_front };
                    Input { wo: turned(i.wi), wi: turned(i.wo), is_front, ..*i }
                })
                .collect();
            for ((i, out), other) in inputs.iter().zip(&outputs).zip(run(&scene, &plain(), &back)) {
                if i.wi.z.abs() < 0.05 || i.wo.z < 0.05 {
                    continue;
                }
                // Film and stretch are told apart by sides; a leaf's lobe has no index.
                let passes = i.wi.z < 0.0;
                if passes
                    && (m.diffuse_transmission.is_some()
                        || m.anisotropy.is_some()
                        || m.iridescence.is_some())
                {
                    continue;
                }
                let scale = if passes && m.volume { f64::from(out.eta).powi(2) } else { 1.0 };
                let there = out.other_value.as_dvec3() / f64::from(i.wi.z.abs()) / scale;
                let here = other.other_value.as_dvec3() / f64::from(i.wo.z.abs());
                let size = there.max_element().max(here.max_element());
                if size > 1e-4 {
                    let error = (there - here).abs().max_element() / size;
                    assert!(error < 0.1, "{name}: {i:?} {there} {here}");
                    errors.push(error);
                }
            }
        }
    }
    assert!(errors.len() > 50_000, "{}", errors.len());
    errors.sort_by(f64::total_cmp);
    // Next to the critical angle what passes has a vertical tangent, and D a steep flank.
    let most = errors[errors.len() * 999 / 1000];
    assert_at_most(
        "G5",
        "reciprocity of extensions' lobes: 99.9th percentile of the error",
        most,
        1e-3,
    );
    report(
        "G5",
        "reciprocity of extensions' lobes: largest relative difference",
        errors[errors.len() - 1],
    );
}

/// 2^20 calls with random materials, extremes among them.
#[test]
fn g3_no_lobe_gives_a_number_that_is_not_finite() {
    const MATERIALS: usize = 256;
    const EACH: usize = 4096;
    let mut random = Random(31);
    let pick = |values: &[f32], random: &mut Random| {
        let k = (random.unit() * (values.len() + 1) as f32) as usize;
        values.get(k).copied().unwrap_or_else(|| random.unit())
    };
    let mut materials = Vec::new();
    for _ in 0..MATERIALS {
        let r = &mut random;
        let unit = [0.0, 1.0, 1e-3, 0.5, 0.031_63];
        let mut m = Material {
            base_color: Vec3::new(pick(&unit, r), pick(&unit, r), pick(&unit, r)),
            metallic: pick(&[0.0, 1.0, 0.0], r),
            roughness: pick(&unit, r),
            ior: 1.0 + pick(&[0.0, 1e-7, 1e-4, 0.5, 3.0, 30.0], r),
            specular: pick(&[0.0, 1.0], r),
            specular_color: Vec3::new(pick(&unit, r), 30.0 * pick(&unit, r), pick(&unit, r)),
            transmission: pick(&[0.0, 1.0, 0.0], r),
            volume: r.unit() < 0.5,
            dispersion: pick(&[0.0, 10.0], r),
            ..Material::default()
        };
        m.diffuse_transmission = list::leaf(pick(&unit, r), Vec3::new(pick(&unit, r), 1.0, 0.0));
        m.anisotropy = list::stretched(pick(&unit, r), 6.0 * r.unit());
        m.iridescence =
            list::film(pick(&unit, r), 1.0 + pick(&[0.0, 0.3, 2.0], r), 2000.0 * pick(&unit, r));
        m.sheen = list::sheen(Vec3::splat(pick(&unit, r)), pick(&unit, r));
        m.clearcoat = list::coat(pick(&unit, r), pick(&unit, r));
        materials.push(m);
    }
    let scene = scene_of(&materials);
    for settings in [plain(), RenderSettings { energy_compensation: true, ..plain() }] {
        let mut inputs = Vec::new();
        for k in 0..MATERIALS {
            for _ in 0..EACH {
                let r = &mut random;
                let upper = |r: &mut Random| {
                    let mut w = r.direction();
                    if r.unit() < 0.3 {
                        w.z *= [1e-1, 1e-3, 1e-4][(r.unit() * 3.0) as usize];
                        w = w.normalize();
                    }
                    if w.z < 0.0 { -w } else { w }
                };
                let mut wo = upper(r);
                wo.z = wo.z.max(1e-4);
                if r.unit() < 0.05 {
                    wo = Vec3::Z;
                }
                let mut wi = upper(r);
                if r.unit() < 0.5 {
                    wi = -wi;
                }
                if r.unit() < 0.05 {
                    wi = if r.unit() < 0.5 { -wo } else { Vec3::new(-wo.x, -wo.y, wo.z) };
                }
                let edge = |u: f32| {
                    if u < 0.02 {
                        0.0
                    } else if u > 0.98 {
                        1.0_f32.next_down()
                    } else {
                        u
                    }
                };
                inputs.push(Input {
                    wo,
                    wi,
                    u: Vec3::new(edge(r.unit()), edge(r.unit()), edge(r.unit())),
                    normal: upper(r),
                    around: if r.unit() < 0.2 { 1.0 + r.unit() } else { 1.0 },
                    ..Input::new(k, r.unit() < 0.5, 1.0)
                });
            }
        }
        let mut bad = 0;
        for (i, out) in inputs.iter().zip(run(&scene, &settings, &inputs)) {
            let words: [f32; 16] = bytemuck::cast(out);
            let is_sound = words.iter().all(|w| w.is_finite())
                && out.weight.min_element() >= 0.0
                && out.other_value.min_element() >= 0.0
                && out.other_pdf >= 0.0
                && (out.pdf == 0.0 || (out.wi.length() - 1.0).abs() < 1e-5);
            if !is_sound {
                bad += 1;
                if bad < 4 {
                    println!("{:?}\n{i:?}\n{out:?}", materials[i.material as usize]);
                }
            }
        }
        assert_at_most(
            "G3",
            "2^20 calls of random materials: unsound results",
            f64::from(bad),
            0.0,
        );
    }
}
