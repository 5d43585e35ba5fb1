//! L3: what camera rays meet first, by the device's walks, by the mirror of their arithmetic on
//! the host, and in f64.

use crate::common::{
    Primitive, Random, World, assert_at_least, assert_at_most, bundled, items, report, settings,
};
use crate::probe::camera_rays;
use crate::traced::{Query, Walk, trace};
use glam::{DVec3, Vec3, Vec4};
use std::collections::BTreeSet;
use steradian::bvh::{Ray, build_sah};
use steradian::reference::{self, Reference};
use steradian::scene::Scene;

/// Triangles and spheres; 145,656 triangles.
const SCENES: [&str; 2] = ["cornell-spheres", "statue"];

const RAYS: usize = 1 << 15;

/// Units of 2^-24 of the largest coordinate about the ray's origin by which rounding may move a
/// corner or a centre: it is rounded when the origin is taken from it and twice when it is sheared,
/// with a shear that is rounded itself; the rest is for weights, roots and quotients.
const ROUNDINGS: f64 = 16.0;

/// Distance along a ray, and the index in scene order of what is there.
type First = Option<(f64, u32)>;

/// Triangles of every instance, then spheres.
fn primitives(scene: &Scene) -> Vec<Primitive> {
    assert!(!scene.shared_meshes().contains(&true), "{}: trees below trees", scene.name);
    let triangles = scene.instances.iter().flat_map(|instance| {
        let placement = instance.world_from_object;
        let mesh = &scene.meshes[instance.mesh as usize];
        let is_mirrored = placement.matrix3.determinant() < 0.0;
        let at = move |i: u32| placement.transform_point3(mesh.positions[i as usize]);
        mesh.triangles.iter().map(move |&[a, b, c]| {
            Primitive::Triangle((if is_mirrored { [a, c, b] } else { [a, b, c] }).map(at))
        })
    });
    let spheres = scene.spheres.iter().map(|s| Primitive::Sphere(s.center, s.radius));
    triangles.chain(spheres).collect()
}

/// The scene in f64.
struct Exact<'a> {
    reference: Reference<'a>,
    /// Index in scene order of each instance's first triangle, and of the first sphere.
    first: Vec<u32>,
    /// Largest coordinate of the scene about the ray's origin.
    extent: f64,
}

impl<'a> Exact<'a> {
    fn new(scene: &'a Scene, primitives: &[Primitive], eye: Vec3) -> Self {
        let mut first = vec![0];
        for instance in &scene.instances {
            let count = scene.meshes[instance.mesh as usize].triangles.len() as u32;
            first.push(first.last().unwrap() + count);
        }
        let reach = |p: &Primitive| match *p {
            Primitive::Triangle(v) => {
                v.map(|v| (v - eye).abs().max_element()).into_iter().fold(0.0, f32::max)
            }
            Primitive::Sphere(c, r) => (c - eye).abs().max_element() + r,
        };
        let extent = primitives.iter().map(reach).fold(0.0, f32::max).into();
        Self { reference: Reference::new(scene, &settings(8, 8, 1)).unwrap(), first, extent }
    }

    /// What the ray meets first, with its normal's cosine.
    fn first_hit(&self, origin: DVec3, direction: DVec3) -> Option<(f64, u32, f64)> {
        let ray = reference::Ray { origin, direction: direction.normalize() };
        let hit = self.reference.intersect(&ray)?;
        let source = match hit.primitive {
            reference::Primitive::Triangle { instance, triangle } => {
                self.first[instance as usize] + triangle
            }
            reference::Primitive::Sphere(i) => self.first.last().unwrap() + i,
        };
        Some((hit.t / direction.length(), source, hit.ng.dot(ray.direction).abs()))
    }

