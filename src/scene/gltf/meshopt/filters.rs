//! Filters that follow mode ATTRIBUTES. All work in place; casts of floats to integers
//! saturate, and make 0 of what is no number, which only invalid elements lead to.

use std::f32::consts::FRAC_1_SQRT_2;

/// Unit vectors of four 8-bit components; the last is left as it is.
pub(super) fn octahedral_8(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        let [x, y, one, _] = element.map(|b| f32::from(b as i8));
        let unit = octahedral(x, y, one).map(|c| (c * 127.0).round() as i8 as u8);
        element[..3].copy_from_slice(&unit);
    }
}

/// As [`octahedral_8`], of 16-bit components.
pub(super) fn octahedral_16(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let [x, y, one, _] = shorts(element).map(|s| f32::from(s as i16));
        let unit = octahedral(x, y, one).map(|c| (c * 32767.0).round() as i16 as u16);
        let [_, _, _, last] = shorts(element);
        *element = from_shorts([unit[0], unit[1], unit[2], last]);
    }
}

fn octahedral(x: f32, y: f32, one: f32) -> [f32; 3] {
    let (x, y) = (x / one, y / one);
    let z = 1.0 - x.abs() - y.abs();
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

/// Quaternions without their largest component, four of 16 bits.
pub(super) fn quaternion(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let input = shorts(element).map(|s| s as i16);
        let one = f32::from(input[3] | 3);
        let [x, y, z] = [input[0], input[1], input[2]].map(|c| f32::from(c) / one * FRAC_1_SQRT_2);
        let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
        let largest = usize::from(input[3] as u16 & 3);
        let mut output = [0; 4];
        for (k, c) in [w, x, y, z].into_iter().enumerate() {
            output[(largest + k) % 4] = (c * 32767.0).round() as i16 as u16;
        }
        *element = from_shorts(output);
    }
}

/// Floats of an 8-bit exponent and a 24-bit integer.
pub(super) fn exponential(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        let value = i32::from_le_bytes(*element);
        let (exponent, mantissa) = (value >> 24, value << 8 >> 8);
        // Exact in double precision, and rounded once where f32 is subnormal.
        let float = (f64::from(exponent).exp2() * f64::from(mantissa)) as f32;
        *element = float.to_le_bytes();
    }
}

/// RGBA of 8 bits from luma, chrominances and alpha.
pub(super) fn color_8(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<4>().0 {
        let [y, co, cg, a] = *element;
        let signed = |b: u8| i32::from(b as i8);
        let rgba = color([i32::from(y), signed(co), signed(cg), i32::from(a)], 255.0);
        *element = rgba.map(|c| c as u8);
    }
}

/// RGBA of 16 bits.
pub(super) fn color_16(bytes: &mut [u8]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let [y, co, cg, a] = shorts(element);
        let signed = |s: u16| i32::from(s as i16);
        let rgba = color([i32::from(y), signed(co), signed(cg), i32::from(a)], 65535.0);
        *element = from_shorts(rgba.map(|c| c as u16));
    }
}

/// The highest bit of alpha says how many bits all components have.
fn color([y, co, cg, a]: [i32; 4], largest: f32) -> [f32; 4] {
    let scale = (1 << (32 - a.leading_zeros())) - 1;
    let alpha = a & (scale >> 1);
    let rgba = [y + co - cg, y + cg, y - co - cg, alpha << 1 | alpha & 1];
    rgba.map(|c| (c as f32 * (largest / scale as f32)).round())
}

fn shorts(bytes: &[u8; 8]) -> [u16; 4] {
    std::array::from_fn(|k| u16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]]))
}

fn from_shorts(shorts: [u16; 4]) -> [u8; 8] {
    std::array::from_fn(|k| shorts[k / 2].to_le_bytes()[k % 2])
}
