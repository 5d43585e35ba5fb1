//! Morph targets, skins, animations, instancing and visibility, each against positions
//! that are known.

mod gltf_fixture;

use glam::{Vec3, Vec4};
use gltf_fixture::*;
use serde_json::{Value, json};
use std::f32::consts::FRAC_1_SQRT_2;
use steradian::scene::gltf::{LoadOptions, load_with};
use steradian::scene::{Scene, Treatment};

const X: [f32; 3] = [1.0, 0.0, 0.0];

/// World positions of the vertices of all instances.
fn vertices(scene: &Scene) -> Vec<Vec3> {
    let placed = scene.instances.iter().flat_map(|instance| {
        let mesh = &scene.meshes[instance.mesh as usize];
        mesh.positions.iter().map(|&p| instance.world_from_object.transform_point3(p))
    });
    placed.collect()
}

#[track_caller]
fn assert_near(found: &[Vec3], expected: &[[f32; 3]]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!(found.distance(Vec3::from(*expected)) < 1e-5, "{found} is not {expected:?}");
    }
}

fn at(fixture: &Fixture, time: f64, animation: Option<&str>) -> steradian::Result<Scene> {
    let options = LoadOptions {
        frame_time: Some(time),
        animation: animation.map(Into::into),
        ..LoadOptions::default()
    };
    load_with(&fixture.write("scene.glb", &fixture.glb()), &options)
}

/// The triangle with two morph targets: by +X, and by +Z with normals from +Z to +Y.
fn morphed() -> Fixture {
    let mut fixture = Fixture::triangle();
    let normals = fixture.floats("VEC3", &[0., 0., 1., 0., 0., 1., 0., 0., 1.]);
    fixture.attribute("NORMAL", normals);
    let by_x = fixture.floats("VEC3", &[1., 0., 0., 1., 0., 0., 1., 0., 0.]);
    let by_z = fixture.floats("VEC3", &[0., 0., 1., 0., 0., 1., 0., 0., 1.]);
    let to_y = fixture.floats("VEC3", &[0., 1., -1., 0., 1., -1., 0., 1., -1.]);
    fixture.primitive()["targets"] =
        json!([{"POSITION": by_x}, {"POSITION": by_z, "NORMAL": to_y}]);
    fixture
}

#[test]
fn morph_targets_by_the_weights_of_mesh_and_node() {
    let mut fixture = morphed();
    let rest = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert_near(&vertices(&fixture.scene()), &rest);
    fixture.json["meshes"][0]["weights"] = json!([0.5, 2.0]);
    let scene = fixture.scene();
    assert_near(&vertices(&scene), &[[0.5, 0.0, 2.0], [2.5, 0.0, 2.0], [0.5, 1.0, 2.0]]);
    // z goes from 1 to -1, y from 0 to 2.
    let normal = Vec3::new(0.0, 2.0, -1.0).normalize();
    assert!(scene.meshes[0].normals.iter().all(|n| n.distance(normal) < 1e-6));
    // A node's weights stand in place of the mesh's: two nodes, two shapes.
    fixture.json["nodes"][0]["weights"] = json!([-1.0, 0.0]);
    fixture.node(json!({"mesh": 0}));
    fixture.node(json!({"mesh": 0}));
    let scene = fixture.scene();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (2, 3));
    assert_near(&vertices(&scene)[..3], &[[-1.0, 0.0, 0.0], X, [-1.0, 1.0, 0.0]]);
    assert_eq!(scene.notices, []);
}

#[test]
fn quantised_morph_targets() {
    let mut fixture = Fixture::triangle();
    let deltas = [127, 0, 0, 0x81, 0, 0, 0, 127, 0];
    let deltas = fixture.accessor(BYTE, "VEC3", 3, &deltas);
    fixture.json["accessors"][deltas]["normalized"] = json!(true);
    fixture.primitive()["targets"] = json!([{"POSITION": deltas}]);
    fixture.json["meshes"][0]["weights"] = json!([1.0]);
    assert_near(&vertices(&fixture.scene()), &[X, X, [0.0, 2.0, 0.0]]);
}

