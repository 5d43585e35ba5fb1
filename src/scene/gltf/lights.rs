//! KHR_lights_punctual: lights of nodes, in world space.

use super::document::Document;
use super::nodes::Placement;
use super::notices::Notices;
use crate::Result;
use crate::scene::{LightKind, PunctualLight};
use glam::Vec3;
use gltf::json;
use gltf::json::extensions::scene::khr_lights_punctual::{Light, Spot, Type};
use gltf::json::validation::Checked;
use std::f32::consts::FRAC_PI_2;

/// Reads the lights of all placed nodes.
pub(super) fn read(
    document: &Document,
    placements: &[Placement],
    notices: &mut Notices,
) -> Result<Vec<PunctualLight>> {
    let mut lights = Vec::new();
    for placement in placements {
        let node = document.get(placement.node, "the scene")?;
        let extension = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        if let Some(extension) = extension.filter(|_| placement.is_visible) {
            lights.extend(read_light(document, placement, extension.light, notices)?);
        }
    }
    Ok(lights)
}

fn read_light(
    document: &Document,
    placement: &Placement,
    index: json::Index<Light>,
    notices: &mut Notices,
) -> Result<Option<PunctualLight>> {
    let node_label = document.label(placement.node);
    let light = document.get(index, &node_label)?;
    let place = format!("{node_label}, {}", document.label(index));

    let position = placement.world_from_node.translation.as_vec3();
    // A light shines along -Z of its node; scale does not matter to it.
    let axis = -placement.world_from_node.matrix3.z_axis;
    let Checked::Valid(kind) = light.type_ else {
        return Err(document.error(format!("{place}: unknown type of light")));
    };
    let Some(direction) = axis.try_normalize().filter(|_| position.is_finite()) else {
        notices.ignored("light whose node has a singular transform: left out", &place);
        return Ok(None);
    };
    let direction = direction.as_vec3();
    let range = match light.range {
        Some(range) if range > 0.0 => range,
        Some(_) => {
            notices.approximated("range of a light not above 0 taken as infinite", &place);
            f32::INFINITY
        }
        None => f32::INFINITY,
    };
    let kind = match kind {
        Type::Directional => LightKind::Directional { direction },
        Type::Point => LightKind::Point { position, range },
        Type::Spot => {
            let Some(spot) = &light.spot else {
                return Err(document.error(format!("{place}: a spot light without spot")));
            };
            let (cos_inner, cos_outer) = cone(spot, &place, notices);
            LightKind::Spot { position, direction, cos_inner, cos_outer, range }
        }
    };
    let intensity = Vec3::from(light.color) * light.intensity;
    if !intensity.is_finite() {
        return Err(document.error(format!("{place}: color × intensity is too large a number")));
    }
    if intensity.min_element() < 0.0 {
        notices.approximated("negative light clamped to 0", &place);
    }
    let name = light.name.clone().unwrap_or_else(|| document.name(placement.node));
    Ok(Some(PunctualLight { name, kind, intensity: intensity.max(Vec3::ZERO) }))
}

/// Cosines of the inner and outer angle, 0 ≤ inner ≤ outer ≤ π/2.
fn cone(spot: &Spot, place: &str, notices: &mut Notices) -> (f32, f32) {
    let outer = spot.outer_cone_angle.clamp(0.0, FRAC_PI_2);
    let inner = spot.inner_cone_angle.clamp(0.0, outer);
    if (inner, outer) != (spot.inner_cone_angle, spot.outer_cone_angle) {
        notices.approximated("cone angles clamped to 0 ≤ inner ≤ outer ≤ π/2", place);
    }
    (inner.cos(), outer.cos())
}
