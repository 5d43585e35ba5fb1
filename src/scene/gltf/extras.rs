//! What Steradian reads from `extras`: the members of an object `steradian`.

use gltf::json::Extras;
use serde::Deserialize;
use serde::de::{DeserializeOwned, IgnoredAny};
use serde_json::Value;

/// `extras.steradian` of a mesh.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshExtras {
    /// The mesh is this sphere; its triangles stand in for it in other programs.
    pub(super) sphere: Option<SphereExtras>,
}

/// A sphere around the origin of object space.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SphereExtras {
    /// Radius in object space.
    pub(super) radius: f32,
}

/// `extras.steradian` of a camera.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub(super) struct CameraExtras {
    /// Radius of the lens in metres.
    pub(super) aperture_radius: Option<f32>,
    /// Distance of the plane in focus in metres.
    pub(super) focus_distance: Option<f32>,
}

/// `extras.steradian` of a scene.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneExtras {
    /// Light from infinity.
    pub(super) environment: Option<EnvironmentExtras>,
    /// The radiance that a formula gives for the scene: for tests, not rendered.
    #[serde(rename = "truth")]
    _truth: Option<IgnoredAny>,
}

/// An environment: either a file or a constant radiance.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EnvironmentExtras {
    /// An equirectangular `.hdr` or `.exr` file.
    pub(super) uri: Option<String>,
    /// The same radiance from everywhere.
    pub(super) radiance: Option<[f32; 3]>,
    /// Turns the map about +Y, degrees, counter-clockwise seen from above.
    pub(super) rotation: Option<f32>,
    /// Multiplies the radiance.
    pub(super) intensity: Option<f32>,
}

/// The `steradian` member of `extras`, if there is one.
pub(super) fn steradian<T: DeserializeOwned>(extras: &Extras) -> Result<Option<T>, String> {
    let Some(extras) = extras else { return Ok(None) };
    let parsed: Value = serde_json::from_str(extras.get()).map_err(|e| e.to_string())?;
    match parsed.get("steradian") {
        None => Ok(None),
        Some(value) => serde_json::from_value(value.clone())
            .map(Some)
            .map_err(|e| format!("extras.steradian cannot be read: {e}")),
    }
}
