//! EXT_mesh_gpu_instancing: many placements of one node's mesh.

use super::accessor::Accessors;
use super::nodes::Placement;
use super::notices::Notices;
use crate::Result;
use glam::{DAffine3, DQuat, DVec3};
use gltf::json::accessor::Type;
use gltf::json::{self, Index};
use serde::Deserialize;
use std::collections::BTreeMap;

const NAME: &str = "EXT_mesh_gpu_instancing";

#[derive(Deserialize)]
struct Instancing {
    #[serde(default)]
    attributes: BTreeMap<String, u32>,
}

/// The instances' transforms in their node's space; `None` without the extension.
pub(super) fn transforms(
    accessors: &Accessors,
    placement: &Placement,
    notices: &mut Notices,
) -> Result<Option<Vec<DAffine3>>> {
    let document = accessors.document;
    let extensions = &document.raw["nodes"][placement.node.value()]["extensions"];
    let Some(raw) = extensions.get(NAME) else { return Ok(None) };
    let label = format!("{}, {NAME}", document.label(placement.node));
    let error = |message: String| document.error(format!("{label}: {message}"));
    let instancing = Instancing::deserialize(raw).map_err(|e| error(e.to_string()))?;

    let mut transforms: Option<Vec<(DVec3, DQuat, DVec3)>> = None;
    for (name, &index) in &instancing.attributes {
        let index = Index::<json::Accessor>::new(index);
        let what = format!("{label}, {name}");
        let count = document.get(index, &what)?.count.0;
        document.budget.has_room_for_instances(count).map_err(error)?;
        let unmoved = (DVec3::ZERO, DQuat::IDENTITY, DVec3::ONE);
        let transforms = transforms.get_or_insert_with(|| vec![unmoved; count as usize]);
        if transforms.len() as u64 != count {
            let first = transforms.len();
            return Err(error(format!("{name} has {count} elements, another attribute {first}")));
        }
        let vectors = || accessors.floats::<3>(index, &[Type::Vec3], 0.0, &what);
        let wide = |v: [f32; 3]| DVec3::from(v.map(f64::from));
        match name.as_str() {
            "TRANSLATION" => {
                transforms.iter_mut().zip(vectors()?).for_each(|(t, v)| t.0 = wide(v));
            }
            "SCALE" => transforms.iter_mut().zip(vectors()?).for_each(|(t, v)| t.2 = wide(v)),
            "ROTATION" => {
                let rotations = accessors.floats::<4>(index, &[Type::Vec4], 0.0, &what)?;
                for (i, (t, rotation)) in transforms.iter_mut().zip(rotations).enumerate() {
                    let rotation = DQuat::from_array(rotation.map(f64::from));
                    if rotation.length_squared() == 0.0 {
                        return Err(error(format!("ROTATION {i} is a quaternion of length 0")));
                    }
                    t.1 = rotation.normalize();
                }
            }
            custom => {
                let custom = custom.escape_debug();
                notices.ignored(format!("instance attribute {custom}"), &label);
            }
        }
    }
    let place =
        |(t, r, s): (DVec3, DQuat, DVec3)| DAffine3::from_scale_rotation_translation(s, r, t);
    Ok(Some(transforms.unwrap_or_default().into_iter().map(place).collect()))
}
