//! FLIP against the numbers of NVIDIA's package, which `tools/check_flip.py` stores.

use serde_json::Value;
use std::path::Path;
use steradian::image::Picture;
use steradian::image::compare::{Flip, PictureFile, hdr_flip, ldr_flip};

/// Both compute in f32, the package in another order: ten units of 2^-24 per value.
const ROUNDING: f64 = 10.0 / 16_777_216.0;

fn fixture(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/compare/fixtures").join(name)
}

fn picture(name: &str) -> Picture {
    PictureFile::read(&fixture(name)).unwrap().picture().unwrap()
}

fn stored(name: &str) -> Value {
    let text = std::fs::read_to_string(fixture("flip.json")).unwrap();
    serde_json::from_str::<Value>(&text).unwrap()[name].clone()
}

fn largest_difference(flip: &Flip, stored: &Value) -> f64 {
    let map = stored["map"].as_array().unwrap();
    assert_eq!(map.len(), flip.map.len());
    let pairs = flip.map.iter().zip(map);
    pairs.map(|(a, b)| (f64::from(*a) - b.as_f64().unwrap()).abs()).fold(0.0, f64::max)
}

#[test]
fn flip_of_what_a_display_shows() {
    let (actual, expected) = (picture("ldr-actual.png"), picture("ldr-expected.png"));
    let (flip, stored) = (ldr_flip(&actual, &expected), stored("ldr"));
    let difference = largest_difference(&flip, &stored);
    println!("largest difference {difference:.1e}, mean {}", stored["mean"]);
    assert!(stored["mean"].as_f64().unwrap() > 0.05, "the fixtures differ");
    assert!(difference < ROUNDING, "{difference:.1e}");
    // The wrong way round is another number.
    assert!(largest_difference(&ldr_flip(&actual, &actual), &stored) > 0.1);
}

#[test]
fn flip_of_linear_radiance() {
    let (actual, expected) = (picture("hdr-actual.exr"), picture("hdr-expected.exr"));
    let (flip, stored) = (hdr_flip(&actual, &expected), stored("hdr"));
    let difference = largest_difference(&flip, &stored);
    println!("largest difference {difference:.1e}, mean {}", stored["mean"]);
    assert!(difference < ROUNDING, "{difference:.1e}");
    let used = flip.exposures.unwrap();
    let asked = &stored["exposures"];
    assert_eq!(used.count as u64, asked["count"].as_u64().unwrap());
    for (value, name) in [(used.start, "start"), (used.stop, "stop")] {
        assert!((f64::from(value) - asked[name].as_f64().unwrap()).abs() < 1e-4, "{name}");
    }
    assert!(largest_difference(&hdr_flip(&expected, &actual), &stored) > 1e-3);
}

/// No exposure suits a black picture; it is compared as it is.
#[test]
fn black_pictures_have_a_flip() {
    let black = Picture::new(4, 4, vec![[0.0; 3]; 16]);
    let grey = Picture::new(4, 4, vec![[0.2; 3]; 16]);
    assert!(hdr_flip(&black, &black).map.iter().all(|&v| v == 0.0));
    assert!(hdr_flip(&grey, &black).map.iter().all(|&v| v > 0.1));
}
