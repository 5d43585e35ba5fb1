//! What the loader makes of valid files: geometry, nodes, cameras, lights.

mod gltf_fixture;

use glam::{Mat3, Vec2, Vec3, Vec4};
use gltf_fixture::*;
use serde_json::json;
use std::f32::consts::FRAC_PI_3;
use steradian::scene::gltf::load;
use steradian::scene::{LightKind, Projection, Scene, Treatment};

/// World positions of the corners of the scene's triangles.
fn world_triangles(scene: &Scene) -> Vec<[Vec3; 3]> {
    let mut triangles = Vec::new();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh as usize];
        for t in &mesh.triangles {
            let corner =
                |i: u32| instance.world_from_object.transform_point3(mesh.positions[i as usize]);
            triangles.push(t.map(corner));
        }
    }
    triangles
}

fn geometric_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a).normalize()
}

#[test]
fn a_triangle_without_material_gets_the_default_one() {
    let scene = Fixture::triangle().scene();
    assert_eq!(scene.name, "scene");
    assert_eq!(world_triangles(&scene), [[Vec3::ZERO, Vec3::X * 2.0, Vec3::Y]]);
    assert_eq!(scene.meshes[0].normals, []);
    assert_eq!(scene.materials.len(), 1);
    assert_eq!((scene.materials[0].metallic, scene.materials[0].roughness), (1.0, 1.0));
    assert_eq!(scene.notices, []);
}

#[test]
fn a_gltf_file_with_an_external_and_a_data_buffer() {
    let fixture = Fixture::empty();
    fixture.write("a b.bin", &bytes_of(&CORNERS));
    let mut json = fixture.json.clone();
    json["buffers"] = json!([
        {"byteLength": 36, "uri": "a%20b.bin"},
        {"byteLength": 3, "uri": "data:application/octet-stream;base64,AAECAA=="},
    ]);
    json["bufferViews"] = json!([{"buffer": 0, "byteLength": 36}, {"buffer": 1, "byteLength": 3}]);
    json["accessors"] = json!([
        {"bufferView": 0, "componentType": FLOAT, "count": 3, "type": "VEC3"},
        {"bufferView": 1, "componentType": UNSIGNED_BYTE, "count": 3, "type": "SCALAR"},
    ]);
    json["meshes"] = json!([{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]);
    json["nodes"] = json!([{"mesh": 0}]);
    json["scenes"] = json!([{"nodes": [0]}]);
    let scene = load(&fixture.write("scene.gltf", json.to_string().as_bytes())).unwrap();
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
    assert_eq!(scene.meshes[0].positions[1], Vec3::X * 2.0);
}

#[test]
fn strips_and_fans_face_one_way_and_lines_are_ignored() {
    let square = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    for (mode, order) in [(5, [0, 1, 2, 3]), (6, [0, 1, 3, 2])] {
        let mut fixture = Fixture::triangle();
        let positions = fixture.floats("VEC3", &square);
        fixture.attribute("POSITION", positions);
        fixture.indices(&order);
        fixture.primitive()["mode"] = json!(mode);
        let triangles = world_triangles(&fixture.scene());
        assert_eq!(triangles.len(), 2, "mode {mode}");
        let area: f32 =
            triangles.iter().map(|[a, b, c]| (*b - *a).cross(*c - *a).length() / 2.0).sum();
        assert_eq!(area, 1.0, "mode {mode}");
        assert!(triangles.iter().all(|&t| geometric_normal(t) == Vec3::Z), "mode {mode}");
    }

    let mut fixture = Fixture::triangle();
    let lines = json!({"attributes": {"POSITION": 0}, "mode": 1});
    fixture.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(lines);
    let scene = fixture.scene();
    assert_eq!(scene.meshes.len(), 1);
    assert!(has_notice(&scene, Treatment::Ignored, "points and lines"));
}

#[test]
fn interleaved_attributes_are_read_by_their_stride() {
    let mut fixture = Fixture::triangle();
    let mut rows = Vec::new();
    for corner in CORNERS.chunks_exact(3) {
        rows.extend([corner[0], corner[1], corner[2], 0.0, 0.0, 5.0]);
    }
    let view = fixture.view(&bytes_of(&rows));
    fixture.json["bufferViews"][view]["byteStride"] = json!(24);
    for (name, offset) in [("POSITION", 0), ("NORMAL", 12)] {
        let accessor = json!({
            "bufferView": view, "byteOffset": offset,
            "componentType": FLOAT, "count": 3, "type": "VEC3",
        });
        let accessor = fixture.push("accessors", accessor);
        fixture.attribute(name, accessor);
    }
    let mesh = &fixture.scene().meshes[0];
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y]);
    // Of length 5 in the file.
    assert_eq!(mesh.normals, [Vec3::Z; 3]);
}

