//! The scene's geometry as trees and records.
//!
//! Meshes that are placed once, or are small, are copied into world space and lie,
//! with the spheres, in the leaves of the top tree. Meshes that many instances share
//! have a tree of their own in object space; their instances are leaves of the top tree.

use super::wide::WideTree;
use super::world_source::{Sources, Triangle};
use crate::bvh::{
    Aabb, BuildItem, Bvh, BvhChild, KeptTrees, LEAF_BIT, LEAF_FIRST_MASK, LEAF_KIND_MASK,
    LEAF_KIND_SHIFT, PrimitiveKind, TreeSources, build_median, build_sah,
};
use crate::scene::Scene;
use crate::settings::Accel;
use crate::shader::generated::{PRIMITIVE_HAS_ALPHA, PRIMITIVE_IS_CULLED, TREE_RECORD_SIZE};
use crate::{Error, Result};
use glam::{Affine3A, Vec3};
use rayon::prelude::*;
use std::sync::Arc;

/// What stack sizes are multiples of. Workgroups of 64 then take 2 KiB more at a time, and scenes
/// share the kernels that their drivers have compiled.
const STACK_STEP: u32 = 8;

/// Geometry in the form of the device's buffers.
#[derive(Debug, Default)]
pub struct World {
    /// Records of the top tree and of instances, then the nodes of all trees.
    pub nodes: Vec<[u32; 4]>,
    /// Three words a primitive, in the order of the leaves.
    pub primitives: Vec<[u32; 4]>,
    /// Corners of primitives, then vertices.
    pub attributes: Vec<[u32; 4]>,
    /// Where the vertices begin.
    pub attribute_base: u32,
    /// `vec4`s of a vertex.
    pub attribute_stride: u32,
    /// Pending links that a walk can need.
    pub stack_size: u32,
    /// What emits, in the order of the lights.
    pub emitters: Vec<Emitter>,
    statistics: WorldStatistics,
    width: TreeWidth,
}

/// Children of a node on the device.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum TreeWidth {
    /// As built: for threads that walk alone.
    #[default]
    Two,
    /// Two levels in one: for packets.
    Four,
}

/// Counts of a [`World`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WorldStatistics {
    /// Triangles that the device holds.
    pub triangle_count: usize,
    /// Spheres.
    pub sphere_count: usize,
    /// Placements of shared meshes.
    pub instance_count: usize,
    /// Nodes of all trees.
    pub node_count: usize,
    /// Surface area cost of the top tree, in units of one primitive test.
    pub sah_cost: f64,
    /// Levels of the top tree and the deepest tree below it together.
    pub tree_depth: u32,
    /// Where the trees came from.
    pub trees: TreeSources,
}

/// A surface that emits, in world space.
#[derive(Debug, Clone, Copy)]
pub struct Emitter {
    /// Index into the scene's materials.
    pub material: u32,
    /// Index in scene order.
    pub source: u32,
    /// Form.
    pub shape: EmitterShape,
    /// Mean luminance of its radiance, before alpha: an estimate, 0 only for what emits nothing.
    pub luminance: f64,
    /// Which cell of a divided triangle it is, and how many the triangle has along a side:
    /// 0 and 1 for all others.
    pub cell: [u32; 2],
}

/// The form of an [`Emitter`].
#[derive(Debug, Clone, Copy)]
pub enum EmitterShape {
    /// Counter-clockwise from the front.
    Triangle([Vec3; 3]),
    /// The outside is the front.
    Sphere {
        /// Centre.
        center: Vec3,
        /// Radius.
        radius: f32,
    },
}

/// Three words of a primitive.
type Record = [[u32; 4]; 3];

/// A tree and where its primitives' records begin.
struct Tree {
    bvh: Arc<Bvh>,
    first_record: u32,
}

/// What is kept of a tree when its nodes and records are with the others.
struct Root {
    link: u32,
    grid: [Vec3; 2],
    /// Levels as built, and on the device.
    depth: u32,
    device_depth: u32,
}

impl World {
    /// Builds all trees of `scene`.
    ///
    /// # Errors
    /// [`Error::Limit`] if there are more primitives than a tree can address.
    pub fn build(scene: &Scene, accel: Accel, width: TreeWidth) -> Result<Self> {
        Self::build_with(scene, accel, width, None)
    }

