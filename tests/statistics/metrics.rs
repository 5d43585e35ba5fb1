//! Error metrics on pictures small enough to compute by hand.

use steradian::image::Picture;
use steradian::image::compare::{mse, relmse};

#[test]
fn errors_of_two_pixels() {
    let reference = Picture::new(2, 1, vec![[1.0; 3], [0.0; 3]]);
    let picture = Picture::new(2, 1, vec![[1.5, 1.0, 1.0], [0.0, 0.0, 0.25]]);
    assert!((mse(&picture, &reference) - (0.25 + 0.0625) / 6.0).abs() < 1e-15);
    // Mean luminance 0.5: epsilon is 0.005².
    let error = relmse(&picture, &reference);
    assert!((error.epsilon - 2.5e-5).abs() < 1e-18);
    let truth = (0.25 / (1.0 + 2.5e-5) + 0.0625 / 2.5e-5) / 6.0;
    assert!((error.value / truth - 1.0).abs() < 1e-12, "{error:?}");
    assert_eq!(relmse(&reference, &reference).value, 0.0);
    let black = Picture::new(1, 1, vec![[0.0; 3]]);
    assert_eq!(relmse(&black, &black).value, 0.0);
}

#[test]
fn a_pixel_that_is_not_finite_is_never_passed_over() {
    let reference = Picture::new(1, 1, vec![[1.0; 3]]);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let picture = Picture::new(1, 1, vec![[1.0, bad, 1.0]]);
        assert!(!mse(&picture, &reference).is_finite());
        assert!(!relmse(&picture, &reference).value.is_finite());
        assert!(!relmse(&reference, &picture).value.is_finite());
    }
}
