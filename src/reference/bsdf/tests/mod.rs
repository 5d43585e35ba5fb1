//! Scattering against integrals and closed forms.

mod albedos;
mod films;
mod interfaces;
mod layers;

use super::*;
use crate::reference::shading::{CoatShading, Dielectric, SheenShading, Stretch};
use crate::reference::tests::hemisphere;
use crate::statistics::{DirectionGrid, FALSE_ALARM, Verdict};
use std::f64::consts::PI;

/// Normal of all test surfaces.
fn up() -> DVec3 {
    DVec3::new(0.2, 0.9, -0.3).normalize()
}

/// At a cosine to [`up`], turned out of every plane of symmetry.
fn tilted(cos: f64) -> DVec3 {
    let (x, y) = up().any_orthonormal_pair();
    up() * cos + (x * 0.8 + y * 0.6) * f64::sqrt(1.0 - cos * cos)
}

/// A coloured mixture of metal and dielectric.
fn paint() -> Shading {
    Shading {
        base: DVec3::new(0.8, 0.5, 0.2),
        metallic: 0.3,
        roughness: 0.6,
        dielectric: Dielectric::Specular { strength: 0.9, color: DVec3::new(1.0, 0.8, 0.6) },
        ior: 1.5,
        transmission: 0.0,
        is_transmitting: false,
        is_volume: false,
        is_inside: false,
        passage_index: 1.5,
        diffuse_transmission: 0.0,
        diffuse_transmission_color: DVec3::ZERO,
        stretch: None,
        film: None,
        sheen: None,
        coat: None,
    }
}

/// A dielectric that is white all through, with the interface of an index of 1.5.
fn white() -> Shading {
    let dielectric = Dielectric::Specular { strength: 1.0, color: DVec3::ONE };
    Shading { base: DVec3::ONE, metallic: 0.0, dielectric, ..paint() }
}

/// White glass.
fn glass(passage_index: f64) -> Shading {
    Shading {
        transmission: 1.0,
        is_transmitting: true,
        is_volume: true,
        passage_index,
        is_inside: passage_index < 1.0,
        ..white()
    }
}

fn stretch(strength: f64) -> Option<Stretch> {
    Some(Stretch { strength, axis: tilted(0.3) })
}

fn coat(roughness: f64) -> Option<CoatShading> {
    let normal = (up() + 0.1 * DVec3::X).normalize();
    Some(CoatShading { factor: 0.8, roughness, normal })
}

fn sheen(roughness: f64) -> Option<SheenShading> {
    Some(SheenShading { color: DVec3::new(0.9, 0.5, 0.7), roughness })
}

fn film(thickness: f64) -> Option<Film> {
    Some(Film { factor: 0.8, ior: 1.4, thickness })
}

fn behind() -> Shading {
    let diffuse_transmission_color = DVec3::new(0.3, 0.9, 0.6);
    Shading { diffuse_transmission: 0.4, diffuse_transmission_color, ..paint() }
}

fn bsdf(m: &Shading, cos: f64) -> Bsdf {
    Bsdf::new(m, tilted(cos), (up(), up()), false)
}

/// Every lobe alone and with others, and a cosine to see it from.
fn cases() -> Vec<(&'static str, Shading, f64)> {
    let thin = Shading { transmission: 0.7, is_transmitting: true, ..paint() };
    let partial = Shading { base: DVec3::new(0.9, 0.8, 0.6), transmission: 0.6, ..glass(1.4) };
    let glossy = Dielectric::Glossy { f0: DVec3::new(0.7, 0.4, 0.1) };
    vec![
        ("paint", paint(), 0.8),
        ("paint aslant", paint(), 0.15),
        ("metal", Shading { metallic: 1.0, roughness: 0.9, ..paint() }, 0.4),
        ("dielectric", Shading { metallic: 0.0, roughness: 0.4, ..paint() }, 0.9),
        ("glossy", Shading { metallic: 0.0, dielectric: glossy, ..paint() }, 0.6),
        ("stretched", Shading { stretch: stretch(0.7), ..paint() }, 0.5),
        ("film", Shading { film: film(400.0), ..paint() }, 0.5),
        ("sheen", Shading { sheen: sheen(0.7), ..paint() }, 0.3),
        ("coat", Shading { coat: coat(0.5), ..paint() }, 0.4),
        ("leaf", behind(), 0.7),
        ("thin", thin, 0.6),
        ("into", Shading { roughness: 0.7, ..partial }, 0.7),
        (
            "out of",
            Shading { roughness: 0.7, passage_index: 1.0 / 1.4, is_inside: true, ..partial },
            0.8,
        ),
        ("beyond the angle", Shading { passage_index: 0.6, is_inside: true, ..partial }, 0.5),
        ("stretched glass", Shading { stretch: stretch(0.6), film: film(250.0), ..partial }, 0.6),
        (
            "mirror under all",
            Shading { roughness: 0.0, sheen: sheen(0.5), coat: coat(0.4), ..paint() },
            0.5,
        ),
        (
            "all",
            Shading {
                film: film(600.0),
                sheen: sheen(0.8),
                coat: coat(0.3),
                stretch: stretch(0.5),
                ..behind()
            },
            0.5,
        ),
        ("all over glass", Shading { sheen: sheen(0.6), coat: coat(0.6), ..partial }, 0.6),
    ]
}

