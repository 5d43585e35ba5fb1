//! Rays of a path tracer: through pixels, from what those meet, and from what these meet.

use crate::tree::Tree;
use glam::Vec3;
use steradian::bvh::{Ray, SpawnPoint};

/// Sets of the same order: eight consecutive rays are of a block of 4 by 2 pixels. Rays
/// whose pixel met nothing are left out with their whole block, so that packets stay full.
pub(crate) struct RaySets {
    /// Through the pixels' centres.
    pub(crate) camera: Vec<Ray>,
    /// From the points that camera rays meet, by the cosine.
    pub(crate) bounce: Vec<Ray>,
    /// From the points that camera rays meet to points of lights, or upward if there are none.
    pub(crate) shadow: Vec<Ray>,
    /// From the points that bounce rays meet, again by the cosine: less coherent.
    pub(crate) second: Vec<Ray>,
}

/// A generator of the splitmix kind: its numbers depend on the seed alone.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / 16_777_216.0
    }
}

/// Where a camera stands.
pub(crate) struct Eye {
    pub(crate) position: Vec3,
    /// Right, up and back, unit vectors.
    pub(crate) axes: [Vec3; 3],
    /// Tangent of half the vertical angle.
    pub(crate) half: f32,
}

impl RaySets {
    /// For a square picture of `side` pixels, a multiple of 4.
    pub(crate) fn new(
        eye: &Eye,
        side: u32,
        tree: &Tree,
        triangles: &[[Vec3; 3]],
        lights: &[[Vec3; 3]],
    ) -> Self {
        let camera = camera_rays(eye, side);
        let (_, hits) = tree.walk(triangles, &camera);
        let mut random = Random(1);
        let bounce = leaving(&camera, &hits, triangles, |point| point.scattered(&mut random));
        let shadow = leaving(&camera, &hits, triangles, |point| point.shadow(lights, &mut random));
        let (_, hits) = tree.walk(triangles, &bounce);
        let second = leaving(&bounce, &hits, triangles, |point| point.scattered(&mut random));
        Self { camera, bounce, shadow, second }
    }
}

/// A point that was met, its normal on the side that it was met from.
struct Met(SpawnPoint);

impl Met {
    /// By the cosine.
    fn scattered(&self, random: &mut Random) -> Ray {
        let (z, phi) = (2.0 * random.unit() - 1.0, std::f32::consts::TAU * random.unit());
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let sphere = Vec3::new(radius * phi.cos(), radius * phi.sin(), z);
        let d = (self.0.normal + sphere).normalize_or(self.0.normal);
        Ray { o: self.0.origin::<false>(d), d, t_max: f32::INFINITY }
    }

    /// To a point of one of `lights`, short of it.
    fn shadow(&self, lights: &[[Vec3; 3]], random: &mut Random) -> Ray {
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let index = (random.unit() * lights.len() as f32) as usize;
        let to = match lights.get(index) {
            Some([a, b, c]) => *a + u * (*b - *a) + v * (*c - *a),
            None => self.0.position + 1e3 * Vec3::Y,
        };
        let o = self.0.origin::<false>(to - self.0.position);
        Ray { o, d: (to - o).normalize_or(Vec3::Y), t_max: 0.999 * to.distance(o) }
    }
}

fn camera_rays(eye: &Eye, side: u32) -> Vec<Ray> {
    let along = |i: u32| (2.0 * (i as f32 + 0.5) / side as f32 - 1.0) * eye.half;
    let [right, up, back] = eye.axes;
    let ray = |x: u32, y: u32| {
        let d = (right * along(x) - up * along(y) - back).normalize();
        Ray { o: eye.position, d, t_max: f32::INFINITY }
    };
    let blocks = (0..side / 2).flat_map(|y| (0..side / 4).map(move |x| [4 * x, 2 * y]));
    blocks.flat_map(|[x, y]| (0..8).map(move |i| ray(x + i % 4, y + i / 4))).collect()
}

/// A ray from each point that was met.
fn leaving(
    rays: &[Ray],
    hits: &[(u32, f32)],
    triangles: &[[Vec3; 3]],
    mut ray_from: impl FnMut(Met) -> Ray,
) -> Vec<Ray> {
    let mut leaving = Vec::new();
    for (rays, hits) in rays.chunks_exact(8).zip(hits.chunks_exact(8)) {
        if hits.iter().any(|hit| hit.0 == u32::MAX) {
            continue;
        }
        for (ray, &(item, t)) in rays.iter().zip(hits) {
            let spawn = SpawnPoint::on_triangle::<false>(triangles[item as usize], 0.0, 0.0);
            let normal = if spawn.normal.dot(ray.d) > 0.0 { -spawn.normal } else { spawn.normal };
            let position = ray.o + t * ray.d;
            // More than the shader's offset, as the point is not interpolated in the plane.
            leaving.push(ray_from(Met(SpawnPoint {
                position,
                normal,
                offset: 4.0 * spawn.offset,
            })));
        }
    }
    leaving
}
