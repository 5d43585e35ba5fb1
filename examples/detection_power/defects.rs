//! The defects that are planted.

use crate::SIDE;
use crate::scene::SMOOTH_MESH;
use steradian::image::compare::{Noise, PictureFile};
use steradian::image::srgb_from_linear;
use steradian::passes::Tuning;
use steradian::scene::{Scene, Wrap};

/// A defect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Defect {
    Grazing,
    ScatteringLoss,
    EmissionLoss,
    LightDropped,
    NormalFlipped,
    Shift,
    GammaTwice,
    BlackPixels,
    TextureWrap,
}

impl Defect {
    pub(crate) const ALL: [Self; 9] = [
        Self::Grazing,
        Self::ScatteringLoss,
        Self::EmissionLoss,
        Self::LightDropped,
        Self::NormalFlipped,
        Self::Shift,
        Self::GammaTwice,
        Self::BlackPixels,
        Self::TextureWrap,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Grazing => "cosine missing below 0.1",
            Self::ScatteringLoss => "1 % lost by scattering",
            Self::EmissionLoss => "1 % of the emission lost",
            Self::LightDropped => "faint light dropped",
            Self::NormalFlipped => "normals of one triangle flipped",
            Self::Shift => "shifted by one pixel",
            Self::GammaTwice => "gamma twice",
            Self::BlackPixels => "0.1 % of the pixels black",
            Self::TextureWrap => "texture clamped, not repeated",
        }
    }

    /// It spoils finished pictures; the others need renders of their own.
    pub(crate) fn is_of_picture(self) -> bool {
        matches!(self, Self::Shift | Self::GammaTwice | Self::BlackPixels)
    }

    /// The scene with a defect in it.
    pub(crate) fn scene(self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        match self {
            Self::ScatteringLoss => {
                scene.materials.iter_mut().for_each(|material| material.base_color *= 0.99);
            }
            Self::EmissionLoss => {
                scene.materials.iter_mut().for_each(|material| material.emission *= 0.99);
                scene.lights.iter_mut().for_each(|light| light.intensity *= 0.99);
            }
            Self::LightDropped => scene.lights.clear(),
            // The triangle that faces camera and light.
            Self::NormalFlipped => {
                scene.meshes[SMOOTH_MESH].normals[..3].iter_mut().for_each(|n| *n = -*n);
            }
            Self::TextureWrap => {
                let texture = scene.materials[0].base_color_texture.as_mut();
                texture.expect("a textured floor").wrap = [Wrap::ClampToEdge; 2];
            }
            _ => {}
        }
        scene
    }

    /// The shaders with a defect in them.
    pub(crate) fn tuning(self) -> Tuning {
        let mut tuning = Tuning::default();
        if self == Self::Grazing {
            let text = tuning.library.get_mut("bsdf/bsdf").expect("the module");
            let from = "bsdf_below_coat(b, cos_h) * lambert_pdf(wi)";
            assert_eq!(text.matches(from).count(), 1, "bsdf/bsdf has changed");
            let to = "bsdf_below_coat(b, cos_h) * select(lambert_pdf(wi), INV_PI, wi.z < 0.1)";
            *text = text.replace(from, to).into();
        }
        tuning
    }

    /// Spoils a finished picture. `seed` chooses black pixels.
    pub(crate) fn spoil(self, file: &mut PictureFile, seed: u32) {
        let side = SIDE as usize;
        let shifted = |i: usize| if i.is_multiple_of(side) { i } else { i - 1 };
        let black = ((f64::from(SIDE * SIDE) * 0.001).round() as u32).max(1);
        let is_black = |i: usize| {
            (0..black).any(|k| {
                let hash = (seed * 7919 + k).wrapping_mul(2_654_435_769) >> 12;
                i as u32 == hash % (SIDE * SIDE)
            })
        };
        for (_, values) in &mut file.layers[0].channels {
            let old = values.clone();
            for (i, value) in values.iter_mut().enumerate() {
                *value = match self {
                    Self::Shift => old[shifted(i)],
                    Self::GammaTwice => srgb_from_linear(old[i]),
                    Self::BlackPixels if is_black(i) => 0.0,
                    _ => old[i],
                };
            }
        }
        if let Some(Noise::Pieces { variance, .. }) = &mut file.noise {
            let old = variance.clone();
            for (i, value) in variance.iter_mut().enumerate() {
                *value = match self {
                    Self::Shift => old[shifted(i)],
                    Self::BlackPixels if is_black(i) => 0.0,
                    _ => old[i],
                };
            }
        }
    }
}