    /// [`World::build`] with the trees that are kept, which are then this scene's.
    ///
    /// # Errors
    /// As [`World::build`].
    pub fn build_with(
        scene: &Scene,
        accel: Accel,
        width: TreeWidth,
        kept: Option<&KeptTrees>,
    ) -> Result<Self> {
        let sources = Sources::gather(scene, accel != Accel::None);
        let limit = crate::bvh::MAX_ITEMS;
        if sources.count() > limit {
            let count = sources.count();
            return Err(Error::Limit(format!(
                "{count} triangles and spheres exceed the {limit} that a tree addresses: \
                 split or simplify the scene"
            )));
        }
        let mut world = World { emitters: sources.emitters.clone(), width, ..Self::default() };
        (world.attributes, world.attribute_base, world.attribute_stride) = sources.attributes();
        world.statistics.triangle_count = sources.triangle_count();
        world.statistics.sphere_count = sources.spheres.len();
        world.statistics.instance_count = sources.instances.len();
        if accel == Accel::None {
            world.nodes = vec![[0; 4]; TREE_RECORD_SIZE as usize];
            world.primitives = sources.top.iter().flat_map(|t| triangle_record(t, scene)).collect();
            world.primitives.extend(sources.sphere_records().into_iter().flatten());
            return Ok(world);
        }
        world.build_trees(scene, &sources, accel, kept);
        world.statistics.trees = match kept {
            Some(kept) => kept.end_scene(),
            None => TreeSources { built: sources.shared.len() + 1, ..Default::default() },
        };
        Ok(world)
    }

    /// The tree of `scene` whose leaves are triangles, spheres and placed meshes.
    pub fn top_tree(scene: &Scene, accel: Accel) -> Bvh {
        let items = top_items(&Sources::gather(scene, true));
        match accel {
            Accel::Median => build_median(&items),
            Accel::Bvh | Accel::None => build_sah(&items),
        }
    }

    /// Counts and quality.
    pub fn statistics(&self) -> WorldStatistics {
        self.statistics
    }

    fn build_trees(
        &mut self,
        scene: &Scene,
        sources: &Sources,
        accel: Accel,
        kept: Option<&KeptTrees>,
    ) {
        let build = |items: &[BuildItem]| {
            let build = match accel {
                Accel::Median => build_median,
                Accel::Bvh | Accel::None => build_sah,
            };
            match kept {
                Some(kept) => kept.tree(items, accel as u64, build),
                None => Arc::new(build(items)),
            }
        };
        let record_words = (1 + sources.instances.len()) * TREE_RECORD_SIZE as usize;
        self.nodes = vec![[0; 4]; record_words];
        self.primitives.reserve_exact(3 * (sources.count() + sources.instances.len()));
        let mut below = Vec::new();
        let mut first_record = 0;
        for mesh in &sources.shared {
            let items: Vec<_> = mesh.par_iter().map(triangle_item).collect();
            let tree = Tree { bvh: build(&items), first_record };
            below.push(self.append(tree, &[], |i| triangle_record(&mesh[i], scene)));
            first_record += mesh.len() as u32;
        }
        let items = top_items(sources);
        let bvh = build(&items);
        drop(items);
        self.statistics.sah_cost = bvh.sah_cost();
        let instance_records: Vec<u32> = (1..=sources.instances.len() as u32).collect();
        let spheres = sources.sphere_records();
        let record = |i: usize| match i.checked_sub(sources.top.len()) {
            None => triangle_record(&sources.top[i], scene),
            // Instances have no primitive.
            Some(beyond) => spheres.get(beyond).copied().unwrap_or_default(),
        };
        let top = self.append(Tree { bvh, first_record }, &instance_records, record);
        self.write_header(0, &top);
        for (k, i) in sources.instances.iter().enumerate() {
            let record = (1 + k) * TREE_RECORD_SIZE as usize;
            self.write_header(record, &below[i.shared]);
            self.write_rows(record + 2, i.world_from_object.inverse());
            self.write_rows(record + 5, i.world_from_object);
        }
        let deepest = |of: fn(&Root) -> u32| of(&top) + below.iter().map(of).max().unwrap_or(0);
        self.statistics.tree_depth = deepest(|root| root.depth);
        let device_depth = deepest(|root| root.device_depth);
        // At most one link a level for every child but the one that is entered, the end
        // mark, and the mark of the way back from an instance.
        let links = match self.width {
            TreeWidth::Two => device_depth + 2,
            TreeWidth::Four => 3 * device_depth + 2,
        };
        // In steps: trees of about the same depth have the same kernel.
        self.stack_size = links.next_multiple_of(STACK_STEP);
    }

