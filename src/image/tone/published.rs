//! The curves beside the numbers of others, which `tools/check_tone.py` prints.

#![allow(
    clippy::excessive_precision,
    clippy::approx_constant,
    reason = "numbers as they are published"
)]

use super::ToneCurve;

type Table = [[f32; 3]; 8];

/// Places of Khronos's table pbrNeutral.cube (KhronosGroup/ToneMapping).
const NEUTRAL_COLOURS: Table = [
    [0.1703328, 0.1703328, 0.1703328],
    [0.8835775, 0.8835775, 0.8835775],
    [2.2635253, 0.0205155, 0.0063300],
    [0.5520448, 0.6984084, 0.2154932],
    [7.3360323, 1.4142136, 0.3449085],
    [1024.0000000, 23.7759086, 0.0019531],
    [0.0128177, 0.3449085, 1.1178404],
    [1.1178404, 0.8835775, 0.6984084],
];
/// Its entries, of seven decimals.
const NEUTRAL: Table = [
    [0.1303328, 0.1303328, 0.1303328],
    [0.8219901, 0.8219901, 0.8219901],
    [0.9668479, 0.1619942, 0.1569040],
    [0.5120448, 0.6584084, 0.1754932],
    [0.9914995, 0.5778910, 0.5032055],
    [0.9999437, 0.9936198, 0.9934695],
    [0.0276281, 0.2903160, 0.9017148],
    [0.8967447, 0.7069963, 0.5570130],
];
/// For the other two.
const COLOURS: Table = [
    [0.1800000, 0.1800000, 0.1800000],
    [1.0000000, 1.0000000, 1.0000000],
    [0.0200000, 0.5000000, 0.9000000],
    [4.0000000, 0.2500000, 0.0500000],
    [0.0000000, 0.0000000, 2.0000000],
    [0.0500000, 0.1000000, 0.0200000],
    [30.0000000, 20.0000000, 10.0000000],
    [0.7000000, 0.0500000, 0.3000000],
];
/// Blender 5.0's view "AgX" for sRGB, linear, by OpenColorIO 2.6: tables of AgX itself.
const AGX: Table = [
    [0.1799700, 0.1799684, 0.1799987],
    [0.5557683, 0.5557668, 0.5558026],
    [0.1419120, 0.4006875, 0.5589127],
    [0.9791199, 0.3791796, 0.2908249],
    [0.0898836, 0.1942412, 0.8117763],
    [0.0456910, 0.0845947, 0.0129401],
    [1.0000396, 0.9981657, 0.9593869],
    [0.5386794, 0.1056983, 0.2773492],
];
/// "ACES 1.0 - SDR Video" of OpenColorIO's built-in config for sRGB, linear: the whole reference
/// and output transforms.
const ACES: Table = [
    [0.1040623, 0.1040625, 0.1040624],
    [0.6243235, 0.6243238, 0.6243237],
    [0.0093734, 0.3737010, 0.5850430],
    [1.0822973, 0.3694579, 0.0796354],
    [0.0017192, -0.0018189, 0.8577629],
    [0.0147717, 0.0423577, 0.0042295],
    [1.0191111, 1.0068916, 0.9856837],
    [0.4990403, 0.0133930, 0.2034427],
];

/// Largest difference for greys, the first two rows, and for all.
fn differences(curve: ToneCurve, scale: f32, colours: &Table, published: &Table) -> [f32; 2] {
    let of_row = |(colour, expected): (&[f32; 3], &[f32; 3])| {
        let mapped = curve.map(colour.map(|v| v * scale)).into_iter();
        let expected = expected.map(|v| v.clamp(0.0, 1.0)).into_iter();
        mapped.zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    let rows: Vec<f32> = colours.iter().zip(published).map(of_row).collect();
    [&rows[..2], &rows[..]].map(|rows| rows.iter().copied().fold(0.0, f32::max))
}

/// To half of the seventh decimal, of colours with seven, and the rounding of f32.
#[test]
fn neutral_has_the_entries_of_khronos() {
    let [_, all] = differences(ToneCurve::Neutral, 1.0, &NEUTRAL_COLOURS, &NEUTRAL);
    assert!(all < 3e-7, "{all}");
}

/// What three.js and Filament call AgX decodes with an exponent of 2.2 where AgX has 2.4, and fits the
/// sigmoid by a polynomial: a grey of 0.18 becomes 0.2145, in Blender 0.18. These are the
/// measured differences, rounded up.
#[test]
fn agx_is_this_far_from_blenders() {
    let [greys, all] = differences(ToneCurve::Agx, 1.0, &COLOURS, &AGX);
    assert!(greys < 0.035 && all < 0.1, "{greys} {all}");
    // A matrix or a constant that is wrong is farther off than another curve.
    let [_, of_aces] = differences(ToneCurve::Aces, 1.0, &COLOURS, &AGX);
    assert!(of_aces > 0.15, "{of_aces}");
}

/// Without the exposure that our curve has before it: how well S. Hill's fit fits, measured and
/// rounded up.
#[test]
fn aces_is_this_far_from_the_academys() {
    let [greys, all] = differences(ToneCurve::Aces, 0.6, &COLOURS, &ACES);
    assert!(greys < 0.006 && all < 0.036, "{greys} {all}");
}
