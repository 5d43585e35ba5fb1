//! A number for what a scene holds.

use super::Scene;
use bytemuck::cast_slice;
use std::fmt::{self, Write};

/// 64-bit FNV-1a.
pub(crate) struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }
}

impl Fnv {
    /// Of what it was given so far.
    pub(crate) fn value(&self) -> u64 {
        self.0
    }

    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3);
        }
    }
}

impl Write for Fnv {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.bytes(text.as_bytes());
        Ok(())
    }
}

impl Scene {
    /// Hash of everything that a picture by one of the cameras can depend on: equal for equal scenes,
    /// whatever file they, or the camera, came from. Names of materials and of the camera are part of
    /// it; notices and the scene's own name are not. It may change with the version of this program.
    pub fn content_hash(&self, camera: usize) -> u64 {
        let mut hash = Fnv::default();
        for mesh in &self.meshes {
            hash.bytes(cast_slice(&mesh.positions));
            hash.bytes(cast_slice(&mesh.normals));
            hash.bytes(cast_slice(&mesh.tangents));
            hash.bytes(cast_slice(&mesh.uvs[0]));
            hash.bytes(cast_slice(&mesh.uvs[1]));
            hash.bytes(cast_slice(&mesh.colors));
            hash.bytes(cast_slice(&mesh.triangles));
            hash.bytes(&mesh.material.to_le_bytes());
        }
        for image in &self.images {
            hash.bytes(&image.width.to_le_bytes());
            hash.bytes(cast_slice(&image.rgba));
        }
        if let Some(map) = &self.environment {
            hash.bytes(&map.width.to_le_bytes());
            hash.bytes(cast_slice(&map.radiance));
            let _ = write!(hash, "{:?}", (map.environment_from_world, map.intensity));
        }
        // Writing to a hash cannot fail. `{:?}` tells any two numbers apart.
        let _ = write!(hash, "{:?}", (&self.instances, &self.spheres, &self.materials));
        let _ = write!(hash, "{:?}", (&self.lights, &self.cameras.get(camera)));
        hash.value()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, Environment, Material, Mesh};
    use glam::Vec3;

    #[test]
    fn every_part_counts() {
        let mesh = Mesh {
            positions: vec![Vec3::X, Vec3::Y, Vec3::Z],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let scene = Scene {
            meshes: vec![mesh],
            materials: vec![Material::default()],
            environment: Some(Environment::constant(Vec3::ONE)),
            cameras: vec![Camera::framing((Vec3::ZERO, Vec3::ONE))],
            ..Scene::default()
        };
        let hash = |change: fn(&mut Scene)| {
            let mut scene = scene.clone();
            change(&mut scene);
            scene.content_hash(0)
        };
        let all = [
            hash(|_| {}),
            hash(|s| s.meshes[0].positions[1].x = f32::MIN_POSITIVE),
            hash(|s| s.meshes[0].triangles[0] = [0, 2, 1]),
            hash(|s| s.materials[0].roughness = 0.5),
            hash(|s| s.environment = None),
            hash(|s| s.cameras[0].focus_distance = 1.0),
            hash(|s| s.environment.as_mut().unwrap().radiance[0].z = 2.0),
        ];
        for (i, a) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|b| a != b), "change {i} does not count");
        }
        assert_eq!(hash(|s| s.name = "another".into()), all[0]);
        // It is not by that camera.
        assert_eq!(hash(|s| s.cameras.push(s.cameras[0].clone())), all[0]);
    }
}
