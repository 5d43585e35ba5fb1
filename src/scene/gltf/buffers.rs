//! The bytes of buffers and of checked views into them.

use super::document::Document;
use super::uri::{self, Resource};
use crate::{Error, Result};
use gltf::json;
use std::borrow::Cow;
use std::path::Path;

/// The data of every buffer; `None` where the file gives none, which is an
/// error only if something uses it.
pub(super) struct Buffers<'a> {
    data: Vec<Option<Cow<'a, [u8]>>>,
}

impl<'a> Buffers<'a> {
    /// Loads all buffers; `bin` is the GLB's binary chunk.
    pub(super) fn load(document: &Document, bin: Option<&'a [u8]>) -> Result<Self> {
        let mut data = Vec::new();
        for (index, buffer) in document.root.buffers.iter().enumerate() {
            let what = document.label(json::Index::<json::Buffer>::new(index as u32));
            let bytes = match &buffer.uri {
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
        Ok(Self { data })
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
        let buffer = document.get(view.buffer, &view_label)?;
        let buffer_label = document.label(view.buffer);
        let Some(bytes) = &self.data[view.buffer.value()] else {
            return Err(document.error(format!("{what}: {buffer_label} has no data")));
        };
        let offset = view.byte_offset.unwrap_or_default().0;
        let end = offset.checked_add(view.byte_length.0);
        match end.filter(|&end| end <= buffer.byte_length.0) {
            // Loading checked that the data is as long as byteLength.
            Some(end) => Ok(&bytes[offset as usize..end as usize]),
            None => Err(document.error(format!(
                "{what}: {view_label} (offset {offset}, length {}) goes beyond the {} bytes of {buffer_label}",
                view.byte_length.0, buffer.byte_length.0
            ))),
        }
    }
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
