//! `steradian info`: what is in a scene and what becomes of it. Needs no device.

use super::flags::InfoFlags;
use super::job::find_camera;
use super::talk::{self, size};
use std::process::ExitCode;
use steradian::gpu::{Device, DeviceInfo, SceneBuffers, TreeWidth};
use steradian::scene::gltf::load_with;
use steradian::scene::{Animation, Camera, Environment, LightKind, Projection, Scene, Treatment};
use steradian::shader::Features;
use steradian::{RenderSettings, Result};

/// Prints lines of a subject and what is to be said about it.
pub(super) fn run(flags: &InfoFlags) -> Result<ExitCode> {
    let scene = load_with(&flags.scene, &flags.reading.options())?;
    if let Some(selector) = &flags.dump_camera {
        let camera = find_camera(&scene.cameras, "--dump-camera", Some(selector))?;
        talk::data(&scene.cameras[camera].to_json())?;
        return Ok(ExitCode::SUCCESS);
    }
    let settings = RenderSettings::default();
    let mut lines = contents(&scene);
    lines.extend(scene.cameras.iter().enumerate().map(|(i, c)| ("camera", camera(i, c))));
    lines.extend(scene.animations.iter().enumerate().map(|(i, a)| ("animation", animation(i, a))));
    lines.extend(notices(&scene));
    lines.push(("features", Features::of(&scene, &settings).to_string()));
    let buffers = SceneBuffers::build(&scene, &settings, TreeWidth::Two)?;
    lines.push(("tree", tree(&buffers)));
    lines.extend(memory(&buffers, flags.device.as_deref()));
    let text: String = lines.iter().map(|(name, text)| format!("{name:<13} {text}\n")).collect();
    talk::data(&text)?;
    Ok(ExitCode::SUCCESS)
}

type Line = (&'static str, String);

fn contents(scene: &Scene) -> Vec<Line> {
    let stored: usize = scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    let placed = scene.primitive_count() - scene.spheres.len();
    let texels: u64 = scene.images.iter().map(|i| u64::from(i.width) * u64::from(i.height)).sum();
    let largest = scene.images.iter().max_by_key(|i| i.width.max(i.height));
    let largest =
        largest.map_or(String::new(), |i| format!(", the largest {}x{}", i.width, i.height));
    let bounds = scene.bounds().map_or("none".to_owned(), |(low, high)| {
        format!("{} {} {} to {} {} {} m", low.x, low.y, low.z, high.x, high.y, high.z)
    });
    vec![
        ("scene", scene.name.clone()),
        ("bounds", bounds),
        ("meshes", format!("{}, placed {} times", scene.meshes.len(), scene.instances.len())),
        ("triangles", format!("{stored}, after instancing {placed}")),
        ("spheres", scene.spheres.len().to_string()),
        ("materials", scene.materials.len().to_string()),
        ("variants", variants(scene)),
        ("images", format!("{}, {texels} texels{largest}", scene.images.len())),
        ("lights", lights(scene)),
        ("environment", scene.environment.as_ref().map_or("none".into(), environment)),
    ]
}

fn variants(scene: &Scene) -> String {
    match scene.variants.is_empty() {
        true => "none".to_owned(),
        false => scene.variants.join(", "),
    }
}

fn lights(scene: &Scene) -> String {
    let emits = |material: u32| scene.materials[material as usize].is_emissive();
    let meshes = scene.instances.iter().map(|i| &scene.meshes[i.mesh as usize]);
    let triangles: usize = meshes.filter(|m| emits(m.material)).map(|m| m.triangles.len()).sum();
    let spheres = scene.spheres.iter().filter(|s| emits(s.material)).count();
    let count = |is_kind: fn(&LightKind) -> bool| {
        scene.lights.iter().filter(|light| is_kind(&light.kind)).count()
    };
    format!(
        "{triangles} emissive triangles, {spheres} emissive spheres, {} point, {} spot, {} directional",
        count(|kind| matches!(kind, LightKind::Point { .. })),
        count(|kind| matches!(kind, LightKind::Spot { .. })),
        count(|kind| matches!(kind, LightKind::Directional { .. })),
    )
}

fn environment(environment: &Environment) -> String {
    let Environment { name, width, height, intensity, .. } = environment;
    format!("{name}, {width}x{height}, intensity {intensity}")
}

fn camera(index: usize, camera: &Camera) -> String {
    let projection = match camera.projection {
        Projection::Perspective { yfov } => {
            format!("perspective, {:.2} degrees high", yfov.to_degrees())
        }
        Projection::Orthographic { ymag } => format!("orthographic, {} m high", 2.0 * ymag),
    };
    let lens = match camera.aperture_radius {
        0.0 => "pinhole".to_owned(),
        radius => format!("lens of radius {radius} m in focus at {} m", camera.focus_distance),
    };
    let aspect_ratio = camera.aspect_ratio.map_or(String::new(), |a| format!(", aspect ratio {a}"));
    format!("{index} {:?}, {projection}{aspect_ratio}, {lens}", camera.name)
}

fn animation(index: usize, animation: &Animation) -> String {
    let duration = match animation.duration.is_nan() {
        true => "cannot be read".to_owned(),
        false => format!("{} s", animation.duration),
    };
    format!("{index} {:?}, {duration}", animation.name)
}

fn notices(scene: &Scene) -> impl Iterator<Item = Line> {
    scene.notices.iter().map(|notice| {
        let name = match notice.treatment {
            Treatment::Honoured => "honoured",
            Treatment::Approximated => "approximated",
            Treatment::Ignored => "ignored",
        };
        (name, notice.message.clone())
    })
}

fn tree(buffers: &SceneBuffers) -> String {
    let s = buffers.world.statistics();
    format!(
        "{} triangles, {} spheres, {} instances in {} nodes, depth {}, SAH cost {:.1}",
        s.triangle_count, s.sphere_count, s.instance_count, s.node_count, s.tree_depth, s.sah_cost
    )
}

/// What the device must hold, and for each device whether it can.
fn memory(buffers: &SceneBuffers, selector: Option<&str>) -> Vec<Line> {
    let sizes = buffers.sizes();
    let total: usize = sizes.iter().map(|(_, bytes)| bytes).sum();
    let parts = sizes.iter().filter(|(_, bytes)| *bytes > 0);
    let parts: Vec<_> =
        parts.map(|(name, bytes)| format!("{name} {}", size(*bytes as u64))).collect();
    let mut lines = vec![("memory", format!("{}: {}", size(total as u64), parts.join(", ")))];
    let devices = match selector {
        Some(_) => Device::open(selector).map(|device| vec![device.info().clone()]),
        None => Ok(Device::list()),
    };
    match devices {
        Ok(devices) if !devices.is_empty() => {
            lines.extend(devices.iter().map(|device| ("device", fit(buffers, device))));
        }
        Ok(_) => lines.push(("device", "none found, so no limits to compare with".into())),
        Err(error) => lines.push(("device", error.to_string())),
    }
    lines
}

fn fit(buffers: &SceneBuffers, device: &DeviceInfo) -> String {
    let verdict = match buffers.split_for(device) {
        Ok(split) if split == Features::default() => "the scene fits".to_owned(),
        Ok(split) => format!("the scene fits, over several bindings: {split}"),
        Err(error) => format!("the scene does not fit: {error}"),
    };
    let limit = device.max_binding_size;
    format!("{} {}, {} in a binding: {verdict}", device.index, device.name, size(limit))
}
