//! Skins: where the joints of a skinned mesh take its vertices.

use super::accessor::Accessors;
use super::nodes::Placement;
use crate::Result;
use glam::{DAffine3, DMat4, DVec4};
use gltf::json::accessor::Type;
use gltf::json::{self, Index};
use serde::Deserialize;

/// A skin as the file has it.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct RawSkin {
    inverse_bind_matrices: Option<u32>,
    /// A hint that moves nothing (glTF 2.0, 3.7.3.1).
    skeleton: Option<u32>,
    joints: Vec<u32>,
}

/// For each joint of the skin, the transform from the mesh at binding to the world.
pub(super) fn world_from_bind(
    accessors: &Accessors,
    placements: &[Placement],
    skin: usize,
    referrer: &str,
) -> Result<Vec<DAffine3>> {
    let document = accessors.document;
    let skin_label = format!("skin {skin}");
    let error = |message: String| document.error(format!("{skin_label}: {message}"));
    let skin = document.skins.get(skin).ok_or_else(|| {
        document.error(format!("{referrer} refers to {skin_label}, which does not exist"))
    })?;
    if let Some(skeleton) = skin.skeleton {
        document.get(Index::<json::Node>::new(skeleton), &skin_label)?;
    }
    if skin.joints.is_empty() {
        return Err(error("it has no joints".into()));
    }
    // Every node with a skin has matrices of its own.
    document.budget.take_elements(skin.joints.len() as u64).map_err(error)?;
    let bind = match skin.inverse_bind_matrices {
        Some(index) => inverse_bind_matrices(accessors, index, &skin_label)?,
        None => vec![DAffine3::IDENTITY; skin.joints.len()],
    };
    if bind.len() < skin.joints.len() {
        let (joints, matrices) = (skin.joints.len(), bind.len());
        return Err(error(format!("{joints} joints have {matrices} inverse bind matrices")));
    }
    let joints = skin.joints.iter().zip(bind).map(|(&joint, joint_from_bind)| {
        document.get(Index::<json::Node>::new(joint), &skin_label)?;
        // Placements are in the order of their nodes.
        let found = placements.binary_search_by_key(&(joint as usize), |p| p.node.value());
        let placed =
            found.map_err(|_| error(format!("its joint node {joint} is not in the scene")))?;
        Ok(placements[placed].world_from_node * joint_from_bind)
    });
    joints.collect()
}

fn inverse_bind_matrices(accessors: &Accessors, index: u32, label: &str) -> Result<Vec<DAffine3>> {
    let what = format!("{label}, inverseBindMatrices");
    let matrices = accessors.floats::<16>(Index::new(index), &[Type::Mat4], 0.0, &what)?;
    let affine = |(i, matrix): (usize, [f32; 16])| {
        let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
        // Exporters leave rounding in the last row.
        match (matrix.row(3) - DVec4::W).abs().max_element() < 1e-4 {
            true => Ok(DAffine3::from_mat4(matrix)),
            false => {
                let message = format!("{what}: the last row of matrix {i} must be 0 0 0 1");
                Err(accessors.document.error(message))
            }
        }
    };
    matrices.into_iter().enumerate().map(affine).collect()
}