#[test]
fn sparse_accessors_replace_elements_of_their_base_or_of_zeros() {
    let mut fixture = Fixture::triangle();
    let indices = fixture.view(&[1, 2]);
    let values = fixture.view(&bytes_of(&[3.0, 0.0, 0.0, 0.0, 4.0, 0.0]));
    let sparse = json!({
        "count": 2,
        "indices": {"bufferView": indices, "componentType": UNSIGNED_BYTE},
        "values": {"bufferView": values},
    });
    fixture.json["accessors"][0]["sparse"] = sparse;
    let expected = [Vec3::ZERO, Vec3::X * 3.0, Vec3::Y * 4.0];
    assert_eq!(fixture.scene().meshes[0].positions, expected);

    fixture.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    fixture.json["accessors"][0]["sparse"]["count"] = json!(1);
    assert_eq!(fixture.scene().meshes[0].positions, [Vec3::ZERO, Vec3::X * 3.0, Vec3::ZERO]);
}

#[test]
fn integers_are_converted_and_normalised() {
    let mut fixture = Fixture::triangle();
    let uvs = fixture.accessor(UNSIGNED_BYTE, "VEC2", 3, &[0, 0, 255, 51, 0, 255]);
    fixture.json["accessors"][uvs]["normalized"] = json!(true);
    fixture.attribute("TEXCOORD_0", uvs);
    // Quantised positions are plain integers (KHR_mesh_quantization).
    let positions = fixture.accessor(BYTE, "VEC3", 3, &[0, 0, 0, 0xfe, 0, 0, 0, 5, 0]);
    fixture.attribute("POSITION", positions);
    fixture.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    fixture.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let scene = fixture.scene();
    assert_eq!(scene.meshes[0].uvs[0], [Vec2::ZERO, Vec2::new(1.0, 0.2), Vec2::Y]);
    assert_eq!(scene.meshes[0].positions, [Vec3::ZERO, Vec3::X * -2.0, Vec3::Y * 5.0]);
    assert!(has_notice(&scene, Treatment::Honoured, "KHR_mesh_quantization"));
}

#[test]
fn integers_may_be_written_as_floats() {
    let mut fixture = Fixture::triangle();
    fixture.json["accessors"][0]["count"] = json!(3.0);
    fixture.json["nodes"][0]["mesh"] = json!(0.0);
    assert_eq!(fixture.scene().meshes[0].positions.len(), 3);
}

#[test]
fn vertex_colours_are_opaque_without_alpha_and_clamped() {
    let mut fixture = Fixture::triangle();
    let colors = fixture.floats("VEC3", &[0.5, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, -1.0, 0.0]);
    fixture.attribute("COLOR_0", colors);
    let scene = fixture.scene();
    let expected = [Vec4::new(0.5, 0.0, 1.0, 1.0), Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::W];
    assert_eq!(scene.meshes[0].colors, expected);
    assert!(has_notice(&scene, Treatment::Approximated, "vertex colours outside [0, 1]"));
}

#[test]
fn normals_without_direction_are_replaced_with_a_notice() {
    let mut fixture = Fixture::triangle();
    let normals = fixture.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, f32::NAN, 0.0, 0.0]);
    fixture.attribute("NORMAL", normals);
    let scene = fixture.scene();
    assert_eq!(scene.meshes[0].normals, [Vec3::Z, Vec3::X, Vec3::Z]);
    assert!(has_notice(&scene, Treatment::Approximated, "normals without direction"));
}

