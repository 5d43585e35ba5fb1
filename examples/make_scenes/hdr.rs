//! Radiance .hdr files: shared-exponent pixels, run-length coded.

use std::io;
use std::path::Path;

/// Writes `pixels`, row by row from the top, and returns the file's size in bytes.
pub(crate) fn write(path: &Path, width: usize, pixels: &[[f64; 3]]) -> io::Result<u64> {
    let height = pixels.len() / width;
    let mut bytes =
        format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    for row in pixels.chunks(width) {
        let coded: Vec<[u8; 4]> = row.iter().map(|&pixel| rgbe(pixel)).collect();
        bytes.extend([2, 2, (width >> 8) as u8, width as u8]);
        for channel in 0..4 {
            let plane: Vec<u8> = coded.iter().map(|pixel| pixel[channel]).collect();
            run_lengths(&plane, &mut bytes);
        }
    }
    std::fs::write(path, &bytes)?;
    Ok(bytes.len() as u64)
}

/// Mantissas of the three channels and their exponent, biased by 128, so that the
/// value is mantissa × 2^(exponent - 136).
fn rgbe(pixel: [f64; 3]) -> [u8; 4] {
    let largest = pixel.iter().fold(0.0_f64, |a, &b| a.max(b));
    if largest < 1e-32 {
        return [0; 4];
    }
    let exponent = largest.log2().floor() as i32 + 1;
    let scale = 256.0 / 2_f64.powi(exponent);
    let [r, g, b] = pixel.map(|x| (x * scale).round().min(255.0) as u8);
    [r, g, b, (exponent + 128) as u8]
}

/// The format's "new" coding: a byte above 128 repeats the next byte so many times
/// less 128; one up to 128 announces so many bytes as they are.
fn run_lengths(plane: &[u8], out: &mut Vec<u8>) {
    const WORTH_A_RUN: usize = 4;
    let run_at =
        |start: usize| plane[start..].iter().take(127).take_while(|&&b| b == plane[start]).count();
    let mut start = 0;
    while start < plane.len() {
        let run = run_at(start);
        if run >= WORTH_A_RUN {
            out.extend([128 + run as u8, plane[start]]);
            start += run;
            continue;
        }
        let mut end = start;
        while end < plane.len() && end - start < 128 && run_at(end) < WORTH_A_RUN {
            end += 1;
        }
        out.push((end - start) as u8);
        out.extend_from_slice(&plane[start..end]);
        start = end;
    }
}
