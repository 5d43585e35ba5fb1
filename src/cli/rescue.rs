//! What cannot be written where it should be is not lost.

use std::io;
use std::path::Path;
use steradian::{Error, Result};

/// Has `write` make the file at `path`; where the system does not let it, another of the same name in a
/// new folder for temporary files. It is an error all the same, which says where the file is.
pub(super) fn or_elsewhere(path: &Path, write: impl Fn(&Path) -> Result<()>) -> Result<()> {
    let Err(error) = write(path) else { return Ok(()) };
    let (Error::Io { source, .. }, Some(name)) = (&error, path.file_name()) else {
        return Err(error);
    };
    let Ok(folder) = tempfile::Builder::new().prefix("steradian-").tempdir() else {
        return Err(error);
    };
    let other = folder.path().join(name);
    if write(&other).is_err() {
        return Err(error);
    }
    // It stays.
    let _ = folder.keep();
    let message = format!("{source}; what should be there is {}", other.display());
    Err(Error::io(path, io::Error::new(source.kind(), message)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian::image::write_atomically;

    #[test]
    fn a_file_without_its_folder_is_elsewhere() {
        let folder = tempfile::tempdir().unwrap();
        let write = |path: &Path| {
            write_atomically(path, |file| {
                io::Write::write_all(file, b"work").map_err(|e| Error::io(path, e))
            })
        };
        or_elsewhere(&folder.path().join("a"), write).unwrap();
        let error = or_elsewhere(&folder.path().join("gone/a"), write).unwrap_err().to_string();
        let other = error.rsplit(' ').next().unwrap();
        assert_eq!(std::fs::read(other).unwrap(), b"work", "{error}");
        std::fs::remove_dir_all(Path::new(other).parent().unwrap()).unwrap();
        let error = or_elsewhere(&folder.path().join("a"), |path| {
            Err(Error::io(path, io::Error::from(io::ErrorKind::StorageFull)))
        });
        assert!(!error.unwrap_err().to_string().contains("should be there"));
    }
}
