//! The sRGB transfer function, IEC 61966-2-1.

/// Encodes a linear value for display; [0, 1] maps onto [0, 1]. The argument is
/// not clipped: values below 0 follow the linear part, values above 1 the curve.
pub fn srgb_from_linear(linear: f32) -> f32 {
    // In f64, so that quantised results do not depend on the rounding of `powf`.
    let linear = f64::from(linear);
    let encoded =
        if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    encoded as f32
}

/// The inverse of [`srgb_from_linear`].
pub fn linear_from_srgb(encoded: f32) -> f32 {
    let encoded = f64::from(encoded);
    let linear =
        if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) };
    linear as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spots_have_their_closed_form() {
        assert_eq!(srgb_from_linear(0.0), 0.0);
        assert_eq!(srgb_from_linear(1.0), 1.0);
        assert_eq!(srgb_from_linear(1.0 / 1024.0), 12.92 / 1024.0);
        // 1.055 × (1/32)^(1/2.4) - 0.055 with (1/32)^(1/2.4) = 2^(-25/12).
        let expected = 1.055 / 2f64.powf(25.0 / 12.0) - 0.055;
        assert_eq!(srgb_from_linear(1.0 / 32.0), expected as f32);
        // ((0.5 + 0.055) / 1.055)^2.4, evaluated with 30 digits.
        assert_eq!(linear_from_srgb(0.5), 0.214_041_14);
    }

    #[test]
    fn the_two_parts_meet_within_the_standards_own_gap() {
        // The standard's rounded constants leave a step of 3e-8 in linear value.
        let (below, above) = (srgb_from_linear(0.003_130_8), srgb_from_linear(0.003_131));
        assert!(below < above && above - below < 4e-6, "{below} {above}");
    }

    #[test]
    fn every_16_bit_code_survives_the_round_trip() {
        for code in 0..=u16::MAX {
            let encoded = f32::from(code) / 65535.0;
            let back = srgb_from_linear(linear_from_srgb(encoded));
            assert_eq!((back * 65535.0).round(), f32::from(code));
        }
    }
}
