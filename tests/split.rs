//! Geometry over several bindings: the picture is the same.

mod common;

use common::{bundled, settings};
use std::sync::Arc;
use steradian::film::Film;
use steradian::gpu::{Device, SceneBuffers, TreeWidth};
use steradian::passes::Tuning;
use steradian::scene::Scene;
use steradian::settings::Accel;
use steradian::shader::{Feature, Features};
use steradian::{Error, RenderSettings, Renderer};

/// The film with tables of the geometry in bindings of at most `limit` bytes, and which of them
/// were split.
fn film(
    device: &mut Arc<Device>,
    scene: &Scene,
    settings: &RenderSettings,
    limit: u64,
    tuning: &Tuning,
) -> Result<(Film, Features), Error> {
    Arc::get_mut(device).unwrap().limit_geometry_bindings(limit);
    let mut renderer = Renderer::with_tuning(device.clone(), scene, settings, tuning)?;
    while renderer.step()? {}
    renderer.finish()?;
    let features = renderer.statistics().features;
    let split = [Feature::SplitNodes, Feature::SplitPrimitives, Feature::SplitAttributes];
    let split =
        split.into_iter().fold(Features::default(), |set, f| set.with_if(f, features.has(f)));
    Ok((renderer.film().clone(), split))
}

/// Bytes of the table of that name.
fn bytes(scene: &Scene, settings: &RenderSettings, device: &Device, name: &str) -> u64 {
    let width = if device.traces_packets() { TreeWidth::Four } else { TreeWidth::Two };
    let sizes = SceneBuffers::build(scene, settings, width).unwrap().sizes();
    sizes.iter().find(|(n, _)| *n == name).unwrap().1 as u64
}

/// In a tree with spheres, in one with instances, and without any tree.
#[test]
fn the_picture_does_not_depend_on_the_number_of_bindings() {
    use Feature::{SplitAttributes, SplitNodes, SplitPrimitives};
    let usual = Tuning::default();
    let mut device = Arc::new(Device::open(None).unwrap());
    let all = [SplitNodes, SplitPrimitives, SplitAttributes];
    for (name, accel, table, parts, expected) in [
        ("environment", Accel::Bvh, "primitives", 4, &all[..]),
        ("instances", Accel::Bvh, "nodes", 2, &[SplitNodes]),
        ("cornell-box", Accel::None, "attributes", 4, &[SplitPrimitives, SplitAttributes]),
    ] {
        let scene = bundled(name);
        let settings = RenderSettings { accel, ..settings(24, 16, 4) };
        let (whole, split) = film(&mut device, &scene, &settings, u64::MAX, &usual).unwrap();
        assert_eq!(split, Features::default(), "{name}");
        let size = bytes(&scene, &settings, &device, table);
        let limit = size.div_ceil(parts);
        let (film, split) = film(&mut device, &scene, &settings, limit, &usual).unwrap();
        let expected = expected.iter().fold(Features::default(), |set, &f| set.with(f));
        assert_eq!(split, expected, "{name}");
        assert!(film.picture() == whole.picture(), "{name} in bindings of {limit} bytes");
    }
}

/// A kernel that takes one binding for another is caught.
#[test]
fn a_wrong_binding_is_seen() {
    let mut device = Arc::new(Device::open(None).unwrap());
    let settings = settings(16, 16, 2);
    for (name, table, parts, module, right, wrong) in [
        (
            "cornell-box",
            "attributes",
            4,
            "geometry/primitive",
            "primitives_2[i]",
            "primitives_1[i]",
        ),
        (
            "cornell-box",
            "attributes",
            4,
            "geometry/attributes",
            "attributes_1[i]",
            "attributes_2[i]",
        ),
        ("instances", "nodes", 2, "geometry/nodes", "nodes_1[index]", "nodes[index]"),
    ] {
        let scene = bundled(name);
        let limit = bytes(&scene, &settings, &device, table).div_ceil(parts);
        let mut film = |tuning| film(&mut device, &scene, &settings, limit, tuning).unwrap().0;
        let usual = Tuning::default();
        let sound = film(&usual);
        let mut defect = Tuning::default();
        let text = defect.library.get_mut(module).unwrap();
        assert!(text.contains(right));
        *text = text.replace(right, wrong).into();
        assert!(film(&defect).picture() != sound.picture(), "{wrong}");
    }
}

#[test]
fn geometry_beyond_all_bindings_is_refused_with_the_remedy() {
    let mut device = Arc::new(Device::open(None).unwrap());
    let (scene, settings) = (bundled("cornell-box"), settings(16, 16, 1));
    let limit = bytes(&scene, &settings, &device, "primitives") / 4 - 16;
    let result = film(&mut device, &scene, &settings, limit, &Tuning::default());
    let Err(error) = result else { panic!("it fits") };
    assert!(matches!(error, Error::Limit(_)), "{error}");
    let message = error.to_string();
    assert!(message.contains("4 bindings of 0.0 MiB"), "{message}");
    assert!(message.contains("instanced triangles"), "{message}");
}