#[test]
fn broken_morph_targets() {
    let mut fixture = morphed();
    fixture.json["meshes"][0]["weights"] = json!([1.0]);
    assert_contains(&fixture.refusal(), "primitive 0: 1 weights for 2 morph targets");
    let mut fixture = morphed();
    fixture.json["meshes"][0]["weights"] = json!([1.0, 0.0]);
    let short = fixture.floats("VEC3", &[0.0; 6]);
    fixture.primitive()["targets"][0]["POSITION"] = json!(short);
    let message = "morph target 0, POSITION has 2 elements for 3 vertices";
    assert_contains(&fixture.refusal(), message);
}

/// The triangle on two joints: nodes 1, at the origin, and 2, at (0, 0, 1). Its own node is
/// far away, which must not matter. Vertex 0 follows joint 0, vertex 1 joint 1, vertex 2 both.
fn skinned() -> Fixture {
    let mut fixture = Fixture::triangle();
    let joints = [0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0];
    let joints = fixture.accessor(UNSIGNED_BYTE, "VEC4", 3, &joints);
    fixture.attribute("JOINTS_0", joints);
    let weights = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0];
    let weights = fixture.floats("VEC4", &weights);
    fixture.attribute("WEIGHTS_0", weights);
    fixture.json["nodes"][0]["translation"] = json!([100.0, 0.0, 0.0]);
    fixture.json["nodes"][0]["skin"] = json!(0);
    fixture.node(json!({}));
    fixture.node(json!({"translation": [0.0, 0.0, 1.0]}));
    fixture.json["skins"] = json!([{"joints": [1, 2]}]);
    fixture
}

#[test]
fn a_skin_takes_vertices_where_its_joints_are() {
    let mut fixture = skinned();
    let expected = [[0.0, 0.0, 0.0], [2.0, 0.0, 1.0], [0.0, 1.0, 0.5]];
    assert_near(&vertices(&fixture.scene()), &expected);
    // Bound where they are, the joints move nothing.
    let mut matrices = [0.0; 32];
    for diagonal in [0, 5, 10, 15, 16, 21, 26, 31] {
        matrices[diagonal] = 1.0;
    }
    matrices[16 + 14] = -1.0;
    let matrices = fixture.accessor(FLOAT, "MAT4", 2, &bytes_of(&matrices));
    fixture.json["skins"][0]["inverseBindMatrices"] = json!(matrices);
    let rest = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let scene = fixture.scene();
    assert_near(&vertices(&scene), &rest);
    assert_eq!(scene.notices, []);
}

