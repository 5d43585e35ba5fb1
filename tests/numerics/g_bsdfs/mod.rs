//! BSDFs.

mod albedo;
mod definition;
mod frames;
mod fresnel;
mod ggx;
mod glass;
mod limits;
mod lobes;
mod samples;

use crate::common::{Call, Random, harness};
use glam::{Vec3, Vec4};
use steradian::shader::Feature;

/// A BSDF and what to do with it: `Input` of `bsdf.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Input {
    wo: Vec3,
    alpha: f32,
    wi: Vec3,
    eta: f32,
    diffuse: Vec3,
    diffuse_f0: f32,
    specular_f0: Vec3,
    specular_f90: f32,
    transmitted: Vec3,
    diffuse_f90: f32,
    u: Vec4,
}

/// What became of it: `Output` of `bsdf.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Output {
    wi: Vec3,
    pdf: f32,
    weight: Vec3,
    eta_scale: f32,
    other_value: Vec3,
    other_pdf: f32,
}

impl Input {
    /// A black surface seen at the cosine `cos_o`.
    fn black(cos_o: f32) -> Self {
        let sin = (1.0 - f64::from(cos_o).powi(2)).sqrt() as f32;
        let wo = Vec3::new(sin, 0.0, cos_o);
        Self { wo, wi: Vec3::Z, eta: 1.0, ..bytemuck::Zeroable::zeroed() }
    }

    /// A metal that reflects all light.
    fn white_metal(alpha: f32, cos_o: f32) -> Self {
        Self { alpha, specular_f0: Vec3::ONE, specular_f90: 1.0, ..Self::black(cos_o) }
    }

    /// Half metal, half lacquer of index 1.5 over a coloured Lambert base.
    fn mixed(alpha: f32, cos_o: f32) -> Self {
        Self {
            alpha,
            diffuse: Vec3::new(0.45, 0.25, 0.05),
            diffuse_f0: 0.04,
            diffuse_f90: 1.0,
            specular_f0: Vec3::new(0.47, 0.27, 0.07),
            specular_f90: 1.0,
            ..Self::black(cos_o)
        }
    }

    /// Clear, colourless, smooth. `eta`: index on wo's side over the other.
    fn glass(eta: f32, cos_o: f32) -> Self {
        Self { eta, transmitted: Vec3::ONE, ..Self::black(cos_o) }
    }

    /// So many copies with random u.
    fn sampled(self, count: usize, random: &mut Random) -> Vec<Self> {
        let one = |_| Self { u: Vec4::new(random.unit(), random.unit(), 0.0, 0.0), ..self };
        (0..count).map(one).collect()
    }
}

fn run(inputs: &[Input]) -> Vec<Output> {
    let features = [Feature::Ggx, Feature::Delta, Feature::Transmission, Feature::SplitFresnel];
    Call::new(harness!("bsdf"), &features).run(inputs, 1)
}

/// A unit vector, uniform over the upper hemisphere.
fn upward(random: &mut Random) -> Vec3 {
    let v = random.direction();
    if v.z >= 0.0 { v } else { -v }
}
