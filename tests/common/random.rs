//! Random numbers of the tests.

/// Random numbers: SplitMix64 (Steele, Lea and Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1), a multiple of 2^-24.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / 16_777_216.0
    }

    /// Uniform in the cube from -1 to 1.
    pub(crate) fn in_cube(&mut self) -> glam::Vec3 {
        glam::Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    /// A unit vector, uniform.
    pub(crate) fn direction(&mut self) -> glam::Vec3 {
        loop {
            let v = self.in_cube().as_dvec3();
            let l = v.length();
            if l > 1e-3 && l <= 1.0 {
                return (v / l).as_vec3();
            }
        }
    }
}
