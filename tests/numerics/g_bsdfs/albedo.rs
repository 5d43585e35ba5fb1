//! G4: the share of light that GGX reflects, single scattering, F = 1.

use super::definition::ggx_value;
use super::{Input, run};
use crate::common::{
    Estimate, STRIP, Stage, assert_at_most, assert_naive_fails, assert_truth, render, report,
    settings, strips,
};
use glam::{DVec3, Vec3, Vec4};
use std::f64::consts::PI;
use steradian::RenderSettings;
use steradian::scene::Material;
use steradian::settings::Strategy;

/// Rows of the table.
const ALPHAS: [f64; 6] = [0.05, 0.1, 0.25, 0.5, 0.75, 1.0];
/// Columns of the table.
const COSINES: [f64; 5] = [1.0, 0.7, 0.3, 0.1, 0.02];
/// Directional albedo, height-correlated Smith masking, to seven digits.
const ALBEDOS: [[f64; 5]; 6] = [
    [0.997_295_8, 0.995_739_5, 0.981_677_7, 0.911_346_9, 0.928_909_2],
    [0.988_304_1, 0.981_418_6, 0.936_251_8, 0.883_455_0, 0.956_344_4],
    [0.915_812_4, 0.885_335_8, 0.837_905_8, 0.891_622_4, 0.967_721_2],
    [0.687_848_5, 0.682_954_2, 0.745_272_0, 0.860_105_1, 0.955_781_6],
    [0.463_916_5, 0.511_491_4, 0.650_278_1, 0.810_714_1, 0.938_793_7],
    [0.306_852_8, 0.378_887_8, 0.560_098_9, 0.760_210_5, 0.921_363_5],
];

/// Nodes and weights of Gauss's quadrature of eight points on [-1, 1].
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_47),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
];

/// Points and weights over panels that narrow towards `peak` from both ends of an interval.
fn rule(from: f64, peak: f64, to: f64, panels: i32) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    for end in [from, to] {
        let mut edge = end;
        for k in 1..=panels {
            let next = if k == panels { peak } else { peak + (end - peak) * 0.5_f64.powi(k) };
            let (middle, half) = (0.5 * (edge + next), 0.5 * (next - edge));
            for (x, w) in GAUSS {
                for x in [x, -x] {
                    points.push((middle + half * x, w * half.abs()));
                }
            }
            edge = next;
        }
    }
    points
}

/// Integral of the lobe over the hemisphere by quadrature in cosine and azimuth.
fn albedo(alpha: f64, cos_o: f64, panels: i32) -> f64 {
    let wo = DVec3::new((1.0 - cos_o * cos_o).sqrt(), 0.0, cos_o);
    let mut sum = 0.0;
    let azimuths = rule(0.0, PI, PI, panels);
    for (z, wz) in rule(0.0, cos_o, 1.0, panels) {
        let r = (1.0 - z * z).sqrt();
        for &(phi, wphi) in &azimuths {
            let wi = DVec3::new(r * phi.cos(), r * phi.sin(), z);
            sum += 2.0 * wz * wphi * ggx_value(alpha, wo, wi);
        }
    }
    sum
}

#[test]
fn g4_the_albedo_table_is_its_integral() {
    let (mut difference, mut doubling) = (0.0_f64, 0.0_f64);
    for (row, alpha) in ALPHAS.into_iter().enumerate() {
        for (column, cos_o) in COSINES.into_iter().enumerate() {
            let fine = albedo(alpha, cos_o, 18);
            println!("alpha {alpha}, cos {cos_o}: {fine:.7}");
            difference = difference.max((ALBEDOS[row][column] - fine).abs());
            doubling = doubling.max((albedo(alpha, cos_o, 15) - fine).abs());
        }
    }
    let exact = 1.0 - 2.0_f64.ln();
    assert_at_most("G4", "quadrature against 1 - ln 2", (albedo(1.0, 1.0, 18) - exact).abs(), 1e-7);
    assert_at_most("G4", "quadrature: largest change with more points", doubling, 5e-7);
    assert_at_most("G4", "table of albedos: largest error", difference, 1e-6);
}

/// Mean weight of samples: 16 lattices of 4096 points, shifted at random.
fn mean_weight(alpha: f32, cos_o: f32) -> Estimate {
    const POINTS: usize = 4096;
    const SHIFTS: usize = 16;
    let mut random = crate::common::Random(u64::from((alpha * cos_o).to_bits()));
    let mut inputs = Vec::new();
    for _ in 0..SHIFTS {
        let shift = [random.unit(), random.unit()].map(f64::from);
        for k in 0..POINTS {
            // The plastic number's lattice (Roberts 2018).
            let at = |step: f64, shift: f64| {
                ((k as f64 * step + shift).fract() as f32).min(1.0_f32.next_down())
            };
            let u = [at(0.754_877_666_246_692_8, shift[0]), at(0.569_840_290_998_053_3, shift[1])];
            let u = Vec4::new(u[0], u[1], 0.0, 0.0);
            inputs.push(Input { u, ..Input::white_metal(alpha, cos_o) });
        }
    }
    let outputs = run(&inputs);
    let mean = |part: &[super::Output]| {
        part.iter().map(|o| f64::from(o.weight.x)).sum::<f64>() / POINTS as f64
    };
    Estimate::of(&outputs.chunks(POINTS).map(mean).collect::<Vec<_>>())
}

