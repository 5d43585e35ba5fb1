//! `shaders/float_environment.wgsl`: how the device computes with floats.

use crate::Result;
use crate::gpu::{Batch, Device};
use crate::shader::{Features, library};
use std::fmt;

/// 2^-23: the spacing of floats above 1.
const EPSILON: f32 = f32::EPSILON;

/// In the order of the shader.
const OPERANDS: [f32; 10] = [
    1.0 + EPSILON,
    1.0 - EPSILON,
    -1.0,
    1e10,
    1e-10,
    16_777_216.0,
    1.0,
    f32::MIN_POSITIVE,
    0.5,
    f32::NAN,
];

/// What a device's arithmetic does and does not do, as found by running it. Nothing that is
/// rendered relies on any of it; it tells apart devices whose pictures differ in the last bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FloatEnvironment {
    /// `fma` rounds once.
    pub has_fused_fma: bool,
    /// `a * b + c` rounds once.
    pub contracts: bool,
    /// Sums are reordered: compensated ones lose their compensation.
    pub reassociates: bool,
    /// Subnormal results become 0.
    pub flushes_subnormals: bool,
    /// `x != x` holds for NaN.
    pub compares_nan: bool,
}

impl FloatEnvironment {
    /// Asks the device, which takes some milliseconds.
    ///
    /// # Errors
    /// [`crate::Error::Shader`], [`crate::Error::DeviceLost`].
    pub fn of(device: &Device) -> Result<Self> {
        let batch = Batch {
            library: &library(),
            entry: "float_environment",
            features: Features::default(),
            scene: None,
            inputs: &[("operands", bytemuck::cast_slice(&OPERANDS))],
            output: ("results", 6 * size_of::<f32>()),
            workgroups: 1,
        };
        let results = bytemuck::pod_collect_to_vec(&batch.run(device)?);
        Ok(Self::from_results(&results))
    }

    fn from_results(results: &[f32]) -> Self {
        // (1 + e) (1 - e) - 1 = -e², which a product that is rounded first loses.
        let fused = -EPSILON * EPSILON;
        Self {
            has_fused_fma: results[0] == fused,
            contracts: results[1] == fused,
            reassociates: results[2] != OPERANDS[4] || results[3] != 100.0,
            flushes_subnormals: results[4] == 0.0,
            compares_nan: results[5] == 1.0,
        }
    }
}

impl fmt::Display for FloatEnvironment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "fused={} contracts={} reassociates={} flushes={} nan-compare={}",
            u8::from(self.has_fused_fma),
            u8::from(self.contracts),
            u8::from(self.reassociates),
            u8::from(self.flushes_subnormals),
            if self.compares_nan { "kept" } else { "folded" },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_property_is_told_from_its_result() {
        let plain = [0.0, 0.0, 1e-10, 100.0, f32::MIN_POSITIVE / 2.0, 1.0];
        let line = |results: [f32; 6]| FloatEnvironment::from_results(&results).to_string();
        assert_eq!(line(plain), "fused=0 contracts=0 reassociates=0 flushes=0 nan-compare=kept");
        let fused = -EPSILON * EPSILON;
        assert_eq!(OPERANDS[0].mul_add(OPERANDS[1], OPERANDS[2]), fused);
        assert_eq!(OPERANDS[0] * OPERANDS[1] + OPERANDS[2], 0.0);
        let other = [fused, fused, 0.0, 100.0, 0.0, 0.0];
        assert_eq!(line(other), "fused=1 contracts=1 reassociates=1 flushes=1 nan-compare=folded");
        assert!(line([0.0, 0.0, 1e-10, 0.0, 0.0, 1.0]).contains("reassociates=1"));
    }
}