#[test]
fn normals_and_tangents_follow_their_joints() {
    let mut fixture = skinned();
    let normals = fixture.floats("VEC3", &[1., 0., 0., 1., 0., 0., 1., 0., 0.]);
    let tangents = fixture.floats("VEC4", &[0., 1., 0., 1., 0., 1., 0., 1., 0., 1., 0., 1.]);
    fixture.attribute("NORMAL", normals);
    fixture.attribute("TANGENT", tangents);
    // Both joints mirror z and shear x along y: normals by the inverse transpose.
    let matrix = [1., 0., 0., 0., 1., 1., 0., 0., 0., 0., -1., 0., 0., 0., 0., 1.];
    fixture.json["nodes"][1] = json!({"matrix": matrix});
    fixture.json["nodes"][2] = json!({"matrix": matrix});
    let scene = fixture.scene();
    let mesh = &scene.meshes[0];
    assert_near(&vertices(&scene), &[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    let normal = Vec3::new(FRAC_1_SQRT_2, -FRAC_1_SQRT_2, 0.0);
    assert!(mesh.normals.iter().all(|n| n.distance(normal) < 1e-6), "{:?}", mesh.normals);
    let tangent = Vec4::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0, -1.0);
    assert!(mesh.tangents.iter().all(|t| t.distance(tangent) < 1e-6), "{:?}", mesh.tangents);
    // What is mirrored keeps its front.
    assert_eq!(mesh.triangles, [[0, 2, 1]]);
}

#[test]
fn skin_weights_of_a_second_set_and_of_other_sums() {
    let mut fixture = skinned();
    let joints = fixture.accessor(UNSIGNED_BYTE, "VEC4", 3, &[1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0]);
    let weights = fixture.floats("VEC4", &[1., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0.]);
    fixture.attribute("JOINTS_1", joints);
    fixture.attribute("WEIGHTS_1", weights);
    let scene = fixture.scene();
    // Vertex 0 now has a weight of 1 on both joints.
    assert_near(&vertices(&scene), &[[0.0, 0.0, 0.5], [2.0, 0.0, 1.0], [0.0, 1.0, 0.5]]);
    assert!(has_notice(&scene, Treatment::Approximated, "skin weights that do not add up to 1"));
}

#[test]
fn broken_skins() {
    let refusal = |change: &dyn Fn(&mut Fixture)| {
        let mut fixture = skinned();
        change(&mut fixture);
        fixture.refusal()
    };
    let skins = |skins: Value| refusal(&|fixture| fixture.json["skins"] = skins.clone());
    assert_contains(&skins(json!([])), "node 0 refers to skin 0, which does not exist");
    assert_contains(&skins(json!([{"joints": []}])), "skin 0: it has no joints");
    assert_contains(&skins(json!([{"joints": [9]}])), "node 9, which does not exist");
    assert_contains(&skins(json!([{"joints": [1]}])), "joint 1 exceeds the 1 joints");
    assert_contains(&skins(json!([{}])), "skins: missing field `joints`");
    let outside = refusal(&|f| f.json["scenes"][0]["nodes"] = json!([0, 1]));
    assert_contains(&outside, "its joint node 2 is not in the scene");
    let few = refusal(&|f| {
        let one = f.accessor(FLOAT, "MAT4", 1, &bytes_of(&[0.0; 16]));
        f.json["skins"][0]["inverseBindMatrices"] = json!(one);
    });
    assert_contains(&few, "the last row of matrix 0 must be 0 0 0 1");
    let negative = refusal(&|f| {
        let weights = f.floats("VEC4", &[-1.0; 12]);
        f.attribute("WEIGHTS_0", weights);
    });
    assert_contains(&negative, "WEIGHTS_0: weight -1 of vertex 0");
    let lone = refusal(&|f| {
        f.primitive()["attributes"].as_object_mut().unwrap().remove("WEIGHTS_0");
    });
    assert_contains(&lone, "JOINTS_0 without WEIGHTS_0");
}

/// Animates node 0 of a fixture: two keyframes, at 1 s and 3 s, with these values.
fn animate(fixture: &mut Fixture, path: &str, interpolation: &str, kind: &str, values: &[f32]) {
    let input = fixture.floats("SCALAR", &[1.0, 3.0]);
    let output = fixture.floats(kind, values);
    if fixture.json.get("animations").is_none() {
        fixture.json["animations"] = json!([]);
    }
    fixture.push(
        "animations",
        json!({
            "name": path, "channels": [{"sampler": 0, "target": {"node": 0, "path": path}}],
            "samplers": [{"input": input, "output": output, "interpolation": interpolation}],
        }),
    );
}

#[test]
fn animated_translation_rotation_and_scale() {
    let mut fixture = Fixture::triangle();
    fixture.json["nodes"][0]["translation"] = json!([0.0, 0.0, 9.0]);
    animate(&mut fixture, "translation", "LINEAR", "VEC3", &[0., 0., 0., 4., 0., 0.]);
    // By half a turn about +Y, a right angle at 2 s: +X to -Z.
    animate(&mut fixture, "rotation", "LINEAR", "VEC4", &[0., 0., 0., 1., 0., 1., 0., 0.]);
    animate(&mut fixture, "scale", "STEP", "VEC3", &[1., 1., 1., 3., 3., 3.]);
    let rest = fixture.scene();
    assert_near(&vertices(&rest)[1..2], &[[2.0, 0.0, 9.0]]);
    assert!(has_notice(&rest, Treatment::Ignored, "drawn in rest pose"));
    let durations: Vec<_> = rest.animations.iter().map(|a| (a.name.as_str(), a.duration)).collect();
    assert_eq!(durations, [("translation", 3.0), ("rotation", 3.0), ("scale", 3.0)]);

    let corner = |time, animation| vertices(&at(&fixture, time, animation).unwrap())[1];
    for (time, x) in [(0.0, 0.0), (1.5, 1.0), (2.0, 2.0), (3.0, 4.0), (10.0, 4.0)] {
        assert_near(&[corner(time, None)], &[[x + 2.0, 0.0, 0.0]]);
    }
    assert_near(&[corner(2.0, Some("rotation"))], &[[0.0, 0.0, 7.0]]);
    assert_near(&[corner(2.9, Some("2")), corner(3.0, Some("2"))], &[[2., 0., 9.], [6., 0., 9.]]);
    assert_near(&[corner(3.0, Some("all"))], &[[-2.0, 0.0, 0.0]]);
    let scene = at(&fixture, 2.0, None).unwrap();
    assert!(has_notice(&scene, Treatment::Honoured, "animation at 2 s (animation 0"));
    assert!(has_notice(&scene, Treatment::Ignored, "animations but the first"));
}

#[test]
fn animated_weights_and_cubic_splines() {
    let mut fixture = morphed();
    // Two weights a keyframe: x from 0 to 2, z always 1.
    animate(&mut fixture, "weights", "LINEAR", "SCALAR", &[0.0, 1.0, 2.0, 1.0]);
    let scene = at(&fixture, 1.5, None).unwrap();
    assert_near(&vertices(&scene)[..1], &[[0.5, 0.0, 1.0]]);

    // In-tangent, value, out-tangent: x is t³ in seconds.
    let mut fixture = Fixture::triangle();
    let values = [9., 0., 0., 1., 0., 0., 3., 0., 0., 27., 0., 0., 27., 0., 0., 9., 0., 0.];
    animate(&mut fixture, "translation", "CUBICSPLINE", "VEC3", &values);
    for (time, x) in [(0.0, 1.0), (2.0, 8.0), (2.5, 15.625), (3.0, 27.0)] {
        assert_near(&vertices(&at(&fixture, time, None).unwrap())[..1], &[[x, 0.0, 0.0]]);
    }
}

#[test]
fn animated_joints_move_the_skin() {
    let mut fixture = skinned();
    animate(&mut fixture, "translation", "LINEAR", "VEC3", &[0., 0., 1., 0., 0., 5.]);
    fixture.json["animations"][0]["channels"][0]["target"]["node"] = json!(2);
    let scene = at(&fixture, 2.0, None).unwrap();
    assert_near(&vertices(&scene), &[[0.0, 0.0, 0.0], [2.0, 0.0, 3.0], [0.0, 1.0, 1.5]]);
}

#[test]
fn broken_animations() {
    let refusal = |change: &dyn Fn(&mut Value)| {
        let mut fixture = Fixture::triangle();
        animate(&mut fixture, "translation", "LINEAR", "VEC3", &[0., 0., 0., 4., 0., 0.]);
        change(&mut fixture.json);
        fixture.scene();
        at(&fixture, 2.0, None).unwrap_err().to_string()
    };
    let animation =
        |change: &dyn Fn(&mut Value)| refusal(&|json| change(&mut json["animations"][0]));
    let message = animation(&|a| a["channels"][0]["sampler"] = json!(4));
    assert_contains(&message, "channel 0 refers to sampler 4, which does not exist");
    let message = animation(&|a| a["channels"][0]["target"]["node"] = json!(4));
    assert_contains(&message, "channel 0 refers to node 4, which does not exist");
    let message = animation(&|a| a["samplers"][0]["interpolation"] = json!("SMOOTH"));
    assert_contains(&message, "unknown interpolation \"SMOOTH\"");
    let message = animation(&|a| a["samplers"][0]["interpolation"] = json!("CUBICSPLINE"));
    assert_contains(&message, "6 numbers of output do not fit 2 keyframes of CubicSpline");
    let message = animation(&|a| a["samplers"][0]["input"] = json!(9));
    assert_contains(&message, "input refers to accessor 9, which does not exist");
    let message = refusal(&|json| {
        json["nodes"][0]["matrix"] =
            json!([1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.]);
    });
    assert_contains(&message, "node 0 has a matrix, which cannot be animated");

    let mut fixture = Fixture::triangle();
    animate(&mut fixture, "translation", "LINEAR", "VEC3", &[0., 0., 0., 4., 0., 0.]);
    let falling = fixture.floats("SCALAR", &[3.0, 1.0]);
    fixture.json["animations"][0]["samplers"][0]["input"] = json!(falling);
    assert_contains(&at(&fixture, 2.0, None).unwrap_err().to_string(), "1 s follows 3 s");
    let rest = fixture.scene();
    assert!(has_notice(&rest, Treatment::Ignored, "animation that cannot be read"));
    assert!(rest.animations[0].duration.is_nan());
}

#[test]
fn what_is_asked_of_animations_must_exist() {
    let mut fixture = Fixture::triangle();
    animate(&mut fixture, "translation", "LINEAR", "VEC3", &[0., 0., 0., 4., 0., 0.]);
    let error = at(&fixture, 2.0, Some("Walk")).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert_contains(&error.to_string(), "animation Walk: the scene has 0 \"translation\"");
    let error = at(&fixture, f64::NAN, None).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    // An extension's target is not ours to animate.
    fixture.json["animations"][0]["channels"][0]["target"] =
        json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": "/x"}}});
    let scene = at(&fixture, 2.0, None).unwrap();
    assert!(has_notice(&scene, Treatment::Ignored, "animated pointer: stays as it is"));
}

/// The triangle at two instances: translated by x, turned and scaled at the second.
fn instanced() -> Fixture {
    let mut fixture = Fixture::triangle();
    let translations = fixture.floats("VEC3", &[0., 0., 0., 5., 0., 0.]);
    // A quarter turn about +Y in normalised 16-bit integers.
    let quarter = (FRAC_1_SQRT_2 * 32767.0).round() as i16;
    let rotations: Vec<u8> =
        [0, 0, 0, 32767, 0, quarter, 0, quarter].iter().flat_map(|c| c.to_le_bytes()).collect();
    let rotations = fixture.accessor(5122, "VEC4", 2, &rotations);
    fixture.json["accessors"][rotations]["normalized"] = json!(true);
    let scales = fixture.floats("VEC3", &[1., 1., 1., 2., 3., 2.]);
    let ids = fixture.floats("SCALAR", &[7.0, 8.0]);
    let attributes =
        json!({"TRANSLATION": translations, "ROTATION": rotations, "SCALE": scales, "_ID": ids});
    fixture.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}});
    fixture.json["nodes"][0]["translation"] = json!([0.0, 0.0, 10.0]);
    fixture.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    fixture
}