#[test]
fn tangents_are_read_where_there_are_normals() {
    let mut fixture = Fixture::triangle();
    let rows = [0.0, 3.0, 0.0, -1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0];
    let tangents = fixture.floats("VEC4", &rows);
    fixture.attribute("TANGENT", tangents);
    assert_eq!(fixture.scene().meshes[0].tangents, []);

    let normals = fixture.floats("VEC3", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    fixture.attribute("NORMAL", normals);
    let x = Vec4::new(1.0, 0.0, 0.0, 1.0);
    assert_eq!(fixture.scene().meshes[0].tangents, [Vec4::new(0.0, 1.0, 0.0, -1.0), x, x]);
}

#[test]
fn nodes_that_share_a_mesh_are_instances_of_it() {
    let mut fixture = Fixture::triangle();
    let second = fixture.primitive().clone();
    fixture.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(second);
    fixture.json["meshes"][0]["name"] = json!("Chair");
    fixture.json["nodes"][0]["name"] = json!("left");
    fixture.node(json!({"name": "right", "mesh": 0, "translation": [3.0, 0.0, 0.0]}));
    let scene = fixture.scene();
    let names: Vec<&str> = scene.meshes.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["Chair, primitive 0", "Chair, primitive 1"]);
    let instances: Vec<_> = scene.instances.iter().map(|i| (i.name.as_str(), i.mesh)).collect();
    assert_eq!(instances, [("left", 0), ("left", 1), ("right", 0), ("right", 1)]);
    assert_eq!(scene.bounds().unwrap().1.x, 5.0);
}

