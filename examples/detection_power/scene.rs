//! A small room with something for every defect.

use glam::{Affine3A, Vec2, Vec3};
use steradian::scene::{
    Camera, ColorSpace, Image, Instance, LightKind, Material, Mesh, Projection, PunctualLight,
    Scene, Sphere, TextureRef, Wrap,
};

/// Index of the mesh whose normals are smooth.
pub(crate) const SMOOTH_MESH: usize = 6;

fn lambert(color: Vec3) -> Material {
    Material { base_color: color, metallic: 0.0, specular: 0.0, ..Material::default() }
}

/// A rectangle `center ± u ± v`, its front towards `u × v`; the texture repeats three times.
fn quad(center: Vec3, u: Vec3, v: Vec3, material: u32) -> Mesh {
    let uvs = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0)].map(|(u, v)| Vec2::new(u, v));
    Mesh {
        positions: [-u - v, u - v, u + v, v - u].map(|c| center + c).into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uvs: [uvs.into(), Vec::new()],
        material,
        ..Mesh::default()
    }
}

/// An octahedron with normals of a sphere.
fn octahedron(center: Vec3, radius: f32, material: u32) -> Mesh {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let mut mesh = Mesh { material, ..Mesh::default() };
    for k in 0..8 {
        let sign = |bit: u32| if k >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let corners = [0, 1, 2].map(|i| axes[i] * sign(i as u32));
        let first = mesh.positions.len() as u32;
        let is_mirrored = sign(0) * sign(1) * sign(2) < 0.0;
        mesh.positions.extend(corners.map(|c| center + radius * c));
        mesh.normals.extend(corners);
        let (b, c) = if is_mirrored { (2, 1) } else { (1, 2) };
        mesh.triangles.push([first, first + b, first + c]);
    }
    mesh
}

/// The room: textured floor, coloured walls, a lamp in the ceiling and a faint second one, an
/// octahedron with smooth normals and a rough metal sphere.
pub(crate) fn scene() -> Scene {
    let texel = |i: u32| {
        let (x, y) = (i % 8, i / 8);
        let level = if (x / 4 + y / 4).is_multiple_of(2) { 230 } else { 120 };
        [level, level - 10 * x as u8, level - 60, 255]
    };
    let image =
        Image { name: "tiles".into(), width: 8, height: 8, rgba: (0..64).map(texel).collect() };
    let texture = TextureRef {
        image: 0,
        color_space: ColorSpace::Srgb,
        uv_set: 0,
        transform: glam::Affine2::IDENTITY,
        wrap: [Wrap::Repeat; 2],
        nearest: false,
    };
    let white = Vec3::splat(0.75);
    let materials = vec![
        Material { base_color_texture: Some(texture), ..lambert(Vec3::ONE) },
        lambert(white),
        lambert(Vec3::new(0.6, 0.1, 0.1)),
        lambert(Vec3::new(0.1, 0.5, 0.15)),
        Material { emission: Vec3::new(17.0, 13.0, 8.0), ..lambert(Vec3::ZERO) },
        lambert(Vec3::new(0.3, 0.45, 0.7)),
        Material { base_color: Vec3::new(0.9, 0.7, 0.4), roughness: 0.5, ..Material::default() },
    ];
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let meshes = vec![
        quad(-y, z, x, 0),
        quad(y, x, z, 1),
        quad(-z, x, y, 1),
        quad(-x, y, z, 2),
        quad(x, z, y, 3),
        quad(y * 0.99, x * 0.35, z * 0.3, 4),
        octahedron(Vec3::new(-0.4, -0.55, -0.2), 0.45, 5),
    ];
    let instances = (0..meshes.len() as u32).map(|mesh| Instance {
        name: String::new(),
        mesh,
        world_from_object: Affine3A::IDENTITY,
    });
    let light = PunctualLight {
        name: "faint".into(),
        kind: LightKind::Point { position: Vec3::new(0.7, 0.1, 0.6), range: f32::INFINITY },
        intensity: Vec3::new(0.05, 0.07, 0.12),
    };
    let camera = Camera {
        name: "camera".into(),
        world_from_camera: Affine3A::from_translation(Vec3::new(0.0, 0.0, 3.6)),
        projection: Projection::Perspective { yfov: 0.72 },
        aspect_ratio: None,
        aperture_radius: 0.0,
        focus_distance: 1.0,
    };
    Scene {
        name: "room".into(),
        instances: instances.collect(),
        meshes,
        spheres: vec![Sphere {
            name: String::new(),
            center: Vec3::new(0.45, -0.65, 0.1),
            radius: 0.35,
            material: 6,
        }],
        materials,
        images: vec![image],
        lights: vec![light],
        cameras: vec![camera],
        ..Scene::default()
    }
}
