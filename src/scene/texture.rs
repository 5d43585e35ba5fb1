//! Decoded images and how materials look them up.

use glam::Affine2;

/// Pixels as read from a file, row by row from the top.
#[derive(Debug, Clone)]
pub struct Image {
    /// Name or URI in the file, for messages.
    pub name: String,
    /// Width in texels, at least 1.
    pub width: u32,
    /// Height in texels, at least 1.
    pub height: u32,
    /// RGBA, 8 bits each, as encoded in the file.
    pub rgba: Vec<[u8; 4]>,
}

/// A material slot's use of an image. Filtering is bilinear between texel
/// centres unless `nearest`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureRef {
    /// Index into [`super::Scene::images`].
    pub image: u32,
    /// How the colour channels are encoded.
    pub color_space: ColorSpace,
    /// Which of [`super::Mesh::uvs`], 0 or 1.
    pub uv_set: u32,
    /// KHR_texture_transform: texture coordinates from the mesh's.
    pub transform: Affine2,
    /// Wrap modes along u and v.
    pub wrap: [Wrap; 2],
    /// Magnification filter NEAREST.
    pub nearest: bool,
}

/// Encoding of an image's colour channels; alpha is always linear.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorSpace {
    /// IEC 61966-2-1.
    Srgb,
    /// Values as they are.
    Linear,
}

/// What lies outside [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wrap {
    /// The image repeats.
    Repeat,
    /// The image repeats, every other time mirrored.
    MirroredRepeat,
    /// The border texel goes on.
    ClampToEdge,
}
