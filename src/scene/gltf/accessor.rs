//! The one reader of accessors: every count, offset, stride and value is checked.

use super::buffers::Buffers;
use super::document::Document;
use crate::Result;
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::validation::Checked;
use gltf::json::{self, Index};

/// Where the elements of an accessor lie; everything in it is checked.
struct Layout<'a> {
    component: ComponentType,
    normalized: bool,
    /// Components of an element.
    width: usize,
    count: usize,
    /// Bytes from one element to the next.
    stride: usize,
    /// From the first element to the end of the last; `None` means zeros.
    bytes: Option<&'a [u8]>,
    sparse: Option<Sparse<'a>>,
}

/// Elements that replace those of the base, in rising order of their index.
struct Sparse<'a> {
    indices: Vec<u32>,
    /// Tightly packed elements.
    values: &'a [u8],
}

/// Reads accessors of one document.
pub(super) struct Accessors<'a> {
    pub(super) document: &'a Document,
    pub(super) buffers: &'a Buffers<'a>,
}

impl<'a> Accessors<'a> {
    /// Elements as `N` finite floats; integers are converted, and scaled to
    /// [0, 1] or [-1, 1] where the accessor is normalised. `accepted` lists the
    /// accessor types allowed; components that the accessor lacks get `fill`.
    /// `what` names the use in messages.
    pub(super) fn floats<const N: usize>(
        &self,
        index: Index<json::Accessor>,
        accepted: &[Type],
        fill: f32,
        what: &str,
    ) -> Result<Vec<[f32; N]>> {
        let elements = self.floats_unchecked(index, accepted, fill, what)?;
        match elements.iter().position(|e| e.iter().any(|c| !c.is_finite())) {
            None => Ok(elements),
            Some(i) => Err(self.document.error(format!(
                "{what}: element {i} is {:?}; every value must be finite",
                elements[i]
            ))),
        }
    }

    /// As [`floats`](Self::floats), with NaN and infinities let through.
    pub(super) fn floats_unchecked<const N: usize>(
        &self,
        index: Index<json::Accessor>,
        accepted: &[Type],
        fill: f32,
        what: &str,
    ) -> Result<Vec<[f32; N]>> {
        let layout = self.layout(index, accepted, what)?;
        // Not in glTF, nor by KHR_mesh_quantization: single precision would round them.
        if layout.component == ComponentType::U32 {
            return Err(self.document.error(format!("{what}: it must not be of UNSIGNED_INT")));
        }
        let decode = |bytes: &[u8]| {
            let mut element = [fill; N];
            let size = layout.component.size();
            for (value, bytes) in
                element.iter_mut().zip(bytes.chunks_exact(size)).take(layout.width)
            {
                *value = component_to_f32(layout.component, layout.normalized, bytes);
            }
            element
        };
        let element_size = layout.width * layout.component.size();
        let mut elements = match layout.bytes {
            Some(bytes) => (0..layout.count).map(|i| decode(&bytes[i * layout.stride..])).collect(),
            None => {
                let mut zero = [fill; N];
                zero.iter_mut().take(layout.width).for_each(|value| *value = 0.0);
                vec![zero; layout.count]
            }
        };
        if let Some(sparse) = layout.sparse {
            let values = sparse.values.chunks_exact(element_size);
            for (&index, bytes) in sparse.indices.iter().zip(values) {
                elements[index as usize] = decode(bytes);
            }
        }
        Ok(elements)
    }

    /// Unsigned integer scalars.
    pub(super) fn indices(&self, index: Index<json::Accessor>, what: &str) -> Result<Vec<u32>> {
        Ok(self.integers::<1>(index, Type::Scalar, what)?.into_flattened())
    }

    /// Elements of `N` unsigned integers.
    pub(super) fn integers<const N: usize>(
        &self,
        index: Index<json::Accessor>,
        kind: Type,
        what: &str,
    ) -> Result<Vec<[u32; N]>> {
        let layout = self.layout(index, &[kind], what)?;
        let unsigned = [ComponentType::U8, ComponentType::U16, ComponentType::U32];
        if !unsigned.contains(&layout.component) {
            return Err(self.document.error(format!("{what}: indices must be unsigned integers")));
        }
        let size = layout.component.size();
        let decode = |bytes: &[u8]| {
            std::array::from_fn(|k| component_to_u32(layout.component, &bytes[k * size..]))
        };
        let mut values = match layout.bytes {
            Some(bytes) => (0..layout.count).map(|i| decode(&bytes[i * layout.stride..])).collect(),
            None => vec![[0; N]; layout.count],
        };
        if let Some(sparse) = layout.sparse {
            let replacements = sparse.values.chunks_exact(N * size);
            for (&index, bytes) in sparse.indices.iter().zip(replacements) {
                values[index as usize] = decode(bytes);
            }
        }
        Ok(values)
    }

    /// Checks an accessor against its views, and takes its elements from the budget.
    fn layout(
        &self,
        index: Index<json::Accessor>,
        accepted: &[Type],
        what: &str,
    ) -> Result<Layout<'a>> {
        let document = self.document;
        let accessor = document.get(index, what)?;
        let what = format!("{what}, {}", document.label(index));
        let error = |message: String| document.error(format!("{what}: {message}"));

        let (Checked::Valid(component), Checked::Valid(kind)) =
            (accessor.component_type, accessor.type_)
        else {
            return Err(error("unknown componentType or type".into()));
        };
        if !accepted.contains(&kind) {
            return Err(error(format!("its type {kind:?} must be one of {accepted:?}")));
        }
        let count = accessor.count.0;
        document.budget.take_elements(count).map_err(error)?;
        let count = count as usize;
        let element_size = kind.multiplicity() * component.0.size();

