//! The node trees of the scene that is rendered, flattened to world transforms.

use super::document::Document;
use super::motion::{NodePose, Pose};
use super::notices::Notices;
use crate::Result;
use glam::{DAffine3, DMat4, DQuat, DVec3, DVec4};
use gltf::json::{self, Index};

/// Why a node that was met before may not be met again.
const TREE_RULE: &str = "nodes must form trees, without cycles or second parents";

/// How far the length of a rotation may be from 1 by rounding: each of four numbers with
/// three decimals is off by 5e-4 at most, together at most by twice that.
const ROTATION_TOLERANCE: f64 = 1e-3;

/// A node of the scene and where it is.
#[derive(Clone)]
pub(super) struct Placement {
    /// The node.
    pub(super) node: Index<json::Node>,
    /// Product of the transforms from the root to the node, in double precision.
    pub(super) world_from_node: DAffine3,
    /// False hides its mesh and its light (KHR_node_visibility).
    pub(super) is_visible: bool,
    /// Of morph targets: what an animation says, else the node.
    pub(super) weights: Option<Vec<f64>>,
}

/// The scene to render: the file's default, else its first; `None` if it has no scenes.
pub(super) fn default_scene(document: &Document) -> Result<Option<Index<json::Scene>>> {
    let chosen = document.root.scene;
    if let Some(chosen) = chosen {
        document.get(chosen, "the default scene")?;
    }
    Ok(chosen.or_else(|| (!document.root.scenes.is_empty()).then(|| Index::new(0))))
}

/// Says which of several scenes is drawn.
pub(super) fn note_scene(
    document: &Document,
    scene: Option<Index<json::Scene>>,
    notices: &mut Notices,
) {
    let count = document.root.scenes.len();
    if let (Some(scene), true) = (scene, count > 1) {
        let why = match document.root.scene {
            Some(_) => "the default",
            None => "the first, where none is the default",
        };
        notices.honoured(&format!("one of {count} scenes: {why}"), &document.label(scene));
    }
}

/// All nodes of `scene`, or of the whole file without one, in the order of their index.
pub(super) fn walk(
    document: &Document,
    scene: Option<Index<json::Scene>>,
    pose: &Pose,
    notices: &mut Notices,
) -> Result<Vec<Placement>> {
    let (roots, referrer) = match scene {
        Some(scene) => (document.get(scene, "the file")?.nodes.clone(), document.label(scene)),
        None => (roots(document), "the file".into()),
    };
    // Each node is entered once, so the walk ends, and its depth is not a stack's.
    let mut is_visited = vec![false; document.root.nodes.len()];
    let mut placements = Vec::new();
    let mut pending: Vec<_> =
        roots.into_iter().map(|root| (root, DAffine3::IDENTITY, None, true)).collect();
    while let Some((index, world_from_parent, parent, is_parent_visible)) = pending.pop() {
        let referrer = || parent.map_or_else(|| referrer.clone(), |p| document.label(p));
        let node = match document.root.get(index) {
            Some(node) => node,
            None => document.get(index, &referrer())?,
        };
        if std::mem::replace(&mut is_visited[index.value()], true) {
            return Err(document.error(format!(
                "{} refers to {}, which is already in the scene; {TREE_RULE}",
                referrer(),
                document.label(index),
            )));
        }
        let posed = pose.get(&index.value()).cloned().unwrap_or_default();
        let parent_from_node = local_transform(document, index, node, &posed, notices)?;
        let world_from_node = world_from_parent * parent_from_node;
        if !world_from_node.is_finite() {
            let label = document.label(index);
            return Err(document.error(format!("{label}: its transform overflows")));
        }
        let is_visible = is_parent_visible && is_shown(document, index);
        let own_weights = || node.weights.as_ref().map(|w| w.iter().map(|&w| w.into()).collect());
        let weights = posed.weights.or_else(own_weights);
        placements.push(Placement { node: index, world_from_node, is_visible, weights });
        let children = node.children.iter().flatten();
        pending.extend(children.map(|&child| (child, world_from_node, Some(index), is_visible)));
    }
    // Without scenes all nodes are drawn. Those that no root leads to go round in a circle.
    if let (None, Some(index)) = (scene, is_visited.iter().position(|is_visited| !is_visited)) {
        let label = document.label::<json::Node>(Index::new(index as u32));
        return Err(document.error(format!("no root leads to {label}; {TREE_RULE}")));
    }
    placements.sort_by_key(|placement| placement.node.value());
    Ok(placements)
}

fn is_shown(document: &Document, index: Index<json::Node>) -> bool {
    let extensions = &document.raw["nodes"][index.value()]["extensions"];
    extensions["KHR_node_visibility"]["visible"] != serde_json::Value::Bool(false)
}

/// Nodes that are no node's child. In a file where every node is one, none.
fn roots(document: &Document) -> Vec<Index<json::Node>> {
    let nodes = &document.root.nodes;
    let mut is_root = vec![true; nodes.len()];
    for child in nodes.iter().filter_map(|node| node.children.as_ref()).flatten() {
        if let Some(is_root) = is_root.get_mut(child.value()) {
            *is_root = false;
        }
    }
    let indices = is_root.iter().enumerate().filter(|(_, is_root)| **is_root);
    indices.map(|(index, _)| Index::new(index as u32)).collect()
}

fn local_transform(
    document: &Document,
    index: Index<json::Node>,
    node: &json::Node,
    posed: &NodePose,
    notices: &mut Notices,
) -> Result<DAffine3> {
    let error =
        |message: &str| Err(document.error(format!("{}: {message}", document.label(index))));
    if let Some(matrix) = node.matrix {
        if node.translation.is_some() || node.rotation.is_some() || node.scale.is_some() {
            let message = "node with a matrix besides translation, rotation or scale: matrix taken";
            notices.approximated(message, &document.label(index));
        }
        let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
        return match matrix.row(3) == DVec4::W {
            true => Ok(DAffine3::from_mat4(matrix)),
            false => error("the last row of its matrix must be 0 0 0 1"),
        };
    }
    let own = |member: Option<[f32; 3]>| member.map(|m| m.map(f64::from));
    let translation = posed.translation.or(own(node.translation)).unwrap_or_default();
    let scale = posed.scale.or(own(node.scale)).unwrap_or([1.0; 3]);
    let own_rotation = node.rotation.unwrap_or_default().0.map(f64::from);
    let rotation = DQuat::from_array(posed.rotation.unwrap_or(own_rotation));
    let (translation, scale) = (DVec3::from(translation), DVec3::from(scale));
    // Files round their quaternions, so all are normalised.
    let length = rotation.length();
    if !(length > 0.0 && length.is_finite()) {
        return error("its rotation is not a quaternion of a positive length");
    }
    if (length - 1.0).abs() > ROTATION_TOLERANCE {
        notices.approximated("rotation whose length is not 1: normalised", &document.label(index));
    }
    Ok(DAffine3::from_scale_rotation_translation(scale, rotation / length, translation))
}
