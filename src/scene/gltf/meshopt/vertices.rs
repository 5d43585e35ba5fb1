//! Mode ATTRIBUTES: bytes of elements as differences to the element before.

use super::{Reader, split};

/// Elements of a group; their deltas have one width.
const GROUP: usize = 16;

/// Bits of a delta in a group by its two header bits: control mode 0, control mode 1, version 0.
const WIDTHS: [[u32; 4]; 3] = [[0, 1, 2, 4], [1, 2, 4, 8], [0, 2, 4, 8]];

/// `count` elements of `stride` bytes, a multiple of 4 up to 256.
pub(super) fn decode(stream: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, String> {
    let tail_length = |header| match header {
        0xA1 => (stride + stride / 4).max(24),
        _ => stride.max(32),
    };
    let (mut reader, header, tail) = split(stream, &[0xA0, 0xA1], tail_length)?;
    let is_version_1 = header == 0xA1;
    let channel_count = if is_version_1 { stride / 4 } else { 0 };
    // Baseline and channel modes are at the very end; what is before them is padding.
    let (rest, channels) = tail.split_at(tail.len() - channel_count);
    let mut last = rest[rest.len() - stride..].to_vec();
    let channels: Vec<Channel> = match is_version_1 {
        true => channels.iter().map(|&c| Channel::parse(c)).collect::<Result<_, _>>()?,
        false => vec![Channel::Bytes; stride / 4],
    };

    let largest_block = ((8192 / stride) & !(GROUP - 1)).min(256);
    let mut elements = vec![0; count * stride];
    // Of each byte of the element: the deltas of a block.
    let mut deltas = vec![0; stride * 256];
    for block in elements.chunks_mut(largest_block * stride) {
        let block_count = block.len() / stride;
        let controls = reader.take(channel_count)?;
        for (k, plane) in deltas.chunks_exact_mut(256).enumerate() {
            let control = controls.get(k / 4).map(|c| c >> (2 * (k % 4)) & 3);
            read_plane(&mut reader, control, block_count, plane)?;
        }
        for ((c, channel), planes) in channels.iter().enumerate().zip(deltas.chunks_exact(4 * 256))
        {
            for (i, element) in block.chunks_exact_mut(stride).enumerate() {
                let last: &mut [u8] = &mut last[4 * c..][..4];
                let delta = std::array::from_fn(|k| planes[k * 256 + i]);
                channel.apply(last, delta);
                element[4 * c..][..4].copy_from_slice(last);
            }
        }
    }
    reader.finish()?;
    Ok(elements)
}

/// The deltas of one byte position in a block. `control` is `None` in version 0.
fn read_plane(
    reader: &mut Reader,
    control: Option<u8>,
    count: usize,
    plane: &mut [u8],
) -> Result<(), String> {
    let widths = match control {
        Some(2) => {
            plane.fill(0);
            return Ok(());
        }
        Some(3) => {
            plane[..count].copy_from_slice(reader.take(count)?);
            return Ok(());
        }
        Some(mode) => WIDTHS[usize::from(mode)],
        None => WIDTHS[2],
    };
    let groups = count.div_ceil(GROUP);
    let header = reader.take(groups.div_ceil(4))?;
    for (g, group) in plane.chunks_exact_mut(GROUP).take(groups).enumerate() {
        let bits = header[g / 4] >> (2 * (g % 4)) & 3;
        read_group(reader, widths[usize::from(bits)], group)?;
    }
    Ok(())
}

/// Sixteen deltas of `width` bits. One with all bits set stands for a byte that follows.
fn read_group(reader: &mut Reader, width: u32, group: &mut [u8]) -> Result<(), String> {
    match width {
        0 => group.fill(0),
        8 => group.copy_from_slice(reader.take(GROUP)?),
        _ => {
            let per_byte = 8 / width as usize;
            let sentinel = (1 << width) - 1;
            let packed = reader.take(GROUP / per_byte)?;
            for (i, delta) in group.iter_mut().enumerate() {
                // Single bits begin with the lowest, wider ones with the highest.
                let place = if width == 1 { i % 8 } else { per_byte - 1 - i % per_byte };
                let value = packed[i / per_byte] >> (place as u32 * width) & sentinel;
                *delta = if value == sentinel { reader.byte()? } else { value };
            }
        }
    }
    Ok(())
}

/// What the deltas of four bytes are.
#[derive(Clone)]
enum Channel {
    /// Differences of bytes.
    Bytes,
    /// Differences of two 16-bit integers.
    Shorts,
    /// Exclusive or of a 32-bit integer, rotated left by so many bits.
    Xor(u32),
}

impl Channel {
    fn parse(byte: u8) -> Result<Self, String> {
        match (byte & 15, byte >> 4) {
            (0, 0) => Ok(Self::Bytes),
            (1, 0) => Ok(Self::Shorts),
            (2, rotation) => Ok(Self::Xor(rotation.into())),
            _ => Err(format!("the compressed stream has the unknown channel mode {byte:#04x}")),
        }
    }

    /// Four bytes of an element from the same of the one before.
    fn apply(&self, last: &mut [u8], delta: [u8; 4]) {
        match self {
            Self::Bytes => {
                for (last, delta) in last.iter_mut().zip(delta) {
                    *last = last.wrapping_add((delta >> 1) ^ (delta & 1).wrapping_neg());
                }
            }
            Self::Shorts => {
                for (last, delta) in last.chunks_exact_mut(2).zip(delta.chunks_exact(2)) {
                    let delta = u16::from_le_bytes([delta[0], delta[1]]);
                    let delta = (delta >> 1) ^ (delta & 1).wrapping_neg();
                    let value = u16::from_le_bytes([last[0], last[1]]).wrapping_add(delta);
                    last.copy_from_slice(&value.to_le_bytes());
                }
            }
            Self::Xor(rotation) => {
                let delta = u32::from_le_bytes(delta).rotate_right(*rotation);
                let value = u32::from_le_bytes([last[0], last[1], last[2], last[3]]) ^ delta;
                last.copy_from_slice(&value.to_le_bytes());
            }
        }
    }
}
