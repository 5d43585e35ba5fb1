//! What camera rays meet first, against closed forms, the reference in f64, and the mirror of
//! the walk. These tests need a Vulkan device.

mod common;

use common::{
    Primitive, Random, Stage, bundled, items, lambert, quad_mesh, scene_of, settings, soup,
    with_device, with_uvs,
};
use glam::{Affine3A, DVec3, Vec2, Vec3};
use steradian::RenderSettings;
use steradian::bvh::{
    Bvh, GridRay, ItemHit, Link, Ray, TraversalCounts, build_sah, closest_hit_counted,
};
use steradian::gpu::{GpuFirstHit, SceneBuffers, TreeWidth};
use steradian::image::{ChannelData, DisplayTransform};
use steradian::passes::{Extras, FirstHits, Tuning};
use steradian::reference::{self, Reference};
use steradian::renderer::PreparedScene;
use steradian::scene::{Camera, Projection, Scene};
use steradian::settings::{Accel, Crop};
use steradian::shader::Features;
use steradian::shader::generated::INVALID;
use steradian::view::{View, of_first_hits};

/// First hits of `rays` rays a pixel, in two parts; none is at fault.
fn hits(scene: &Scene, settings: &RenderSettings, rays: u32) -> Vec<GpuFirstHit> {
    with_device(|device| {
        let tuning = Tuning::default();
        let prepared = PreparedScene::new(device.clone(), scene, settings).unwrap();
        let mut hits = prepared.first_hits(scene, settings, Extras::default(), &tuning).unwrap();
        hits.run(&device, rays / 2).unwrap();
        hits.run(&device, rays - rays / 2).unwrap();
        assert!(hits.hits().iter().all(|h| h.ray_count == rays && h.faults == 0));
        hits.hits().to_vec()
    })
}

const SIDE: u32 = 32;
/// Half the height of what the parallel camera sees: no pixel's centre is on an outline.
const HALF: f32 = 1.9;
const EYE: f32 = 5.0;

/// A unit sphere before a quad of half side 1.5 at z = -2, seen along -Z.
fn sphere_and_quad() -> Scene {
    let mut stage = Stage::orthographic(Vec3::new(0.0, 0.0, EYE), Vec3::ZERO, HALF);
    let mut grey = lambert(0.25);
    grey.base_color = Vec3::new(0.25, 0.5, 0.75);
    let quad = quad_mesh(Vec3::new(0.0, 0.0, -2.0), Vec3::X * 1.5, Vec3::Y * 1.5);
    let quad = with_uvs(quad, [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y]);
    let quad = stage.mesh(quad, grey);
    stage.place(quad, Affine3A::IDENTITY);
    stage.sphere(Vec3::ZERO, 1.0, lambert(0.8));
    stage.scene
}

/// A pixel's corners on the plane through the origin, along x and y of the world.
fn corners(camera: &Camera, x: u32, y: u32) -> [Vec3; 4] {
    let m = camera.world_from_camera.matrix3;
    [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| {
        let at = |k: u32| 2.0 * k as f32 / SIDE as f32 - 1.0;
        let film = Vec2::new(at(x + i), -at(y + j)) * HALF;
        Vec3::from(m.x_axis) * film.x + Vec3::from(m.y_axis) * film.y
    })
}

/// That `value` is between the least and the largest of `bounds`, but for rounding.
fn assert_within(value: f32, bounds: impl Iterator<Item = f32> + Clone, what: &str) {
    let (least, most) =
        (bounds.clone().fold(f32::INFINITY, f32::min), bounds.fold(f32::NEG_INFINITY, f32::max));
    let is_within = (least - 4e-6..=most + 4e-6).contains(&value);
    assert!(is_within, "{what}: {value} not in {least} to {most}");
}

