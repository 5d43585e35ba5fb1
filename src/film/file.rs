//! Film files: sums and whatever else a render needs to be gone on with, or joined with others.
//!
//! Little-endian: 8 bytes of magic, the format's number (u32), the length of the head (u32), the
//! head as JSON, which names the sections and their lengths, the sections one after the
//! other, and the CRC-32 (ISO 3309) of all of that.

use crate::image::write_atomically;
use crate::{Error, Result};
use bytemuck::{Pod, Zeroable};
use crc32fast::Hasher;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

const MAGIC: [u8; 8] = *b"STERFILM";
/// Raised when files of before can not be read any more.
const FORMAT: u32 = 1;
/// Bytes before the head.
const PREFIX: u64 = 16;
/// Bytes of the checksum.
const SUFFIX: u64 = 4;
/// Bytes that are copied or checked at once.
const CHUNK: usize = 1 << 20;

/// Named contents of a film file.
pub type Sections<'a> = Vec<(String, Cow<'a, [u8]>)>;

#[derive(Serialize, Deserialize)]
struct Head {
    /// Of the caller.
    head: Value,
    /// Names and lengths in bytes, in the order of the file.
    sections: Vec<(String, u64)>,
}

/// A film file that is whole.
#[derive(Debug)]
pub struct FilmFile {
    path: PathBuf,
    head: Value,
    /// Names, first bytes, lengths.
    sections: Vec<(String, u64, u64)>,
}

fn invalid(path: &Path, message: impl Into<String>) -> Error {
    Error::io(path, io::Error::new(ErrorKind::InvalidData, message.into()))
}

/// Creates or replaces the film file at `path`: at any time there is the old one or the whole new one.
///
/// # Errors
/// [`Error::Io`].
pub fn write_film_file(path: &Path, head: &impl Serialize, sections: &Sections) -> Result<()> {
    let failure = |e: io::Error| Error::io(path, e);
    let lengths = sections.iter().map(|(name, bytes)| (name.clone(), bytes.len() as u64));
    let head = serde_json::to_value(head).map_err(|e| failure(e.into()))?;
    let head = Head { head, sections: lengths.collect() };
    let head = serde_json::to_vec(&head).map_err(|e| failure(e.into()))?;
    write_atomically(path, |file| {
        let mut crc = Hasher::new();
        let mut put = |bytes: &[u8]| {
            crc.update(bytes);
            file.write_all(bytes)
        };
        put(&MAGIC).map_err(failure)?;
        put(&FORMAT.to_le_bytes()).map_err(failure)?;
        put(&(head.len() as u32).to_le_bytes()).map_err(failure)?;
        put(&head).map_err(failure)?;
        for (_, bytes) in sections {
            bytes.chunks(CHUNK).try_for_each(&mut put).map_err(failure)?;
        }
        file.write_all(&crc.finalize().to_le_bytes()).map_err(failure)
    })
}

