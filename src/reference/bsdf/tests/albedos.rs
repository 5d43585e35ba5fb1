//! Integrals of lobes.

use super::super::albedo::AlbedoTable;
use super::super::{compensation, sheen};
use super::*;

/// Interpolated albedos are what the integrals are: those of sheen, and, as far as the quadrature
/// goes, those of microfacets.
#[test]
fn tables_of_albedos_hold_their_integrals() {
    let mut random = Random::new(7, (0, 0), 0);
    type Integral = fn(f64, f64) -> f64;
    let cases: [(&str, Integral, f64, &[f64]); 2] = [
        ("sheen", sheen::albedo, 1e-6, &[0.83, 0.1, 1.3e-3]),
        ("ggx", compensation::albedo, 1e-3, &[0.4]),
    ];
    for (what, integral, allowed, alphas) in cases {
        let table = AlbedoTable::new(integral);
        let mut worst = 0.0_f64;
        for &alpha in alphas {
            for _ in 0..12 {
                // As many near 0 as elsewhere.
                let cos = 1e-4_f64.powf(random.uniform());
                let truth = integral(cos, alpha);
                // Of fine sheen it is more than 1.
                let error = (table.at(cos, alpha) - truth).abs() / truth.max(1.0);
                if error > worst {
                    println!("{what}: error {error:.1e} at alpha {alpha}, cos {cos}");
                    worst = error;
                }
            }
        }
        assert!(worst < allowed, "{what}: {worst}");
    }
}

/// The integrals themselves, by midpoints over directions.
#[test]
fn albedos_are_integrals_of_their_lobes() {
    for (roughness, cos) in [(1.0, 0.7), (0.6, 0.2), (0.3, 0.4)] {
        let white = sheen::Sheen::new(DVec3::ONE, roughness, cos).unwrap();
        let whole = hemisphere(|wi| white.eval(tilted(cos), wi, up()), up()).x;
        let expected = sheen::albedo(cos, (roughness * roughness).max(1e-3));
        assert!((whole - expected).abs() < 1e-3 * expected, "sheen: {whole} {expected}");

        let ggx = ggx::Ggx::isotropic(roughness * roughness, up()).unwrap();
        let whole = hemisphere(|wi| DVec3::splat(ggx.reflection(tilted(cos), wi)), up()).x;
        let expected = compensation::albedo(cos, roughness * roughness);
        assert!((whole - expected).abs() < 2e-3 * expected, "ggx: {whole} {expected}");
    }
}

/// White metal loses what single scattering loses, and with compensation nothing.
#[test]
fn compensation_gives_back_all() {
    let metal = Shading { base: DVec3::ONE, metallic: 1.0, roughness: 0.8, ..paint() };
    for cos in [0.9, 0.3] {
        let [without, with] = [false, true].map(|compensate| {
            let bsdf = Bsdf::new(&metal, tilted(cos), (up(), up()), compensate);
            hemisphere(|wi| bsdf.eval(wi), up()).x
        });
        assert!((without - compensation::albedo(cos, 0.64)).abs() < 1e-3, "{without}");
        assert!((with - 1.0).abs() < 1e-3 && without < 0.95, "{without} {with}");
    }
}

/// White sheen of little roughness scatters more than it gets at the horizon, by the extension's
/// own formulas: the base has nothing left there, and there the model does not conserve energy.
#[test]
fn fine_sheen_is_too_bright_at_the_horizon() {
    for roughness in [0.04_f64, 0.2, 0.3, 0.5, 1.0] {
        let alpha = (roughness * roughness).max(1e-3);
        let most = (0..12).map(|k| 10_f64.powf(-f64::from(k) / 4.0));
        let most = most
            .map(|cos| (sheen::albedo(cos, alpha), cos))
            .reduce(|a, b| if a.0 > b.0 { a } else { b });
        let (albedo, cos) = most.unwrap();
        println!("sheen of roughness {roughness}: at most {albedo:.3}, at cosine {cos:.4}");
        // A table of the shader cannot hide it: E is cut off at 1 for the base's share only.
        let white = sheen::Sheen::new(DVec3::ONE, roughness, cos).unwrap();
        assert_eq!(white.base_share(1.0) == 0.0, albedo >= 1.0, "{roughness}");
    }
}
