//! Triangles and spheres in world space, and where rays meet them.
//!
//! The file's f32 numbers are exact in f64, and so is the placement of a vertex up to a few
//! units of 2^-53.

use super::tree::{Bounds, Tree};
use crate::scene::{Instance, Mesh, Scene};
use glam::{DMat3, DVec3};

/// A hit this share of a surface's largest coordinate away from the point on it where the ray
/// begins is that point again, seen on a coincident or adjoining primitive. 2^-44 is some
/// hundred times the rounding of such a point, and 0.1 mm at two million kilometres.
const SAME_POINT: f64 = 1.0 / (1_u64 << 44) as f64;

/// A half line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it begins.
    pub origin: DVec3,
    /// Where it goes; unit length.
    pub direction: DVec3,
}

/// What can be hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Primitive {
    /// A triangle of a placed mesh.
    Triangle {
        /// Index into [`Scene::instances`].
        instance: u32,
        /// Index into [`Mesh::triangles`].
        triangle: u32,
    },
    /// Index into [`Scene::spheres`].
    Sphere(u32),
}

/// Where a ray meets a primitive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hit {
    /// Distance from the ray's origin.
    pub(super) t: f64,
    /// Index of the primitive in [`Geometry`].
    pub(super) primitive: usize,
    /// Weights of the three corners; of no meaning for spheres.
    pub(super) barycentrics: [f64; 3],
}

#[derive(Debug)]
struct Triangle {
    corners: [DVec3; 3],
    instance: u32,
    triangle: u32,
}

#[derive(Debug)]
struct Ball {
    center: DVec3,
    radius: f64,
}

/// All primitives of a scene: triangles first, spheres after them.
#[derive(Debug)]
pub(super) struct Geometry {
    triangles: Vec<Triangle>,
    balls: Vec<Ball>,
    /// For each mesh, whether camera rays pass through its back.
    culled_meshes: Vec<bool>,
    /// `None`: every ray tests every primitive.
    tree: Option<Tree>,
}

impl Geometry {
    /// Places every mesh of `scene`. Without `with_tree`, rays test everything.
    pub(super) fn new(scene: &Scene, with_tree: bool) -> Self {
        let instances = (0..).zip(&scene.instances);
        let triangles = instances.flat_map(|(index, instance)| place(scene, index, instance));
        let balls = scene
            .spheres
            .iter()
            .map(|s| Ball { center: s.center.as_dvec3(), radius: s.radius.into() });
        let mut geometry = Self {
            triangles: triangles.collect(),
            balls: balls.collect(),
            culled_meshes: scene.culled_meshes(),
            tree: None,
        };
        if with_tree {
            let bounds: Vec<_> = (0..geometry.count()).map(|i| geometry.bounds(i)).collect();
            geometry.tree = Some(Tree::new(&bounds));
        }
        geometry
    }

    /// Whether camera rays pass through the back of a mesh.
    pub(super) fn is_culled(&self, mesh: u32) -> bool {
        self.culled_meshes[mesh as usize]
    }

    /// Number of primitives.
    pub(super) fn count(&self) -> usize {
        self.triangles.len() + self.balls.len()
    }

    /// The nearest hit beyond 0. `left`: the primitive on which the ray begins, if it does; the
    /// ray does not meet it at its origin.
    pub(super) fn nearest(&self, ray: &Ray, left: Option<usize>) -> Option<Hit> {
        let t_min = left.map_or(0.0, |p| self.extent(p) * SAME_POINT);
        let mut nearest: Option<Hit> = None;
        let mut test = |primitive: usize| {
            if let Some(hit) = self.intersect(primitive, ray, left, t_min)
                // Of several at one distance the first, whatever the order of the tests.
                && nearest.is_none_or(|n| (hit.t, primitive) < (n.t, n.primitive))
            {
                nearest = Some(hit);
            }
            nearest.map_or(f64::INFINITY, |n| n.t)
        };
        match &self.tree {
            Some(tree) => tree.visit(ray, &mut test),
            None => (0..self.count()).for_each(|p| _ = test(p)),
        }
        nearest
    }

    fn intersect(&self, p: usize, ray: &Ray, left: Option<usize>, t_min: f64) -> Option<Hit> {
        let is_left = left == Some(p);
        let Some(ball) = p.checked_sub(self.triangles.len()).map(|i| &self.balls[i]) else {
            // A straight line does not meet a plane twice.
            let hit = if is_left { None } else { self.triangles[p].intersect(ray) };
            return hit.filter(|(t, _)| *t > t_min).map(|(t, barycentrics)| Hit {
                t,
                primitive: p,
                barycentrics,
            });
        };
        let t = if is_left {
            // One root is 0, so that the other one is their sum.
            Some(-2.0 * (ray.origin - ball.center).dot(ray.direction)).filter(|t| *t > 0.0)
        } else {
            ball.intersect(ray).into_iter().flatten().find(|t| *t > t_min)
        };
        t.map(|t| Hit { t, primitive: p, barycentrics: [0.0; 3] })
    }