/// Integral over all directions.
fn sphere(mut value: impl FnMut(DVec3) -> DVec3) -> DVec3 {
    hemisphere(&mut value, up()) + hemisphere(value, -up())
}

#[test]
fn drawn_directions_have_their_density() {
    for (what, m, cos) in cases() {
        let bsdf = bsdf(&m, cos);
        let grid = DirectionGrid::sphere(up().to_array(), 16, 16);
        let mut random = Random::new(3, (0, 0), 0);
        let draws = (0..60_000).map(|_| match bsdf.draw(&mut random) {
            Some(Drawn::OfMany(wi)) => Some(wi.to_array()),
            _ => None,
        });
        let fit = grid.test(draws, |wi| bsdf.pdf(DVec3::from(wi)));
        println!("{what}: {fit}");
        assert_eq!(fit.verdict(FALSE_ALARM), Verdict::Agrees, "{what}: {fit}");
    }
}

/// The mean weight of drawn directions is the integral of the BSDF and the cosine.
#[test]
fn drawn_directions_integrate_the_bsdf() {
    for (what, m, cos) in cases() {
        let bsdf = bsdf(&m, cos);
        let expected = sphere(|wi| bsdf.eval(wi));
        let mut random = Random::new(4, (0, 0), 0);
        let n = 100_000;
        let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
        for _ in 0..n {
            let drawn = bsdf.sample(&mut random).filter(|scattered| scattered.pdf.is_some());
            let weight = drawn.map_or(DVec3::ZERO, |scattered| scattered.weight);
            sum += weight;
            squares += weight * weight;
        }
        let n = f64::from(n);
        let mean = sum / n;
        for c in 0..3 {
            let s = ((squares[c] / n - mean[c] * mean[c]) / n).sqrt();
            let z = (mean[c] - expected[c]) / s;
            println!("{what}: {:.5} for {:.5}, z = {z:.1}", mean[c], expected[c]);
            assert!(z.abs() < 3.9, "{what}: {mean} {expected}, s {s}");
            assert!(s < 0.015 * expected[c], "{what}: {s} of {expected}");
        }
    }
}

/// BSDF times cosine of metal and dielectric, written out from angles.
fn by_definition(m: &Shading, wo: DVec3, wi: DVec3) -> DVec3 {
    let Dielectric::Specular { strength, color } = m.dielectric else { unreachable!() };
    let h = (wo + wi).normalize();
    let angle = |a: DVec3, b: DVec3| a.angle_between(b);
    let (o, i, half) = (angle(wo, up()), angle(wi, up()), angle(h, up()));
    let x = (1.0 - angle(wo, h).cos()).powi(5);
    let d = 1.0 - m.metallic;
    let f0 = (color * ((m.ior - 1.0) / (m.ior + 1.0)).powi(2)).min(DVec3::ONE) * strength;
    let f0_max = f0.max_element();
    let interface = f0_max + (strength - f0_max) * x;
    let diffuse = m.base * d / PI * (1.0 - interface);
    let low = f0 * d + m.base * m.metallic;
    let fresnel = low + (DVec3::splat(d * strength + m.metallic) - low) * x;
    let a2 = m.roughness.powi(4);
    let d_ggx = a2 / (PI * half.cos().powi(4) * (a2 + half.tan().powi(2)).powi(2));
    let root = |t: f64| (1.0 + a2 * t.tan().powi(2)).sqrt();
    let g2 = 2.0 / (root(o) + root(i));
    (diffuse + fresnel * (d_ggx * g2 / (4.0 * o.cos() * i.cos()))) * i.cos()
}

#[test]
fn paint_is_its_definition() {
    for (what, m, cos) in cases().into_iter().take(4) {
        let bsdf = bsdf(&m, cos);
        let _ = hemisphere(
            |wi| {
                let (expected, got) = (by_definition(&m, tilted(cos), wi), bsdf.eval(wi));
                let error = (expected - got).abs().max_element();
                assert!(error < 1e-9 * (1.0 + got.max_element()), "{what}: {wi}");
                got
            },
            up(),
        );
    }
}
