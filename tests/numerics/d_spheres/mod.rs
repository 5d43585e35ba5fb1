//! Rays and spheres.

mod distant;
mod floor;
mod loading;
mod roots;
mod surface;

use crate::probe;
use glam::{DVec3, Vec3, Vec4};
use steradian::bvh::{AnchoredSphere, sphere_hit, sphere_hit_anchored};

/// An intersection function of a sphere by centre and radius.
type SphereTest = fn(Vec3, Vec3, Vec3, f32, f32) -> Option<f32>;

/// The product's, in both arithmetics.
const PRODUCT: [(&str, SphereTest); 2] =
    [("plain", sphere_hit::<false>), ("fused", sphere_hit::<true>)];

/// Of a sphere in the anchored form.
type AnchoredTest = fn(Vec3, Vec3, AnchoredSphere, f32) -> Option<f32>;

const ANCHORED: [(&str, AnchoredTest); 2] =
    [("plain", sphere_hit_anchored::<false>), ("fused", sphere_hit_anchored::<true>)];

/// One ray against one sphere, for the device.
#[derive(Clone, Copy)]
struct Query {
    o: Vec3,
    d: Vec3,
    center: Vec3,
    radius: f32,
    anchored: AnchoredSphere,
}

/// Hits on the device: by centre and radius, and in the anchored form.
fn device_hits(queries: &[Query]) -> Vec<[Option<f32>; 2]> {
    let input = |q: &Query| {
        let AnchoredSphere { point, normal, curvature } = q.anchored;
        let sphere = q.center.extend(q.radius);
        [q.o.extend(0.0), q.d.extend(0.0), sphere, point.extend(0.0), normal.extend(curvature)]
    };
    let inputs: Vec<[Vec4; 5]> = queries.iter().map(input).collect();
    let outputs = probe::sphere_hits(&inputs);
    let hit = |t: f32| (t < f32::MAX).then_some(t);
    outputs.iter().map(|pair| pair.map(hit)).collect()
}

/// The quadratic of the textbooks: the discriminant is the difference of two large squares.
fn naive_hit(o: Vec3, d: Vec3, center: Vec3, radius: f32, t_max: f32) -> Option<f32> {
    let f = o - center;
    let (a, b, c) = (d.dot(d), 2.0 * f.dot(d), f.dot(f) - radius * radius);
    let root = (b * b - 4.0 * a * c).sqrt();
    let roots = [(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)];
    roots.into_iter().find(|&t| t > 0.0 && t < t_max)
}

/// Haines, Günther and Akenine-Möller 2019 for a unit direction, as published.
fn gems_hit(o: Vec3, d: Vec3, center: Vec3, radius: f32, t_max: f32) -> Option<f32> {
    let f = o - center;
    let b = -f.dot(d);
    let l = f + b * d;
    let discriminant = radius * radius - l.dot(l);
    if discriminant < 0.0 {
        return None;
    }
    let c = f.dot(f) - radius * radius;
    let q = b + b.signum() * discriminant.sqrt();
    let (t0, t1) = if c / q < q { (c / q, q) } else { (q, c / q) };
    [t0, t1].into_iter().find(|&t| t > 0.0 && t < t_max)
}

/// A line and a sphere in f64.
struct Exact {
    /// Distance of the line from the centre over the radius.
    impact: f64,
    /// Both roots, NaN where the line misses.
    roots: [f64; 2],
    o: DVec3,
    d: DVec3,
}

impl Exact {
    fn new(o: Vec3, d: Vec3, center: Vec3, radius: f32) -> Self {
        let (f, d, r) = (o.as_dvec3() - center.as_dvec3(), d.as_dvec3(), f64::from(radius));
        let (a, b) = (d.dot(d), -f.dot(d));
        let off = f + b / a * d;
        let root = (a * (r * r - off.dot(off))).sqrt();
        let impact = off.length() / r;
        // The root near zero as the quotient, which does not cancel.
        let q = b + b.signum() * root;
        let mut roots = [f.dot(f) - r * r, q * q / a].map(|x| x / q);
        roots.sort_by(f64::total_cmp);
        Self { impact, roots, o: f, d }
    }

    /// Outward unit normal at the nearer root.
    fn near_normal(&self) -> DVec3 {
        (self.o + self.roots[0] * self.d).normalize()
    }

    /// The first root above 0.
    fn first(&self) -> Option<f64> {
        self.roots.into_iter().find(|&t| t > 0.0)
    }
}
