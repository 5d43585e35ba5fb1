//! The images that materials use: collected, checked against the limits, then decoded in
//! parallel, each once.

use super::buffers::{Buffers, read_resource};
use super::document::Document;
use super::limits::MAX_IMAGE_SIDE;
use super::notices::Notices;
use super::{ktx2_images, resize};
use crate::Result;
use crate::scene::guard::decoding;
use crate::scene::{ColorSpace, Image};
use gltf::json;
use image::{ColorType, DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::HashMap;
use std::io::Cursor;

/// What decoders may allocate besides the picture itself.
const DECODER_MEMORY: u64 = 64 << 20;

/// The images asked for so far.
#[derive(Default)]
pub(super) struct Images<'a> {
    encoded: Vec<Encoded<'a>>,
    /// From the file's index to that in `encoded`.
    places: HashMap<usize, u32>,
}

/// An image as it is in the file.
struct Encoded<'a> {
    bytes: Cow<'a, [u8]>,
    /// Name for people.
    name: String,
    /// Name in messages.
    what: String,
    /// Whether any texture takes it as sRGB.
    is_srgb: bool,
}

/// RGBA of 8 bits, row by row from the top.
pub(super) struct Pixels {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) rgba: Vec<[u8; 4]>,
}

impl<'a> Images<'a> {
    /// Index that the decoded image will have in
    /// [`Scene::images`](crate::scene::Scene::images).
    pub(super) fn index_of(
        &mut self,
        document: &Document,
        buffers: &'a Buffers,
        index: json::Index<json::Image>,
        referrer: &str,
        color_space: ColorSpace,
    ) -> Result<u32> {
        let is_srgb = color_space == ColorSpace::Srgb;
        if let Some(&place) = self.places.get(&index.value()) {
            self.encoded[place as usize].is_srgb |= is_srgb;
            return Ok(place);
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
        let place = self.encoded.len() as u32;
        let name = display_name(document, index);
        self.encoded.push(Encoded { bytes, name, what, is_srgb });
        self.places.insert(index.value(), place);
        Ok(place)
    }

    /// All of them. Sides longer than `max_size` are brought down to it.
    pub(super) fn decode(
        self,
        document: &Document,
        max_size: Option<u32>,
        notices: &mut Notices,
    ) -> Result<Vec<Image>> {
        let fail = |what: &str, message| document.error(format!("{what}: {message}"));
        for image in &self.encoded {
            let size =
                decoding(|| size(&image.bytes)).map_err(|message| fail(&image.what, message))?;
            let (width, height) = size;
            document
                .budget
                .take_pixels(width, height)
                .map_err(|message| fail(&image.what, message))?;
        }
        let decoded: Vec<_> = self
            .encoded
            .par_iter()
            .map(|image| {
                let (pixels, notice) = decoding(|| decode(&image.bytes))?;
                let longest = pixels.width.max(pixels.height);
                let pixels = match max_size.filter(|&most| longest > most) {
                    Some(most) => resize::shrink(&pixels, most, image.is_srgb),
                    None => pixels,
                };
                Ok((pixels, notice, longest))
            })
            .collect();
        let mut images = Vec::new();
        for (image, decoded) in self.encoded.into_iter().zip(decoded) {
            let (pixels, notice, longest) =
                decoded.map_err(|message: String| fail(&image.what, message))?;
            if let Some(notice) = notice {
                notices.approximated(notice, &image.what);
            }
            if let Some(most) = max_size.filter(|&most| longest > most) {
                let message = format!("images larger than {most} texels a side reduced to that");
                notices.approximated(message, &image.what);
            }
            let Pixels { width, height, rgba } = pixels;
            images.push(Image { name: image.name, width, height, rgba });
        }
        Ok(images)
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

/// A decoder for PNG, JPEG or WebP, with its limits.
fn decoder(bytes: &[u8]) -> std::result::Result<(impl ImageDecoder + '_, Limits), String> {
    // The content decides: a wrong mimeType or file ending does no harm.
    let format = match image::guess_format(bytes) {
        Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP)) => format,
        _ => return Err("it is none of PNG, JPEG, WebP and KTX2".into()),
    };
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_IMAGE_SIDE);
    limits.max_image_height = Some(MAX_IMAGE_SIDE);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits.clone());
    Ok((reader.into_decoder().map_err(|e| e.to_string())?, limits))
}

/// Width and height, by the header alone.
fn size(bytes: &[u8]) -> std::result::Result<(u32, u32), String> {
    let (width, height) = match ktx2_images::is_ktx2(bytes) {
        true => ktx2_images::size(bytes)?,
        false => decoder(bytes)?.0.dimensions(),
    };
    if width.max(height) > MAX_IMAGE_SIDE {
        return Err(format!("{width}x{height} texels; the limit is {MAX_IMAGE_SIDE} a side"));
    }
    Ok((width, height))
}

/// The picture, and what is to be said about it.
fn decode(bytes: &[u8]) -> std::result::Result<(Pixels, Option<&'static str>), String> {
    if ktx2_images::is_ktx2(bytes) {
        return Ok((ktx2_images::decode(bytes)?, None));
    }
    let (mut decoder, mut limits) = decoder(bytes)?;
    limits.max_alloc = Some(decoder.total_bytes().saturating_add(DECODER_MEMORY));
    decoder.set_limits(limits).map_err(|e| e.to_string())?;
    let is_8_bit = matches!(
        decoder.color_type(),
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8
    );
    let notice = (!is_8_bit).then_some("image with 16 bits a channel reduced to 8");
    let picture = DynamicImage::from_decoder(decoder).map_err(|e| e.to_string())?.into_rgba8();
    let (width, height) = picture.dimensions();
    let rgba = picture.into_raw().as_chunks().0.to_vec();
    Ok((Pixels { width, height, rgba }, notice))
}
