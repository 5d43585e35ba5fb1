//! What is read, and what cannot be compared.

use crate::{linear, picture, ramp};
use std::path::Path;
use steradian::image::compare::{Comparison, ComparisonOptions, Noise, PictureFile};
use steradian::image::{
    Attribute, BitDepth, ChannelData, ExrImage, Layer, Picture, PngOptions, Precision,
    linear_from_srgb, write_exr, write_png,
};

fn channel(values: Vec<f32>) -> ChannelData {
    ChannelData::F32(values)
}

fn store(path: &Path, change: impl FnOnce(&mut ExrImage)) -> PictureFile {
    let mut image = ExrImage::from_picture(&ramp(4, 3));
    change(&mut image);
    write_exr(path, &image, Precision::Float).unwrap();
    PictureFile::read(path).unwrap()
}

fn refusal(actual: &PictureFile, expected: &PictureFile, layers: &[&str]) -> String {
    let layers = layers.iter().map(|&name| name.to_owned()).collect();
    let options = ComparisonOptions { layers, ..ComparisonOptions::default() };
    Comparison::of(actual, expected, &options).unwrap_err().to_string()
}

#[test]
fn png_of_8_and_16_bits_is_linear() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let codes = picture(256, 1, |x, _| [linear_from_srgb(x as f32 / 255.0); 3]);
    for depth in [BitDepth::Eight, BitDepth::Sixteen] {
        let text = vec![("steradian.seed".to_owned(), "7".to_owned())];
        write_png(&path, &codes, &PngOptions { depth, text, ..PngOptions::default() }).unwrap();
        let file = PictureFile::read(&path).unwrap();
        // 16 bits hold every 8-bit code.
        assert_eq!(file.picture().unwrap(), codes, "{depth:?}");
        assert_eq!(file.setting("seed"), Some("7"));
        assert!(file.noise.is_none());
    }
}

/// A file has its channels by the alphabet: B, G, R.
#[test]
fn exr_layers_have_names_and_colours_their_order() {
    let folder = tempfile::tempdir().unwrap();
    let file = store(&folder.path().join("a.exr"), |image| {
        image.layers[0].channels.push(("Z".into(), channel(vec![5.0; 12])));
        let normal = ["X", "Y", "Z"].map(|n| (n.to_owned(), channel(vec![0.5; 12])));
        image.layers.push(Layer { name: "normal".into(), channels: normal.into() });
        image.metadata.insert("steradian.seed".into(), Attribute::Number(3.0));
    });
    let names: Vec<_> = file.layers.iter().map(|layer| layer.name.as_str()).collect();
    assert_eq!(names, ["", "Z", "normal"]);
    let channels: Vec<_> = file.layers[0].channels.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(channels, ["R", "G", "B"]);
    assert_eq!(file.picture().unwrap(), ramp(4, 3));
    assert_eq!(file.setting("seed"), Some("3"));
}

#[test]
fn noise_is_read_in_both_forms() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let pieces = store(&path, |image| {
        let channels = vec![
            ("samples".to_owned(), ChannelData::U32(vec![64; 12])),
            ("standard_error".to_owned(), channel(vec![0.5; 12])),
        ];
        image.layers.push(Layer { name: "noise".into(), channels });
        image.metadata.insert("steradian.block".into(), Attribute::Number(16.0));
    });
    let Some(Noise::Pieces { variance, pieces, samples }) = pieces.noise else {
        panic!("{:?}", pieces.noise)
    };
    assert_eq!((variance[0], pieces, samples[0]), (0.25, 4, 64));
    let of_runs = |values: Vec<f32>, runs: &str| {
        let mut image = ExrImage::from_picture(&ramp(4, 3));
        let names = ["R", "G", "B"];
        let channels = names.map(|name| (name.to_owned(), channel(values.clone()))).into();
        image.layers.push(Layer { name: "variance".into(), channels });
        image.metadata.insert("runs".into(), Attribute::Text(runs.into()));
        write_exr(&path, &image, Precision::Float).unwrap();
        PictureFile::read(&path)
    };
    let runs = of_runs(vec![0.25; 12], "32").unwrap();
    let Some(Noise::Runs { variance, runs, spp, luminance }) = runs.noise else { panic!() };
    assert_eq!((variance[3], runs, spp, luminance), ([0.25; 3], 32, None, None));
    // What is no variance is an error, not a picture without noise.
    for (value, runs) in [(-1.0, "32"), (f32::NAN, "32"), (0.25, "1"), (0.25, "many")] {
        assert!(of_runs(vec![value; 12], runs).is_err(), "{value} {runs}");
    }
}

#[test]
fn what_cannot_be_compared_is_said_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let a = linear(&ramp(8, 4));
    let size = refusal(&a, &linear(&ramp(8, 5)), &[]);
    assert_eq!(size, "sizes differ: actual 8x4, expected 8x5 pixels");
    let shown = PictureFile { format: steradian::image::OutputFormat::Png, ..a.clone() };
    assert!(refusal(&a, &shown, &[]).contains("compare like with like"));
    let part = PictureFile {
        window: steradian::settings::Crop { x: 1, y: 0, width: 8, height: 4 },
        ..a.clone()
    };
    assert!(refusal(&a, &part, &[]).contains("parts of the picture differ"));

    let path = folder.path().join("layers.exr");
    let depth = |name: &str| {
        let layer =
            Layer { name: "depth".into(), channels: vec![(name.into(), channel(vec![1.0; 12]))] };
        store(&path, |image| image.layers.push(layer))
    };
    let plain = linear(&ramp(4, 3));
    let missing = refusal(&depth("V"), &plain, &[]);
    assert_eq!(missing, "expected has no layer depth, only: colour; choose layers with --layer");
    assert!(refusal(&depth("V"), &plain, &["albedo"]).starts_with("actual has no layer albedo"));
    let channels = refusal(&depth("V"), &depth("Z"), &[]);
    assert_eq!(channels, "channels of layer depth differ: actual V, expected Z");
    // The colour alone can be compared.
    let options = ComparisonOptions { layers: vec![String::new()], ..Default::default() };
    assert!(Comparison::of(&depth("V"), &plain, &options).unwrap().passes());
}

/// A value that is not finite fails every metric and every rule, in either picture.
#[test]
fn what_is_not_finite_fails_everything() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut spoilt: Picture = ramp(8, 4);
        spoilt.rgb[8 * 2 + 5][1] = bad;
        let (good, bad) = (linear(&ramp(8, 4)), linear(&spoilt));
        for (actual, expected) in [(&bad, &good), (&good, &bad), (&bad, &bad)] {
            let rules = ["mse<1e30", "flip.mean<2", "hdrflip.max<2", "exact", "different<2"];
            let rules = rules.iter().map(|rule| rule.parse().unwrap()).collect();
            let options = ComparisonOptions { rules, ..Default::default() };
            let found = Comparison::of(actual, expected, &options).unwrap();
            assert!(!found.passes());
            assert_eq!(found.failures[0].rule, "finite");
            assert!(found.failures[0].finding.contains("G at (5, 2)"), "{:?}", found.failures);
            assert_eq!(found.failures.len(), 6, "every rule fails too: {:?}", found.failures);
            let layer = found.layer("").unwrap();
            assert!(layer.metrics.iter().all(|(_, value)| value.is_nan()));
        }
    }
}
