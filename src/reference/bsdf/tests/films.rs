//! Thin films against interference.

use super::*;
use std::f64::consts::TAU;

fn reflectance(ior: f64, thickness: f64, cos: f64, f0: f64) -> DVec3 {
    Film { factor: 1.0, ior, thickness }.reflectance(cos, DVec3::splat(f0))
}

/// Without thickness the base is left, but for the floor of 1e-5 under the product of the two
/// reflectances, whose root is an amplitude of 0.003, twice counted both ways.
#[test]
fn no_film_is_no_film() {
    for f0 in [0.02, 0.3, 0.9] {
        let error = (reflectance(1.8, 0.0, 1.0, f0) - f0).abs().max_element();
        println!("f0 {f0}: {error:.1e}");
        assert!(error < 4.0 * 1e-5_f64.sqrt() * (1.0 - f0), "{f0}: {error}");
    }
    // A film of the base's own index is no film either: only its outside reflects.
    let f0 = fresnel::at_normal(1.5);
    let error = (reflectance(1.5, 500.0, 1.0, f0) - f0).abs().max_element();
    assert!(error < 4.0 * 1e-5_f64.sqrt(), "{error}");
}

/// Airy's sum at normal incidence and one wavelength.
fn airy(film: f64, base: f64, thickness: f64, wavelength: f64) -> f64 {
    let (r1, r2) = ((1.0 - film) / (1.0 + film), (film - base) / (film + base));
    let phase = 2.0 * TAU * film * thickness / wavelength;
    let (sum, product) = (r1 * r1 + r2 * r2, 2.0 * r1 * r2 * phase.cos());
    (sum + product) / (1.0 + r1 * r1 * r2 * r2 + product)
}

/// Airy's sum over the matching functions as the model has them, in linear Rec. 709: wave numbers
/// in steps of 1/4 of a nm at the middle.
fn airy_color(film: f64, base: f64, thickness: f64) -> DVec3 {
    let gaussian = |x: f64, h: f64, c: f64, v: f64| h * (-(x - c).powi(2) / (2.0 * v)).exp();
    let (mut sum, mut whole) = (DVec3::ZERO, DVec3::ZERO);
    // 2 pi over the wavelength.
    for k in 0..3000 {
        let x = 1e3 * f64::from(k) / TAU * TAU + 1e6;
        let [h, c, v] =
            [super::super::film::HEIGHT, super::super::film::CENTRE, super::super::film::VARIANCE];
        let [h2, c2, v2] = super::super::film::SECOND;
        let matching = DVec3::new(
            gaussian(x, h.x, c.x, v.x) + gaussian(x, h2, c2, v2),
            gaussian(x, h.y, c.y, v.y),
            gaussian(x, h.z, c.z, v.z),
        );
        sum += matching * airy(film, base, thickness, 1e9 / x);
        whole += matching;
    }
    super::super::film::REC709 * (sum / whole)
}

/// The luminance of the sum to two orders is near that of Airy's whole sum where the second
/// reflection is weak; and it is smallest and largest where two beams cancel and add up.
#[test]
fn films_interfere_as_airy_says() {
    let luminance = |c: DVec3| DVec3::new(0.2126, 0.7152, 0.0722).dot(c);
    let (film, base) = (1.33, 1.5);
    let f0 = fresnel::at_normal(base);
    let mut worst = 0.0_f64;
    for thickness in [50.0, 100.0, 150.0, 200.0, 300.0, 450.0] {
        let (got, exact) =
            (reflectance(film, thickness, 1.0, f0), airy_color(film, base, thickness));
        worst = worst.max((luminance(got) - luminance(exact)).abs());
        println!("{thickness} nm: {got:.4} for {exact:.4}");
    }
    println!("luminance off by {worst:.1e}");
    assert!(worst < 2e-3);
    // A quarter of the wave that looks brightest, within the film: 555 nm.
    let quarter = 555.0 / film / 4.0;
    let [dark, bright] = [quarter, 2.0 * quarter].map(|d| luminance(reflectance(film, d, 1.0, f0)));
    // Both beams reflect at a larger index: a quarter wave cancels, ((n0 n2 - n1²)/(n0 n2 + n1²))².
    let least = ((base - film * film) / (base + film * film)).powi(2);
    println!("dark {dark:.4} for {least:.4}, bright {bright:.4} for {f0:.4}");
    assert!((dark - least).abs() < 2e-3 && (bright - f0).abs() < 4e-3);
}

/// Aslant the two beams differ by 2 n d times the cosine within the film: the thickness at which
/// they first cancel is larger than at normal incidence by that.
#[test]
fn films_cancel_by_the_angle_within() {
    let (film, f0) = (1.33, fresnel::at_normal(1.5));
    let darkest = |cos: f64| {
        let green = |d: u32| reflectance(film, f64::from(d), cos, f0).y;
        let least = (60..200).min_by(|&a, &b| green(a).total_cmp(&green(b)));
        f64::from(least.unwrap())
    };
    let cos = 0.6_f64;
    let within = (1.0 - (1.0 - cos * cos) / (film * film)).sqrt();
    let ratio = darkest(cos) / darkest(1.0);
    println!("{ratio} for {}", 1.0 / within);
    assert!((ratio * within - 1.0).abs() < 0.03, "{ratio}");
}
