//! Modes TRIANGLES and INDICES.

use super::{Reader, split};

const UNWRITTEN: &str = "the compressed stream refers to a vertex or an edge before its first";

/// The newest sixteen entries; the newest has index 0.
struct Fifo<T> {
    entries: [Option<T>; 16],
    newest: usize,
}

impl<T: Copy> Fifo<T> {
    fn new() -> Self {
        Self { entries: [None; 16], newest: 0 }
    }

    fn push(&mut self, entry: T) {
        self.newest = (self.newest + 1) % 16;
        self.entries[self.newest] = Some(entry);
    }

    fn get(&self, index: u8) -> Result<T, String> {
        let entry = self.entries[(self.newest + 16 - usize::from(index)) % 16];
        entry.ok_or_else(|| UNWRITTEN.into())
    }
}

/// The state of a triangle stream.
struct Triangles<'a> {
    data: Reader<'a>,
    edges: Fifo<(u32, u32)>,
    vertices: Fifo<u32>,
    /// The index expected of a vertex that is new.
    next: u32,
    /// The last index that was written out.
    last: u32,
}

/// `count` indices, a multiple of 3.
pub(super) fn decode_triangles(stream: &[u8], count: usize) -> Result<Vec<u32>, String> {
    let (mut reader, _, table) = split(stream, &[0xE1], |_| 16)?;
    let is_wide = |byte: &u8| byte & 15 == 15 || byte >> 4 == 15;
    if table[14..] != [0, 0] || table.iter().any(is_wide) {
        return Err("the table at the end of the compressed stream is broken".into());
    }
    let codes = reader.take(count / 3)?;
    let (edges, vertices) = (Fifo::new(), Fifo::new());
    let mut state = Triangles { data: reader, edges, vertices, next: 0, last: 0 };
    let mut indices = Vec::with_capacity(count);
    for code in codes {
        let triangle = match (code >> 4, code & 15) {
            (15, low @ ..14) => state.new_triangle(false, table[usize::from(low)])?,
            (15, low) => {
                let aux = state.data.byte()?;
                if aux == 0 {
                    state.next = 0;
                }
                state.new_triangle(low == 15, aux)?
            }
            (edge, third) => state.beside_edge(edge, third)?,
        };
        indices.extend(triangle);
    }
    state.data.finish()?;
    Ok(indices)
}

impl Triangles<'_> {
    fn take_next(&mut self) -> u32 {
        let next = self.next;
        self.next = next.wrapping_add(1);
        next
    }

    fn explicit(&mut self) -> Result<u32, String> {
        self.last = self.last.wrapping_add(unzigzag(self.data.varint()?));
        Ok(self.last)
    }

    /// A triangle on an edge of a recent one.
    fn beside_edge(&mut self, edge: u8, third: u8) -> Result<[u32; 3], String> {
        let (a, b) = self.edges.get(edge)?;
        let c = match third {
            0 => self.take_next(),
            1..13 => self.vertices.get(third)?,
            13 | 14 => {
                let step = if third == 13 { u32::MAX } else { 1 };
                self.last = self.last.wrapping_add(step);
                self.last
            }
            _ => self.explicit()?,
        };
        self.edges.push((c, b));
        self.edges.push((a, c));
        if !(1..13).contains(&third) {
            self.vertices.push(c);
        }
        Ok([a, b, c])
    }

    /// A triangle that shares no recent edge. The halves of `aux` say where its second and
    /// third vertex come from.
    fn new_triangle(&mut self, is_first_explicit: bool, aux: u8) -> Result<[u32; 3], String> {
        let (second, third) = (aux >> 4, aux & 15);
        let a = if is_first_explicit { self.explicit()? } else { self.take_next() };
        let b = self.other(second)?;
        let c = self.other(third)?;
        for edge in [(b, a), (c, b), (a, c)] {
            self.edges.push(edge);
        }
        self.vertices.push(a);
        for (vertex, source) in [(b, second), (c, third)] {
            if source == 0 || source == 15 {
                self.vertices.push(vertex);
            }
        }
        Ok([a, b, c])
    }

    fn other(&mut self, source: u8) -> Result<u32, String> {
        match source {
            0 => Ok(self.take_next()),
            15 => self.explicit(),
            recent => self.vertices.get(recent - 1),
        }
    }
}

/// `count` indices of any topology.
pub(super) fn decode_sequence(stream: &[u8], count: usize) -> Result<Vec<u32>, String> {
    let (mut reader, _, _) = split(stream, &[0xD1], |_| 4)?;
    // Every index has at least a byte, so a short stream cannot ask for much.
    if count > reader.rest.len() {
        return Err("the compressed stream ends too early".into());
    }
    let mut baselines = [0_u32; 2];
    let indices = (0..count).map(|_| {
        let value = reader.varint()?;
        let baseline = &mut baselines[(value & 1) as usize];
        *baseline = baseline.wrapping_add(unzigzag(value >> 1));
        Ok(*baseline)
    });
    let indices = indices.collect::<Result<_, String>>()?;
    reader.finish()?;
    Ok(indices)
}

fn unzigzag(value: u32) -> u32 {
    (value >> 1) ^ (value & 1).wrapping_neg()
}
