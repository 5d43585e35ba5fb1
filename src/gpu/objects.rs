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
