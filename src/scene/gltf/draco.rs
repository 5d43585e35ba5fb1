//! KHR_draco_mesh_compression: accessors of primitives from Draco streams. The decoder is
//! the `draco-core` crate, which is safe Rust; here is what the extension asks of it.

use super::buffers::Buffers;
use super::document::Document;
use crate::Result;
use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::validation::Checked;
use gltf::json::{self, Index};
use serde::Deserialize;
use std::collections::BTreeMap;

pub(super) const NAME: &str = "KHR_draco_mesh_compression";

/// Most points and faces of one stream.
const MAX_COUNT: u64 = 1 << 26;

/// The extension's object in a primitive.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Compressed {
    buffer_view: u32,
    /// The stream's attributes by the primitive's names.
    attributes: BTreeMap<String, u32>,
}

/// The elements of all compressed accessors, tightly packed, by the accessor's index.
pub(super) fn decode(document: &Document, buffers: &Buffers) -> Result<BTreeMap<usize, Vec<u8>>> {
    let mut decoded = BTreeMap::new();
    for (m, mesh) in document.root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let raw = &document.raw["meshes"][m]["primitives"][p]["extensions"];
            let Some(raw) = raw.get(NAME) else { continue };
            let what = format!("mesh {m}, primitive {p}, {NAME}");
            let compressed =
                Compressed::deserialize(raw).map_err(|e| document.error(format!("{what}: {e}")))?;
            decode_primitive(document, buffers, primitive, &compressed, &what, &mut decoded)?;
        }
    }
    Ok(decoded)
}

fn decode_primitive(
    document: &Document,
    buffers: &Buffers,
    primitive: &json::mesh::Primitive,
    compressed: &Compressed,
    what: &str,
    decoded: &mut BTreeMap<usize, Vec<u8>>,
) -> Result<()> {
    let error = |message: String| document.error(format!("{what}: {message}"));
    let bytes = buffers.view(document, Index::new(compressed.buffer_view), what)?;
    let mesh = decode_stream(bytes).map_err(error)?;
    // Also of what no accessor takes, so that a stream cannot be decoded many times for nothing.
    let held = 12 * mesh.num_faces() + 4 * mesh.num_points();
    document.budget.take_decoded(held as u64).map_err(error)?;
    if let Some(indices) = primitive.indices {
        let accessor = document.get(indices, what)?;
        let values = mesh.faces().iter().flatten().map(|point| point.0 as f32);
        // Points are below 2^26; as f32 they would be rounded above 2^24.
        let is_exact = mesh.num_points() <= 1 << 24;
        if !is_exact {
            return Err(error(format!("{} points are too many", mesh.num_points())));
        }
        let bytes = pack(document, accessor, values, 3 * mesh.num_faces()).map_err(error)?;
        decoded.insert(indices.value(), bytes);
    }
    for (name, &id) in &compressed.attributes {
        let semantic = primitive.attributes.iter().find(|(semantic, _)| match semantic {
            Checked::Valid(semantic) => semantic.to_string() == *name,
            Checked::Invalid => false,
        });
        let name = name.escape_debug();
        let Some((_, &index)) = semantic else {
            return Err(error(format!("the primitive has no attribute {name}")));
        };
        let accessor = document.get(index, what)?;
        let Some(attribute) = mesh.attribute_by_unique_id(id) else {
            return Err(error(format!("{name} is attribute {id}, which its stream lacks")));
        };
        let Checked::Valid(kind) = accessor.type_ else {
            return Err(error(format!("{name}: unknown type")));
        };
        let width = kind.multiplicity();
        let is_wide = matches!(attribute.data_type(), DataType::Int64 | DataType::Uint64);
        if is_wide || usize::from(attribute.num_components()) != width {
            let found = attribute.num_components();
            let kind: Type = kind;
            return Err(error(format!(
                "{name} has {found} components in the stream, not {kind:?}"
            )));
        }
        let values = attribute.read_f32s(mesh.num_points(), width);
        let count = values.len();
        let bytes = pack(document, accessor, values.into_iter(), count).map_err(error)?;
        decoded.insert(index.value(), bytes);
    }
    Ok(())
}

fn decode_stream(bytes: &[u8]) -> std::result::Result<Mesh, String> {
    let mut limits = DecodeLimits::default();
    limits.max_points = MAX_COUNT;
    limits.max_faces = MAX_COUNT;
    limits.max_decoded_bytes = super::limits::MAX_DECODED;
    let mut mesh = Mesh::new();
    let mut buffer = DecoderBuffer::new(bytes).with_limits(limits);
    MeshDecoder::new().decode(&mut buffer, &mut mesh).map_err(|e| format!("{e:?}"))?;
    Ok(mesh)
}

/// Numbers as components of the accessor, which must be of their count.
fn pack(
    document: &Document,
    accessor: &json::Accessor,
    values: impl Iterator<Item = f32>,
    count: usize,
) -> std::result::Result<Vec<u8>, String> {
    let (Checked::Valid(component), Checked::Valid(kind)) =
        (accessor.component_type, accessor.type_)
    else {
        return Err("unknown componentType or type".into());
    };
    let expected = accessor.count.0.saturating_mul(kind.multiplicity() as u64);
    if expected != count as u64 {
        return Err(format!("an accessor has {expected} numbers, its stream {count}"));
    }
    document.budget.take_decoded(count as u64 * component.0.size() as u64)?;
    let mut bytes = Vec::with_capacity(count * component.0.size());
    for value in values {
        match component.0 {
            ComponentType::I8 => bytes.extend((value as i8).to_le_bytes()),
            ComponentType::U8 => bytes.extend((value as u8).to_le_bytes()),
            ComponentType::I16 => bytes.extend((value as i16).to_le_bytes()),
            ComponentType::U16 => bytes.extend((value as u16).to_le_bytes()),
            ComponentType::U32 => bytes.extend((value as u32).to_le_bytes()),
            ComponentType::F32 => bytes.extend(value.to_le_bytes()),
        }
    }
    Ok(bytes)
}