        let mut stride = element_size;
        let decoded = self.buffers.decoded_accessor(index);
        let bytes = match accessor.buffer_view {
            _ if decoded.is_some() => {
                let bytes = decoded.unwrap_or_default();
                Some(span(bytes, 0, count, stride, element_size).map_err(error)?)
            }
            None => {
                document.budget.take_zero_elements(count as u64).map_err(error)?;
                None
            }
            Some(view) => {
                let bytes = self.buffers.view(document, view, &what)?;
                if let Some(json::buffer::Stride(given)) = document.get(view, &what)?.byte_stride {
                    stride = given;
                }
                if stride < element_size {
                    return Err(error(format!(
                        "byteStride {stride} is less than the {element_size} bytes of an element"
                    )));
                }
                let offset = accessor.byte_offset.unwrap_or_default().0;
                Some(span(bytes, offset, count, stride, element_size).map_err(error)?)
            }
        };
        let sparse = match &accessor.sparse {
            None => None,
            Some(sparse) => Some(self.sparse(sparse, count, element_size, &what)?),
        };
        Ok(Layout {
            component: component.0,
            normalized: accessor.normalized,
            width: kind.multiplicity(),
            count,
            stride,
            bytes,
            sparse,
        })
    }

    fn sparse(
        &self,
        sparse: &json::accessor::sparse::Sparse,
        count: usize,
        element_size: usize,
        what: &str,
    ) -> Result<Sparse<'a>> {
        let document = self.document;
        let what = format!("{what}, sparse");
        let error = |message: String| document.error(format!("{what}: {message}"));
        let replaced = sparse.count.0;
        if replaced > count as u64 {
            return Err(error(format!("replaces {replaced} of {count} elements")));
        }
        let replaced = replaced as usize;

        let Checked::Valid(component) = sparse.indices.component_type else {
            return Err(error("unknown componentType of the indices".into()));
        };
        let size = component.0.size();
        let bytes = self.buffers.view(document, sparse.indices.buffer_view, &what)?;
        let bytes =
            span(bytes, sparse.indices.byte_offset.0, replaced, size, size).map_err(error)?;
        let indices: Vec<u32> =
            bytes.chunks_exact(size).map(|b| component_to_u32(component.0, b)).collect();
        if let Some(pair) = indices.windows(2).find(|pair| pair[0] >= pair[1]) {
            return Err(error(format!("index {} follows {}; they must rise", pair[1], pair[0])));
        }
        if let Some(&last) = indices.last()
            && last as usize >= count
        {
            return Err(error(format!("index {last} exceeds the {count} elements")));
        }

        let bytes = self.buffers.view(document, sparse.values.buffer_view, &what)?;
        let offset = sparse.values.byte_offset.0;
        let values = span(bytes, offset, replaced, element_size, element_size).map_err(error)?;
        Ok(Sparse { indices, values })
    }
}

/// The part of a view from the first element to the end of the last.
fn span(
    view: &[u8],
    offset: u64,
    count: usize,
    stride: usize,
    element_size: usize,
) -> std::result::Result<&[u8], String> {
    let length = match count as u64 {
        0 => Some(0),
        count => (count - 1)
            .checked_mul(stride as u64)
            .and_then(|start| start.checked_add(element_size as u64)),
    };
    let end = length.and_then(|length| length.checked_add(offset));
    match end.filter(|&end| end <= view.len() as u64) {
        Some(end) => Ok(&view[offset as usize..end as usize]),
        None => Err(format!(
            "{count} elements, {stride} bytes apart, from byte {offset} go beyond the {} bytes of the bufferView",
            view.len()
        )),
    }
}

/// `bytes` starts with the component. Normalised integers by glTF 2.0, 3.6.2.2.
fn component_to_f32(component: ComponentType, normalized: bool, bytes: &[u8]) -> f32 {
    let (value, largest) = match component {
        ComponentType::F32 => return f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        ComponentType::I8 => (f32::from(bytes[0] as i8), 127.0),
        ComponentType::U8 => (f32::from(bytes[0]), 255.0),
        ComponentType::I16 => (f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
        ComponentType::U16 => (f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
        ComponentType::U32 => (component_to_u32(component, bytes) as f32, u32::MAX as f32),
    };
    if normalized { (value / largest).max(-1.0) } else { value }
}

/// `bytes` starts with the component, an unsigned integer.
fn component_to_u32(component: ComponentType, bytes: &[u8]) -> u32 {
    match component.size() {
        1 => u32::from(bytes[0]),
        2 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
        _ => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normalised_integers_reach_both_ends() {
        let byte = |b: u8| component_to_f32(ComponentType::I8, true, &[b]);
        assert_eq!([byte(127), byte(0), byte(0x81), byte(0x80)], [1.0, 0.0, -1.0, -1.0]);
        let short = |s: i16| component_to_f32(ComponentType::I16, true, &s.to_le_bytes());
        assert_eq!([short(i16::MAX), short(i16::MIN)], [1.0, -1.0]);
        assert_eq!(component_to_f32(ComponentType::U8, true, &[255]), 1.0);
        assert_eq!(component_to_f32(ComponentType::U16, true, &[255, 255]), 1.0);
        assert_eq!(component_to_f32(ComponentType::U16, false, &[1, 1]), 257.0);
    }

    #[test]
    fn a_span_ends_with_the_last_element_not_with_its_stride() {
        let view = [0u8; 20];
        assert_eq!(span(&view, 0, 2, 16, 4).unwrap().len(), 20);
        assert!(span(&view, 1, 2, 16, 4).is_err());
        assert!(span(&view, 0, 0, 16, 4).unwrap().is_empty());
        assert!(span(&view, u64::MAX, 2, 16, 4).is_err());
        assert!(span(&view, 0, usize::MAX, usize::MAX, 4).is_err());
    }
}
