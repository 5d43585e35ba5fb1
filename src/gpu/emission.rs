//! How much of its texture's light each part of an emissive triangle has: what its samples are
//! distributed by. Estimates: floors see to it that what they miss is only noisier.

use crate::image::linear_from_srgb;
use crate::scene::{ColorSpace, Image, TextureRef, Wrap};
use glam::{Vec2, Vec3};

/// Cells along a side of a divided triangle, at most.
const MAX_SIDE: u32 = 16;
/// Cells of all divided triangles of a scene, at most.
const MAX_CELLS: usize = 1 << 16;
/// A triangle is divided where the mean square of its cells' means exceeds the square of
/// their mean by this factor: that of the variance which dividing removes.
const LEAST_GAIN: f64 = 1.7;
/// Lookups in a cell, at most.
const MAX_LOOKUPS: f64 = 4096.0;
/// Share of a triangle's probability that its cells have alike.
const UNIFORM_SHARE: f64 = 0.1;
/// Least mean of a triangle, relative to its image's.
const LEAST_MEAN: f64 = 0.01;

/// What red, green and blue of the texture add to the luminance of an emission of this factor.
pub(super) fn luminance_weights(emission: Vec3) -> [f32; 3] {
    (emission * Vec3::new(0.2126, 0.7152, 0.0722)).to_array()
}

/// The emission texture of a mesh.
pub(super) struct EmissionTexture<'a> {
    texture: TextureRef,
    image: &'a Image,
    /// Linear luminance of each texel, as the emission's colour weighs it.
    luminance: Vec<f32>,
    /// Of the whole image.
    pub(super) mean: f64,
    max_side: u32,
}

impl<'a> EmissionTexture<'a> {
    /// `weights` of red, green and blue in the luminance; `triangles` that share the limit of cells.
    pub(super) fn new(
        texture: TextureRef,
        images: &'a [Image],
        weights: [f32; 3],
        triangles: usize,
    ) -> Self {
        let image = &images[texture.image as usize];
        let decode = |c: u8| match texture.color_space {
            ColorSpace::Srgb => linear_from_srgb(f32::from(c) / 255.0),
            ColorSpace::Linear => f32::from(c) / 255.0,
        };
        let decoded: Vec<f32> = (0..=255).map(decode).collect();
        let luminance: Vec<f32> = (image.rgba.iter())
            .map(|c| (0..3).map(|k| weights[k] * decoded[usize::from(c[k])]).sum())
            .collect();
        let sum: f64 = luminance.iter().map(|&l| f64::from(l)).sum();
        let mean = sum / luminance.len() as f64;
        let side = ((MAX_CELLS / triangles.max(1)) as f64).sqrt() as u32;
        Self { texture, image, luminance, mean, max_side: side.min(MAX_SIDE) }
    }

    /// Cells along a side, and of each cell the mean luminance of the emission's factor times the
    /// texture. `uvs` are the triangle's corners', as the mesh has them.
    pub(super) fn cells(&self, uvs: [Vec2; 3]) -> (u32, Vec<f64>) {
        let size = Vec2::new(self.image.width as f32, self.image.height as f32);
        let corners = uvs.map(|uv| self.texture.transform.transform_point2(uv) * size);
        let [a, b, c] = corners;
        let texels = 0.5 * f64::from((b - a).perp_dot(c - a).abs());
        let floor = LEAST_MEAN * self.mean;
        // A broken coordinate makes no number, and a part of a texel nothing to divide.
        let side = match texels >= 4.0 {
            true => (texels.sqrt() as u32).min(self.max_side),
            false => 1,
        };
        let means = self.means(corners, side, texels);
        let mean = means.iter().sum::<f64>() / means.len() as f64;
        let squares = means.iter().map(|m| m * m).sum::<f64>() / means.len() as f64;
        let mean_or_floor = mean.max(floor);
        let is_even = squares.is_nan() || squares < LEAST_GAIN * mean * mean;
        if side < 2 || is_even || mean <= 0.0 {
            return (1, vec![if mean_or_floor.is_finite() { mean_or_floor } else { self.mean }]);
        }
        let scale = mean_or_floor / mean;
        let mix = |m: &f64| scale * ((1.0 - UNIFORM_SHARE) * m + UNIFORM_SHARE * mean);
        (side, means.iter().map(mix).collect())
    }

    /// Mean of each cell, in the order of `light/triangle.wgsl`.
    fn means(&self, [a, b, c]: [Vec2; 3], side: u32, texels: f64) -> Vec<f64> {
        let per_cell = 2.0 * texels / f64::from(side * side);
        // A triangular lattice in the cell again, so that no texel is far from a lookup.
        let fine = per_cell.clamp(4.0, MAX_LOOKUPS).sqrt().ceil() as u32;
        let at = |w: Vec2| self.lookup(a + (b - a) * w.x + (c - a) * w.y);
        let cell = |k: u32| {
            let inner = (0..fine * fine).map(|m| {
                let w = within(k, side, centroid(m, fine));
                f64::from(at(w))
            });
            inner.sum::<f64>() / f64::from(fine * fine)
        };
        (0..side * side).map(cell).collect()
    }

