//! Layers of a picture file beside its light: what camera rays meet first, and how sure the light
//! is. Compositors and denoisers want them (docs/outputs.md has every channel with its unit).

mod cryptomatte;
mod motion;
mod of_film;
mod tracer;

pub use cryptomatte::{float_of_hash, murmur3};
pub use of_film::film_layers;
pub use tracer::LayerTracer;

/// A layer that can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LayerKind {
    /// `albedo.R/G/B`: base colour, linear Rec. 709.
    Albedo,
    /// `N.X/Y/Z`: shading normal, world space, on the viewer's side.
    ShadingNormal,
    /// `Ng.X/Y/Z`: geometric normal, likewise.
    GeometricNormal,
    /// `Z`: distance along the camera's axis, metres; infinite where nothing is hit.
    Depth,
    /// `P.X/Y/Z`: position, world space, metres.
    Position,
    /// `uv.U/V`: texture coordinates of set 0.
    Uv,
    /// `coverage.A`: share of the rays that hit anything.
    Coverage,
    /// `id.object`, `id.material`: indices of what the ray through the pixel's centre meets.
    Id,
    /// `CryptoObject00.r` and so on: what share of the pixel is which object, by its name.
    CryptoObject,
    /// `CryptoMaterial00.r` and so on: which material.
    CryptoMaterial,
    /// `motion.X/Y`: pixels to the right and down since an earlier time, of what the ray through
    /// the pixel's centre meets.
    Motion,
    /// `variance.Y`: variance of the mean luminance, by the render's own samples.
    Variance,
}

impl LayerKind {
    /// All of them.
    pub const ALL: [LayerKind; 12] = [
        LayerKind::Albedo,
        LayerKind::ShadingNormal,
        LayerKind::GeometricNormal,
        LayerKind::Depth,
        LayerKind::Position,
        LayerKind::Uv,
        LayerKind::Coverage,
        LayerKind::Id,
        LayerKind::CryptoObject,
        LayerKind::CryptoMaterial,
        LayerKind::Motion,
        LayerKind::Variance,
    ];

    /// Whether it comes from camera rays that are traced for it, and not from the film.
    pub fn is_traced(self) -> bool {
        self != LayerKind::Variance
    }
}
