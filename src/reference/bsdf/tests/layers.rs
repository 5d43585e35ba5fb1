//! Coats, leaves, sheen over a base, and stretched highlights.

use super::*;

/// A smooth coat over black: Fresnel's share of a mirror image, and nothing else.
#[test]
fn a_coat_over_black_is_its_reflection() {
    let black = Dielectric::Specular { strength: 0.0, color: DVec3::ONE };
    let smooth = CoatShading { factor: 0.5, roughness: 0.0, normal: up() };
    let m = Shading {
        base: DVec3::ZERO,
        metallic: 0.0,
        roughness: 0.0,
        dielectric: black,
        coat: Some(smooth),
        ..paint()
    };
    for cos in [1.0, 0.5, 0.1] {
        let bsdf = bsdf(&m, cos);
        let s = bsdf.sample(&mut Random::new(1, (0, 0), 0)).unwrap();
        let expected = 0.5 * (0.04 + 0.96 * f64::powi(1.0 - cos, 5));
        assert!((s.weight - expected).abs().max_element() < 1e-12, "{:?}", s.weight);
        assert!((s.wi + tilted(cos)).normalize().dot(up()) > 1.0 - 1e-12 && s.pdf.is_none());
        assert_eq!(bsdf.eval(up()), DVec3::ZERO);
    }
}

/// A coat takes its share of what is below, in all directions.
#[test]
fn a_coat_dims_what_is_below() {
    let bare = bsdf(&behind(), 0.4);
    let mirror = CoatShading { factor: 0.7, roughness: 0.0, normal: up() };
    let coated = bsdf(&Shading { coat: Some(mirror), ..behind() }, 0.4);
    let kept = 1.0 - 0.7 * (0.04 + 0.96 * 0.6_f64.powi(5));
    for wi in [up(), tilted(0.3), -up(), -tilted(0.8)] {
        assert!((coated.eval(wi) - bare.eval(wi) * kept).length() < 1e-12);
    }
}

/// The colours of a leaf's two sides, without an interface: base (1 - d) and colour d over pi.
#[test]
fn a_leaf_scatters_to_both_sides() {
    let dielectric = Dielectric::Specular { strength: 0.0, color: DVec3::ONE };
    let m = Shading { metallic: 0.0, dielectric, ..behind() };
    let bsdf = bsdf(&m, 0.6);
    let above = m.base * 0.6 / PI * 0.25;
    let below = m.diffuse_transmission_color * 0.4 / PI * 0.7;
    assert!((bsdf.eval(tilted(0.25)) - above).length() < 1e-12);
    assert!((bsdf.eval(-tilted(0.7)) - below).length() < 1e-12);
}

/// Sheen and what it leaves of a white base make at most 1 of light, and the base is dimmed for
/// both directions alike.
#[test]
fn sheen_takes_from_the_base_what_it_scatters() {
    let lambert = Dielectric::Specular { strength: 0.0, color: DVec3::ONE };
    let m = Shading { roughness: 1.0, dielectric: lambert, ..white() };
    let cloth = Shading { sheen: Some(SheenShading { color: DVec3::ONE, roughness: 0.7 }), ..m };
    for cos in [0.9, 0.3, 0.05] {
        let dressed = hemisphere(|wi| bsdf(&cloth, cos).eval(wi), up()).x;
        let taken = super::super::sheen::albedo(cos, 0.49);
        println!("cos {cos}: {dressed}, sheen {taken}");
        assert!(dressed < 1.0 + 1e-3 && dressed > taken);
    }
    let (a, b) = (tilted(0.2), up());
    let [there, back] = [(a, b), (b, a)]
        .map(|(wo, wi)| Bsdf::new(&cloth, wo, (up(), up()), false).eval(wi) / up().dot(wi));
    assert!((there - back).length() < 1e-12);
}

/// Strength s makes alpha mix(alpha, 1, s²) along the axis, and leaves it as it is across: the
/// slopes in both directions have those scales, by the value at the pole and at slope 1.
#[test]
fn highlights_stretch_along_their_axis() {
    let strength = 0.6_f64;
    let m = Shading { roughness: 0.4, stretch: stretch(strength), metallic: 1.0, ..white() };
    let [along, across] = [0.16 + 0.84 * strength * strength, 0.16];
    let base = Base::new(&m, up(), up(), false);
    let ggx = base.ggx.unwrap();
    let axis = (tilted(0.3) - up() * 0.3).normalize();
    let pole = 1.0 / (PI * along * across);
    assert!((ggx.distribution(up()) / pole - 1.0).abs() < 1e-12);
    for (axis, alpha) in [(axis, along), (up().cross(axis), across)] {
        let half = (up() + axis).normalize();
        let expected = pole / (0.5 + 0.5 / (alpha * alpha)).powi(2);
        assert!((ggx.distribution(half) / expected - 1.0).abs() < 1e-12);
    }
}
