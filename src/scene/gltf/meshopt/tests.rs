//! Streams made by the reference encoder (meshoptimizer) from the arrays here, and the
//! examples of the extension's text.

use super::*;

const VERSION_0: [u8; 135] = [
    160, 0, 0, 7, 0, 255, 255, 128, 128, 64, 64, 64, 64, 32, 32, 32, 32, 32, 32, 32, 255, 0, 0, 0,
    32, 16, 16, 16, 1, 56, 0, 128, 0, 126, 0, 0, 5, 51, 51, 204, 207, 255, 255, 255, 255, 255, 255,
    255, 255, 255, 51, 0, 0, 0, 255, 255, 5, 56, 7, 224, 31, 126, 125, 126, 125, 126, 128, 0, 0, 0,
    0, 0, 7, 0, 255, 255, 128, 128, 64, 64, 64, 64, 32, 32, 32, 32, 32, 32, 32, 255, 0, 0, 0, 32,
    16, 16, 16, 1, 56, 0, 128, 0, 124, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 128,
];
const VERSION_1: [u8; 95] = [
    161, 104, 106, 104, 1, 6, 0, 7, 15, 2, 15, 248, 244, 196, 242, 98, 226, 98, 240, 240, 24, 60,
    15, 0, 30, 1, 3, 1, 5, 61, 31, 244, 127, 127, 254, 254, 127, 127, 254, 254, 127, 127, 209, 0,
    0, 0, 254, 1, 2, 1, 7, 15, 2, 15, 248, 244, 196, 242, 98, 226, 98, 208, 48, 24, 252, 15, 0, 30,
    1, 3, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 128, 82, 18, 82,
];
const SHORTS: [u8; 94] = [
    161, 151, 155, 0, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88,
    5, 42, 170, 170, 170, 170, 0, 0, 0, 5, 21, 85, 85, 85, 85, 0, 0, 0, 0, 2, 6, 10, 14, 18, 22,
    26, 30, 34, 38, 42, 46, 50, 54, 58, 62, 66, 70, 74, 5, 38, 102, 102, 102, 102, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 0, 0, 0, 0, 1, 1,
];
const TRIANGLES: [u8; 33] = [
    225, 240, 16, 0, 4, 255, 7, 255, 16, 255, 18, 1, 1, 244, 186, 1, 99, 0, 118, 135, 86, 103, 120,
    169, 134, 101, 137, 104, 152, 1, 105, 0, 0,
];
const INDICES: [u8; 15] = [209, 0, 4, 4, 161, 31, 5, 4, 157, 236, 16, 0, 0, 0, 0];

fn view(mode: Mode, filter: Filter, count: u64, byte_stride: u64) -> CompressedView {
    CompressedView { buffer: 0, byte_offset: 0, byte_length: 0, byte_stride, count, mode, filter }
}

fn attributes(stream: &[u8], count: u64, stride: u64) -> Result<Vec<u8>, String> {
    view(Mode::Attributes, Filter::None, count, stride).decode(stream)
}

#[test]
fn vertices_of_both_versions() {
    let vertices = (0..20).flat_map(|i| [i as f32, (i * i % 7) as f32, -(i as f32) / 4.0]);
    let bytes: Vec<u8> = vertices.flat_map(f32::to_le_bytes).collect();
    assert_eq!(attributes(&VERSION_0, 20, 12).unwrap(), bytes);
    assert_eq!(attributes(&VERSION_1, 20, 12).unwrap(), bytes);
    let shorts = (0..20_u16).flat_map(|i| [i * 300, 65535 - i, i * i, i % 2]);
    let bytes: Vec<u8> = shorts.flat_map(u16::to_le_bytes).collect();
    assert_eq!(attributes(&SHORTS, 20, 8).unwrap(), bytes);
}

#[test]
fn the_deltas_of_the_specification() {
    // Four bytes to an element; the first has the example's group in four bits, the others none.
    let mut stream = vec![0xA0, 0b10];
    stream.extend([0x17, 0x5F, 0xF0, 0xBC, 0x77, 0xA9, 0x21, 0x00, 0x34, 0xB5]);
    stream.extend([0, 0, 0]);
    stream.resize(stream.len() + 32, 0);
    let decoded = attributes(&stream, 16, 4).unwrap();
    let deltas: [i32; 16] = [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0];
    let mut sum = 0;
    for (element, delta) in decoded.chunks(4).zip(deltas) {
        sum += delta;
        assert_eq!(element, [sum as u8, 0, 0, 0]);
    }
}

