//! KHR_draco_mesh_compression, with the feature and without.

mod gltf_fixture;

use gltf_fixture::*;
use serde_json::json;

/// A triangle with a Draco stream for positions and indices.
fn compressed(stream: &[u8]) -> Fixture {
    let mut fixture = Fixture::triangle();
    let view = fixture.view(stream);
    let accessors = [
        json!({"componentType": FLOAT, "count": 3, "type": "VEC3"}),
        json!({"componentType": UNSIGNED_SHORT, "count": 3, "type": "SCALAR"}),
    ];
    let [positions, indices] = accessors.map(|accessor| fixture.push("accessors", accessor));
    fixture.attribute("POSITION", positions);
    fixture.primitive()["indices"] = json!(indices);
    fixture.primitive()["extensions"] = json!({"KHR_draco_mesh_compression": {
        "bufferView": view, "attributes": {"POSITION": 0},
    }});
    fixture.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    fixture
}

#[cfg(not(feature = "draco"))]
#[test]
fn without_the_feature_the_refusal_names_it() {
    assert_contains(&compressed(&[]).refusal(), "a build with the cargo feature `draco`");
}

#[cfg(feature = "draco")]
mod with_the_feature {
    use super::*;
    use glam::Vec3;
    use steradian::scene::Treatment;

    /// By Google's encoder, from the corners of [`Fixture::triangle`].
    const STREAM: [u8; 85] = [
        68, 82, 65, 67, 79, 2, 2, 1, 1, 0, 0, 0, 3, 1, 0, 1, 0, 0, 1, 7, 255, 1, 17, 1, 255, 0, 0,
        1, 0, 9, 3, 0, 0, 2, 1, 1, 1, 0, 15, 3, 85, 21, 47, 173, 42, 3, 4, 112, 129, 17, 0, 254,
        127, 0, 0, 0, 248, 255, 1, 0, 0, 0, 0, 0, 255, 63, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
        0, 0, 0, 0, 64, 14,
    ];

    #[test]
    fn positions_and_indices_come_from_the_stream() {
        let scene = compressed(&STREAM).scene();
        let mesh = &scene.meshes[0];
        let [a, b, c] = mesh.triangles[0].map(|i| mesh.positions[i as usize]);
        // Quantised to 14 bits of the largest side.
        let is_near = |p: Vec3, q: Vec3| p.distance(q) < 2.0 / 16384.0;
        let corners = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y];
        let first = corners.iter().position(|&q| is_near(a, q)).unwrap();
        assert!(is_near(b, corners[(first + 1) % 3]) && is_near(c, corners[(first + 2) % 3]));
        assert!(has_notice(&scene, Treatment::Honoured, "KHR_draco_mesh_compression"));
    }

    #[test]
    fn broken_streams_are_refused() {
        for length in 0..STREAM.len() {
            assert!(compressed(&STREAM[..length]).load().is_err(), "{length}");
        }
        let mut fixture = compressed(&STREAM);
        fixture.json["accessors"][1]["count"] = json!(4);
        assert_contains(&fixture.refusal(), "an accessor has 12 numbers, its stream 9");
        let mut fixture = compressed(&STREAM);
        let extension = &mut fixture.primitive()["extensions"]["KHR_draco_mesh_compression"];
        extension["attributes"]["POSITION"] = json!(5);
        assert_contains(&fixture.refusal(), "POSITION is attribute 5, which its stream lacks");
    }
}
