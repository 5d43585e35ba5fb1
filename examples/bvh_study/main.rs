//! What a tree costs: to build, and the rays that walk it.
//!
//! ```sh
//! cargo run --release --example bvh_study -- SCENE [--side PIXELS] [--others] [--device] [--dump FILE]
//! ```
//!
//! Prints build speed, cost by the surface area heuristic, and what camera rays and two
//! generations of scattered rays touch on average: alone in the tree as built, and in packets of
//! eight, and alone, in the tree of four children a node. `--others` adds the presets of the `obvhs` crate;
//! `--device` rays per second of the shaders' walks on the device; `--dump` writes triangles and
//! rays for `tools/bvh_embree.py`. Instances are traced as copies of their meshes.

#[path = "../make_gallery/clock.rs"]
#[expect(dead_code, reason = "shared with an example that starts children")]
mod clock;
mod device;
mod other;
mod packets;
mod rays;
mod tree;

use clock::own_seconds;
use device::{Walk, rays_per_second};
use glam::Vec3;
use rays::{Eye, RaySets};
use std::path::Path;
use std::process::ExitCode;
use steradian::bvh::{Aabb, BuildItem, PrimitiveKind, Ray, build_sah};
use steradian::gpu::{Device, TreeWidth, World};
use steradian::scene::gltf::{LoadOptions, load_with};
use steradian::scene::{Instance, Projection, Scene};
use steradian::settings::Accel;
use tree::Tree;

/// One build is repeated until so many seconds of processor time have gone.
const LONG: f64 = 0.5;

type Failure = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[String]) -> Result<(), Failure> {
    let has = |flag: &str| arguments.iter().any(|a| a == flag);
    let value = |flag: &str| {
        let at = arguments.iter().position(|a| a == flag);
        at.and_then(|at| arguments.get(at + 1)).map(String::as_str)
    };
    let path = arguments.first().filter(|a| !a.starts_with("--")).ok_or("which scene?")?;
    let side: u32 = value("--side").unwrap_or("256").parse()?;
    let mut scene = load_with(Path::new(path), &LoadOptions::default())?;
    copy_instances(&mut scene);
    let triangles = triangles(&scene);
    println!("{path}: {} triangles", triangles.len());

    let item =
        |v: &[Vec3; 3]| BuildItem { bounds: Aabb::of_points(v), kind: PrimitiveKind::Triangle };
    let items: Vec<_> = triangles.iter().map(item).collect();
    let (seconds, bvh) = timed(|| build_sah(&items));
    println!("depth {}, {} nodes of 32 bytes", bvh.depth, bvh.nodes.len());
    let tree = Tree::from(&bvh);
    let sets = RaySets::new(&eye(&scene)?, side, &tree, &triangles, &lights(&scene));
    print_row("ours", &tree, seconds, &sets, &triangles);
    if has("--others") {
        for (name, params) in other::PRESETS {
            let (seconds, tree) = timed(|| other::build(&triangles, params));
            print_row(name, &tree, seconds, &sets, &triangles);
        }
    }
    print_packets(&scene, &sets)?;
    if has("--device") {
        print_device(&scene, &sets)?;
    }
    if let Some(file) = value("--dump") {
        std::fs::write(file, sets.dump(&triangles))?;
    }
    Ok(())
}

/// Gives every instance a mesh of its own in world space, so that there is one tree.
fn copy_instances(scene: &mut Scene) {
    let placed = |instance: &Instance| {
        let mut mesh = scene.meshes[instance.mesh as usize].clone();
        for p in &mut mesh.positions {
            *p = instance.world_from_object.transform_point3(*p);
        }
        mesh
    };
    let meshes: Vec<_> = scene.instances.iter().map(placed).collect();
    scene.meshes = meshes;
    for (index, instance) in scene.instances.iter_mut().enumerate() {
        instance.mesh = index as u32;
        instance.world_from_object = glam::Affine3A::IDENTITY;
    }
}

fn triangles(scene: &Scene) -> Vec<[Vec3; 3]> {
    let of_mesh = |instance: &Instance| {
        let mesh = &scene.meshes[instance.mesh as usize];
        mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize]))
    };
    scene.instances.iter().flat_map(of_mesh).collect()
}

/// Triangles that emit.
fn lights(scene: &Scene) -> Vec<[Vec3; 3]> {
    let emits = |instance: &&Instance| {
        let mesh = &scene.meshes[instance.mesh as usize];
        scene.materials[mesh.material as usize].is_emissive()
    };
    let of_mesh = |instance: &Instance| {
        let mesh = &scene.meshes[instance.mesh as usize];
        mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize]))
    };
    scene.instances.iter().filter(emits).flat_map(of_mesh).collect()
}