#[test]
fn triangles_and_sequences() {
    let words = |bytes: Vec<u8>| -> Vec<u32> {
        bytes.as_chunks::<4>().0.iter().map(|b| u32::from_le_bytes(*b)).collect()
    };
    let triangles = view(Mode::Triangles, Filter::None, 24, 4).decode(&TRIANGLES).unwrap();
    let expected = [0, 1, 2, 2, 1, 3, 2, 3, 4, 2, 4, 0, 9, 8, 7, 9, 7, 0, 100, 50, 4, 4, 50, 5];
    assert_eq!(words(triangles), expected);
    let indices = view(Mode::Indices, Filter::None, 7, 4).decode(&INDICES).unwrap();
    assert_eq!(words(indices), [0, 1, 2, 1000, 1001, 3, 70000]);
    // The upper half is cut off, as the specification says.
    let indices = view(Mode::Indices, Filter::None, 7, 2).decode(&INDICES).unwrap();
    assert_eq!(indices[12..], (70000_u32 as u16).to_le_bytes());
}

#[test]
fn filters_by_their_formulas() {
    let mut unit = [127_u8, 0, 127, 9, 0, 0, 127, 9, 0x81, 0, 127, 9];
    filters::octahedral_8(&mut unit);
    assert_eq!(unit, [127, 0, 0, 9, 0, 0, 127, 9, 0x81, 0, 0, 9]);
    // Ten bits; (-1, -1) is folded to -z.
    let mut folded = Vec::from([-511_i16, -511, 511, 3].map(i16::to_le_bytes).as_flattened());
    filters::octahedral_16(&mut folded);
    assert_eq!(folded, [0_i16, 0, -32767, 3].map(i16::to_le_bytes).as_flattened());
    // All but the third component 0: the largest is at place 2.
    let mut turn = Vec::from([0_i16, 0, 0, (511 & !3) | 2].map(i16::to_le_bytes).as_flattened());
    filters::quaternion(&mut turn);
    assert_eq!(turn, [0_i16, 0, 32767, 0].map(i16::to_le_bytes).as_flattened());
    let encoded = |e: i32, m: i32| e << 24 | m & 0xFF_FFFF;
    for (e, m, expected) in
        [(-3, 5, 0.625_f32), (2, -7, -28.0), (0, 0, 0.0), (-100, 1, 7.888609e-31)]
    {
        let mut bytes = encoded(e, m).to_le_bytes();
        filters::exponential(&mut bytes);
        assert_eq!(f32::from_le_bytes(bytes), expected);
    }
    // Eight bits: y 100, co 20, cg 10, alpha all of its seven bits.
    let mut color = [100, 20, 10, 255];
    filters::color_8(&mut color);
    assert_eq!(color, [110, 110, 70, 255]);
}

#[test]
fn broken_streams_are_errors() {
    for stream in [&VERSION_0[..], &VERSION_1[..]] {
        for length in 0..stream.len() {
            assert!(attributes(&stream[..length], 20, 12).is_err(), "{length}");
        }
    }
    for length in 0..TRIANGLES.len() {
        assert!(view(Mode::Triangles, Filter::None, 24, 4).decode(&TRIANGLES[..length]).is_err());
    }
    for length in 0..INDICES.len() {
        assert!(view(Mode::Indices, Filter::None, 7, 4).decode(&INDICES[..length]).is_err());
    }
    let longer = |stream: &[u8]| [&stream[..1], &[0], &stream[1..]].concat();
    assert!(attributes(&longer(&VERSION_0), 20, 12).is_err());
    // An edge before the first triangle.
    let mut stream = TRIANGLES;
    stream[1] = 0;
    let error = view(Mode::Triangles, Filter::None, 24, 4).decode(&stream).unwrap_err();
    assert!(error.contains("before its first"), "{error}");
}

#[test]
fn objects_that_the_specification_forbids() {
    let refused = |mode, filter, count, stride| {
        view(mode, filter, count, stride).decoded_length().unwrap_err()
    };
    assert!(refused(Mode::Attributes, Filter::None, 1, 6).contains("byteStride of 6"));
    assert!(refused(Mode::Attributes, Filter::None, 1, 260).contains("byteStride of 260"));
    assert!(refused(Mode::Triangles, Filter::None, 4, 2).contains("whole triangles"));
    assert!(refused(Mode::Indices, Filter::Color, 4, 4).contains("filter Color"));
    assert!(refused(Mode::Attributes, Filter::Quaternion, 4, 4).contains("filter Quaternion"));
    assert!(refused(Mode::Attributes, Filter::None, u64::MAX, 4).contains("too large"));
}
