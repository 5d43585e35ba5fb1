//! Decodes the PNG and JPEG images that materials use, each once.

use super::buffers::{Buffers, read_resource};
use super::document::Document;
use super::limits::MAX_IMAGE_SIDE;
use super::notices::Notices;
use crate::Result;
use crate::scene::Image;
use crate::scene::guard::decoding;
use gltf::json;
use image::{ColorType, DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::borrow::Cow;
use std::collections::HashMap;
use std::io::Cursor;

/// What decoders may allocate besides the picture itself.
const DECODER_MEMORY: u64 = 64 << 20;

/// The images decoded so far.
#[derive(Default)]
pub(super) struct Images {
    images: Vec<Image>,
    /// From the file's index to that in `images`.
    decoded: HashMap<usize, u32>,
}

impl Images {
    /// Index of the decoded image in [`Scene::images`](crate::scene::Scene::images).
    pub(super) fn index_of(
        &mut self,
        document: &Document,
        buffers: &Buffers,
        index: json::Index<json::Image>,
        referrer: &str,
        notices: &mut Notices,
    ) -> Result<u32> {
        if let Some(&decoded) = self.decoded.get(&index.value()) {
            return Ok(decoded);
        }
        let source = document.get(index, referrer)?;
        let what = document.label(index);
        let bytes = match (&source.uri, source.buffer_view) {
            (Some(uri), None) => read_resource(document, uri, &what)?,
            (None, Some(view)) => Cow::Borrowed(buffers.view(document, view, &what)?),
            _ => {
                return Err(document.error(format!("{what} needs either a uri or a bufferView")));
            }
        };
        let (width, height, rgba) = decoding(|| decode(&bytes, document, &what, notices))
            .map_err(|message| document.error(format!("{what}: {message}")))?;
        let place = self.images.len() as u32;
        self.images.push(Image { name: display_name(document, index), width, height, rgba });
        self.decoded.insert(index.value(), place);
        Ok(place)
    }

    /// All of them.
    pub(super) fn into_images(self) -> Vec<Image> {
        self.images
    }
}

/// The image's name, or its URI where that is a path.
fn display_name(document: &Document, index: json::Index<json::Image>) -> String {
    let image = document.root.get(index);
    let uri = image.and_then(|i| i.uri.as_ref()).filter(|uri| !uri.starts_with("data:"));
    match (image.and_then(|i| i.name.as_ref()), uri) {
        (None, Some(uri)) => uri.clone(),
        _ => document.name(index),
    }
}

fn decode(
    bytes: &[u8],
    document: &Document,
    what: &str,
    notices: &mut Notices,
) -> std::result::Result<(u32, u32, Vec<[u8; 4]>), String> {
    // The content decides: a wrong mimeType or file ending does no harm.
    let format = match image::guess_format(bytes) {
        Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg)) => format,
        _ => return Err("it is neither PNG nor JPEG".into()),
    };
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_IMAGE_SIDE);
    limits.max_image_height = Some(MAX_IMAGE_SIDE);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits.clone());
    let mut decoder = reader.into_decoder().map_err(|e| e.to_string())?;

    let (width, height) = decoder.dimensions();
    document.budget.take_pixels(width, height)?;
    limits.max_alloc = Some(decoder.total_bytes().saturating_add(DECODER_MEMORY));
    decoder.set_limits(limits).map_err(|e| e.to_string())?;
    if !matches!(
        decoder.color_type(),
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8
    ) {
        notices.approximated("image with 16 bits a channel reduced to 8", what);
    }
    let picture = DynamicImage::from_decoder(decoder).map_err(|e| e.to_string())?.into_rgba8();
    let rgba = picture.into_raw().as_chunks().0.to_vec();
    Ok((width, height, rgba))
}
