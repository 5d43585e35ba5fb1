//! The environment that a scene names in its extras.

use super::document::Document;
use super::extras::{self, EnvironmentExtras, SceneExtras};
use super::notices::Notices;
use super::uri::{self, Resource};
use crate::Result;
use crate::scene::Environment;
use glam::{Mat3, Vec3};
use gltf::json::{self, Index};

/// Reads `extras.steradian.environment` of the scene, if it is there.
pub(super) fn read(
    document: &Document,
    scene: Option<Index<json::Scene>>,
    notices: &mut Notices,
) -> Result<Option<Environment>> {
    let Some(scene) = scene else { return Ok(None) };
    let label = document.label(scene);
    let error = |message: String| document.error(format!("{label}: {message}"));
    let extras: Option<SceneExtras> =
        extras::steradian(&document.get(scene, "the file")?.extras).map_err(error)?;
    let Some(source) = extras.and_then(|extras| extras.environment) else { return Ok(None) };

    let mut environment = match (&source.uri, source.radiance) {
        (Some(uri), None) => match uri::resolve(&document.reach, uri).map_err(error)? {
            Resource::File(path) => {
                let (environment, clamped) = Environment::load_counting_negatives(&path)?;
                if clamped > 0 {
                    notices.approximated(
                        format!("{clamped} pixels of the environment with negative radiance clamped to 0"),
                        &environment.name,
                    );
                }
                environment
            }
            Resource::Data(_) => return Err(error("the environment must be a file".into())),
        },
        (None, Some(radiance)) => {
            let radiance = Vec3::from(radiance);
            if !(radiance.is_finite() && radiance.min_element() >= 0.0) {
                return Err(error(
                    "the environment's radiance must be finite and not negative".into(),
                ));
            }
            Environment::constant(radiance)
        }
        _ => return Err(error("the environment needs either uri or radiance".into())),
    };
    place(&source, &mut environment).map_err(error)?;
    Ok(Some(environment))
}

/// Sets rotation and intensity.
fn place(
    source: &EnvironmentExtras,
    environment: &mut Environment,
) -> std::result::Result<(), String> {
    let rotation = source.rotation.unwrap_or(0.0);
    let intensity = source.intensity.unwrap_or(1.0);
    if !rotation.is_finite() {
        return Err("the environment's rotation must be finite".into());
    }
    if !(intensity.is_finite() && intensity >= 0.0) {
        return Err("the environment's intensity must be finite and not negative".into());
    }
    // Turning the map one way looks it up turned the other way.
    environment.environment_from_world = Mat3::from_rotation_y(-rotation.to_radians());
    environment.intensity = intensity;
    Ok(())
}
