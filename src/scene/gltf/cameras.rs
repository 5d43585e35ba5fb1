//! Cameras of nodes, in world space.

use super::document::Document;
use super::extras::{self, CameraExtras};
use super::nodes::Placement;
use super::notices::Notices;
use crate::Result;
use crate::scene::{Camera, Projection};
use glam::{Affine3A, DAffine3, DVec3, Vec3};
use gltf::json;
use gltf::json::camera::Type;
use gltf::json::validation::Checked;
use std::f32::consts::PI;

/// Reads the cameras of all placed nodes; one that frames `bounds` if there are none.
pub(super) fn read(
    document: &Document,
    placements: &[Placement],
    bounds: (Vec3, Vec3),
    notices: &mut Notices,
) -> Result<Vec<Camera>> {
    let mut cameras = Vec::new();
    for placement in placements {
        if let Some(index) = document.get(placement.node, "the scene")?.camera {
            cameras.extend(read_camera(document, placement, index, bounds, notices)?);
        }
    }
    if cameras.is_empty() {
        cameras.push(Camera::framing(bounds));
    }
    Ok(cameras)
}

fn read_camera(
    document: &Document,
    placement: &Placement,
    index: json::Index<json::Camera>,
    bounds: (Vec3, Vec3),
    notices: &mut Notices,
) -> Result<Option<Camera>> {
    let node_label = document.label(placement.node);
    let camera = document.get(index, &node_label)?;
    let place = document.label(index);
    let error = |message: &str| document.error(format!("{place}: {message}"));

    let Some(world_from_camera) = rigid(&placement.world_from_node) else {
        notices.ignored("camera whose node has a singular transform: left out", &node_label);
        return Ok(None);
    };
    let (projection, aspect_ratio) =
        match (&camera.type_, &camera.perspective, &camera.orthographic) {
            (Checked::Valid(Type::Perspective), Some(perspective), _) => {
                let yfov = perspective.yfov;
                if !(yfov > 0.0 && yfov < PI) {
                    return Err(error(&format!("yfov is {yfov}; it must be above 0 and below π")));
                }
                (Projection::Perspective { yfov }, perspective.aspect_ratio)
            }
            (Checked::Valid(Type::Orthographic), _, Some(orthographic)) => {
                let (xmag, ymag) = (orthographic.xmag, orthographic.ymag);
                if !(ymag > 0.0 && xmag > 0.0 && ymag.is_finite()) {
                    return Err(error("xmag and ymag must be above 0"));
                }
                (Projection::Orthographic { ymag }, Some(xmag / ymag))
            }
            _ => return Err(error("its type needs an object perspective or orthographic")),
        };
    if aspect_ratio.is_some_and(|ratio| !(ratio > 0.0 && ratio.is_finite())) {
        return Err(error("its aspect ratio must be above 0 and finite"));
    }

    let lens: CameraExtras =
        extras::steradian(&camera.extras).map_err(|message| error(&message))?.unwrap_or_default();
    let aperture_radius = lens.aperture_radius.unwrap_or(0.0);
    if !(aperture_radius >= 0.0 && aperture_radius.is_finite()) {
        return Err(error("extras.steradian.apertureRadius must not be negative"));
    }
    let focus_distance =
        lens.focus_distance.unwrap_or_else(|| distance_to_center(&world_from_camera, bounds));
    if !(focus_distance > 0.0 && focus_distance.is_finite()) {
        return Err(error("extras.steradian.focusDistance must be above 0"));
    }
    let name = match &camera.name {
        Some(name) if !name.is_empty() => name.clone(),
        _ => document.name(placement.node),
    };
    Ok(Some(Camera {
        name,
        world_from_camera,
        projection,
        aspect_ratio,
        aperture_radius,
        focus_distance,
    }))
}

/// The transform without scale, shear and mirroring: the view axis -Z is kept,
/// and of +Y what is perpendicular to it. `None` if one of them vanishes.
fn rigid(transform: &DAffine3) -> Option<Affine3A> {
    let z: DVec3 = transform.matrix3.z_axis.try_normalize()?;
    let y = transform.matrix3.y_axis.try_normalize()?.reject_from_normalized(z).try_normalize()?;
    let x = y.cross(z);
    let translation = transform.translation.as_vec3a();
    translation
        .is_finite()
        .then(|| Affine3A::from_cols(x.as_vec3a(), y.as_vec3a(), z.as_vec3a(), translation))
}

/// Distance along the view axis to the centre of the bounds; where that lies
/// behind the camera, the distance in space, and 1 where it is the camera.
fn distance_to_center(world_from_camera: &Affine3A, (lo, hi): (Vec3, Vec3)) -> f32 {
    let center = lo + (hi - lo) * 0.5;
    let to_center = center - Vec3::from(world_from_camera.translation);
    let along_axis = -to_center.dot(Vec3::from(world_from_camera.matrix3.z_axis));
    let distances = [along_axis, to_center.length()];
    distances.into_iter().find(|&distance| distance > 0.0).unwrap_or(1.0)
}
