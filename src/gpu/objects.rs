//! From what a ray met to the object of the scene.

use crate::scene::Scene;
use crate::settings::Accel;
use crate::shader::generated::{INVALID, TREE_RECORD_SIZE};

/// Which of a scene's objects the primitives are: its instances, then its spheres.
#[derive(Debug, Clone)]
pub struct Objects {
    /// First source of each run of primitives, and whose they are; INVALID for a shared mesh's.
    runs: Vec<(u32, u32)>,
    /// Instances of shared meshes, in the order of their records.
    shared: Vec<u32>,
    /// Material of each object.
    materials: Vec<u32>,
}

impl Objects {
    /// In the order in which the scene's primitives are numbered for a tree of this kind.
    pub fn new(scene: &Scene, accel: Accel) -> Self {
        let is_shared = scene.shared_meshes();
        let (mut runs, mut shared, mut next) = (Vec::new(), Vec::new(), 0);
        let mut is_numbered = vec![false; scene.meshes.len()];
        for (object, instance) in (0..).zip(&scene.instances) {
            let mesh = instance.mesh as usize;
            let count = scene.meshes[mesh].triangles.len() as u32;
            if accel == Accel::None || !is_shared[mesh] {
                runs.push((next, object));
                next += count;
                continue;
            }
            shared.push(object);
            if !std::mem::replace(&mut is_numbered[mesh], true) {
                runs.push((next, INVALID));
                next += count;
            }
        }
        let instances = scene.instances.len() as u32;
        runs.extend((0..scene.spheres.len() as u32).map(|i| (next + i, instances + i)));
        let of_instances = scene.instances.iter().map(|i| scene.meshes[i.mesh as usize].material);
        let materials = of_instances.chain(scene.spheres.iter().map(|s| s.material)).collect();
        Self { runs, shared, materials }
    }

    /// Index of the object whose primitive `source` was met, by its place among the instances and
    /// then the spheres; `None` for a miss. `instance`: offset of the record of a shared mesh's
    /// placement, if it is one's.
    pub fn find(&self, source: u32, instance: u32) -> Option<u32> {
        if source == INVALID {
            return None;
        }
        // Meshes without triangles begin where the next one does: the last run is it.
        let run = self.runs.partition_point(|(first, _)| *first <= source).checked_sub(1)?;
        match self.runs[run].1 {
            INVALID => {
                self.shared.get((instance / TREE_RECORD_SIZE).checked_sub(1)? as usize).copied()
            }
            object => Some(object),
        }
    }

    /// Index of a primitive of [`Self::find`]'s object among the triangles of its mesh.
    pub fn primitive(&self, source: u32) -> u32 {
        let run = self.runs.partition_point(|(first, _)| *first <= source).max(1) - 1;
        self.runs.get(run).map_or(0, |(first, _)| source - first)
    }

    /// Index of an object's material.
    pub fn material(&self, object: u32) -> u32 {
        self.materials[object as usize]
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.materials.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.materials.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{TreeWidth, World};
    use crate::scene::{Instance, Material, Mesh, Sphere};
    use glam::{Affine3A, Vec3};

    /// A strip of triangles of a material.
    fn strip(count: u32, material: u32) -> Mesh {
        let positions = (0..count + 2).map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.0)).collect();
        let triangles = (0..count).map(|i| [i, i + 1, i + 2]).collect();
        Mesh { positions, triangles, material, ..Mesh::default() }
    }

    /// Instances of two meshes that are copied, one of them empty in between, and one that is shared.
    fn scene() -> Scene {
        let place =
            |mesh| Instance { name: String::new(), mesh, world_from_object: Affine3A::IDENTITY };
        let sphere =
            |material| Sphere { name: String::new(), center: Vec3::ZERO, radius: 1.0, material };
        Scene {
            meshes: vec![strip(3, 0), strip(5000, 1), strip(0, 2), strip(2, 2)],
            instances: [1, 0, 1, 2, 3, 0].map(place).into(),
            spheres: vec![sphere(1), sphere(3)],
            materials: vec![Material::default(); 4],
            ..Scene::default()
        }
    }

    /// Every primitive has the material of the object that it is found to be, in the very records
    /// that the device has.
    #[test]
    fn primitives_have_the_material_of_their_object() {
        let scene = scene();
        assert_eq!(scene.shared_meshes(), [false, true, false, false]);
        for accel in [Accel::Bvh, Accel::None] {
            let objects = Objects::new(&scene, accel);
            assert_eq!(objects.len(), 8);
            let world = World::build(&scene, accel, TreeWidth::Two).unwrap();
            let (mut met, mut count) = ([0; 8], 0);
            for record in world.primitives.chunks_exact(3) {
                let (material, source) = (record[0][3] & 0xFF, record[2][3]);
                // The instances' places in the order of the leaves have no primitive.
                let is_empty = record == [[0; 4]; 3];
                if is_empty && count > 0 {
                    continue;
                }
                let object = objects.find(source, 2 * TREE_RECORD_SIZE).unwrap();
                assert_eq!(objects.material(object), material, "source {source} of {accel:?}");
                met[object as usize] += 1;
                count += 1;
            }
            // The second placement of the shared mesh is the third instance.
            let shared = if accel == Accel::Bvh {
                [0, 3, 5000, 0, 2, 3, 1, 1]
            } else {
                [5000, 3, 5000, 0, 2, 3, 1, 1]
            };
            assert_eq!(met, shared, "{accel:?}");
            assert_eq!(objects.find(INVALID, INVALID), None);
        }
        let objects = Objects::new(&scene, Accel::Bvh);
        assert_eq!([0, 4999, 5000, 5004].map(|source| objects.primitive(source)), [0, 4999, 0, 1]);
        assert_eq!(objects.find(0, TREE_RECORD_SIZE), Some(0));
        assert_eq!(objects.find(0, 2 * TREE_RECORD_SIZE), Some(2));
    }
}
