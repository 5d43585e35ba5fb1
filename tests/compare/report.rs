//! The report without a browser: that it is whole, safe, and small. `make test-report` clicks
//! through it.

use crate::common::Random;
use crate::{picture, ramp};
use serde_json::Value;
use std::path::{Path, PathBuf};
use steradian::image::compare::report::{ReportOptions, page};
use steradian::image::compare::{ComparisonOptions, Run};
use steradian::image::{
    Attribute, ExrImage, Picture, PngOptions, Precision, linear_from_srgb, write_exr, write_png,
};

fn data(page: &str) -> Value {
    let mark = "<script type=\"application/json\" id=\"data\">";
    let begin = page.find(mark).unwrap() + mark.len();
    let end = begin + page[begin..].find("</script>").unwrap();
    serde_json::from_str(&page[begin..end]).unwrap()
}

fn folders(folder: &Path) -> [PathBuf; 2] {
    ["actual", "expected"].map(|name| {
        let path = folder.join(name);
        std::fs::create_dir_all(&path).unwrap();
        path
    })
}

#[test]
fn a_page_holds_everything_and_asks_nobody() {
    let folder = tempfile::tempdir().unwrap();
    let [actual, expected] = folders(folder.path());
    // Texts that would end a script, if they were let.
    let evil = "</script><script>alert(1)</script><!--";
    for (path, picture) in [(&actual, ramp(9, 7)), (&expected, ramp(9, 7))] {
        let mut image = ExrImage::from_picture(&picture);
        image.metadata.insert("steradian.scene".into(), Attribute::Text(evil.into()));
        image.metadata.insert("command".into(), Attribute::Text("make it".into()));
        write_exr(&path.join("a.exr"), &image, Precision::Float).unwrap();
    }
    let shown = picture(8, 8, |x, y| [linear_from_srgb((8 * y + x) as f32 / 255.0); 3]);
    write_png(&actual.join("b.png"), &shown, &PngOptions::default()).unwrap();
    let run = Run::of(&actual, &expected, &ComparisonOptions::default()).unwrap();
    let options = ReportOptions { accept_command: "accept <all>".into(), ..Default::default() };
    let page = page(&run, &options);
    assert_eq!(page.matches("<script").count(), 2, "the data and the program");
    for word in ["http:", "https:", "src=", "@import", "url(", "fetch(", "/*STYLE*/", "/*DATA*/"] {
        assert!(!page.contains(word), "{word}");
    }
    let data = data(&page);
    assert_eq!(data["run"]["cases"][1]["metadata"]["actual"]["steradian.scene"], evil);
    assert_eq!(data["accept"], "accept <all>");
    assert_eq!(data["magma"].as_array().unwrap().len(), 256);
    // Missing: the actual picture alone. Compared: both, and their maps.
    let [missing, compared] = [0, 1].map(|k| data["pictures"][k][0].clone());
    assert_eq!(data["run"]["cases"][0]["status"], "missing");
    assert_eq!(missing["actual"]["format"], "u8");
    assert!(missing["expected"].is_null());
    assert_eq!(compared["actual"]["format"], "f16");
    assert_eq!((&compared["width"], &compared["height"]), (&Value::from(9), &Value::from(7)));
    assert_eq!(compared["maps"].as_array().unwrap().len(), 2);
}

/// Twenty pictures of noise, which compresses badly, at 256x256: shown smaller, and said so.
#[test]
fn a_report_keeps_to_its_size() {
    let folder = tempfile::tempdir().unwrap();
    let [actual, expected] = folders(folder.path());
    for k in 0..20 {
        let mut random = Random(k);
        let mut pixel = || [0; 3].map(|_| random.unit());
        let picture = Picture::new(256, 256, (0..256 * 256).map(|_| pixel()).collect());
        for path in [&actual, &expected] {
            let image = ExrImage::from_picture(&picture);
            write_exr(&path.join(format!("{k:02}.exr")), &image, Precision::Half).unwrap();
        }
    }
    let run = Run::of(&actual, &expected, &ComparisonOptions::default()).unwrap();
    let page = page(&run, &ReportOptions::default());
    println!("{} bytes", page.len());
    assert!(page.len() < 10_000_000, "{} bytes", page.len());
    let data = data(&page);
    let factors = data["pictures"].as_array().unwrap().iter();
    let factors: Vec<u64> = factors.map(|p| p[0]["actual"]["factor"].as_u64().unwrap()).collect();
    assert!(factors.iter().all(|f| *f <= 4) && factors.iter().any(|f| *f > 1), "{factors:?}");
}