/// The means over a pixel are between the values at its corners where these grow one way.
#[test]
fn a_sphere_and_a_quad_have_their_closed_forms() {
    let scene = sphere_and_quad();
    let camera = &scene.cameras[0];
    let (mut on_sphere, mut on_quad) = (0, 0);
    for (i, hit) in hits(&scene, &settings(SIDE, SIDE, 1), 9).iter().enumerate() {
        let (x, y) = (i as u32 % SIDE, i as u32 / SIDE);
        let p = corners(camera, x, y);
        let n = hit.hit_count as f32;
        let radius = |f: fn(f32, f32) -> f32| p.iter().map(|p| p.length()).reduce(f).unwrap();
        let outside = p.iter().map(|p| p.x.abs().max(p.y.abs())).fold(0.0, f32::max);
        if radius(f32::max) < 1.0 {
            on_sphere += 1;
            assert_eq!((hit.hit_count, hit.material), (9, 1), "{x},{y}");
            let z = p.iter().map(|p| (1.0 - p.length_squared()).sqrt());
            assert_within(hit.depth / n, z.clone().map(|z| EYE - z), "depth of the sphere");
            for normal in [hit.shading_normal, hit.geometric_normal] {
                assert_within(normal[0] / n, p.iter().map(|p| p.x), "normal's x");
                assert_within(normal[1] / n, p.iter().map(|p| p.y), "normal's y");
                assert_within(normal[2] / n, z.clone(), "normal's z");
            }
            assert_within(hit.albedo[1] / n, [0.8].into_iter(), "albedo");
        } else if radius(f32::min) > 1.0 && outside < 1.5 {
            on_quad += 1;
            assert_eq!((hit.hit_count, hit.material), (9, 0), "{x},{y}");
            assert_within(hit.depth / n, [EYE + 2.0].into_iter(), "depth of the quad");
            assert_eq!(hit.shading_normal.map(|c| c / n), [0.0, 0.0, 1.0]);
            assert_eq!(hit.albedo.map(|c| c / n), [0.25, 0.5, 0.75]);
            assert_within(hit.uv[0] / n, p.iter().map(|p| (p.x + 1.5) / 3.0), "u");
            assert_within(hit.uv[1] / n, p.iter().map(|p| (p.y + 1.5) / 3.0), "v");
        } else if p.iter().map(|p| p.x.abs().max(p.y.abs())).fold(f32::INFINITY, f32::min) > 1.5 {
            assert_eq!((hit.hit_count, hit.material), (0, INVALID), "{x},{y}");
        }
    }
    assert!(on_sphere > 100 && on_quad > 100, "{on_sphere} {on_quad}");
}

/// The ray through the centre of a pixel.
fn centre_ray(camera: &Camera, (width, height): (u32, u32), x: u32, y: u32) -> Ray {
    let Projection::Perspective { yfov } = camera.projection else { panic!("perspective") };
    let half_height = (f64::from(yfov) * 0.5).tan();
    let half_width = half_height * f64::from(width) / f64::from(height);
    let at = |k: u32, n: u32| (k as f32 + 0.5) / n as f32;
    let film = Vec2::new(2.0 * at(x, width) - 1.0, 1.0 - 2.0 * at(y, height));
    let plane = film * Vec2::new(half_width as f32, half_height as f32);
    let m = camera.world_from_camera.matrix3;
    let d = Vec3::from(m.x_axis * plane.x + m.y_axis * plane.y - m.z_axis);
    Ray { o: camera.world_from_camera.translation.into(), d: d.normalize(), t_max: f32::MAX }
}

/// Material, distance, and normals on the viewer's side, in f64.
fn exact(scene: &Scene, reference: &Reference, ray: &Ray) -> Option<(u32, f64, DVec3, DVec3)> {
    let direction = ray.d.as_dvec3().normalize();
    let hit = reference.intersect(&reference::Ray { origin: ray.o.as_dvec3(), direction })?;
    let material = match hit.primitive {
        reference::Primitive::Triangle { instance, .. } => {
            scene.meshes[scene.instances[instance as usize].mesh as usize].material
        }
        reference::Primitive::Sphere(i) => scene.spheres[i as usize].material,
    };
    let side = if hit.ng.dot(direction) < 0.0 { 1.0 } else { -1.0 };
    Some((material, hit.t, hit.ng * side, hit.ns * side))
}

