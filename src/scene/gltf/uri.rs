//! Which resources a scene may name: files inside its own folder, and data URIs.
//! Nothing else is ever opened, so a scene from a stranger cannot read other files.

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;
use std::path::{Component, Path, PathBuf};

/// Padding is optional: files in the wild leave it out.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// What a URI stands for.
#[derive(Debug)]
pub(super) enum Resource {
    /// The path of an existing regular file inside the scene's folder.
    File(PathBuf),
    /// The decoded payload of a data URI.
    Data(Vec<u8>),
}

/// Resolves `uri` against `folder`, the canonical folder of the scene file.
pub(super) fn resolve(folder: &Path, uri: &str) -> Result<Resource, String> {
    if let Some(scheme) = scheme(uri) {
        return match scheme.eq_ignore_ascii_case("data") {
            true => decode_data(&uri[scheme.len() + 1..]).map(Resource::Data),
            false => Err(format!(
                "the URI {} has the scheme {scheme:?}; only relative paths and data: URIs are read",
                quoted(uri)
            )),
        };
    }
    let relative = percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| format!("the URI {} does not decode to UTF-8", quoted(uri)))?;
    check_relative(&relative).map_err(|why| format!("the URI {} {why}", quoted(uri)))?;

    let path = folder.join(relative.as_ref());
    let canonical =
        path.canonicalize().map_err(|e| format!("the file {} cannot be read: {e}", quoted(uri)))?;
    if !canonical.starts_with(folder) {
        return Err(format!(
            "the URI {} is a link out of the scene's folder; copy the file into it",
            quoted(uri)
        ));
    }
    if !canonical.is_file() {
        return Err(format!("the URI {} is not a file", quoted(uri)));
    }
    Ok(Resource::File(canonical))
}

/// The URI for a message: escaped, and cut where it is long.
fn quoted(uri: &str) -> String {
    const SHOWN: usize = 80;
    match uri.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{:?}…", &uri[..end]),
        None => format!("{uri:?}"),
    }
}

/// The scheme of an absolute URI (RFC 3986, 3.1).
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let mut characters = scheme.chars();
    let starts_with_letter = characters.next().is_some_and(|c| c.is_ascii_alphabetic());
    let rest = characters.all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c));
    (starts_with_letter && rest).then_some(scheme)
}

fn check_relative(path: &str) -> Result<(), &'static str> {
    if path.is_empty() {
        return Err("is empty");
    }
    // A backslash separates folders on some systems and not on others.
    if path.contains(['\\', '\0']) {
        return Err("contains a backslash or NUL");
    }
    for component in Path::new(path).components() {
        match component {
            Component::Normal(_) | Component::CurDir => {}
            Component::ParentDir => {
                return Err("leaves the scene's folder; copy the file into it");
            }
            Component::RootDir | Component::Prefix(_) => {
                return Err("is an absolute path; only paths relative to the scene are read");
            }
        }
    }
    Ok(())
}

/// Decodes what follows `data:` (RFC 2397).
fn decode_data(rest: &str) -> Result<Vec<u8>, String> {
    let (header, payload) = rest.split_once(',').ok_or("a data URI without a comma")?;
    let is_base64 = header.rsplit(';').next().is_some_and(|p| p.eq_ignore_ascii_case("base64"));
    if !is_base64 {
        return Ok(percent_decode_str(payload).collect());
    }
    BASE64.decode(payload).map_err(|e| format!("a data URI whose base64 is damaged: {e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(folder: &Path, uri: &str) -> String {
        resolve(folder, uri).expect_err(uri)
    }

    #[test]
    fn files_in_the_folder_resolve_percent_decoded() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        std::fs::create_dir(root.join("sub")).unwrap();
        std::fs::write(root.join("sub/a b.bin"), "x").unwrap();
        match resolve(&root, "./sub/a%20b.bin").unwrap() {
            Resource::File(path) => assert_eq!(path, root.join("sub/a b.bin")),
            Resource::Data(_) => panic!("a file is no data URI"),
        }
    }

    #[test]
    fn everything_outside_the_folder_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().join("scene");
        std::fs::create_dir(&root).unwrap();
        let root = root.canonicalize().unwrap();
        std::fs::write(folder.path().join("secret"), "x").unwrap();

        assert!(refusal(&root, "../secret").contains("leaves the scene's folder"));
        assert!(refusal(&root, "%2e%2e/secret").contains("leaves the scene's folder"));
        assert!(refusal(&root, "..\\secret").contains("backslash"));
        assert!(refusal(&root, "/etc/passwd").contains("absolute path"));
        assert!(refusal(&root, "%2Fetc/passwd").contains("absolute path"));
        assert!(refusal(&root, "file:///etc/passwd").contains("scheme \"file\""));
        assert!(refusal(&root, "HTTP://example.org/x").contains("scheme \"HTTP\""));
        assert!(refusal(&root, "%FF.bin").contains("UTF-8"));
        assert!(refusal(&root, "").contains("empty"));
        assert!(refusal(&root, ".").contains("not a file"));
        assert!(refusal(&root, "absent.bin").contains("absent.bin"));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_out_of_the_folder_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().join("scene");
        std::fs::create_dir(&root).unwrap();
        std::fs::write(folder.path().join("secret"), "x").unwrap();
        std::os::unix::fs::symlink("../secret", root.join("inside")).unwrap();
        let root = root.canonicalize().unwrap();
        assert!(refusal(&root, "inside").contains("link out of the scene's folder"));
    }

    #[test]
    fn data_uris_decode() {
        let decode = |uri: &str| match resolve(Path::new("."), uri) {
            Ok(Resource::Data(bytes)) => Ok(bytes),
            Ok(Resource::File(path)) => panic!("{uri} became {path:?}"),
            Err(message) => Err(message),
        };
        let expected = b"\x00\x01\x02\x03".to_vec();
        assert_eq!(decode("data:application/octet-stream;base64,AAECAw==").unwrap(), expected);
        assert_eq!(decode("data:;base64,AAECAw").unwrap(), expected);
        assert_eq!(decode("DATA:,%00%01%02%03").unwrap(), expected);
        assert!(decode("data:;base64,A*").unwrap_err().contains("base64"));
        assert!(decode("data:nothing").unwrap_err().contains("comma"));
    }
}
