//! Morph targets and skinning: vertices of a primitive to where a placement shows them.

use super::accessor::Accessors;
use super::normals;
use super::notices::Notices;
use crate::Result;
use crate::scene::Mesh;
use glam::{DAffine3, DMat3, DVec3, Vec3, Vec4Swizzles};
use gltf::json;
use gltf::json::accessor::Type;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

/// How a placement moves the vertices of its mesh, morph targets first.
#[derive(Default)]
pub(super) struct Deformation {
    /// Of morph targets; empty where all of them are 0.
    pub(super) weights: Vec<f64>,
    pub(super) skin: Option<Skinning>,
}

/// A skin, and where its mesh would be without it.
pub(super) struct Skinning {
    /// For each joint.
    pub(super) world_from_bind: Vec<DAffine3>,
    pub(super) world_from_node: DAffine3,
}

/// Largest difference of a vertex's weights from a sum of 1 that is rounding: four 8-bit
/// weights, each off by half a step.
const SUM_TOLERANCE: f64 = 4.0 * 0.5 / 255.0;

const WITHOUT_JOINTS: &str = "primitive without joints of a skinned mesh: placed by its node";
const WEIGHT_SUMS: &str = "skin weights that do not add up to 1: scaled, or the first joint's";

/// Adds what the morph targets add.
pub(super) fn morph(
    accessors: &Accessors,
    primitive: &Primitive,
    weights: &[f64],
    mesh: &mut Mesh,
    notices: &mut Notices,
    what: &str,
) -> Result<()> {
    let document = accessors.document;
    let Some(targets) = &primitive.targets else {
        notices.ignored("weights of morph targets that a primitive lacks", what);
        return Ok(());
    };
    if targets.len() != weights.len() {
        let (weights, targets) = (weights.len(), targets.len());
        return Err(
            document.error(format!("{what}: {weights} weights for {targets} morph targets"))
        );
    }
    let wide = |v: &Vec3| v.as_dvec3();
    let mut positions: Vec<DVec3> = mesh.positions.iter().map(wide).collect();
    let mut normals: Vec<DVec3> = mesh.normals.iter().map(wide).collect();
    let mut tangents: Vec<DVec3> = mesh.tangents.iter().map(|t| t.xyz().as_dvec3()).collect();
    for (i, (target, &weight)) in targets.iter().zip(weights).enumerate() {
        if weight == 0.0 {
            continue;
        }
        for (name, index, values) in [
            ("POSITION", target.positions, &mut positions),
            ("NORMAL", target.normals, &mut normals),
            ("TANGENT", target.tangents, &mut tangents),
        ] {
            let Some(index) = index.filter(|_| !values.is_empty()) else { continue };
            let what = format!("{what}, morph target {i}, {name}");
            let deltas = accessors.floats::<3>(index, &[Type::Vec3], 0.0, &what)?;
            if deltas.len() != values.len() {
                let (found, vertices) = (deltas.len(), values.len());
                return Err(
                    document.error(format!("{what} has {found} elements for {vertices} vertices"))
                );
            }
            for (value, delta) in values.iter_mut().zip(deltas) {
                *value += weight * Vec3::from(delta).as_dvec3();
            }
        }
    }
    mesh.positions = positions.iter().map(|p| p.as_vec3()).collect();
    mesh.normals = normals.iter().map(|n| n.normalize_or_zero().as_vec3()).collect();
    for (tangent, moved) in mesh.tangents.iter_mut().zip(tangents) {
        *tangent = moved.normalize_or_zero().as_vec3().extend(tangent.w);
    }
    finish(accessors, mesh, notices, what)
}