fn eye(scene: &Scene) -> Result<Eye, Failure> {
    let camera = &scene.cameras[0];
    let Projection::Perspective { yfov } = camera.projection else {
        return Err("the camera is orthographic".into());
    };
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    Ok(Eye {
        position: camera.world_from_camera.translation.into(),
        axes: axes.map(|axis| camera.world_from_camera.transform_vector3(axis).normalize()),
        half: (0.5 * yfov).tan(),
    })
}

/// Processor time of `build`, and what it built.
fn timed<T>(build: impl Fn() -> T) -> (f64, T) {
    let (begin, mut builds) = (own_seconds(), 0);
    loop {
        let built = build();
        builds += 1;
        let seconds = own_seconds() - begin;
        if seconds > LONG || seconds.is_nan() {
            return (seconds / f64::from(builds), built);
        }
    }
}

fn print_row(name: &str, tree: &Tree, seconds: f64, sets: &RaySets, triangles: &[[Vec3; 3]]) {
    let speed = triangles.len() as f64 / seconds / 1e6;
    let (cost, size) = (tree.sah_cost(1.0), tree.leaf_size());
    print!("{name:10} {speed:5.2} million a CPU second, SAH {cost:7.2}, {size:.2} in a leaf;");
    for (set, rays) in sets.named() {
        let touched = tree.walk(triangles, rays).0;
        print!(" {set} {:.2} nodes {:.2} triangles;", touched.nodes, touched.triangles);
    }
    println!();
}

fn print_packets(scene: &Scene, sets: &RaySets) -> Result<(), Failure> {
    let world = World::build(scene, Accel::Bvh, TreeWidth::Four)?;
    if world.statistics().instance_count + world.statistics().sphere_count > 0 {
        return Err("packets are counted in triangles alone".into());
    }
    let wide = packets::WideTree { nodes: &world.nodes, primitives: &world.primitives };
    let bytes = 16.0 * world.nodes.len() as f64 / world.statistics().triangle_count as f64;
    print!("packets: {bytes:.1} bytes of nodes a triangle, stack {};", world.stack_size);
    for (set, rays) in sets.named() {
        let touched = wide.walk(rays, 8, set == "shadow");
        let alone = wide.walk(rays, 1, set == "shadow");
        print!(" {set} {:.2} nodes {:.2} triangles", touched.nodes, touched.triangles);
        print!(" (one ray {:.2}, {:.2});", alone.nodes, alone.triangles);
    }
    println!();
    Ok(())
}

fn print_device(scene: &Scene, sets: &RaySets) -> Result<(), Failure> {
    let device = Device::open(None)?;
    println!("{}, {}", device.info().name, device.info().driver.trim());
    let ways: &[(&str, bool)] = match device.traces_packets() {
        true => &[("packets", true), ("lanes", false)],
        false => &[("lanes", false)],
    };
    for &(way, packets) in ways {
        for (set, rays) in sets.named() {
            let walk = Walk { packets, any: set == "shadow" };
            let (speed, found) = rays_per_second(&device, scene, rays, walk)?;
            let sum: f64 = found.iter().map(|&t| f64::from(t.min(1e3))).sum();
            println!("{way} {set} {:.4e} rays a CPU second, sum {sum:.6e}", speed);
        }
    }
    Ok(())
}

impl RaySets {
    /// The sets by name; of shadow rays any hit is asked for.
    fn named(&self) -> [(&'static str, &[Ray]); 4] {
        let Self { camera, bounce, shadow, second } = self;
        [("camera", camera), ("bounce", bounce), ("shadow", shadow), ("second", second)]
    }

    /// Little endian: counts of triangles and of the rays of each set, u32; nine f32 a triangle;
    /// origin, direction and end, seven f32 a ray.
    fn dump(&self, triangles: &[[Vec3; 3]]) -> Vec<u8> {
        let counts = self.named().map(|(_, rays)| rays.len() as u32);
        let mut words: Vec<u32> = [triangles.len() as u32].into_iter().chain(counts).collect();
        let corners = triangles.iter().flatten().flat_map(|v| v.to_array());
        words.extend(corners.map(f32::to_bits));
        for (_, rays) in self.named() {
            let numbers = |ray: &Ray| {
                let ([a, b, c], [d, e, f]) = (ray.o.to_array(), ray.d.to_array());
                [a, b, c, d, e, f, ray.t_max]
            };
            words.extend(rays.iter().flat_map(numbers).map(f32::to_bits));
        }
        words.into_iter().flat_map(u32::to_le_bytes).collect()
    }
}
