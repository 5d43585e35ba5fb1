//! Tone curves: from linear radiance to what a display can show.

use glam::{Mat3, Vec3};

/// Radiance above this is white under every curve; squares of it are still finite.
const LARGEST: f32 = 1e15;

/// How exposed radiance becomes linear display colour, both Rec. 709.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ToneCurve {
    /// Clips at 1.
    #[default]
    None,
    /// Khronos PBR Neutral: base colours stay what they are, highlights are compressed.
    Neutral,
    /// AgX, base look: Sobotka's, with the Rec. 2020 matrices of Blender 4, as in three.js and
    /// Filament. A grey of 0.18 becomes 0.2145, in Blender itself 0.18: those decode with 2.2 what was
    /// encoded for 2.4.
    Agx,
    /// ACES: S. Hill's fit of the reference and output transforms, with the exposure of 1/0.6
    /// that three.js and the Khronos sample viewer's "exposure boost" put before it.
    Aces,
}

impl ToneCurve {
    /// All of them.
    pub const ALL: [ToneCurve; 4] =
        [ToneCurve::None, ToneCurve::Neutral, ToneCurve::Agx, ToneCurve::Aces];

    /// `rgb`: linear, already exposed; what is negative counts as 0. Linear too, each in
    /// [0, 1]; NaN where a component is NaN.
    pub fn map(self, rgb: [f32; 3]) -> [f32; 3] {
        if rgb.iter().any(|v| v.is_nan()) {
            return [f32::NAN; 3];
        }
        let rgb = Vec3::from(rgb).clamp(Vec3::ZERO, Vec3::splat(LARGEST));
        let mapped = match self {
            ToneCurve::None => rgb,
            ToneCurve::Neutral => neutral(rgb),
            ToneCurve::Agx => agx(rgb),
            ToneCurve::Aces => aces(rgb),
        };
        mapped.clamp(Vec3::ZERO, Vec3::ONE).to_array()
    }
}

/// Khronos PBR Neutral Specification (KhronosGroup/ToneMapping, PBR_Neutral/README.md).
fn neutral(rgb: Vec3) -> Vec3 {
    const F90: f32 = 0.04;
    const START: f32 = 0.8 - F90;
    const DESATURATION: f32 = 0.15;
    let x = rgb.min_element();
    let offset = if x <= 2.0 * F90 { x - x * x / (4.0 * F90) } else { F90 };
    let rgb = rgb - offset;
    let peak = rgb.max_element();
    if peak <= START {
        return rgb;
    }
    let new_peak = 1.0 - (1.0 - START).powi(2) / (peak + 1.0 - 2.0 * START);
    let saturation = 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    rgb * (new_peak / peak * saturation) + new_peak * (1.0 - saturation)
}

/// Rec. 2020 from Rec. 709, from their primaries and D65; rows.
const REC_2020_FROM_709: [[f32; 3]; 3] = [
    [0.627_403_9, 0.329_283_04, 0.043_313_07],
    [0.069_097_29, 0.919_540_4, 0.011_362_32],
    [0.016_391_44, 0.088_013_31, 0.895_595_25],
];

/// The inverse.
const REC_709_FROM_2020: [[f32; 3]; 3] = [
    [1.660_491, -0.587_641_1, -0.072_849_86],
    [-0.124_550_47, 1.132_899_9, -0.008_349_42],
    [-0.018_150_76, -0.100_578_9, 1.118_729_7],
];

/// Pulls colours towards grey, so that bright ones lose their saturation: AgX_LUT_Gen,
/// AgXBaseRec2020.py; rows.
const AGX_INSET: [[f32; 3]; 3] = [
    [0.856_627_15, 0.095_121_24, 0.048_251_607],
    [0.137_318_97, 0.761_242, 0.101_439_04],
    [0.111_898_21, 0.076_799_42, 0.811_302_37],
];

/// Gives part of it back: the inverse of the outset's matrix there.
const AGX_OUTSET: [[f32; 3]; 3] = [
    [1.127_100_6, -0.110_606_64, -0.016_493_938],
    [-0.141_329_76, 1.157_823_7, -0.016_493_938],
    [-0.141_329_76, -0.110_606_64, 1.251_936_4],
];