#[test]
fn transforms_of_parents_apply_and_mirrors_stay_mirrored() {
    let mut fixture = Fixture::triangle();
    fixture.json["nodes"][0]["scale"] = json!([-1.0, 1.0, 1.0]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let parent = json!({
        "children": [0], "translation": [0.0, 0.0, 7.0],
        // A quarter turn about +Y takes +X to -Z; its length is not 1.
        "rotation": [0.0, half * 1.01, 0.0, half * 1.01], "scale": [2.0, 2.0, 2.0],
    });
    let parent = fixture.push("nodes", parent);
    fixture.json["scenes"][0]["nodes"] = json!([parent]);
    let scene = fixture.scene();
    let [_, corner, _] = world_triangles(&scene)[0];
    assert!(corner.distance(Vec3::new(0.0, 0.0, 11.0)) < 1e-5, "{corner}");
    assert!(scene.instances[0].world_from_object.matrix3.determinant() < 0.0);
}

#[test]
fn a_matrix_is_read_by_columns() {
    let mut fixture = Fixture::triangle();
    let matrix: [f32; 16] = [0., 1., 0., 0., 1., 0., 0., 0., 0., 0., 1., 0., 10., 20., 30., 1.];
    fixture.json["nodes"][0]["matrix"] = json!(matrix);
    let [origin, corner, _] = world_triangles(&fixture.scene())[0];
    assert_eq!(origin, Vec3::new(10.0, 20.0, 30.0));
    assert_eq!(corner, Vec3::new(10.0, 22.0, 30.0));
}

#[test]
fn a_mesh_with_a_singular_transform_is_left_out() {
    let mut fixture = Fixture::triangle();
    fixture.node(json!({"mesh": 0, "scale": [1.0, 0.0, 1.0]}));
    let scene = fixture.scene();
    assert_eq!(scene.instances.len(), 1);
    assert!(has_notice(&scene, Treatment::Ignored, "singular transform"));
}

#[test]
fn the_default_scene_is_rendered_else_the_first_else_all_roots() {
    let mut fixture = Fixture::triangle();
    fixture.push("nodes", json!({"mesh": 0, "translation": [100.0, 0.0, 0.0]}));
    fixture.push("scenes", json!({"nodes": [1]}));
    let first_x = |fixture: &Fixture| world_triangles(&fixture.scene())[0][0].x;

    fixture.json["scene"] = json!(1);
    assert_eq!(first_x(&fixture), 100.0);
    fixture.json.as_object_mut().unwrap().remove("scene");
    assert_eq!(first_x(&fixture), 0.0);
    fixture.json.as_object_mut().unwrap().remove("scenes");
    assert_eq!(world_triangles(&fixture.scene()).len(), 2);
}

#[test]
fn degenerate_triangles_and_long_normals_are_told() {
    let mut fixture = Fixture::triangle();
    fixture.indices(&[0, 1, 2, 0, 1, 1, 2, 2, 2]);
    let normals = fixture.floats("VEC3", &[0.0, 0.0, 5.0, 0.0, 0.0, 1.006, 0.0, 0.0, 1.0]);
    fixture.attribute("NORMAL", normals);
    let scene = fixture.scene();
    assert_eq!(scene.meshes[0].triangles.len(), 3);
    let degenerate = "triangles without area: nothing hits them (2 times";
    assert!(has_notice(&scene, Treatment::Honoured, degenerate));
    let scaled = "normals of another length than 1: scaled (mesh 0";
    assert!(has_notice(&scene, Treatment::Approximated, scaled));
}

#[test]
fn a_sphere_replaces_its_triangles() {
    let mut fixture = Fixture::with_material(json!({"name": "glass"}));
    fixture.json["meshes"][0]["extras"] = json!({"steradian": {"sphere": {"radius": 0.5}}});
    fixture.json["nodes"][0] = json!({
        "mesh": 0, "name": "ball", "translation": [1.0, 2.0, 3.0],
        "rotation": [0.5, 0.5, 0.5, 0.5], "scale": [-3.0, 3.0, 3.0],
    });
    let scene = fixture.scene();
    assert!(scene.meshes.is_empty() && scene.instances.is_empty());
    let [sphere] = scene.spheres.as_slice() else { panic!("{} spheres", scene.spheres.len()) };
    assert_eq!((sphere.name.as_str(), sphere.radius), ("ball", 1.5));
    assert_eq!(sphere.center, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(scene.materials[sphere.material as usize].name, "glass");
    assert_eq!(scene.notices, []);
}

#[test]
fn a_sphere_with_alpha_is_noted() {
    let sphere = |mode: &str| {
        let mut fixture = Fixture::triangle();
        fixture.json["meshes"][0]["extras"] = json!({"steradian": {"sphere": {"radius": 0.5}}});
        fixture.json["materials"] = json!([{"alphaMode": mode}]);
        fixture.json["meshes"][0]["primitives"][0]["material"] = json!(0);
        let scene = fixture.scene();
        scene.notices.iter().any(|n| n.message.contains("alpha of an analytic sphere"))
    };
    assert!(sphere("BLEND") && sphere("MASK") && !sphere("OPAQUE"));
}

#[test]
fn a_sphere_too_small_for_its_place_is_noted() {
    // Between 8192 and 16384 an ulp is 2^-10; the bound is 2048 of them.
    for (radius, is_noted) in [(1.99, true), (2.0, false)] {
        let mut fixture = Fixture::triangle();
        let extras = json!({"steradian": {"sphere": {"radius": radius}}});
        fixture.json["meshes"][0]["extras"] = extras;
        fixture.json["nodes"][0]["translation"] = json!([10000.0, 0.0, 0.0]);
        let scene = fixture.scene();
        assert_eq!(has_notice(&scene, Treatment::Approximated, "too small"), is_noted, "{radius}");
    }
}

#[test]
fn cameras_look_along_minus_z_without_the_scale_of_their_node() {
    let mut fixture = Fixture::triangle();
    fixture.push(
        "cameras",
        json!({
            "name": "lens", "type": "perspective",
            "perspective": {"yfov": FRAC_PI_3, "znear": 0.1, "aspectRatio": 2.0},
            "extras": {"steradian": {"apertureRadius": 0.02, "focusDistance": 4.0}},
        }),
    );
    fixture.push(
        "cameras",
        json!({
            "type": "orthographic",
            "orthographic": {"xmag": 3.0, "ymag": 2.0, "znear": 0.1, "zfar": 10.0},
        }),
    );
    fixture.node(json!({"camera": 0, "translation": [0.0, 0.0, 5.0], "scale": [2.0, 2.0, -3.0]}));
    fixture.node(json!({"name": "top", "camera": 1, "translation": [4.0, 0.5, 8.0]}));
    let cameras = fixture.scene().cameras;

    assert_eq!(cameras.len(), 2);
    assert_eq!(cameras[0].name, "lens");
    assert_eq!(cameras[0].projection, Projection::Perspective { yfov: FRAC_PI_3 });
    assert_eq!(cameras[0].aspect_ratio, Some(2.0));
    assert_eq!((cameras[0].aperture_radius, cameras[0].focus_distance), (0.02, 4.0));
    // A scale of -3 turns the view round; the frame stays right-handed.
    let turned = Mat3::from_rotation_y(std::f32::consts::PI);
    let rotation = Mat3::from(cameras[0].world_from_camera.matrix3);
    assert!(rotation.abs_diff_eq(turned, 1e-6), "{rotation}");

    assert_eq!(cameras[1].name, "top");
    assert_eq!(cameras[1].projection, Projection::Orthographic { ymag: 2.0 });
    assert_eq!(cameras[1].aspect_ratio, Some(1.5));
    assert_eq!(cameras[1].aperture_radius, 0.0);
    // The center of the bounds is (1, ½, 0); the distance is along the view axis.
    assert_eq!(cameras[1].focus_distance, 8.0);
}

#[test]
fn without_a_camera_the_default_one_sees_the_whole_scene() {
    let scene = Fixture::triangle().scene();
    let [camera] = scene.cameras.as_slice() else { panic!("one camera") };
    let Projection::Perspective { yfov } = camera.projection else { panic!("perspective") };
    let (lo, hi) = scene.bounds().unwrap();
    let camera_from_world = camera.world_from_camera.inverse();
    let limit = (yfov / 2.0).tan();
    let mut largest = 0.0_f32;
    for corner in [lo, hi, Vec3::new(lo.x, hi.y, lo.z), Vec3::new(hi.x, lo.y, hi.z)] {
        let p = camera_from_world.transform_point3(corner);
        assert!(p.z < 0.0, "{corner} is behind the camera");
        largest = largest.max(p.x.abs().max(p.y.abs()) / -p.z);
    }
    assert!(largest <= limit, "{largest} of {limit}");
    assert!(largest > limit / 2.0, "the scene fills less than half: {largest} of {limit}");
    assert!(camera.world_from_camera.translation.z > hi.z, "not in front");
    assert!(camera.world_from_camera.translation.y > hi.y, "not above");
    assert!((camera.world_from_camera.matrix3.determinant() - 1.0).abs() < 1e-6);
}

#[test]
fn punctual_lights_are_in_world_space() {
    let mut fixture = Fixture::triangle();
    fixture.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    fixture.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point", "name": "bulb", "color": [1.0, 0.5, 0.0], "intensity": 4.0, "range": 9.0,
         "extras": {"made by": "hand"}},
        {"type": "spot", "spot": {"innerConeAngle": 0.0, "outerConeAngle": FRAC_PI_3}},
        {"type": "directional", "intensity": -1.0},
    ]}});
    let half = std::f32::consts::FRAC_1_SQRT_2;
    for light in 0..3 {
        // A quarter turn about +X takes -Z to +Y.
        fixture.node(json!({
            "extensions": {"KHR_lights_punctual": {"light": light}},
            "translation": [1.0, 2.0, 3.0], "rotation": [half, 0.0, 0.0, half], "scale": [2.0, 2.0, 2.0],
        }));
    }
    let scene = fixture.scene();
    let position = Vec3::new(1.0, 2.0, 3.0);
    let is_up = |direction: Vec3| direction.distance(Vec3::Y) < 1e-6;
    assert_eq!(scene.lights.len(), 3);
    assert_eq!(scene.lights[0].name, "bulb");
    assert_eq!(scene.lights[0].intensity, Vec3::new(4.0, 2.0, 0.0));
    assert_eq!(scene.lights[0].kind, LightKind::Point { position, range: 9.0 });
    match scene.lights[1].kind {
        LightKind::Spot { position: p, direction, cos_inner, cos_outer, range } => {
            assert_eq!((p, cos_inner, range), (position, 1.0, f32::INFINITY));
            assert!(is_up(direction) && (cos_outer - 0.5).abs() < 1e-6);
        }
        other => panic!("{other:?}"),
    }
    assert!(
        matches!(scene.lights[2].kind, LightKind::Directional { direction } if is_up(direction))
    );
    assert_eq!(scene.lights[2].intensity, Vec3::ZERO);
    assert!(has_notice(&scene, Treatment::Approximated, "negative light"));
}

