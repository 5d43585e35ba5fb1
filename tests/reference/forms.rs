//! Shapes and pictures for scenes that are built in code.

use glam::{Vec2, Vec3, Vec4};
use steradian::scene::{ColorSpace, Environment, Image, Mesh, TextureRef, Wrap};

/// A cheap scrambled byte: textures need no pattern, only to be neither smooth nor symmetric.
fn byte(k: usize) -> u8 {
    ((k * 2_654_435_761) >> 11) as u8
}

/// A picture of `width` by `height` texels, all of them different.
pub(crate) fn picture(width: u32, height: u32, least: u8) -> Image {
    let texel = |k: usize| [0, 1, 2, 3].map(|c| byte(4 * k + c + 17).max(least));
    let rgba = (0..(width * height) as usize).map(texel).collect();
    Image { name: "picture".into(), width, height, rgba }
}

/// Normals that lean up to some forty degrees.
pub(crate) fn normal_map(width: u32, height: u32) -> Image {
    let lean = |k: usize| 128 + byte(k) / 3 - 42;
    let texel = |k: usize| [lean(2 * k + 5), lean(2 * k + 6), 220, 255];
    let rgba = (0..(width * height) as usize).map(texel).collect();
    Image { name: "normals".into(), width, height, rgba }
}

/// A bilinear lookup by uv set 0, repeating.
pub(crate) fn texture(image: u32, color_space: ColorSpace) -> TextureRef {
    TextureRef {
        image,
        color_space,
        uv_set: 0,
        transform: glam::Affine2::IDENTITY,
        wrap: [Wrap::Repeat; 2],
        nearest: false,
    }
}

/// A bowl z = bend (x² + y²) over the square of half side 1, its front towards +Z. Corners know
/// every attribute; u grows along x, and v along -y as in a picture that hangs upright.
pub(crate) fn bowl(cells: u32, bend: f32) -> Mesh {
    let mut mesh = Mesh::default();
    for (j, i) in (0..=cells).flat_map(|j| (0..=cells).map(move |i| (j, i))) {
        let [s, t] = [i, j].map(|k| k as f32 / cells as f32);
        let (x, y) = (2.0 * s - 1.0, 2.0 * t - 1.0);
        mesh.positions.push(Vec3::new(x, y, bend * (x * x + y * y)));
        let normal = Vec3::new(-2.0 * bend * x, -2.0 * bend * y, 1.0).normalize();
        mesh.normals.push(normal);
        let along_x = Vec3::new(1.0, 0.0, 2.0 * bend * x);
        let tangent = (along_x - normal * normal.dot(along_x)).normalize();
        mesh.tangents.push(tangent.extend(1.0));
        mesh.uvs[0].push(Vec2::new(s, 1.0 - t));
        mesh.uvs[1].push(Vec2::new(0.7 * t + 0.1, 1.3 * s - 0.2));
        mesh.colors.push(Vec4::new(0.5 + 0.5 * s, 1.0 - 0.6 * t, 0.7, 1.0 - 0.5 * s));
    }
    let corner = |i: u32, j: u32| j * (cells + 1) + i;
    for (j, i) in (0..cells).flat_map(|j| (0..cells).map(move |i| (j, i))) {
        let [a, b] = [corner(i, j), corner(i + 1, j)];
        let [c, d] = [corner(i + 1, j + 1), corner(i, j + 1)];
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh
}

/// The closed box between two corners, its front outside.
pub(crate) fn closed_box(low: Vec3, high: Vec3) -> Mesh {
    let corner = |k: u32| {
        let pick = |bit: u32, a: f32, b: f32| if k >> bit & 1 == 1 { b } else { a };
        Vec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z))
    };
    let faces =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Mesh {
        positions: (0..8).map(corner).collect(),
        triangles: faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..Mesh::default()
    }
}

/// A coarse sky: bright from one side, coloured, turned about an oblique axis.
pub(crate) fn sky() -> Environment {
    let (width, height) = (8_u32, 4_u32);
    let texel = |k: u32| {
        let bright = if k == 11 { 4.0 } else { 0.3 };
        let part = |c: u32| bright * (0.3 + f32::from(byte((3 * k + c) as usize)) / 255.0);
        Vec3::new(part(0), part(1), part(2))
    };
    let axis = Vec3::new(0.3, 1.0, -0.2).normalize();
    Environment {
        name: "coarse".into(),
        width,
        height,
        radiance: (0..width * height).map(texel).collect(),
        environment_from_world: glam::Mat3::from_axis_angle(axis, 1.1),
        intensity: 0.8,
    }
}
