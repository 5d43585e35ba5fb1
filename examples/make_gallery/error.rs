//! Errors and their slopes.

use steradian::image::Picture;
use steradian::image::compare::relmse;
use steradian::settings::Crop;

/// Relative mean squared error of `picture`; the printed form has the ε that goes with it.
pub(crate) fn error(picture: &Picture, reference: &Picture) -> f64 {
    relmse(picture, reference).value
}

/// ε of errors against `reference`, as text.
pub(crate) fn epsilon(reference: &Picture) -> String {
    format!("{:.1e}", relmse(reference, reference).epsilon)
}

/// The pictures added up.
pub(crate) fn sum<'a>(pictures: impl IntoIterator<Item = &'a Picture>) -> Picture {
    let mut pictures = pictures.into_iter();
    let mut total = pictures.next().cloned().unwrap_or_default();
    for picture in pictures {
        for (to, from) in total.rgb.iter_mut().zip(&picture.rgb) {
            *to = std::array::from_fn(|c| to[c] + from[c]);
        }
    }
    total
}

/// A part of `picture`.
pub(crate) fn window(picture: &Picture, part: Crop) -> Picture {
    let at = |x: u32, y: u32| picture.rgb[(y * picture.width + x) as usize];
    let row = |y| (part.x..part.x + part.width).map(move |x| at(x, y));
    let rgb = (part.y..part.y + part.height).flat_map(row).collect();
    Picture::new(part.width, part.height, rgb)
}

/// Weights of red, green and blue in luminance, Rec. 709.
pub(crate) const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// Mean luminance.
pub(crate) fn luminance(picture: &Picture) -> f64 {
    let of = |c: &[f32; 3]| (0..3).map(|i| f64::from(c[i]) * LUMINANCE[i]).sum::<f64>();
    picture.rgb.iter().map(of).sum::<f64>() / picture.rgb.len() as f64
}

/// Largest difference of a component, in units of the mean luminance of `b`.
pub(crate) fn largest_difference(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.rgb.iter().flatten().zip(b.rgb.iter().flatten());
    let largest = pairs.map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max);
    largest / luminance(b)
}

/// Exponent p of error ~ n^p, the error being the root of the mean square: the slope of the
/// line through the logarithms that has the least squares.
pub(crate) fn slope(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<_> = points.iter().map(|(n, square)| (n.ln(), 0.5 * square.ln())).collect();
    let count = logs.len() as f64;
    let mean_x = logs.iter().map(|p| p.0).sum::<f64>() / count;
    let mean_y = logs.iter().map(|p| p.1).sum::<f64>() / count;
    let xy: f64 = logs.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    let xx: f64 = logs.iter().map(|p| (p.0 - mean_x).powi(2)).sum();
    xy / xx
}
