//! Image tests of our own, one of each kind and what they refuse. Goldens and references are in
//! `tests/goldens`; they were made by `STERADIAN_BLESS=1 cargo test --test compare image_tests`.

use crate::common::{bundled, settings, with_device};
use crate::ramp;
use std::path::Path;
use steradian::RenderSettings;
use steradian::image::Picture;
use steradian::settings::Crop;
use steradian::testing::{Blessing, ImageTest, Passed, Rendered};

fn render(scene: &str, settings: &RenderSettings) -> Rendered {
    with_device(|device| Rendered::render(device, &bundled(scene), settings).unwrap())
}

/// Every bit, on the drivers that there are goldens of; elsewhere within noise, which four
/// blocks tell of. Of cornell-spheres there are goldens of two versions of lavapipe.
#[test]
fn exact() {
    for scene in ["cornell-spheres", "environment"] {
        let settings = RenderSettings { block_size: 4, ..settings(24, 24, 16) };
        let picture = render(scene, &settings);
        let passed = ImageTest::new(scene).exact(&picture).unwrap();
        println!("{scene}: {passed:?}");
    }
}

/// The same picture in one piece, in quarters put together, and by blocks of the same size in
/// another order of work.
#[test]
fn same_bytes() {
    let base = settings(32, 32, 8);
    let whole = render("cornell-spheres", &base);
    let again = render("cornell-spheres", &base);
    let quarter = |x: u32, y: u32| {
        let crop = Some(Crop { x, y, width: 16, height: 16 });
        render("cornell-spheres", &RenderSettings { crop, ..base.clone() }).picture()
    };
    let quarters = [quarter(0, 0), quarter(16, 0), quarter(0, 16), quarter(16, 16)];
    let at = |i: usize| {
        let (x, y) = (i % 32, i / 32);
        quarters[y / 16 * 2 + x / 16].rgb[y % 16 * 16 + x % 16]
    };
    let joined = Picture::new(32, 32, (0..1024).map(at).collect());
    let joined = Rendered::new(joined, "joined", "of four crops");
    let test = ImageTest::new("same-bytes");
    test.same_bytes(&[("whole", &whole), ("again", &again), ("quarters", &joined)]).unwrap();
}

/// Against the mean of 64 runs. The edges of the lamp are noisy in so small a picture: 8 % of the mean
/// would show.
#[test]
fn statistical() {
    let test = ImageTest::new("cornell-box-64spp");
    let render = |seed| {
        let settings = RenderSettings { seed, ..settings(24, 24, 64) };
        render("cornell-box", &settings)
    };
    test.statistical(0.08, render).unwrap();
}

/// And what is not the reference fails it: direct light alone.
#[test]
fn statistical_finds_a_difference() {
    let folder = tempfile::tempdir().unwrap();
    let test = ImageTest::new("cornell-box-64spp").output_in(folder.path()).blessing(Blessing::Off);
    let render = |seed| {
        let settings = RenderSettings { seed, max_bounces: Some(1), ..settings(24, 24, 64) };
        render("cornell-box", &settings)
    };
    let failure = test.statistical(0.08, render).unwrap_err();
    println!("{failure}");
    assert!(failure.message.contains("verdict: more than noise"), "{failure}");
    assert_evidence(
        failure.report.as_deref(),
        &["actual.exr", "actual.png", "expected.png", "flip.png"],
    );
}

fn assert_evidence(report: Option<&Path>, files: &[&str]) {
    let report = report.expect("a report");
    assert!(std::fs::read_to_string(report).unwrap().contains("</html>"));
    for file in files {
        assert!(report.with_file_name(file).exists(), "{file}");
    }
}

fn by(driver: &str, brightness: f32) -> Rendered {
    let mut picture = ramp(12, 8);
    picture.rgb.iter_mut().flatten().for_each(|v| *v *= brightness);
    Rendered::new(picture, "adapter", driver)
}

#[test]
fn what_is_missing_fails() {
    let folder = tempfile::tempdir().unwrap();
    let test = ImageTest::new("nothing")
        .references_in(folder.path())
        .output_in(folder.path())
        .blessing(Blessing::Off);
    let failure = test.exact(&by("1", 1.0)).unwrap_err();
    assert!(failure.message.contains("STERADIAN_BLESS=1 makes one"), "{failure}");
    let failure = test.statistical(0.01, |_| by("1", 1.0)).unwrap_err();
    assert!(failure.message.contains("there is no reference"), "{failure}");
    assert!(test.same_bytes(&[("alone", &by("1", 1.0))]).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is stored");
}

#[test]
fn blessing_on_another_driver_is_refused() {
    let (folder, output) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let off = ImageTest::new("golden")
        .references_in(folder.path())
        .output_in(output.path())
        .blessing(Blessing::Off);
    let bless = off.clone().blessing(Blessing::Replace);
    assert_eq!(bless.exact(&by("Mesa 1", 1.0)), Ok(Passed::Blessed));
    assert_eq!(off.exact(&by("Mesa 1", 1.0)), Ok(Passed::Compared));
    let failure = off.exact(&by("Mesa 1", 1.001)).unwrap_err();
    assert!(failure.message.contains("is not its golden picture"), "{failure}");
    assert_evidence(
        failure.report.as_deref(),
        &["actual.exr", "actual.png", "expected.png", "flip.png"],
    );
    // Another driver: refused, and nothing is written.
    let failure = bless.exact(&by("Mesa 2", 1.001)).unwrap_err();
    assert!(failure.message.contains("blessing refused"), "{failure}");
    assert!(failure.message.contains("goldens of adapter, Mesa 1, and this is adapter, Mesa 2"));
    assert_eq!(std::fs::read_dir(folder.path().join("golden")).unwrap().count(), 1);
    assert_eq!(off.exact(&by("Mesa 1", 1.0)), Ok(Passed::Compared));
    // Where a golden of the driver is demanded, its lack is a failure.
    let failure = off.clone().requires_golden(true).exact(&by("Mesa 2", 1.0)).unwrap_err();
    assert!(failure.message.contains("STERADIAN_BLESS=new adds one"), "{failure}");
    // Without noise a picture of another driver cannot be judged: no pass by default.
    assert!(off.exact(&by("Mesa 2", 1.0)).is_err());
    let add = off.clone().blessing(Blessing::New);
    assert_eq!(add.exact(&by("Mesa 2", 1.5)), Ok(Passed::Blessed));
    assert_eq!(off.exact(&by("Mesa 2", 1.5)), Ok(Passed::Compared));
    assert_eq!(off.exact(&by("Mesa 1", 1.0)), Ok(Passed::Compared));
}

#[test]
fn same_bytes_names_what_differs() {
    let folder = tempfile::tempdir().unwrap();
    let test = ImageTest::new("ways").output_in(folder.path());
    let (a, b) = (by("1", 1.0), by("1", 1.0001));
    assert_eq!(test.same_bytes(&[("a", &a), ("b", &a)]), Ok(Passed::Compared));
    let failure = test.same_bytes(&[("a", &a), ("b", &a), ("c", &b)]).unwrap_err();
    assert!(failure.message.contains("c differs from a"), "{failure}");
    assert_evidence(failure.report.as_deref(), &["actual.exr", "expected.exr"]);
}
