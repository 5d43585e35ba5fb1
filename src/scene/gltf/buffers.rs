//! The bytes of buffers and of checked views into them.

use super::document::Document;
use super::meshopt::CompressedView;
use super::uri::{self, Resource};
use crate::{Error, Result};
use gltf::json;
use serde::Deserialize;
use serde_json::Value;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;

/// Names of the compression, the newer first; both are read the same way.
const COMPRESSIONS: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];

/// The data of every buffer; `None` where the file gives none, which is an
/// error only if something uses it.
pub(super) struct Buffers<'a> {
    data: Vec<Option<Cow<'a, [u8]>>>,
    /// By bufferView: those that are compressed.
    compressed: Vec<Option<Compressed>>,
    /// Elements, tightly packed, of accessors that have a decoded primitive's data.
    decoded: BTreeMap<usize, Vec<u8>>,
}

struct Compressed {
    view: CompressedView,
    /// Filled when something first uses the view.
    decoded: OnceLock<Vec<u8>>,
}

impl<'a> Buffers<'a> {
    /// Loads all buffers; `bin` is the GLB's binary chunk.
    pub(super) fn load(document: &Document, bin: Option<&'a [u8]>) -> Result<Self> {
        let mut data = Vec::new();
        for (index, buffer) in document.root.buffers.iter().enumerate() {
            let what = document.label(json::Index::<json::Buffer>::new(index as u32));
            let bytes = match &buffer.uri {
                // Its views are all compressed, so it is never read.
                _ if is_fallback(document, index) => None,
                Some(uri) => Some(read_resource(document, uri, &what)?),
                None if index == 0 => bin.map(Cow::Borrowed),
                None => None,
            };
            let needed = buffer.byte_length.0;
            if let Some(bytes) = &bytes
                && (bytes.len() as u64) < needed
            {
                return Err(document.error(format!(
                    "{what} should have {needed} bytes, its data has {}",
                    bytes.len()
                )));
            }
            data.push(bytes);
        }
        let views = 0..document.root.buffer_views.len();
        let compressed =
            views.map(|view| compressed_view(document, view)).collect::<Result<_>>()?;
        let buffers = Self { data, compressed, decoded: BTreeMap::new() };
        #[cfg(feature = "draco")]
        let buffers = Self { decoded: super::draco::decode(document, &buffers)?, ..buffers };
        Ok(buffers)
    }

    /// The elements of an accessor whose primitive is compressed.
    pub(super) fn decoded_accessor(&self, index: json::Index<json::Accessor>) -> Option<&[u8]> {
        self.decoded.get(&index.value()).map(Vec::as_slice)
    }

    /// The bytes of a buffer view.
    pub(super) fn view(
        &self,
        document: &Document,
        index: json::Index<json::buffer::View>,
        what: &str,
    ) -> Result<&[u8]> {
        let view = document.get(index, what)?;
        let view_label = document.label(index);
        if let Some(compressed) = &self.compressed[index.value()] {
            return self.decode(document, compressed, view.byte_length.0, &view_label);
        }
        let range = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
        self.range(document, view.buffer, range, what, &view_label)
    }

    /// The decoded bytes of a compressed view, whose bufferView says `length`.
    fn decode<'b>(
        &'b self,
        document: &Document,
        compressed: &'b Compressed,
        length: u64,
        label: &str,
    ) -> Result<&'b [u8]> {
        if let Some(decoded) = compressed.decoded.get() {
            return Ok(decoded);
        }
        let error = |message: String| document.error(format!("{label}: {message}"));
        let view = &compressed.view;
        let decoded_length = view.decoded_length().map_err(error)?;
        if decoded_length != length {
            return Err(error(format!(
                "its byteLength is {length}, its compressed elements have {decoded_length} bytes"
            )));
        }
        document.budget.take_decoded(decoded_length).map_err(error)?;
        let range = (view.byte_offset, view.byte_length);
        let what = format!("{label}, compressed");
        let stream = self.range(document, json::Index::new(view.buffer), range, &what, &what)?;
        let decoded = view.decode(stream).map_err(error)?;
        Ok(compressed.decoded.get_or_init(|| decoded))
    }

    /// Bytes (offset, length) of a buffer.
    fn range(
        &self,
        document: &Document,
        index: json::Index<json::Buffer>,
        (offset, length): (u64, u64),
        what: &str,
        view_label: &str,
    ) -> Result<&[u8]> {
        let buffer = document.get(index, view_label)?;
        let buffer_label = document.label(index);
        let Some(bytes) = &self.data[index.value()] else {
            return Err(document.error(format!("{what}: {buffer_label} has no data")));
        };
        let end = offset.checked_add(length);
        match end.filter(|&end| end <= buffer.byte_length.0) {
            // Loading checked that the data is as long as byteLength.
            Some(end) => Ok(&bytes[offset as usize..end as usize]),
            None => Err(document.error(format!(
                "{what}: {view_label} (offset {offset}, length {length}) goes beyond the {} bytes of {buffer_label}",
                buffer.byte_length.0
            ))),
        }
    }
}

/// Whether the buffer only stands in for readers that cannot decompress.
fn is_fallback(document: &Document, index: usize) -> bool {
    let extensions = &document.raw["buffers"][index]["extensions"];
    COMPRESSIONS.iter().any(|name| extensions[name]["fallback"] == Value::Bool(true))
}

fn compressed_view(document: &Document, index: usize) -> Result<Option<Compressed>> {
    let extensions = &document.raw["bufferViews"][index]["extensions"];
    let Some(name) = COMPRESSIONS.iter().find(|name| extensions.get(name).is_some()) else {
        return Ok(None);
    };
    let view = CompressedView::deserialize(&extensions[name])
        .map_err(|e| document.error(format!("bufferView {index}: {name}: {e}")))?;
    Ok(Some(Compressed { view, decoded: OnceLock::new() }))
}

/// The bytes behind a URI of the document.
pub(super) fn read_resource<'a>(
    document: &Document,
    uri: &str,
    what: &str,
) -> Result<Cow<'a, [u8]>> {
    let in_document = |message: String| document.error(format!("{what}: {message}"));
    match uri::resolve(&document.reach, uri).map_err(in_document)? {
        Resource::Data(bytes) => {
            document.budget.take_bytes(bytes.len() as u64).map_err(in_document)?;
            Ok(Cow::Owned(bytes))
        }
        Resource::File(path) => read_file(&path, &document.budget).map(Cow::Owned),
    }
}

/// A whole file, if the budget has room for it.
pub(super) fn read_file(path: &Path, budget: &super::limits::Budget) -> Result<Vec<u8>> {
    let cannot_read = |e: std::io::Error| Error::scene(path, format!("cannot be read: {e}"));
    let metadata = path.metadata().map_err(cannot_read)?;
    if !metadata.is_file() {
        return Err(Error::scene(path, "is not a file"));
    }
    budget.take_bytes(metadata.len()).map_err(|message| Error::scene(path, message))?;
    std::fs::read(path).map_err(cannot_read)
}