#[test]
fn the_scene_names_its_environment() {
    let mut fixture = Fixture::triangle();
    let environment = json!({"radiance": [1.0, 2.0, 3.0], "intensity": 0.5});
    let truth = json!({"radiance": [0.5, 1.0, 1.5]});
    fixture.json["scenes"][0]["extras"] =
        json!({"steradian": {"environment": environment, "truth": truth}});
    let constant = fixture.scene().environment.unwrap();
    assert_eq!((constant.radiance[0], constant.intensity), (Vec3::new(1.0, 2.0, 3.0), 0.5));

    let mut hdr = Vec::new();
    image::codecs::hdr::HdrEncoder::new(&mut hdr)
        .encode(&[image::Rgb([4.0, 2.0, 1.0]), image::Rgb([0.5, 0.0, 8.0])], 2, 1)
        .unwrap();
    fixture.write("sky.hdr", &hdr);
    let environment = json!({"uri": "sky.hdr", "rotation": 90.0});
    fixture.json["scenes"][0]["extras"] = json!({"steradian": {"environment": environment}});
    let sky = fixture.scene().environment.unwrap();
    assert_eq!((sky.name.as_str(), sky.width, sky.height), ("sky.hdr", 2, 1));
    assert_eq!(sky.radiance, [Vec3::new(4.0, 2.0, 1.0), Vec3::new(0.5, 0.0, 8.0)]);
    // Turned counter-clockwise seen from above, what was at +X is now at -Z.
    assert!((sky.environment_from_world * Vec3::NEG_Z).distance(Vec3::X) < 1e-6);
}