    /// The point of a hit, from the primitive rather than along the ray: on it to its rounding.
    pub(super) fn position(&self, ray: &Ray, hit: &Hit) -> DVec3 {
        match self.primitive(hit.primitive) {
            Primitive::Triangle { .. } => {
                let corners = self.corners(hit.primitive);
                corners.iter().zip(hit.barycentrics).map(|(corner, weight)| corner * weight).sum()
            }
            Primitive::Sphere(i) => {
                let ball = &self.balls[i as usize];
                let outward = ray.origin + ray.direction * hit.t - ball.center;
                ball.center + outward.normalize() * ball.radius
            }
        }
    }

    /// What is at an index.
    pub(super) fn primitive(&self, index: usize) -> Primitive {
        match self.triangles.get(index) {
            Some(t) => Primitive::Triangle { instance: t.instance, triangle: t.triangle },
            None => Primitive::Sphere((index - self.triangles.len()) as u32),
        }
    }

    /// Corners in world space of the triangle at an index.
    pub(super) fn corners(&self, index: usize) -> &[DVec3; 3] {
        &self.triangles[index].corners
    }

    /// Largest coordinate of a primitive, by magnitude.
    fn extent(&self, p: usize) -> f64 {
        let Bounds { low, high } = self.exact_bounds(p);
        low.abs().max(high.abs()).max_element()
    }

    /// Bounds that hold every hit as computed.
    fn bounds(&self, p: usize) -> Bounds {
        let Bounds { low, high } = self.exact_bounds(p);
        let margin = self.extent(p) * SAME_POINT;
        Bounds { low: low - margin, high: high + margin }
    }

    fn exact_bounds(&self, p: usize) -> Bounds {
        match self.triangles.get(p) {
            Some(Triangle { corners: [a, b, c], .. }) => {
                Bounds { low: a.min(*b).min(*c), high: a.max(*b).max(*c) }
            }
            None => {
                let Ball { center, radius } = self.balls[p - self.triangles.len()];
                Bounds { low: center - radius, high: center + radius }
            }
        }
    }
}

/// The linear part of an instance's transform.
pub(super) fn linear_part(instance: &Instance) -> DMat3 {
    let m = instance.world_from_object.matrix3;
    DMat3::from_cols_array(&m.to_cols_array().map(f64::from))
}

fn place<'a>(
    scene: &'a Scene,
    instance_index: u32,
    instance: &'a Instance,
) -> impl Iterator<Item = Triangle> + 'a {
    let mesh: &Mesh = &scene.meshes[instance.mesh as usize];
    let (linear, offset) = (
        linear_part(instance),
        glam::Vec3::from(instance.world_from_object.translation).as_dvec3(),
    );
    (0..).zip(&mesh.triangles).map(move |(triangle, corners)| Triangle {
        corners: corners.map(|i| linear * mesh.positions[i as usize].as_dvec3() + offset),
        instance: instance_index,
        triangle,
    })
}

impl Triangle {
    /// Distance and barycentrics of the hit with the whole line, from either side.
    ///
    /// The weight of a corner is the volume of the tetrahedron of the opposite edge, the origin
    /// and the direction. The two triangles at an edge compute that volume with opposite sign
    /// and the same rounding, so that no line passes between them. (One that is aimed at a common
    /// corner to the last place may: no random ray is.)
    fn intersect(&self, ray: &Ray) -> Option<(f64, [f64; 3])> {
        let [a, b, c] = self.corners.map(|corner| corner - ray.origin);
        let volumes = [b.cross(c), c.cross(a), a.cross(b)].map(|edge| edge.dot(ray.direction));
        let sum: f64 = volumes.iter().sum();
        // Zero: seen from its edge, or without area.
        if sum == 0.0 || volumes.iter().any(|v| v * sum.signum() < 0.0) {
            return None;
        }
        let [u, v, w] = volumes.map(|volume| volume / sum);
        Some(((a * u + b * v + c * w).dot(ray.direction), [u, v, w]))
    }
}

impl Ball {
    /// Distances to both hits with the whole line, in order.
    fn intersect(&self, ray: &Ray) -> Option<[f64; 2]> {
        let from_center = ray.origin - self.center;
        let to_middle = -from_center.dot(ray.direction);
        let miss = (from_center + ray.direction * to_middle).length();
        if miss > self.radius {
            return None;
        }
        let half_chord = ((self.radius - miss) * (self.radius + miss)).sqrt();
        // The root of larger magnitude has no cancellation; their product gives the other one.
        let large = to_middle + half_chord.copysign(to_middle);
        let distance = from_center.length();
        let small = (distance - self.radius) * (distance + self.radius) / large;
        Some(if large > small { [small, large] } else { [large, small] })
    }
}
