//! A scene file's bytes to its JSON text and, for GLB, its binary chunk.

const MAGIC: &[u8; 4] = b"glTF";
const CHUNK_JSON: u32 = u32::from_le_bytes(*b"JSON");
const CHUNK_BIN: u32 = u32::from_le_bytes(*b"BIN\0");
const HEADER_SIZE: usize = 12;
const CHUNK_HEADER_SIZE: usize = 8;

/// The parts of a scene file.
#[derive(Debug, PartialEq)]
pub(super) struct Container<'a> {
    /// The JSON text, without a byte order mark.
    pub(super) json: &'a [u8],
    /// GLB's binary chunk: the data of buffer 0.
    pub(super) bin: Option<&'a [u8]>,
}

/// Splits the bytes of a `.glb` or `.gltf` file; which one it is follows from
/// the first bytes, not from the name.
pub(super) fn split(bytes: &[u8]) -> Result<Container<'_>, String> {
    if bytes.is_empty() {
        return Err("the file is empty".into());
    }
    if bytes.starts_with(MAGIC) { split_glb(bytes) } else { Ok(text(bytes, None)) }
}

fn text<'a>(json: &'a [u8], bin: Option<&'a [u8]>) -> Container<'a> {
    Container { json: json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json), bin }
}

fn split_glb(bytes: &[u8]) -> Result<Container<'_>, String> {
    let truncated = |what: &str, needed: usize| {
        format!("truncated GLB: {what} needs {needed} bytes, the file has {}", bytes.len())
    };
    let (Some(version), Some(length)) = (read_u32(bytes, 4), read_u32(bytes, 8)) else {
        return Err(truncated("its header", HEADER_SIZE));
    };
    if version != 2 {
        return Err(format!("GLB version {version}; only version 2 is read"));
    }
    let length = length as usize;
    if length > bytes.len() {
        return Err(truncated("its header says it", length));
    }

    let mut json = None;
    let mut bin = None;
    let mut offset = HEADER_SIZE;
    let mut chunk_index = 0;
    while offset < length {
        let start = offset + CHUNK_HEADER_SIZE;
        let (true, Some(size), Some(kind)) =
            (start <= length, read_u32(bytes, offset), read_u32(bytes, offset + 4))
        else {
            return Err(truncated(&format!("the header of chunk {chunk_index}"), start));
        };
        let end = start.saturating_add(size as usize);
        if end > length {
            return Err(format!(
                "truncated GLB: chunk {chunk_index} ends at byte {end}, the container at {length}"
            ));
        }
        match (kind, chunk_index) {
            (CHUNK_JSON, 0) => json = Some(&bytes[start..end]),
            (CHUNK_BIN, 1) => bin = Some(&bytes[start..end]),
            (CHUNK_JSON | CHUNK_BIN, _) => {
                return Err(format!(
                    "GLB chunk {chunk_index} is out of place: the first must be JSON, the second BIN"
                ));
            }
            // The specification wants unknown chunks skipped.
            _ => {}
        }
        offset = end;
        chunk_index += 1;
    }
    json.map(|json| text(json, bin)).ok_or_else(|| "GLB without a JSON chunk".into())
}

fn read_u32(bytes: &[u8], offset: usize) -> Option<u32> {
    let four = bytes.get(offset..offset.checked_add(4)?)?;
    four.try_into().ok().map(u32::from_le_bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut body = Vec::new();
        for (kind, data) in chunks {
            body.extend((data.len() as u32).to_le_bytes());
            body.extend(*kind);
            body.extend(*data);
        }
        let mut bytes = MAGIC.to_vec();
        bytes.extend(2u32.to_le_bytes());
        bytes.extend((HEADER_SIZE as u32 + body.len() as u32).to_le_bytes());
        bytes.extend(body);
        bytes
    }

    #[test]
    fn splits_json_and_bin_and_skips_unknown_chunks() {
        let bytes = glb(&[(b"JSON", b"{}  "), (b"BIN\0", b"1234"), (b"what", b"zzzz")]);
        let parts = split(&bytes).unwrap();
        assert_eq!(parts, Container { json: b"{}  ", bin: Some(b"1234") });
    }

    #[test]
    fn every_truncation_of_a_glb_is_refused() {
        let bytes = glb(&[(b"JSON", b"{}  "), (b"BIN\0", b"1234")]);
        for length in MAGIC.len()..bytes.len() {
            let message = split(&bytes[..length]).unwrap_err();
            assert!(message.contains("truncated GLB"), "{length}: {message}");
        }
    }

    #[test]
    fn chunk_lengths_beyond_the_container_are_refused() {
        let mut bytes = glb(&[(b"JSON", b"{}  ")]);
        bytes[HEADER_SIZE..HEADER_SIZE + 4].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(split(&bytes).unwrap_err().contains("chunk 0 ends at byte"));
    }

    #[test]
    fn misplaced_chunks_are_refused() {
        let swapped = glb(&[(b"BIN\0", b"1234"), (b"JSON", b"{}  ")]);
        assert!(split(&swapped).unwrap_err().contains("out of place"));
        assert!(split(&glb(&[])).unwrap_err().contains("without a JSON chunk"));
    }
}
