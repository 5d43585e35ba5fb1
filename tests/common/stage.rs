//! Scenes in a few lines.

use glam::{Affine3A, Vec2, Vec3};
use steradian::scene::{
    Camera, Environment, Instance, LightKind, Material, Mesh, Projection, PunctualLight, Scene,
    Sphere,
};

/// A scene under construction.
pub(crate) struct Stage {
    pub(crate) scene: Scene,
}

/// A Lambertian surface without a coat.
pub(crate) fn lambert(albedo: f32) -> Material {
    Material {
        base_color: Vec3::splat(albedo),
        metallic: 0.0,
        specular: 0.0,
        ..Material::default()
    }
}

/// A surface that emits `radiance` from its front and reflects nothing.
pub(crate) fn emitter(radiance: f32) -> Material {
    Material { emission: Vec3::splat(radiance), ..lambert(0.0) }
}

impl Stage {
    /// Nothing yet but a camera at `eye` that looks at `target`.
    fn seen_by(eye: Vec3, target: Vec3, projection: Projection) -> Self {
        let back = (eye - target).normalize();
        let right = back.any_orthonormal_vector();
        let up = back.cross(right);
        let camera = Camera {
            name: "camera".into(),
            world_from_camera: Affine3A::from_cols(
                right.into(),
                up.into(),
                back.into(),
                eye.into(),
            ),
            projection,
            aspect_ratio: None,
            aperture_radius: 0.0,
            focus_distance: 1.0,
        };
        let scene = Scene { name: "stage".into(), cameras: vec![camera], ..Scene::default() };
        Self { scene }
    }

    /// Parallel view of a square of `2 ymag` metres.
    pub(crate) fn orthographic(eye: Vec3, target: Vec3, ymag: f32) -> Self {
        Self::seen_by(eye, target, Projection::Orthographic { ymag })
    }

    /// View with a vertical angle of `yfov` radians.
    pub(crate) fn perspective(eye: Vec3, target: Vec3, yfov: f32) -> Self {
        Self::seen_by(eye, target, Projection::Perspective { yfov })
    }

    pub(crate) fn material(&mut self, material: Material) -> u32 {
        self.scene.materials.push(material);
        self.scene.materials.len() as u32 - 1
    }

    /// Adds a mesh without placing it.
    pub(crate) fn mesh(&mut self, mesh: Mesh, material: Material) -> u32 {
        let material = self.material(material);
        self.scene.meshes.push(Mesh { material, ..mesh });
        self.scene.meshes.len() as u32 - 1
    }

    pub(crate) fn place(&mut self, mesh: u32, world_from_object: Affine3A) {
        let name = String::new();
        self.scene.instances.push(Instance { name, mesh, world_from_object });
    }

    /// The parallelogram `center ± u ± v`, its front towards `u × v`. Texture
    /// coordinates grow along u and v.
    pub(crate) fn quad(&mut self, center: Vec3, u: Vec3, v: Vec3, material: Material) -> u32 {
        let mesh = self.mesh(quad_mesh(center, u, v), material);
        self.place(mesh, Affine3A::IDENTITY);
        mesh
    }

    /// Horizontal square of half side `half`, its front up.
    pub(crate) fn floor(&mut self, center: Vec3, half: f32, material: Material) -> u32 {
        self.quad(center, Vec3::Z * half, Vec3::X * half, material)
    }

    /// Horizontal square of half side `half`, its front down.
    pub(crate) fn ceiling(&mut self, center: Vec3, half: f32, material: Material) -> u32 {
        self.quad(center, Vec3::X * half, Vec3::Z * half, material)
    }

    pub(crate) fn sphere(&mut self, center: Vec3, radius: f32, material: Material) {
        let material = self.material(material);
        self.scene.spheres.push(Sphere { name: String::new(), center, radius, material });
    }

    pub(crate) fn light(&mut self, kind: LightKind, intensity: f32) {
        let intensity = Vec3::splat(intensity);
        self.scene.lights.push(PunctualLight { name: String::new(), kind, intensity });
    }

    /// The same radiance from everywhere.
    pub(crate) fn sky(&mut self, radiance: f32) {
        self.scene.environment = Some(Environment::constant(Vec3::splat(radiance)));
    }
}

/// The parallelogram `center ± u ± v`, its front towards `u × v`.
pub(crate) fn quad_mesh(center: Vec3, u: Vec3, v: Vec3) -> Mesh {
    Mesh {
        positions: [-u - v, u - v, u + v, v - u].map(|c| center + c).into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// Gives a quad of four corners texture coordinates.
pub(crate) fn with_uvs(mesh: Mesh, uvs: [Vec2; 4]) -> Mesh {
    Mesh { uvs: [uvs.into(), Vec::new()], ..mesh }
}

/// The box `center ± half`, its front outside.
pub(crate) fn box_mesh(center: Vec3, half: Vec3) -> Mesh {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
    let sides =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Mesh {
        positions: (0..8).map(|i| center + half * (corner(i) * 2.0 - 1.0)).collect(),
        triangles: sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..Mesh::default()
    }
}
