//! Texture lookup.

use crate::scene::{ColorSpace, Image, TextureRef, Wrap};
use glam::{DAffine2, DVec2, DVec4};
use std::sync::LazyLock;

/// Linear values of the 8-bit sRGB codes, IEC 61966-2-1.
static LINEAR: LazyLock<[f64; 256]> = LazyLock::new(|| {
    std::array::from_fn(|code| {
        let encoded = code as f64 / 255.0;
        if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    })
});

/// The texture's value where the mesh's two sets of coordinates are `uvs`.
pub(super) fn lookup(images: &[Image], texture: &TextureRef, uvs: &[DVec2; 2]) -> DVec4 {
    let image = &images[texture.image as usize];
    let transform = DAffine2::from_cols_array(&texture.transform.to_cols_array().map(f64::from));
    let uv = transform.transform_point2(uvs[texture.uv_set as usize]);
    let place = uv * DVec2::new(image.width.into(), image.height.into());
    if texture.nearest {
        let cell = place.floor();
        return texel(image, texture, cell.x, cell.y);
    }
    // Texel centres lie at half numbers.
    let place = place - 0.5;
    let cell = place.floor();
    let share = place - cell;
    let row = |y: f64| {
        let (left, right) =
            (texel(image, texture, cell.x, y), texel(image, texture, cell.x + 1.0, y));
        left.lerp(right, share.x)
    };
    row(cell.y).lerp(row(cell.y + 1.0), share.y)
}

/// The decoded texel in column `x` and row `y`, which may lie outside the image.
fn texel(image: &Image, texture: &TextureRef, x: f64, y: f64) -> DVec4 {
    let x = wrapped(x, image.width, texture.wrap[0]);
    let y = wrapped(y, image.height, texture.wrap[1]);
    let rgba = image.rgba[y * image.width as usize + x];
    let [r, g, b, a] = rgba.map(|code| f64::from(code) / 255.0);
    match texture.color_space {
        ColorSpace::Linear => DVec4::new(r, g, b, a),
        ColorSpace::Srgb => {
            let [r, g, b, _] = rgba.map(|code| LINEAR[usize::from(code)]);
            DVec4::new(r, g, b, a)
        }
    }
}

fn wrapped(index: f64, size: u32, wrap: Wrap) -> usize {
    let n = f64::from(size);
    let inside = match wrap {
        Wrap::Repeat => index.rem_euclid(n),
        Wrap::MirroredRepeat => {
            let k = index.rem_euclid(2.0 * n);
            if k < n { k } else { 2.0 * n - 1.0 - k }
        }
        Wrap::ClampToEdge => index.clamp(0.0, n - 1.0),
    };
    inside as usize
}
