//! Places shapes in the world: instances of meshes, and spheres.

use super::accessor::Accessors;
use super::geometry::{Shape, Shapes};
use super::instancing;
use super::nodes::Placement;
use super::notices::Notices;
use crate::Result;
use crate::scene::{Instance, Mesh, Sphere};
use glam::{Affine3A, DAffine3, Vec3};

/// Largest coordinate in the world, metres. Areas, and sums of them over any
/// number of primitives that fits memory, then stay finite in f32.
const MAX_COORDINATE: f32 = 1e15;
/// Largest relative difference of scales that is taken for rounding.
const UNIFORM_SCALE_TOLERANCE: f64 = 1e-5;

/// Everything placed in the world.
#[derive(Default)]
pub(super) struct Placed {
    pub(super) instances: Vec<Instance>,
    pub(super) spheres: Vec<Sphere>,
    /// Encloses all of it: the boxes of meshes are transformed, not their
    /// vertices, so that many instances cost little.
    pub(super) bounds: Option<(Vec3, Vec3)>,
}

/// Places every shape that a node has.
pub(super) fn place(
    accessors: &Accessors,
    placements: &[Placement],
    shapes: &Shapes,
    meshes: &[Mesh],
    notices: &mut Notices,
) -> Result<Placed> {
    let mesh_bounds: Vec<_> = meshes.iter().map(|mesh| mesh.bounds().unwrap_or_default()).collect();
    let document = accessors.document;
    let mut placed = Placed::default();
    for (i, placement) in placements.iter().enumerate() {
        let Some(shape) = shapes.of(i) else { continue };
        let node = document.get(placement.node, "the scene")?;
        let label = document.label(placement.node);
        let is_skinned = node.skin.is_some() && matches!(shape, Shape::Meshes(_));
        let instances = match instancing::transforms(accessors, placement, notices)? {
            Some(_) if is_skinned => {
                notices.ignored("instances of a skinned mesh: drawn once", &label);
                None
            }
            instances => instances,
        };
        // A skin takes its vertices to the world.
        let world_from_node =
            if is_skinned { DAffine3::IDENTITY } else { placement.world_from_node };
        for node_from_object in instances.unwrap_or_else(|| vec![DAffine3::IDENTITY]) {
            let world_from_object = world_from_node * node_from_object;
            let name = document.name(placement.node);
            let Some(transform) = invertible(&world_from_object) else {
                notices.ignored("mesh whose node has a singular transform: not drawn", &label);
                continue;
            };
            let error = |message: String| document.error(format!("{label}: {message}"));
            match shape {
                Shape::Meshes(meshes) => {
                    document.budget.take_instances(meshes.len() as u64).map_err(error)?;
                    for &mesh in meshes {
                        placed.grow(&transform, mesh_bounds[mesh as usize]).map_err(error)?;
                        let (name, world_from_object) = (name.clone(), transform);
                        placed.instances.push(Instance { name, mesh, world_from_object });
                    }
                }
                &Shape::Sphere { radius, material } => {
                    document.budget.take_instances(1).map_err(error)?;
                    let (center, radius) =
                        world_sphere(&world_from_object, radius).map_err(error)?;
                    let corners = (center - radius, center + radius);
                    placed.grow(&Affine3A::IDENTITY, corners).map_err(error)?;
                    placed.spheres.push(Sphere { name, center, radius, material });
                }
            }
        }
    }
    Ok(placed)
}

impl Placed {
    /// Extends the bounds by a transformed box, if that is finite and not too far away.
    fn grow(
        &mut self,
        transform: &Affine3A,
        (lo, hi): (Vec3, Vec3),
    ) -> std::result::Result<(), String> {
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { lo[axis] } else { hi[axis] };
            let point = transform.transform_point3(Vec3::new(pick(0), pick(1), pick(2)));
            // A NaN fails this comparison too.
            if !point.abs().cmple(Vec3::splat(MAX_COORDINATE)).all() {
                return Err(format!(
                    "its geometry reaches {point} in the world; coordinates must stay within ±{MAX_COORDINATE:e}"
                ));
            }
            let (min, max) = self.bounds.unwrap_or((point, point));
            self.bounds = Some((min.min(point), max.max(point)));
        }
        Ok(())
    }
}

/// The transform in single precision, if it and its inverse are finite there.
fn invertible(transform: &DAffine3) -> Option<Affine3A> {
    let linear = transform.matrix3;
    let transform = Affine3A::from_cols(
        linear.x_axis.as_vec3a(),
        linear.y_axis.as_vec3a(),
        linear.z_axis.as_vec3a(),
        transform.translation.as_vec3a(),
    );
    // The inverse of a determinant that overflows would be finite, but zero.
    let is_invertible = transform.matrix3.determinant().is_finite()
        && transform.is_finite()
        && transform.inverse().is_finite();
    is_invertible.then_some(transform)
}

/// Centre and radius in the world of a sphere around the object's origin.
fn world_sphere(transform: &DAffine3, radius: f32) -> std::result::Result<(Vec3, f32), String> {
    let [x, y, z] = [transform.matrix3.x_axis, transform.matrix3.y_axis, transform.matrix3.z_axis];
    let scales = [x.length(), y.length(), z.length()];
    let scale = scales.iter().sum::<f64>() / 3.0;
    let is_uniform = scales.iter().all(|s| (s - scale).abs() <= UNIFORM_SCALE_TOLERANCE * scale);
    let is_orthogonal = [x.dot(y), y.dot(z), z.dot(x)]
        .iter()
        .all(|dot| dot.abs() <= UNIFORM_SCALE_TOLERANCE * scale * scale);
    if !(is_uniform && is_orthogonal) {
        return Err(format!(
            "an analytic sphere cannot be scaled by {:.6} × {:.6} × {:.6} or sheared; \
             use the same scale on all axes, or remove extras.steradian.sphere to render its triangles",
            scales[0], scales[1], scales[2]
        ));
    }
    let radius = (f64::from(radius) * scale) as f32;
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(format!("the sphere's radius in the world is {radius:e}"));
    }
    Ok((transform.translation.as_vec3(), radius))
}