    /// The nearest texel's.
    fn lookup(&self, position: Vec2) -> f32 {
        let wrap = |p: f32, size: u32, mode: Wrap| {
            let (i, size) = (p.floor() as i64, i64::from(size));
            let wrapped = match mode {
                Wrap::ClampToEdge => i.clamp(0, size - 1),
                Wrap::Repeat => i.rem_euclid(size),
                Wrap::MirroredRepeat => {
                    let m = i.rem_euclid(2 * size);
                    if m < size { m } else { 2 * size - 1 - m }
                }
            };
            wrapped as usize
        };
        let [u, v] = self.texture.wrap;
        let x = wrap(position.x, self.image.width, u);
        let y = wrap(position.y, self.image.height, v);
        self.luminance[y * self.image.width as usize + x]
    }
}

/// The weights (of b and c) in the triangle, of the weights in its cell `k` of `side`².
pub(super) fn within(k: u32, side: u32, w: Vec2) -> Vec2 {
    let strip = k.isqrt();
    let rest = k - strip * strip;
    let (j, is_turned) = (rest / 2, rest % 2);
    let corner = Vec2::new((strip - j - is_turned) as f32, j as f32);
    let w = if is_turned == 1 { Vec2::ONE - w } else { w };
    (corner + w) / side as f32
}

/// The middle of cell `k` of `side`².
fn centroid(k: u32, side: u32) -> Vec2 {
    within(k, side, Vec2::splat(1.0 / 3.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Affine2;

    fn texture(wrap: Wrap) -> TextureRef {
        TextureRef {
            image: 0,
            color_space: ColorSpace::Linear,
            uv_set: 0,
            transform: Affine2::IDENTITY,
            wrap: [wrap; 2],
            nearest: false,
        }
    }

    /// 64 × 64 texels, white where x and y are below `edge`.
    fn image(edge: u32) -> Image {
        let texel = |i: u32| if i % 64 < edge && i / 64 < edge { [255; 4] } else { [0, 0, 0, 255] };
        Image { name: String::new(), width: 64, height: 64, rgba: (0..4096).map(texel).collect() }
    }

    const LOWER: [Vec2; 3] = [Vec2::ZERO, Vec2::X, Vec2::Y];

    #[test]
    fn cells_cover_the_triangle_once() {
        for side in [1, 2, 5, 16] {
            // Of a finer lattice: each point is in one cell, by area.
            let mut sum = Vec2::ZERO;
            for k in 0..side * side {
                let corners = [Vec2::ZERO, Vec2::X, Vec2::Y].map(|w| within(k, side, w));
                let area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]);
                assert!((area - 1.0 / (side * side) as f32).abs() < 1e-6, "{side} {k}");
                assert!(corners.iter().all(|w| w.min_element() >= 0.0 && w.element_sum() <= 1.0));
                sum += centroid(k, side);
            }
            assert!((sum / (side * side) as f32).distance(Vec2::splat(1.0 / 3.0)) < 1e-5);
        }
    }

    #[test]
    fn a_picture_with_a_bright_corner_is_divided() {
        let images = [image(8)];
        let emission = EmissionTexture::new(texture(Wrap::Repeat), &images, [0.2, 0.7, 0.1], 2);
        let (side, cells) = emission.cells(LOWER);
        assert_eq!((side, cells.len()), (16, 256));
        // 64 of the 2048 texels of the triangle are white.
        let mean = cells.iter().sum::<f64>() / 256.0;
        assert!((mean - 64.0 / 2048.0).abs() < 0.1 * mean, "{mean}");
        let floor = UNIFORM_SHARE * mean;
        assert!(cells[0] > 0.9 && (cells[255] - floor).abs() < 1e-12, "{cells:?}");
    }

    #[test]
    fn an_even_picture_is_not_divided_and_a_dark_part_keeps_a_floor() {
        let images = [image(64)];
        let emission = EmissionTexture::new(texture(Wrap::Repeat), &images, [0.2, 0.7, 0.1], 2);
        assert_eq!(emission.cells(LOWER), (1, vec![f64::from(0.2_f32 + 0.7 + 0.1)]));
        let images = [image(8)];
        let emission = EmissionTexture::new(texture(Wrap::Repeat), &images, [0.2, 0.7, 0.1], 2);
        let dark = [Vec2::ONE * 0.9, Vec2::new(0.5, 0.9), Vec2::new(0.9, 0.5)];
        let (side, cells) = emission.cells(dark);
        assert_eq!(side, 1);
        assert!((cells[0] - LEAST_MEAN * 64.0 / 4096.0).abs() < 1e-9, "{}", cells[0]);
        let broken = [Vec2::NAN, Vec2::X, Vec2::splat(f32::INFINITY)];
        assert!(emission.cells(broken).1[0] > 0.0);
    }

    #[test]
    fn wrap_modes_repeat_as_they_say() {
        let images = [image(8)];
        let at = |wrap, x: f32| {
            let emission = EmissionTexture::new(texture(wrap), &images, [1.0, 0.0, 0.0], 2);
            emission.lookup(Vec2::new(x, 0.5))
        };
        assert_eq!([at(Wrap::Repeat, 65.0), at(Wrap::Repeat, -1.0)], [1.0, 0.0]);
        assert_eq!([at(Wrap::MirroredRepeat, 65.0), at(Wrap::MirroredRepeat, -1.0)], [0.0, 1.0]);
        assert_eq!([at(Wrap::ClampToEdge, 65.0), at(Wrap::ClampToEdge, -1.0)], [0.0, 1.0]);
    }
}