/// The device's samples carry as much energy as the integral says.
#[test]
fn g4_ggx_samples_have_the_albedo_of_the_integral() {
    let mut worst = 0.0_f64;
    let mut largest_error = 0.0_f64;
    for (row, alpha) in ALPHAS.into_iter().enumerate() {
        for (column, cos_o) in COSINES.into_iter().enumerate() {
            let e = mean_weight(alpha as f32, cos_o as f32);
            assert!(e.standard_error <= 1e-3 / 4.0, "alpha {alpha}, cos {cos_o}: {e:?}");
            let error = (e.mean - ALBEDOS[row][column]).abs();
            largest_error = largest_error.max(error);
            worst = worst.max(error / (3.0 * e.standard_error + 1e-4));
        }
    }
    report("G4", "albedo of 65,536 samples, 30 cases: largest error", largest_error);
    assert_at_most("G4", "albedo of samples: error over 3 SE + 1e-4", worst, 1.0);
}

/// The albedo table with the separable masking of the usual shortcut, G1 G1 for G2: what is
/// kept of the energy falls short at grazing directions.
#[test]
fn g4_separable_masking_loses_energy() {
    let (alpha, cos_o) = (1.0_f64, 0.1_f64);
    let lambda = |z: f64| ((1.0 + alpha * alpha * (1.0 - z * z) / (z * z)).sqrt() - 1.0) / 2.0;
    let wo = DVec3::new((1.0 - cos_o * cos_o).sqrt(), 0.0, cos_o);
    let mut sum = 0.0;
    for (z, wz) in rule(0.0, cos_o, 1.0, 12) {
        let correlated = 1.0 + lambda(cos_o) + lambda(z);
        let separable = (1.0 + lambda(cos_o)) * (1.0 + lambda(z));
        for (phi, wphi) in rule(0.0, PI, PI, 12) {
            let r = (1.0 - z * z).sqrt();
            let wi = DVec3::new(r * phi.cos(), r * phi.sin(), z);
            sum += 2.0 * wz * wphi * ggx_value(alpha, wo, wi) * correlated / separable;
        }
    }
    let short = albedo(alpha, cos_o, 12) - sum;
    assert_naive_fails("G4", "albedo lost by separable masking, alpha 1, cos 0.1", short, 1e-2);
}

/// White metal under a white sky shows its albedo. A strip for each alpha, in one plane.
#[test]
fn g4_rough_metal_under_a_white_sky_shows_its_albedo() {
    for (column, cos) in COSINES.into_iter().enumerate().step_by(2) {
        let sin = (1.0 - cos * cos).sqrt();
        // At the grazing angle the lower edge of the view must still begin above the plane.
        // The picture's x axis is the world's z axis, in which the strips are placed.
        let eye = Vec3::new(-sin as f32, cos as f32, 0.0);
        let mut stage = Stage::orthographic(eye * 100.0, Vec3::ZERO, 0.5);
        let camera = &mut stage.scene.cameras[0].world_from_camera;
        (camera.matrix3.x_axis, camera.matrix3.y_axis) =
            (Vec3::Z.into(), eye.cross(Vec3::Z).into());
        for (row, alpha) in ALPHAS.into_iter().enumerate() {
            let metal = Material { roughness: alpha.sqrt() as f32, ..Material::default() };
            let z = row as f32 - (ALPHAS.len() - 1) as f32 / 2.0;
            // Long enough to fill the view at a grazing angle.
            stage.quad(Vec3::new(1.0, 0.0, z), Vec3::Z * 0.5, Vec3::X * 60.0, metal);
        }
        stage.sky(1.0);
        let width = STRIP * ALPHAS.len() as u32;
        for (strategy, spp, visible_bias) in
            [(Strategy::Bsdf, 512, 0.004), (Strategy::Mis, 128, 0.01)]
        {
            let settings = RenderSettings { strategy, ..settings(width, STRIP, spp) };
            for (row, estimate) in strips(&render(&stage.scene, &settings)).into_iter().enumerate()
            {
                let what = format!("alpha {}, cos {cos}, {strategy:?}", ALPHAS[row]);
                assert_truth(&what, estimate, ALBEDOS[row][column], visible_bias);
            }
        }
    }
}
