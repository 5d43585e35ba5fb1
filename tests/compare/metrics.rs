//! Metrics by hand.

use crate::{linear, picture, ramp};
use steradian::image::Picture;
use steradian::image::compare::{Comparison, ComparisonOptions, Metrics, mse, relmse};

fn metrics(actual: &Picture, expected: &Picture) -> Metrics {
    let options = ComparisonOptions::default();
    let found = Comparison::of(&linear(actual), &linear(expected), &options).unwrap();
    found.layers[0].metrics.clone()
}

#[track_caller]
fn assert_close(value: f64, truth: f64) {
    assert!((value / truth - 1.0).abs() < 1e-9, "{value} for {truth}");
}

/// 2000 pixels of 1, of which one is 3 in red and one is 0.
#[test]
fn two_wrong_pixels() {
    let expected = picture(50, 40, |_, _| [1.0; 3]);
    let mut actual = expected.clone();
    actual.rgb[17] = [3.0, 1.0, 1.0];
    actual.rgb[1999] = [0.0; 3];
    let m = metrics(&actual, &expected);
    let get = |name: &str| m.get(name).unwrap();
    let values = 6000.0;
    let epsilon = 1e-4;
    assert_close(m.epsilon, epsilon);
    assert_close(get("mse"), (4.0 + 3.0) / values);
    assert_close(get("rmse"), (7.0_f64 / values).sqrt());
    assert_close(get("mae"), (2.0 + 3.0) / values);
    assert_close(get("relmse"), 7.0 / (1.0 + epsilon) / values);
    // The worst two of 2000 pixels are left out.
    assert_eq!(get("relmse.trimmed"), 0.0);
    assert_close(get("smape"), (2.0 / 4.01 + 3.0 / 1.01) / values);
    assert_eq!(get("error.max"), 2.0);
    assert_eq!([get("error.p50"), get("error.p99")], [0.0; 2]);
    // 1998 of 2000 are right: the 99.9th percentile is the last of them.
    assert_eq!(get("error.p99.9"), 0.0);
    assert_close(get("different"), 0.001);
    assert!(get("flip.max") > 0.3 && get("flip.mean") < 0.05);
}

#[test]
fn equal_pictures_have_no_error() {
    for picture in [ramp(16, 9), picture(3, 3, |_, _| [0.0; 3])] {
        let m = metrics(&picture, &picture);
        assert!(m.iter().all(|(_, value)| value == 0.0), "{m:?}");
    }
}

/// The functions of pictures and the named metrics are one.
#[test]
fn both_forms_agree() {
    let expected = ramp(20, 10);
    let actual = picture(20, 10, |x, y| {
        let i = (y * 20 + x) as usize;
        expected.rgb[i].map(|v| v * (1.0 + 0.01 * ((i * 7) % 13) as f32))
    });
    let m = metrics(&actual, &expected);
    assert_close(m.get("mse").unwrap(), mse(&actual, &expected));
    let relative = relmse(&actual, &expected);
    assert_close(m.get("relmse").unwrap(), relative.value);
    assert_close(m.epsilon, relative.epsilon);
}