impl FilmFile {
    /// Opens a file and reads it once, to see that it is what was written.
    ///
    /// # Errors
    /// [`Error::Io`]: it cannot be read, is no film file, is cut off or damaged.
    pub fn open(path: &Path) -> Result<Self> {
        let failure = |e: io::Error| Error::io(path, e);
        let mut file = BufReader::with_capacity(CHUNK, File::open(path).map_err(failure)?);
        let length = file.get_ref().metadata().map_err(failure)?.len();
        let mut prefix = [0; PREFIX as usize];
        let is_read = file.read_exact(&mut prefix).is_ok();
        let word =
            |at: usize| u32::from_le_bytes(prefix[at..at + 4].try_into().unwrap_or_default());
        if !is_read || prefix[..8] != MAGIC {
            return Err(invalid(path, "is not a film file"));
        }
        if word(8) != FORMAT {
            let message =
                format!("is a film file of format {}; this program reads {FORMAT}", word(8));
            return Err(invalid(path, message));
        }
        let head_length = u64::from(word(12));
        let cut = || invalid(path, format!("is cut off after {length} bytes: make it anew"));
        if PREFIX + head_length + SUFFIX > length {
            return Err(cut());
        }
        let mut head = vec![0; head_length as usize];
        file.read_exact(&mut head).map_err(failure)?;
        let parsed: Head = serde_json::from_slice(&head)
            .map_err(|e| invalid(path, format!("is damaged: its head cannot be read: {e}")))?;
        let mut at = PREFIX + head_length;
        let mut sections = Vec::new();
        for (name, bytes) in parsed.sections {
            sections.push((name, at, bytes));
            at = at.saturating_add(bytes);
        }
        if at.saturating_add(SUFFIX) != length {
            return Err(if at.saturating_add(SUFFIX) > length {
                cut()
            } else {
                invalid(path, "is damaged: it has more bytes than its head says")
            });
        }
        let mut crc = Hasher::new();
        crc.update(&prefix);
        crc.update(&head);
        let mut chunk = vec![0; CHUNK];
        let mut left = at - PREFIX - head_length;
        while left > 0 {
            let part = &mut chunk[..left.min(CHUNK as u64) as usize];
            file.read_exact(part).map_err(failure)?;
            crc.update(part);
            left -= part.len() as u64;
        }
        let mut sum = [0; SUFFIX as usize];
        file.read_exact(&mut sum).map_err(failure)?;
        if crc.finalize() != u32::from_le_bytes(sum) {
            return Err(invalid(path, "is damaged: its checksum is wrong; make it anew"));
        }
        Ok(Self { path: path.to_owned(), head: parsed.head, sections })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What the head says.
    ///
    /// # Errors
    /// [`Error::Io`] if it is of another kind.
    pub fn head<T: DeserializeOwned>(&self) -> Result<T> {
        T::deserialize(&self.head).map_err(|e| {
            invalid(&self.path, format!("was written by another version of this program: {e}"))
        })
    }

    /// Whether it has that section.
    pub fn has(&self, name: &str) -> bool {
        self.sections.iter().any(|(n, ..)| n == name)
    }

    /// Bytes of a section; 0 where there is none.
    pub fn section_bytes(&self, name: &str) -> u64 {
        self.sections.iter().find(|(n, ..)| n == name).map_or(0, |s| s.2)
    }

    /// An [`Error::Io`] about what the file holds.
    pub fn misfit(&self, message: &str) -> Error {
        invalid(&self.path, message)
    }

    /// A section as `count` elements.
    ///
    /// # Errors
    /// [`Error::Io`]: there is none, or it has not so many.
    pub fn section<T: Pod + Zeroable>(&self, name: &str, count: usize) -> Result<Vec<T>> {
        let failure = |e: io::Error| Error::io(&self.path, e);
        let found = self.sections.iter().find(|(n, ..)| n == name);
        let Some(&(_, at, bytes)) = found else {
            return Err(invalid(&self.path, format!("has no section {name}")));
        };
        if bytes != (count * size_of::<T>()) as u64 {
            let message = format!("section {name} has {bytes} bytes for {count} elements");
            return Err(invalid(&self.path, message));
        }
        let mut elements = vec![T::zeroed(); count];
        let mut file = File::open(&self.path).map_err(failure)?;
        file.seek(SeekFrom::Start(at)).map_err(failure)?;
        file.read_exact(bytemuck::cast_slice_mut(&mut elements)).map_err(failure)?;
        Ok(elements)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(path: &Path) {
        let numbers = [1.5_f64, -2.0, 1e300];
        let sections: Sections = vec![
            ("numbers".into(), bytemuck::cast_slice(&numbers).into()),
            ("nothing".into(), Cow::Borrowed(&[])),
            ("words".into(), vec![7; 3 * CHUNK + 4].into()),
        ];
        write_film_file(path, &("a head", 7), &sections).unwrap();
    }

    #[test]
    fn what_is_written_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.film");
        write(&path);
        let file = FilmFile::open(&path).unwrap();
        assert_eq!(file.head::<(String, u32)>().unwrap(), ("a head".into(), 7));
        assert_eq!(file.section::<f64>("numbers", 3).unwrap(), [1.5, -2.0, 1e300]);
        assert!(file.section::<u8>("nothing", 0).unwrap().is_empty());
        assert_eq!(
            file.section::<u32>("words", 3 * CHUNK / 4 + 1).unwrap(),
            vec![0x0707_0707_u32; 3 * CHUNK / 4 + 1]
        );
        assert!(file.has("words") && !file.has("others"));
        assert!(
            file.section::<f64>("numbers", 2).is_err() && file.section::<u8>("others", 0).is_err()
        );
        assert!(file.head::<u32>().is_err());
    }

    /// Any byte that is changed, and any that is missing.
    #[test]
    fn damage_is_seen() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.film");
        write(&path);
        let whole = std::fs::read(&path).unwrap();
        let n = whole.len();
        for at in (0..200).chain([n / 2, n - 5, n - 1]) {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x10;
            std::fs::write(&path, &bytes).unwrap();
            let error = FilmFile::open(&path).expect_err("a changed byte").to_string();
            assert!(error.contains("a.film"), "{error}");
        }
        for length in (0..200).chain([n / 2, n - 5, n - 1]) {
            std::fs::write(&path, &whole[..length]).unwrap();
            let error = FilmFile::open(&path).expect_err("a file that is cut").to_string();
            assert!(error.contains("cut off") || error.contains("not a film file"), "{error}");
        }
        std::fs::write(&path, [&whole[..], &[0]].concat()).unwrap();
        assert!(FilmFile::open(&path).unwrap_err().to_string().contains("more bytes"));
    }
}
