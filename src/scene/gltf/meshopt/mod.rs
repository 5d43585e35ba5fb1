//! EXT_meshopt_compression and KHR_meshopt_compression: bitstreams and filters
//! by the appendices of KHR_meshopt_compression. Every read is checked: a broken
//! stream is an error and never more.

mod filters;
mod indices;
mod vertices;

use serde::Deserialize;

/// The extension's object in a bufferView.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct CompressedView {
    /// Buffer that holds the stream.
    pub(super) buffer: u32,
    /// Where in the buffer it begins, bytes.
    #[serde(default)]
    pub(super) byte_offset: u64,
    /// Length of the stream, bytes.
    pub(super) byte_length: u64,
    /// Bytes of a decoded element.
    pub(super) byte_stride: u64,
    /// Number of elements.
    pub(super) count: u64,
    mode: Mode,
    #[serde(default)]
    filter: Filter,
}

#[derive(Deserialize, Clone, Copy, PartialEq, Debug)]
#[serde(rename_all = "UPPERCASE")]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

#[derive(Deserialize, Clone, Copy, PartialEq, Debug, Default)]
#[serde(rename_all = "UPPERCASE")]
enum Filter {
    #[default]
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Color,
}

impl CompressedView {
    /// Bytes after decoding, or what is wrong with the object. The stream is not looked at.
    pub(super) fn decoded_length(&self) -> Result<u64, String> {
        let &Self { byte_stride: stride, count, mode, filter, .. } = self;
        let is_stride_valid = match mode {
            Mode::Attributes => (4..=256).contains(&stride) && stride.is_multiple_of(4),
            Mode::Triangles | Mode::Indices => stride == 2 || stride == 4,
        };
        if !is_stride_valid {
            return Err(format!("a byteStride of {stride} is not valid in mode {mode:?}"));
        }
        if mode == Mode::Triangles && !count.is_multiple_of(3) {
            return Err(format!("a count of {count} is not of whole triangles"));
        }
        let is_filter_valid = match filter {
            Filter::None => true,
            _ if mode != Mode::Attributes => false,
            Filter::Octahedral | Filter::Color => stride == 4 || stride == 8,
            Filter::Quaternion => stride == 8,
            Filter::Exponential => true,
        };
        if !is_filter_valid {
            return Err(format!(
                "the filter {filter:?} is not valid in mode {mode:?} with a byteStride of {stride}"
            ));
        }
        count.checked_mul(stride).ok_or_else(|| format!("a count of {count} is too large"))
    }

    /// The decoded bytes of the stream. [`decoded_length`](Self::decoded_length) must have passed.
    pub(super) fn decode(&self, stream: &[u8]) -> Result<Vec<u8>, String> {
        let (count, stride) = (self.count as usize, self.byte_stride as usize);
        let mut bytes = match self.mode {
            Mode::Attributes => vertices::decode(stream, count, stride),
            Mode::Triangles => indices::decode_triangles(stream, count).map(|i| pack(&i, stride)),
            Mode::Indices => indices::decode_sequence(stream, count).map(|i| pack(&i, stride)),
        }?;
        match (self.filter, stride) {
            (Filter::None, _) => {}
            (Filter::Octahedral, 4) => filters::octahedral_8(&mut bytes),
            (Filter::Octahedral, _) => filters::octahedral_16(&mut bytes),
            (Filter::Quaternion, _) => filters::quaternion(&mut bytes),
            (Filter::Exponential, _) => filters::exponential(&mut bytes),
            (Filter::Color, 4) => filters::color_8(&mut bytes),
            (Filter::Color, _) => filters::color_16(&mut bytes),
        }
        Ok(bytes)
    }
}

/// Indices as integers of 2 bytes, the upper half cut off, or of 4.
fn pack(indices: &[u32], stride: usize) -> Vec<u8> {
    indices.iter().flat_map(|i| i.to_le_bytes().into_iter().take(stride)).collect()
}

/// Reads a stream from its front.
struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (taken, rest) =
            self.rest.split_at_checked(count).ok_or("the compressed stream ends too early")?;
        self.rest = rest;
        Ok(taken)
    }

    fn byte(&mut self) -> Result<u8, String> {
        Ok(self.take(1)?[0])
    }

    /// Unsigned LEB128 of at most five bytes; bits beyond 32 are cut off.
    fn varint(&mut self) -> Result<u32, String> {
        let mut value = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7F) << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err("an integer of the compressed stream has more than five bytes".into())
    }

    fn finish(&self) -> Result<(), String> {
        match self.rest.len() {
            0 => Ok(()),
            left => Err(format!("the compressed stream has {left} bytes too many")),
        }
    }
}

/// The stream without its header byte, which must be one of `headers`, and without its
/// tail; then the header and the tail.
fn split<'a>(
    stream: &'a [u8],
    headers: &[u8],
    tail_length: impl Fn(u8) -> usize,
) -> Result<(Reader<'a>, u8, &'a [u8]), String> {
    let (&header, rest) = stream.split_first().ok_or("the compressed stream is empty")?;
    if !headers.contains(&header) {
        return Err(format!(
            "the compressed stream begins with {header:#04x}, not {headers:#04x?}"
        ));
    }
    let body = rest.len().checked_sub(tail_length(header));
    let (body, tail) = rest.split_at(body.ok_or("the compressed stream is shorter than its tail")?);
    Ok((Reader { rest: body }, header, tail))
}

#[cfg(test)]
mod tests;
