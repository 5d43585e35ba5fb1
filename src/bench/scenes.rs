//! Scenes of any size, made in memory: what costs are scaled on.

use crate::scene::{Camera, Instance, Material, Mesh, Scene};
use glam::{Affine3A, Vec3};
use std::f32::consts::{PI, TAU};

/// Twists of the knot about its ring and about its tube's axis.
const KNOT: (f32, f32) = (2.0, 3.0);
/// Side of the room, metres.
const ROOM: f32 = 4.0;
/// Emitted power per area of the lamp of [`knot`], W/(sr m²).
const RADIANCE: f32 = 12.0;

/// A diffuse room of 4 m, open to the camera, with a tube along a (2, 3) torus knot of about
/// `triangles` triangles, 16 at least, and a lamp of 1 m² below the ceiling.
pub fn knot(triangles: usize) -> Scene {
    let mut scene = room();
    scene.name = format!("knot-{triangles}");
    let mesh = tube(triangles);
    add(&mut scene, Mesh { name: "knot".into(), material: 1, ..mesh });
    let lamp = quad(Vec3::new(-0.5, ROOM - 0.01, -0.5), Vec3::X, Vec3::Z);
    add(&mut scene, Mesh { name: "lamp".into(), material: 2, ..lamp });
    scene.materials[2].emission = Vec3::splat(RADIANCE);
    scene
}