    /// Whether rounding explains `found`: the ray, or one that passes it at the distance of the
    /// error's bound where it meets or leaves something, meets the same, and at the same distance
    /// but for the bound; or meets something else at that distance.
    fn explains(&self, ray: &Ray, found: First) -> bool {
        let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
        let bound = ROUNDINGS * self.extent / f64::from(1 << 24);
        let is_same = |exact: Option<(f64, u32, f64)>| match (exact, found) {
            (None, None) => true,
            (Some((t, source, cosine)), Some((found_t, found_source))) => {
                let is_near = (found_t - t).abs() * d.length() * cosine <= bound;
                // Two surfaces at one place, or the same one.
                is_near && (source == found_source || cosine > 0.1)
            }
            _ => false,
        };
        if is_same(self.first_hit(o, d)) {
            return true;
        }
        let (across, up) = d.normalize().any_orthonormal_pair();
        (0..16).any(|k| {
            let angle = f64::from(k) * std::f64::consts::TAU / 16.0;
            let aside = (across * angle.cos() + up * angle.sin()) * bound;
            is_same(self.first_hit(o + aside, d))
        })
    }
}

#[test]
fn l3_first_hits_are_the_mirrors_and_those_in_double_precision() {
    for name in SCENES {
        let scene = bundled(name);
        let primitives = primitives(&scene);
        let bvh = build_sah(&items(&primitives));
        let world = World { name: name.into(), primitives, bvh };
        let mut random = Random(303);
        let film = |_| {
            let at = random.in_cube();
            Vec4::new(at.x, at.y, 0.5, 0.5)
        };
        let films: Vec<Vec4> = (0..RAYS).map(film).collect();
        let rays: Vec<Ray> = camera_rays(&scene, &settings(512, 512, 1), &films)
            .iter()
            .map(|[o, d]| Ray { o: o.truncate(), d: d.truncate(), t_max: f32::MAX })
            .collect();
        let exact = Exact::new(&scene, &world.primitives, rays[0].o);

        let mirror = |ray: &Ray| world.closest::<false>(ray).map(|h| (f64::from(h.t), h.item));
        let mirrored: Vec<First> = rays.iter().map(mirror).collect();
        let met: BTreeSet<u32> = mirrored.iter().flatten().map(|h| h.1).collect();
        report("L3", &format!("{name}: primitives seen by {RAYS} camera rays"), met.len() as f64);
        let hits = mirrored.iter().flatten().count();
        assert_at_least("L3", &format!("{name}: hits of {RAYS} camera rays"), hits as f64, 1e4);
        let unexplained = |found: &[First]| {
            rays.iter().zip(found).filter(|(ray, f)| !exact.explains(ray, **f)).count() as f64
        };
        let exact_sources = rays.iter().map(|ray| {
            exact.first_hit(ray.o.as_dvec3(), ray.d.as_dvec3()).map(|(_, source, _)| source)
        });
        let others = exact_sources.zip(&mirrored).filter(|(e, m)| *e != m.map(|h| h.1)).count();
        let share = others as f64 / RAYS as f64;
        report("L3", &format!("{name}: share of the mirror's first primitives not f64's"), share);
        let what = format!("{name}: first hits other than in f64 beyond rounding");
        assert_at_most("L3", &format!("{what}, mirror"), unexplained(&mirrored), 0.0);

        let queries: Vec<Query> = rays.iter().map(|r| Query::new(r.o, r.d)).collect();
        for walk in Walk::over_trees() {
            let answers: Vec<First> = trace(&scene, walk, &queries)
                .iter()
                .map(|a| a.source().map(|source| (f64::from(a.t), source)))
                .collect();
            // As f32, quotients apart: WGSL allows 2.5 units in the last place.
            let is_same = |(a, b): (&First, &First)| match (a, b) {
                (Some((t, a)), Some((u, b))) => {
                    a == b && (t - u).abs() <= 8.0 * f64::from(f32::EPSILON) * u
                }
                (a, b) => a == b,
            };
            let differ = answers.iter().zip(&mirrored).filter(|pair| !is_same(*pair)).count();
            let share = differ as f64 / RAYS as f64;
            let of_mirror = format!("{name}: share of first hits other than the mirror's");
            assert_at_most("L3", &format!("{of_mirror}, device, {walk:?}"), share, 1e-4);
            let count = unexplained(&answers);
            assert_at_most("L3", &format!("{what}, device, {walk:?}"), count, 0.0);
        }
    }
}
