//! Which resources a scene may name: files inside its own folder and the folders that
//! the user allows, and data URIs. Nothing else is ever opened, so a scene from a stranger
//! cannot read other files.

use super::document::quoted;
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

/// The folders whose files a scene may name; all are canonical.
#[derive(Debug, Default)]
pub(super) struct Reach {
    /// That of the scene file; `None` for a scene without one, which may name no files.
    folder: Option<PathBuf>,
    /// Others that the user allows. Where there are any, a URI may be an absolute path
    /// and may have `..` in it, as long as the file itself lies in one of the folders.
    external: Vec<PathBuf>,
}

impl Reach {
    /// From folders as they were named; the error has the one that cannot be read.
    pub(super) fn new(
        folder: Option<&Path>,
        external: &[PathBuf],
    ) -> Result<Self, (PathBuf, std::io::Error)> {
        let canonical = |path: &Path| path.canonicalize().map_err(|e| (path.to_owned(), e));
        Ok(Self {
            folder: folder.map(canonical).transpose()?,
            external: external.iter().map(|path| canonical(path)).collect::<Result<_, _>>()?,
        })
    }

    /// Whether a canonical path lies in one of the folders.
    fn contains(&self, path: &Path) -> bool {
        self.folder.iter().chain(&self.external).any(|folder| path.starts_with(folder))
    }
}

/// What a URI stands for.
#[derive(Debug)]
pub(super) enum Resource {
    /// The canonical path of an existing regular file inside an allowed folder.
    File(PathBuf),
    /// The decoded payload of a data URI.
    Data(Vec<u8>),
}

/// Resolves `uri` against the scene's folder.
pub(super) fn resolve(reach: &Reach, uri: &str) -> Result<Resource, String> {
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
    let Some(folder) = &reach.folder else {
        return Err(format!("the URI {} names a file; only data: URIs are read here", quoted(uri)));
    };
    check_path(&relative, !reach.external.is_empty())
        .map_err(|why| format!("the URI {} {why}", quoted(uri)))?;

    let path = folder.join(relative.as_ref());
    let canonical =
        path.canonicalize().map_err(|e| format!("the file {} cannot be read: {e}", quoted(uri)))?;
    if !reach.contains(&canonical) {
        return Err(format!(
            "the URI {} is a link out of the scene's folder; {REMEDY}",
            quoted(uri)
        ));
    }
    if !canonical.is_file() {
        return Err(format!("the URI {} is not a file", quoted(uri)));
    }
    Ok(Resource::File(canonical))
}

/// The scheme of an absolute URI (RFC 3986, 3.1).
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let mut characters = scheme.chars();
    let starts_with_letter = characters.next().is_some_and(|c| c.is_ascii_alphabetic());
    let rest = characters.all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c));
    (starts_with_letter && rest).then_some(scheme)
}

/// What to do about a file that lies elsewhere.
const REMEDY: &str = "copy the file into it, or allow its folder with --allow-external";

/// Checks the form of a percent-decoded path; `may_leave` the scene's folder, for another
/// that is allowed.
fn check_path(path: &str, may_leave: bool) -> Result<(), String> {
    if path.is_empty() {
        return Err("is empty".into());
    }
    // A backslash separates folders on some systems and not on others.
    if path.contains(['\\', '\0']) {
        return Err("contains a backslash or NUL".into());
    }
    for component in Path::new(path).components() {
        match component {
            Component::Normal(_) | Component::CurDir => {}
            _ if may_leave => {}
            Component::ParentDir => return Err(format!("leaves the scene's folder; {REMEDY}")),
            Component::RootDir | Component::Prefix(_) => {
                return Err(format!("is an absolute path out of the scene's folder; {REMEDY}"));
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

    /// Of a scene in this folder, with nothing else allowed.
    fn only(folder: &Path) -> Reach {
        Reach::new(Some(folder), &[]).unwrap()
    }

    fn refusal(folder: &Path, uri: &str) -> String {
        resolve(&only(folder), uri).expect_err(uri)
    }

    #[test]
    fn files_in_the_folder_resolve_percent_decoded() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        std::fs::create_dir(root.join("sub")).unwrap();
        std::fs::write(root.join("sub/a b.bin"), "x").unwrap();
        match resolve(&only(&root), "./sub/a%20b.bin").unwrap() {
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
        assert!(refusal(&root, "a%00.bin").contains("NUL"));
        assert!(refusal(&root, "sub/../../secret").contains("leaves the scene's folder"));
        assert!(refusal(&root, "%252e%252e/secret").contains("cannot be read"));
        assert!(refusal(&root, "//example.org/x").contains("absolute path"));
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

    #[cfg(unix)]
    #[test]
    fn an_allowed_folder_is_read_and_no_other() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["scene", "shared", "secret", "shared secret"] {
            std::fs::create_dir(folder.path().join(name)).unwrap();
            std::fs::write(folder.path().join(name).join("x"), name).unwrap();
        }
        let links = [("../secret/x", "shared/out"), ("../shared/x", "scene/in")];
        for (target, link) in links {
            std::os::unix::fs::symlink(target, folder.path().join(link)).unwrap();
        }
        // The allowed folder may itself be named by way of a link or `..`.
        let allowed = folder.path().join("scene/../shared");
        let scene = folder.path().join("scene");
        let reach = Reach::new(Some(&scene), &[allowed]).unwrap();
        let read = |uri: &str| match resolve(&reach, uri) {
            Ok(Resource::File(path)) => Ok(std::fs::read_to_string(path).unwrap()),
            Ok(Resource::Data(_)) => panic!("{uri} is no data URI"),
            Err(message) => Err(message),
        };
        let absolute = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        for uri in ["../shared/x", "in", "%2E./shared/x", &absolute("shared/x")] {
            assert_eq!(read(uri).as_deref(), Ok("shared"), "{uri}");
        }
        assert_eq!(read("x").as_deref(), Ok("scene"));
        let outside =
            ["../secret/x", "../shared/out", "../shared%20secret/x", &absolute("secret/x")];
        for uri in outside {
            assert!(read(uri).unwrap_err().contains("out of the scene's folder"), "{uri}");
        }
        assert!(read(&format!("file://{}", absolute("shared/x"))).unwrap_err().contains("scheme"));
        assert!(Reach::new(None, &[folder.path().join("absent")]).is_err());
    }

    #[test]
    fn a_scene_without_a_folder_names_no_files() {
        let refusal = resolve(&Reach::default(), "Cargo.toml").unwrap_err();
        assert!(refusal.contains("only data: URIs"), "{refusal}");
    }

    #[test]
    fn data_uris_decode() {
        let decode = |uri: &str| match resolve(&Reach::default(), uri) {
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