/// Takes the vertices to the world by their joints.
pub(super) fn skin(
    accessors: &Accessors,
    primitive: &Primitive,
    skin: &Skinning,
    mesh: &mut Mesh,
    notices: &mut Notices,
    what: &str,
) -> Result<()> {
    let transforms = vertex_transforms(accessors, primitive, skin, mesh, notices, what)?;
    let mut mirrored = 0;
    for (i, transform) in transforms.iter().enumerate() {
        let m = transform.matrix3;
        let sign = 1.0_f64.copysign(m.determinant());
        mirrored += usize::from(sign < 0.0);
        let position = &mut mesh.positions[i];
        *position = transform.transform_point3(position.as_dvec3()).as_vec3();
        if let Some(normal) = mesh.normals.get_mut(i) {
            // The inverse transpose but for a factor: it needs no inverse.
            let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
            let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
            let turned = sign * (cofactors * normal.as_dvec3());
            *normal = turned.normalize_or_zero().as_vec3();
        }
        if let Some(tangent) = mesh.tangents.get_mut(i) {
            let turned = (m * tangent.xyz().as_dvec3()).normalize_or_zero().as_vec3();
            *tangent = turned.extend(tangent.w * sign as f32);
        }
    }
    // As with a node that mirrors, the front stays the front.
    if 2 * mirrored > transforms.len() {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    finish(accessors, mesh, notices, what)
}

/// The blended transform of each vertex.
fn vertex_transforms(
    accessors: &Accessors,
    primitive: &Primitive,
    skin: &Skinning,
    mesh: &Mesh,
    notices: &mut Notices,
    what: &str,
) -> Result<Vec<DAffine3>> {
    let document = accessors.document;
    let count = mesh.positions.len();
    let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
    let mut sums = vec![(0.0_f64, DAffine3::ZERO); count];
    let mut first = vec![0_u32; count];
    let mut set = 0;
    while let Some(joints) = attribute(Semantic::Joints(set)) {
        let weights = attribute(Semantic::Weights(set))
            .ok_or_else(|| document.error(format!("{what}: JOINTS_{set} without WEIGHTS_{set}")))?;
        let place = format!("{what}, JOINTS_{set}");
        let joints = accessors.integers::<4>(joints, Type::Vec4, &place)?;
        let weights_place = format!("{what}, WEIGHTS_{set}");
        let weights = accessors.floats::<4>(weights, &[Type::Vec4], 0.0, &weights_place)?;
        for (name, length) in [(&place, joints.len()), (&weights_place, weights.len())] {
            if length != count {
                return Err(
                    document.error(format!("{name} has {length} elements for {count} vertices"))
                );
            }
        }
        for (i, (joints, weights)) in joints.into_iter().zip(weights).enumerate() {
            if set == 0 {
                first[i] = joints[0];
            }
            for (joint, weight) in joints.into_iter().zip(weights).filter(|(_, w)| *w != 0.0) {
                let transform =
                    joint_of(skin, joint).map_err(|m| document.error(format!("{place}: {m}")))?;
                if weight < 0.0 {
                    return Err(
                        document.error(format!("{weights_place}: weight {weight} of vertex {i}"))
                    );
                }
                add(&mut sums[i], f64::from(weight), transform);
            }
        }
        set += 1;
    }
    if set == 0 {
        notices.approximated(WITHOUT_JOINTS, what);
        return Ok(vec![skin.world_from_node; count]);
    }
    if sums.iter().any(|(sum, _)| (sum - 1.0).abs() > SUM_TOLERANCE) {
        notices.approximated(WEIGHT_SUMS, what);
    }
    let blended = sums.into_iter().zip(first).map(|((sum, transform), first)| match sum > 0.0 {
        true => Ok(DAffine3 {
            matrix3: transform.matrix3 * (1.0 / sum),
            translation: transform.translation / sum,
        }),
        false => joint_of(skin, first).copied().map_err(|m| document.error(format!("{what}: {m}"))),
    });
    blended.collect()
}

fn joint_of(skin: &Skinning, joint: u32) -> std::result::Result<&DAffine3, String> {
    let joints = &skin.world_from_bind;
    let missing = || format!("joint {joint} exceeds the {} joints of the skin", joints.len());
    joints.get(joint as usize).ok_or_else(missing)
}

fn add(sum: &mut (f64, DAffine3), weight: f64, transform: &DAffine3) {
    sum.0 += weight;
    sum.1.matrix3 += transform.matrix3 * weight;
    sum.1.translation += transform.translation * weight;
}

/// Checks positions, and gives directions to vectors that lost theirs.
fn finish(accessors: &Accessors, mesh: &mut Mesh, notices: &mut Notices, what: &str) -> Result<()> {
    if let Some(i) = mesh.positions.iter().position(|p| !p.is_finite()) {
        let message = format!("{what}: vertex {i} is moved to {}", mesh.positions[i]);
        return Err(accessors.document.error(message));
    }
    if normals::normalize(&mut mesh.normals, &mesh.positions, &mesh.triangles).replaced > 0 {
        let message = "normals without direction replaced by the average of face normals";
        notices.approximated(message, what);
    }
    if !normals::normalize_tangents(&mut mesh.tangents) {
        notices.approximated("tangents without direction: left out", what);
        mesh.tangents.clear();
    }
    Ok(())
}

/// The weights that a placement of the mesh has; empty where all are 0.
pub(super) fn weights(placed: Option<&Vec<f64>>, mesh: &json::Mesh) -> Vec<f64> {
    let own = || mesh.weights.iter().flatten().map(|&w| w.into()).collect();
    let weights: Vec<f64> = placed.cloned().unwrap_or_else(own);
    if weights.iter().all(|&w| w == 0.0) { Vec::new() } else { weights }
}
