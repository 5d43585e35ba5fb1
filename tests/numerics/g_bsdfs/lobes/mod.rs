//! The lobes of the extensions, alone and together, as materials have them.

mod energy;
mod limits;
mod list;
mod samples;

use crate::common::{Call, Random, Stage, harness, settings};
use glam::Vec3;
use steradian::RenderSettings;
use steradian::scene::{Material, Scene};

/// A material seen from somewhere: `Input` of `materials.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Input {
    wo: Vec3,
    material: f32,
    wi: Vec3,
    is_front: f32,
    u: Vec3,
    around: f32,
    normal: Vec3,
    padding: f32,
}

/// What became of it: `Output` of `materials.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Output {
    wi: Vec3,
    pdf: f32,
    weight: Vec3,
    eta_scale: f32,
    other_value: Vec3,
    other_pdf: f32,
    choice: f32,
    /// 1: has a density; 2: reaches below.
    bits: f32,
    eta: f32,
    padding: f32,
}

impl Input {
    /// Material number `material` from its front or its back, at the cosine `cos_o`.
    fn new(material: usize, is_front: bool, cos_o: f32) -> Self {
        let sin = (1.0 - f64::from(cos_o).powi(2)).max(0.0).sqrt() as f32;
        // Off the axes: a stretched lobe has no symmetry there.
        let wo = Vec3::new(sin * 0.8, sin * 0.6, cos_o);
        Self {
            wo,
            material: material as f32,
            wi: Vec3::Z,
            is_front: f32::from(u8::from(is_front)),
            u: Vec3::ZERO,
            around: 1.0,
            normal: Vec3::Z,
            padding: 0.0,
        }
    }

    /// So many copies with random numbers.
    fn sampled(self, count: usize, random: &mut Random) -> Vec<Self> {
        let one = |_| Self { u: Vec3::new(random.unit(), random.unit(), random.unit()), ..self };
        (0..count).map(one).collect()
    }
}

impl Output {
    fn is_delta(&self) -> bool {
        self.pdf < 0.0
    }

    /// Weight as a share of flux: without the factor by which refraction scales radiance.
    fn share(&self) -> Vec3 {
        self.weight / self.eta_scale
    }
}

/// A scene whose materials are these, each in use.
fn scene_of(materials: &[Material]) -> Scene {
    let mut stage = Stage::perspective(Vec3::Z * 3.0, Vec3::ZERO, 0.6);
    for (k, m) in materials.iter().enumerate() {
        stage.sphere(Vec3::X * k as f32, 0.1, m.clone());
    }
    assert_eq!(stage.scene.materials.len(), materials.len());
    stage.scene
}

/// Calls the device for a scene's materials.
fn run(scene: &Scene, settings: &RenderSettings, inputs: &[Input]) -> Vec<Output> {
    Call::new(harness!("materials"), &[]).on(scene, settings).run(inputs, 1)
}

fn plain() -> RenderSettings {
    settings(8, 8, 1)
}