/// Range of the logarithm, stops: from -10 to 6.5 around a grey of 0.18.
const AGX_STOPS: [f32; 2] = [-12.473_93, 4.026_069];

/// B. Wrensch's fit of AgX's sigmoid, from the constant term on (Minimal AgX Implementation, 2023).
const AGX_SIGMOID: [f32; 7] = [-0.002_32, 0.119_1, 0.429_8, -6.868, 31.96, -40.14, 15.5];

fn agx(rgb: Vec3) -> Vec3 {
    let inset = rows(AGX_INSET) * (rows(REC_2020_FROM_709) * rgb);
    let [low, high] = AGX_STOPS;
    let formed = inset.to_array().map(|v| {
        let x = ((v.max(1e-10).log2() - low) / (high - low)).clamp(0.0, 1.0);
        AGX_SIGMOID.iter().rev().fold(0.0, |sum, c| sum * x + c)
    });
    let encoded = rows(AGX_OUTSET) * Vec3::from(formed);
    rows(REC_709_FROM_2020) * encoded.max(Vec3::ZERO).powf(2.2)
}

/// To the ACES reference primaries with the desaturation of the reference transform; rows.
const ACES_INPUT: [[f32; 3]; 3] =
    [[0.597_19, 0.354_58, 0.048_23], [0.076, 0.908_34, 0.015_66], [0.028_4, 0.133_83, 0.837_77]];

/// Back, with that of the output transform; rows.
const ACES_OUTPUT: [[f32; 3]; 3] = [
    [1.604_75, -0.531_08, -0.073_67],
    [-0.102_08, 1.108_13, -0.006_05],
    [-0.003_27, -0.072_76, 1.076_02],
];

/// S. Hill's fit, published in M. Pettineo's and D. Neubelt's Baking Lab, ACES.hlsl.
fn aces(rgb: Vec3) -> Vec3 {
    let v = rows(ACES_INPUT) * (rgb / 0.6);
    let a = v * (v + 0.024_578_6) - 0.000_090_537;
    let b = v * (0.983_729 * v + 0.432_951) + 0.238_081;
    rows(ACES_OUTPUT) * (a / b)
}

fn rows(rows: [[f32; 3]; 3]) -> Mat3 {
    Mat3::from_cols_array_2d(&rows).transpose()
}

#[cfg(test)]
mod published;

#[cfg(test)]
mod tests {
    use super::*;

    const COLOURS: [[f32; 3]; 8] = [
        [0.18, 0.18, 0.18],
        [1.0, 1.0, 1.0],
        [0.02, 0.5, 0.9],
        [4.0, 0.25, 0.05],
        [0.0, 0.0, 2.0],
        [0.001, 0.002, 0.000_5],
        [30.0, 20.0, 10.0],
        [0.7, 0.05, 0.3],
    ];