#[test]
fn instances_of_one_node() {
    let mut fixture = instanced();
    let scene = fixture.scene();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2));
    let first = [[0.0, 0.0, 10.0], [2.0, 0.0, 10.0], [0.0, 1.0, 10.0]];
    let second = [[5.0, 0.0, 10.0], [5.0, 0.0, 6.0], [5.0, 3.0, 10.0]];
    assert_near(&vertices(&scene), &[first, second].concat());
    assert!(has_notice(&scene, Treatment::Honoured, "EXT_mesh_gpu_instancing"));
    assert!(has_notice(&scene, Treatment::Ignored, "instance attribute _ID"));

    let attributes =
        &mut fixture.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    attributes["SCALE"] = json!(0);
    assert_contains(&fixture.refusal(), "another attribute 2");
    let mut fixture = instanced();
    fixture.json["accessors"][1]["count"] = json!(u32::MAX);
    assert_contains(&fixture.refusal(), "placements of primitives; the limit is");
}

#[test]
fn invisible_nodes_hide_what_is_below_them() {
    let mut fixture = Fixture::triangle();
    fixture.json["extensionsUsed"] = json!(["KHR_node_visibility", "KHR_lights_punctual"]);
    fixture.json["extensions"] =
        json!({"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 1.0}]}});
    let child = fixture.push(
        "nodes",
        json!({"mesh": 0, "extensions": {
            "KHR_lights_punctual": {"light": 0}, "KHR_node_visibility": {"visible": true},
        }}),
    );
    fixture.node(json!({"children": [child]}));
    let counts = |fixture: &Fixture| {
        let scene = fixture.scene();
        (scene.instances.len(), scene.lights.len())
    };
    assert_eq!(counts(&fixture), (2, 1));
    fixture.json["nodes"][2]["extensions"] = json!({"KHR_node_visibility": {"visible": false}});
    assert_eq!(counts(&fixture), (1, 0));
}