/// The same room with so many small emissive triangles on a grid below its ceiling, facing
/// down, which together emit the same power whatever their number; no knot.
pub fn lamps(count: usize) -> Scene {
    let mut scene = room();
    scene.name = format!("lamps-{count}");
    let side = (count as f64).sqrt().ceil() as usize;
    let cell = (ROOM - 1.0) / side as f32;
    let mut mesh = Mesh { name: "lamps".into(), material: 2, ..Mesh::default() };
    for k in 0..count {
        let corner = Vec3::new((k % side) as f32, 0.0, (k / side) as f32) * cell;
        let corner = corner + Vec3::new(0.5 - 0.5 * ROOM, ROOM - 0.2, 0.5 - 0.5 * ROOM);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([
            corner,
            corner + 0.3 * cell * Vec3::X,
            corner + 0.3 * cell * Vec3::Z,
        ]);
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    let area = 0.045 * cell * cell * count as f32;
    scene.materials[2].emission = Vec3::splat(RADIANCE / area);
    add(&mut scene, mesh);
    scene
}

/// Floor, ceiling and three walls, with materials for them, for an object, and for lamps.
fn room() -> Scene {
    let diffuse = |name: &str, grey: f32| Material {
        name: name.into(),
        base_color: Vec3::splat(grey),
        metallic: 0.0,
        specular: 0.0,
        ..Material::default()
    };
    let mut scene = Scene {
        materials: vec![diffuse("wall", 0.7), diffuse("object", 0.5), diffuse("lamp", 0.0)],
        ..Scene::default()
    };
    let half = 0.5 * ROOM;
    let (low, x, y, z) =
        (Vec3::new(-half, 0.0, -half), Vec3::X * ROOM, Vec3::Y * ROOM, Vec3::Z * ROOM);
    for (corner, u, v) in [(low, z, x), (low + y, x, z), (low, x, y), (low, y, z), (low + x, z, y)]
    {
        add(&mut scene, Mesh { name: "wall".into(), ..quad(corner, u, v) });
    }
    let mut camera = Camera::framing((Vec3::ZERO, Vec3::ONE));
    camera.name = "front".into();
    camera.world_from_camera = Affine3A::from_translation(Vec3::new(0.0, half, half + 1.6 * ROOM));
    camera.projection = crate::scene::Projection::Perspective { yfov: 34f32.to_radians() };
    scene.cameras = vec![camera];
    scene
}

fn add(scene: &mut Scene, mesh: Mesh) {
    scene.instances.push(Instance {
        name: mesh.name.clone(),
        mesh: scene.meshes.len() as u32,
        world_from_object: Affine3A::IDENTITY,
    });
    scene.meshes.push(mesh);
}

/// Two triangles; the front is where `u` × `v` points.
fn quad(corner: Vec3, u: Vec3, v: Vec3) -> Mesh {
    Mesh {
        positions: vec![corner, corner + u, corner + u + v, corner + v],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// A closed tube along the knot, 8 times as long as around in facets.
fn tube(triangles: usize) -> Mesh {
    let around = (((triangles as f64) / 16.0).sqrt().round() as usize).max(3);
    let along = (triangles as f64 / (2 * around) as f64).round().max(3.0) as usize;
    let center = |t: f32| {
        let (p, q) = (KNOT.0 * t, KNOT.1 * t);
        let ring = 0.9 + 0.4 * q.cos();
        Vec3::new(ring * p.cos(), 1.9 + 0.4 * q.sin(), ring * p.sin())
    };
    let mut positions = Vec::with_capacity(along * around);
    let mut normals = Vec::with_capacity(along * around);
    for i in 0..along {
        let t = i as f32 / along as f32 * TAU;
        let tangent = (center(t + 1e-2) - center(t - 1e-2)).normalize();
        // The knot's plane turns about the vertical axis: this is nowhere along the tangent.
        let outward = Vec3::new((KNOT.0 * t).cos(), 0.0, (KNOT.0 * t).sin());
        let side = tangent.cross(outward).normalize();
        let up = side.cross(tangent);
        for j in 0..around {
            let angle = j as f32 / around as f32 * 2.0 * PI;
            let normal = angle.cos() * up + angle.sin() * side;
            positions.push(center(t) + 0.22 * normal);
            normals.push(normal);
        }
    }
    let index = |i: usize, j: usize| ((i % along) * around + j % around) as u32;
    let mut faces = Vec::with_capacity(2 * along * around);
    for i in 0..along {
        for j in 0..around {
            let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            faces.extend([[a, c, b], [a, d, c]]);
        }
    }
    Mesh { positions, normals, triangles: faces, ..Mesh::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RenderSettings;

    fn area(mesh: &Mesh) -> f32 {
        let of = |[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|&i| mesh.positions[i as usize]);
            0.5 * (b - a).cross(c - a).length()
        };
        mesh.triangles.iter().map(of).sum()
    }

    #[test]
    fn a_knot_has_about_as_many_triangles_as_asked_for_and_is_closed() {
        for wanted in [1_000, 10_000, 100_000] {
            let scene = knot(wanted);
            let mesh = scene.meshes.iter().find(|m| m.name == "knot").unwrap();
            let found = mesh.triangles.len() as f64 / wanted as f64;
            assert!((found - 1.0).abs() < 0.05, "{wanted}: {found}");
            assert!(mesh.is_closed());
            assert!(RenderSettings::default().validate(&scene).is_ok());
        }
    }

    /// Its faces look outwards, as its normals do, and it is inside the room.
    #[test]
    fn a_knot_is_in_the_room_with_its_front_outside() {
        let scene = knot(10_000);
        let mesh = scene.meshes.iter().find(|m| m.name == "knot").unwrap();
        for [a, b, c] in &mesh.triangles {
            let [p, q, r] = [a, b, c].map(|&i| mesh.positions[i as usize]);
            assert!((q - p).cross(r - p).dot(mesh.normals[*a as usize]) > 0.0);
        }
        let (low, high) = mesh.bounds().unwrap();
        assert!(
            low.min_element() > -2.0 && low.y > 0.0 && high.y < ROOM && high.max_element() < ROOM
        );
    }

    /// Whatever their number, lamps emit the same power, downwards.
    #[test]
    fn lamps_share_one_power() {
        for count in [1, 10, 1000] {
            let scene = lamps(count);
            let mesh = scene.meshes.iter().find(|m| m.name == "lamps").unwrap();
            assert_eq!(mesh.triangles.len(), count);
            let power = area(mesh) * scene.materials[mesh.material as usize].emission.x;
            assert!((power / RADIANCE - 1.0).abs() < 1e-3, "{count}: {power}");
            let [a, b, c] = mesh.triangles[0].map(|i| mesh.positions[i as usize]);
            assert!((b - a).cross(c - a).y < 0.0, "faces down");
        }
    }
}
