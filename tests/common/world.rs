//! Primitives and their trees on the host, beside brute force.

use super::{Random, Stage, lambert};
use glam::{Affine3A, Vec3};
use steradian::bvh::{
    Aabb, BuildItem, Bvh, ItemHit, PrimitiveKind, Ray, any_hit_as, build_median, build_sah,
    closest_hit_as, sphere_hit, triangle_hit_as,
};
use steradian::scene::{Mesh, Scene};

pub(crate) type Builder = fn(&[BuildItem]) -> Bvh;
pub(crate) const BUILDERS: [(&str, Builder); 2] = [("sah", build_sah), ("median", build_median)];

#[derive(Debug, Clone, Copy)]
pub(crate) enum Primitive {
    Triangle([Vec3; 3]),
    Sphere(Vec3, f32),
}

impl Primitive {
    pub(crate) fn item(&self) -> BuildItem {
        match *self {
            Self::Triangle(v) => {
                BuildItem { bounds: Aabb::of_points(&v), kind: PrimitiveKind::Triangle }
            }
            Self::Sphere(center, radius) => {
                BuildItem { bounds: Aabb::of_sphere(center, radius), kind: PrimitiveKind::Sphere }
            }
        }
    }

    pub(crate) fn hit<const FUSED: bool>(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        match *self {
            Self::Triangle([a, b, c]) => {
                triangle_hit_as::<FUSED>(ray.o, ray.d, a, b, c, t_max).map(|h| h.t)
            }
            Self::Sphere(center, radius) => {
                sphere_hit::<FUSED>(ray.o, ray.d, center, radius, t_max)
            }
        }
    }
}

pub(crate) fn items(primitives: &[Primitive]) -> Vec<BuildItem> {
    primitives.iter().map(Primitive::item).collect()
}

/// Primitives and their tree, which is valid.
pub(crate) struct World {
    pub(crate) name: String,
    pub(crate) primitives: Vec<Primitive>,
    pub(crate) bvh: Bvh,
}

impl World {
    /// One for each builder.
    pub(crate) fn each(name: &str, primitives: &[Primitive]) -> Vec<Self> {
        let items = items(primitives);
        let build = |(builder, build): (&str, Builder)| {
            let name = format!("{name}, {builder}");
            let bvh = build(&items);
            if let Err(error) = bvh.validate(&items) {
                panic!("{name}: {error}");
            }
            Self { name, primitives: primitives.to_vec(), bvh }
        };
        BUILDERS.into_iter().map(build).collect()
    }

    pub(crate) fn brute_force<const FUSED: bool>(&self, ray: &Ray) -> Option<ItemHit> {
        self.first_of::<FUSED>(ray, 0..self.primitives.len())
    }

    /// Brute force over some of the primitives.
    pub(crate) fn first_of<const FUSED: bool>(
        &self,
        ray: &Ray,
        items: impl Iterator<Item = usize>,
    ) -> Option<ItemHit> {
        let hits = items.filter_map(|item| {
            let t = self.primitives[item].hit::<FUSED>(ray, ray.t_max)?;
            Some(ItemHit { t, item: item as u32 })
        });
        hits.reduce(|a, b| if b.is_before(&a) { b } else { a })
    }

    pub(crate) fn closest<const FUSED: bool>(&self, ray: &Ray) -> Option<ItemHit> {
        closest_hit_as::<FUSED>(&self.bvh, ray, |_, item, t_max| {
            self.primitives[item as usize].hit::<FUSED>(ray, t_max)
        })
    }

    pub(crate) fn is_blocked<const FUSED: bool>(&self, ray: &Ray) -> bool {
        any_hit_as::<FUSED>(&self.bvh, ray, |_, item, t_max| {
            self.primitives[item as usize].hit::<FUSED>(ray, t_max)
        })
    }

    /// Whether the tree gives what brute force gives, to the bit, for closest and any hit.
    pub(crate) fn is_right<const FUSED: bool>(&self, ray: &Ray, expected: Option<ItemHit>) -> bool {
        self.closest::<FUSED>(ray) == expected
            && self.is_blocked::<FUSED>(ray) == expected.is_some()
    }
}

/// `count` triangles, then `spheres` spheres, with sizes spread over three decades.
pub(crate) fn soup(count: usize, spheres: usize, random: &mut Random) -> Vec<Primitive> {
    let primitive = |i: usize| {
        let center = random.in_cube();
        let size = 10.0f32.powf(-0.3 - 3.0 * random.unit());
        if i >= count {
            Primitive::Sphere(center, size)
        } else {
            Primitive::Triangle([0; 3].map(|_| center + size * random.in_cube()))
        }
    };
    (0..count + spheres).map(primitive).collect()
}

/// A ray from about the cube from -1 to 1 towards a point in it, of random length.
pub(crate) fn random_ray(random: &mut Random) -> Ray {
    let o = 2.0 * random.in_cube();
    let d = random.in_cube() - o;
    let is_endless = random.bits() & 1 == 0;
    Ray { o, d, t_max: if is_endless { f32::MAX } else { 2.0 * random.unit() } }
}

/// The primitives as a scene, in the same order if triangles come first.
pub(crate) fn scene_of(primitives: &[Primitive]) -> Scene {
    let mut stage = Stage::perspective(Vec3::ZERO, Vec3::NEG_Z, 1.0);
    let mut positions = Vec::new();
    for primitive in primitives {
        match *primitive {
            Primitive::Triangle(v) => positions.extend(v),
            Primitive::Sphere(center, radius) => stage.sphere(center, radius, lambert(0.5)),
        }
    }
    if !positions.is_empty() {
        let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
        let mesh = Mesh { triangles: triangles.collect(), positions, ..Mesh::default() };
        let mesh = stage.mesh(mesh, lambert(0.5));
        stage.place(mesh, Affine3A::IDENTITY);
    }
    stage.scene
}