#[test]
fn what_has_no_effect_is_named() {
    let mut fixture = Fixture::triangle();
    let colors = fixture.floats("VEC3", &[0.5; 9]);
    fixture.attribute("COLOR_1", colors);
    fixture.attribute("_ID", colors);
    fixture.json["nodes"][0]["rotation"] = json!([0.0, 0.0, 0.0, 1.01]);
    fixture.json["materials"] = json!([{"pbrMetallicRoughness": {"metalicFactor": 0.0}}]);
    fixture.json["nodes"][0]["extensions"] = json!({"KHR_materials_ior": {"ior": 1.2}});
    fixture.json["extensions"] = json!({"KHR_xmp_json_ld": {"packets": []}});
    fixture.push("scenes", json!({"nodes": []}));
    let scene = fixture.scene();
    let has = |treatment, text: &str| {
        assert!(has_notice(&scene, treatment, text), "{text:?} is not in {:?}", scene.notices);
    };
    has(Treatment::Ignored, "vertex colours beyond COLOR_0 (meshes[0], primitives)");
    has(Treatment::Ignored, "\"metalicFactor\", which glTF 2.0 does not have (materials[0]");
    has(Treatment::Ignored, "KHR_materials_ior where it has no meaning (nodes[0])");
    has(Treatment::Approximated, "rotation whose length is not 1: normalised (node 0)");
    has(Treatment::Honoured, "KHR_xmp_json_ld: no part of the picture (the file)");
    has(Treatment::Honoured, "one of 2 scenes: the default (scene 0)");
    assert_eq!(scene.notices.len(), 6, "{:?}", scene.notices);
}