/// Whether `seen` is the normal `ns`, or where the mirror image of `wo` about that is not above the
/// surface with the normal `ng`, one whose is.
fn is_shading_normal(seen: DVec3, ns: DVec3, ng: DVec3, wo: DVec3) -> bool {
    let mirrored = |n: DVec3| 2.0 * n.dot(wo) * n.dot(ng) - ng.dot(wo);
    if mirrored(ns) > 0.01 {
        return (seen - ns).length() < 2e-2;
    }
    mirrored(seen) > -1e-3 && seen.dot(wo) > 0.0
}

/// Windows of 16 by 16 pixels out of 32,768 by 32,768, so small that all of a pixel is its centre,
/// but for pixels that an edge crosses.
#[test]
fn small_pixels_are_those_of_the_reference() {
    for name in ["cornell-spheres", "statue", "instances"] {
        let scene = bundled(name);
        let (mut same, mut count, mut met) = (0, 0, 0);
        let reference = Reference::new(&scene, &settings(8, 8, 1)).unwrap();
        for k in 0..8 {
            let side = 32_768;
            let crop =
                Crop { x: 4096 + k % 4 * 8000, y: 11_200 + k / 4 * 7600, width: 16, height: 16 };
            let settings = RenderSettings { crop: Some(crop), ..settings(side, side, 1) };
            for (i, hit) in hits(&scene, &settings, 4).iter().enumerate() {
                let (x, y) = (crop.x + i as u32 % 16, crop.y + i as u32 / 16);
                let ray = centre_ray(&scene.cameras[0], (side, side), x, y);
                let expected = exact(&scene, &reference, &ray);
                count += 1;
                met += usize::from(expected.is_some());
                let n = f64::from(hit.hit_count);
                let mean = |v: [f32; 3]| Vec3::from(v).as_dvec3() / n;
                same += usize::from(match expected {
                    None => hit.hit_count == 0 && hit.material == INVALID,
                    Some((material, t, ng, ns)) => {
                        material == hit.material
                            && hit.hit_count == 4
                            && (f64::from(hit.depth) / n / t - 1.0).abs() < 2e-3
                            && (mean(hit.geometric_normal) - ng).length() < 2e-2
                            && is_shading_normal(
                                mean(hit.shading_normal),
                                ns,
                                ng,
                                -ray.d.as_dvec3(),
                            )
                    }
                });
            }
        }
        println!("{name}: {same} of {count} pixels, {met} of which meet something");
        assert!(met > count / 4, "{name}: the windows look past the scene");
        assert!(same * 100 >= count * 98, "{name}: {same} of {count}");
    }
}

/// The device's walk with a thread for each ray: both boxes of a node are tested before its leaves.
fn walk(bvh: &Bvh, primitives: &[Primitive], ray: &Ray) -> TraversalCounts {
    let grid = GridRay::<false>::prepare(bvh, ray.o, ray.d);
    let mut best: Option<ItemHit> = None;
    let mut counts = TraversalCounts::default();
    let mut pending = vec![Some(Link::Inner { node: 0 })];
    while let Some(link) = pending.pop() {
        match link.expect("a link") {
            Link::Inner { node } => {
                counts.nodes += 1;
                let [a, b] = &bvh.nodes[node as usize].children;
                let t_max = best.map_or(ray.t_max, |hit| hit.t);
                let entries = [a, b].map(|child| grid.entry(child, t_max));
                match entries {
                    [Some(near), Some(far)] if far < near => {
                        pending.extend([a.target(), b.target()]);
                    }
                    [Some(_), Some(_)] => pending.extend([b.target(), a.target()]),
                    [Some(_), None] => pending.push(a.target()),
                    [None, Some(_)] => pending.push(b.target()),
                    [None, None] => {}
                }
            }
            Link::Leaf { first, count, .. } => {
                for &item in &bvh.order[first as usize..(first + count) as usize] {
                    counts.items += 1;
                    let t = primitives[item as usize].hit::<false>(ray, ray.t_max);
                    let hit = t.map(|t| ItemHit { t, item });
                    best = match (best, hit) {
                        (Some(best), Some(hit)) if !hit.is_before(&best) => Some(best),
                        (best, hit) => hit.or(best),
                    };
                }
            }
        }
    }
    counts
}