    // The published formulas in f64 by NumPy; for AgX with both Rec. 2020 matrices computed
    // from the primaries, and the outset inverted there.
    const NEUTRAL: [[f64; 3]; 8] = [
        [0.140000000, 0.140000000, 0.140000000],
        [0.869090909, 0.869090909, 0.869090909],
        [0.007558612, 0.462219432, 0.841103448],
        [0.983283149, 0.340855429, 0.306592618],
        [0.129579421, 0.129579421, 0.961081081],
        [0.000501563, 0.001501563, 0.000001563],
        [0.998043478, 0.935710575, 0.873377672],
        [0.665625000, 0.015625000, 0.265625000],
    ];
    const AGX: [[f64; 3]; 8] = [
        [0.214519092, 0.214519092, 0.214519092],
        [0.590159251, 0.590159251, 0.590159251],
        [0.162992548, 0.448658281, 0.593292716],
        [1.000000000, 0.457435537, 0.315229476],
        [0.107368806, 0.246064482, 0.910546555],
        [0.000106559, 0.000272762, 0.000033670],
        [0.998704665, 0.997334017, 0.973383346],
        [0.558216262, 0.150065075, 0.317862875],
    ];
    /// With the four digits of three.js's Rec. 2020 matrices.
    const AGX_OF_THREE_JS: [[f64; 3]; 8] = [
        [0.214548629, 0.214502356, 0.214499165],
        [0.590229442, 0.590136120, 0.590102344],
        [0.163050749, 0.448636863, 0.593258617],
        [1.000000000, 0.457412165, 0.315185430],
        [0.107427108, 0.245994556, 0.910548419],
        [0.000106594, 0.000272730, 0.000033655],
        [0.998803364, 0.997332977, 0.973283709],
        [0.558248327, 0.150042790, 0.317837226],
    ];
    const ACES: [[f64; 3]; 8] = [
        [0.213105446, 0.213105446, 0.213103315],
        [0.763397442, 0.763397442, 0.763389808],
        [0.125902151, 0.559859473, 0.727642678],
        [1.000000000, 0.546975955, 0.198420880],
        [0.071654693, 0.002159571, 0.926944265],
        [0.000000000, 0.000002539, 0.000000000],
        [1.000000000, 1.000000000, 0.994409261],
        [0.757297761, 0.054309848, 0.365134110],
    ];

    fn largest_difference(curve: ToneCurve, expected: &[[f64; 3]; 8]) -> f64 {
        let mapped = COLOURS.iter().flat_map(|c| curve.map(*c));
        let differences = mapped.zip(expected.iter().flatten()).map(|(a, b)| f64::from(a) - b);
        differences.map(f64::abs).fold(0.0, f64::max)
    }

    /// Sums of terms up to 40 in f32 leave 40 × 2⁻²⁴ = 2.4e-6 before the exponent of 2.2.
    #[test]
    fn curves_equal_their_published_formulas() {
        assert!(largest_difference(ToneCurve::Neutral, &NEUTRAL) < 1e-6);
        assert!(largest_difference(ToneCurve::Aces, &ACES) < 1e-6);
        assert!(largest_difference(ToneCurve::Agx, &AGX) < 1e-5);
        assert!(largest_difference(ToneCurve::Agx, &AGX_OF_THREE_JS) < 1.2e-4);
    }

    #[test]
    fn greys_stay_grey_and_grow_from_black() {
        for curve in ToneCurve::ALL {
            assert_eq!(curve.map([0.0; 3]), [0.0; 3], "{curve:?}");
            assert_eq!(curve.map([-1.0; 3]), [0.0; 3], "{curve:?}");
            let mut last = 0.0;
            for step in -20 * 64..20 * 64 {
                let [r, g, b] = curve.map([(step as f32 / 64.0).exp2(); 3]);
                let mean = (r + g + b) / 3.0;
                // Hill's matrices have five digits: their greys are off by 1e-5.
                let spread = (r - mean).abs().max((g - mean).abs()).max((b - mean).abs());
                assert!(spread < 1.1e-5, "{curve:?} {step}: {r} {g} {b}");
                // Near white a step is less than a rounding.
                assert!(mean >= last - 2.0 * f32::EPSILON, "{curve:?} falls at {step}");
                last = mean;
            }
            assert!(last > 0.99, "{curve:?}: white is {last}");
        }
    }

    #[test]
    fn every_number_has_a_colour_and_nan_has_none() {
        let values =
            [0.0, -0.0, -1e30, f32::MIN_POSITIVE, 1e-45, 0.5, 1.0, 1e8, 1e30, f32::MAX, f32::MIN];
        for curve in ToneCurve::ALL {
            for r in values {
                for g in values {
                    for b in values {
                        let mapped = curve.map([r, g, b]);
                        let is_colour = mapped.iter().all(|v| (0.0..=1.0).contains(v));
                        assert!(is_colour, "{curve:?} {r} {g} {b}: {mapped:?}");
                    }
                }
            }
            assert_eq!(curve.map([f32::INFINITY; 3]), curve.map([f32::MAX; 3]), "{curve:?}");
            assert!(curve.map([0.5, f32::NAN, 0.5]).iter().all(|v| v.is_nan()), "{curve:?}");
        }
    }
}