    /// Appends a tree's nodes, and the records of its items by their indices. `instance_records`
    /// numbers the records of the tree's instances, which are its last items.
    fn append(
        &mut self,
        tree: Tree,
        instance_records: &[u32],
        record: impl Fn(usize) -> Record + Sync,
    ) -> Root {
        let Tree { bvh, first_record } = tree;
        let base = self.nodes.len() as u32;
        let first_instance = bvh.order.len() - instance_records.len();
        let relocated = |c: BvhChild, width: u32| {
            let first = c.link & LEAF_FIRST_MASK;
            let kind = c.link >> LEAF_KIND_SHIFT & LEAF_KIND_MASK;
            let link = if c.link & LEAF_BIT == 0 {
                base + width * c.link
            } else if kind == PrimitiveKind::Instance as u32 {
                let item = bvh.order[first as usize] as usize;
                c.link & !LEAF_FIRST_MASK | instance_records[item - first_instance]
            } else {
                c.link & !LEAF_FIRST_MASK | (first_record + first)
            };
            [c.x, c.y, c.z, link]
        };
        self.statistics.node_count += bvh.nodes.len();
        let device_depth = match self.width {
            TreeWidth::Two => {
                self.nodes.reserve_exact(2 * bvh.nodes.len());
                let children = bvh.nodes.iter().flat_map(|n| n.children);
                self.nodes.extend(children.map(|c| relocated(c, 2)));
                bvh.depth
            }
            TreeWidth::Four => {
                let WideTree { nodes, depth } = WideTree::new(&bvh);
                self.nodes.reserve_exact(4 * nodes.len());
                self.nodes.extend(nodes.iter().flatten().map(|&c| relocated(c, 4)));
                depth
            }
        };
        let held = self.primitives.len();
        self.primitives.resize(held + 3 * bvh.order.len(), [0; 4]);
        let records = self.primitives[held..].par_chunks_exact_mut(3);
        records.zip(&bvh.order).for_each(|(words, &i)| words.copy_from_slice(&record(i as usize)));
        let grid = [bvh.grid_min, bvh.grid_scale];
        Root { link: base, grid, depth: bvh.depth, device_depth }
    }

    fn write_header(&mut self, at: usize, root: &Root) {
        let words = |v: Vec3, w: u32| [v.x.to_bits(), v.y.to_bits(), v.z.to_bits(), w];
        let [min, scale] = root.grid;
        self.nodes[at] = words(min, root.link);
        self.nodes[at + 1] = words(scale, 0);
    }

    fn write_rows(&mut self, at: usize, m: Affine3A) {
        let (a, t) = (m.matrix3, m.translation);
        for (k, row) in [a.row(0), a.row(1), a.row(2)].into_iter().enumerate() {
            self.nodes[at + k] = [row.x, row.y, row.z, t[k]].map(f32::to_bits);
        }
    }
}

/// Items of the top tree: triangles, spheres, instances, in this order.
fn top_items(sources: &Sources) -> Vec<BuildItem> {
    let mut items: Vec<_> = sources.top.par_iter().map(triangle_item).collect();
    items.extend(sources.spheres.iter().map(|s| BuildItem {
        bounds: Aabb::of_sphere(s.center, s.radius),
        kind: PrimitiveKind::Sphere,
    }));
    items.par_extend(sources.instances.par_iter().map(|i| BuildItem {
        bounds: instance_bounds(&sources.shared[i.shared], i.world_from_object),
        kind: PrimitiveKind::Instance,
    }));
    items
}

fn triangle_item(t: &Triangle) -> BuildItem {
    BuildItem { bounds: Aabb::of_points(&t.vertices), kind: PrimitiveKind::Triangle }
}

/// Bounds of a placed mesh, widened by the rounding of its transforms.
fn instance_bounds(mesh: &[Triangle], world_from_object: Affine3A) -> Aabb {
    let mut bounds = Aabb::empty();
    for v in mesh.iter().flat_map(|t| t.vertices) {
        bounds = bounds.grow(world_from_object.transform_point3(v));
    }
    let size = bounds.min.abs().max(bounds.max.abs()).max_element();
    let margin = Vec3::splat(size * 32.0 * f32::EPSILON);
    Aabb { min: bounds.min - margin, max: bounds.max + margin }
}

fn triangle_record(t: &Triangle, scene: &Scene) -> Record {
    let opaque = scene.materials[t.material as usize].alpha_mode == crate::scene::AlphaMode::Opaque;
    let flag = |holds: bool, bit: u32| if holds { bit } else { 0 };
    let material =
        t.material | flag(!opaque, PRIMITIVE_HAS_ALPHA) | flag(t.is_culled, PRIMITIVE_IS_CULLED);
    let word = |v: Vec3, w: u32| [v.x.to_bits(), v.y.to_bits(), v.z.to_bits(), w];
    let [a, b, c] = t.vertices;
    [word(a, material), word(b, t.light), word(c, t.source)]
}