/// Counts of every pixel, by threads that walk alone.
fn visits(scene: &Scene, settings: &RenderSettings) -> Vec<(u64, u64)> {
    with_device(|device| {
        let buffers = SceneBuffers::build(scene, settings, TreeWidth::Two).unwrap();
        let uploaded = buffers.upload(&device).unwrap();
        let features = Features::of(scene, settings);
        let stack_size = buffers.world.stack_size.max(1);
        let frame = buffers.facts().frame(scene, settings);
        let tuning = Tuning::default();
        let mut hits = FirstHits::new(
            &device,
            &uploaded,
            features,
            Extras::visits(true),
            stack_size,
            frame,
            &tuning,
        )
        .unwrap();
        hits.run(&device, 1).unwrap();
        let of = |h: &GpuFirstHit| (u64::from(h.node_visits), u64::from(h.primitive_visits));
        hits.hits().iter().map(of).collect()
    })
}

#[test]
fn node_visits_are_those_of_the_walk() {
    let primitives = soup(3000, 200, &mut Random(5));
    let scene = scene_of(&primitives);
    let settings = settings(64, 48, 1);
    let bvh = build_sah(&items(&primitives));
    let found = visits(&scene, &settings);
    let (mut same, mut of_device, mut of_mirror) = (0, 0, 0);
    for (i, &(nodes, items)) in found.iter().enumerate() {
        let ray = centre_ray(&scene.cameras[0], (64, 48), i as u32 % 64, i as u32 / 64);
        let walked = walk(&bvh, &primitives, &ray);
        same += usize::from((nodes, items) == (walked.nodes, walked.items));
        // The mirror tests a node's leaves before the box of its other child.
        let (_, counts) = closest_hit_counted::<false>(&bvh, &ray, |_, item, t_max| {
            primitives[item as usize].hit::<false>(&ray, t_max)
        });
        of_device += nodes + items;
        of_mirror += counts.nodes + counts.items;
    }
    let ratio = of_device as f64 / of_mirror as f64;
    println!("{same} of {}, {of_device} visits, ratio to the mirror {ratio:.4}", found.len());
    // A box that a rounding decides about.
    assert!(same * 1000 >= found.len() * 995, "{same} of {}", found.len());
    assert!((1.0..1.01).contains(&ratio), "{ratio}");

    let brute_force = RenderSettings { accel: Accel::None, ..settings };
    assert!(visits(&scene, &brute_force).iter().all(|v| *v == (0, 3200)));
}

#[test]
fn views_have_the_colours_and_numbers_of_their_hits() {
    let scene = sphere_and_quad();
    let hits = hits(&scene, &settings(SIDE, SIDE, 1), 4);
    let size = (SIDE, SIDE);
    let of = |view| of_first_hits(view, &hits, size).unwrap();
    let shown = |view| DisplayTransform::default().srgb8(&of(view).picture.rgb);
    // The upper left corner is empty; the middle of the left edge of the quad is the quad's.
    let (empty, quad) = (0, 16 * SIDE as usize + 5);
    for view in [View::Normals, View::Albedo, View::Depth, View::Uv, View::Material] {
        assert_eq!(shown(view)[empty], [0, 0, 0, 255], "{view:?}");
    }
    assert_eq!(shown(View::Normals)[quad], [128, 128, 255, 255]);
    assert_eq!(shown(View::Albedo)[quad], [137, 188, 225, 255]);
    let depth = of(View::Depth);
    assert_eq!(depth.layer.channels[0].0, "Z");
    let ChannelData::F32(z) = &depth.layer.channels[0].1 else { panic!() };
    assert!(z[empty].is_infinite() && (z[quad] - 7.0).abs() < 1e-5, "{}", z[quad]);
    let ChannelData::F32(coverage) = &depth.layer.channels[1].1 else { panic!() };
    assert_eq!((coverage[empty], coverage[quad]), (0.0, 1.0));
    let middle = 16 * SIDE as usize + 16;
    assert_ne!(shown(View::Material)[middle], shown(View::Material)[quad]);
    let ChannelData::U32(ids) = &of(View::Material).layer.channels[0].1.clone() else { panic!() };
    assert_eq!([ids[empty], ids[quad], ids[middle]], [INVALID, 0, 1]);
    assert!(of_first_hits(View::StandardError, &hits, size).is_none());
}
