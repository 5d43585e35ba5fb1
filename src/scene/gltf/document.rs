//! The parsed JSON of a scene file, and how its objects are named in messages.

use super::limits::{self, Budget};
use super::motion::RawAnimation;
use super::skins::RawSkin;
use super::uri::Reach;
use crate::{Error, Result};
use gltf::json;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A scene file's JSON. Its indices are not checked: whoever uses one looks it
/// up with [`get`](Document::get).
pub(super) struct Document {
    /// The scene file as the caller named it.
    pub(super) path: PathBuf,
    /// Where its resources lie.
    pub(super) reach: Reach,
    /// The JSON as the `gltf` crate's types.
    pub(super) root: json::Root,
    /// The JSON as it is, for extensions those types lack; without what is never read.
    pub(super) raw: Value,
    /// The skins, which `root` lacks.
    pub(super) skins: Vec<RawSkin>,
    /// The animations, which `root` lacks.
    pub(super) animations: Vec<RawAnimation>,
    /// What was used of the loader's limits.
    pub(super) budget: Budget,
}

impl Document {
    /// Parses the JSON text of the scene file `path`, which may name files within `reach`.
    pub(super) fn parse(path: &Path, json: &[u8], reach: Reach, budget: Budget) -> Result<Self> {
        let invalid = |e: &dyn std::fmt::Display| Error::scene(path, format!("not glTF 2.0: {e}"));
        limits::check_json(json).map_err(|message| Error::scene(path, message))?;
        let mut raw: Value = serde_json::from_slice(json).map_err(|e| invalid(&e))?;
        check_version(&raw).map_err(|e| invalid(&e))?;
        let materials = raw.get("materials").and_then(Value::as_array).map_or(0, Vec::len);
        limits::check_materials(materials).map_err(|message| Error::scene(path, message))?;
        normalize_integers(&mut raw).map_err(|e| invalid(&e))?;
        // The crate refuses valid animations whose target is an extension's, and skins.
        let skins = take_list(&mut raw, "skins").map_err(|e| invalid(&e))?;
        let animations = take_list(&mut raw, "animations").map_err(|e| invalid(&e))?;
        let root =
            json::Root::deserialize(&raw).map_err(|e| match json::Root::from_slice(json) {
                // Read from the text, the same fault has a line number.
                Err(located) => invalid(&located),
                Ok(_) => invalid(&e),
            })?;
        Ok(Self { path: path.into(), reach, root, raw, skins, animations, budget })
    }

    /// An error in the scene file.
    pub(super) fn error(&self, message: impl Into<String>) -> Error {
        Error::scene(&self.path, message)
    }

    /// The object that `index` refers to, or an error naming who refers to it.
    pub(super) fn get<T: Kind>(&self, index: json::Index<T>, referrer: &str) -> Result<&T>
    where
        json::Root: json::root::Get<T>,
    {
        self.root.get(index).ok_or_else(|| {
            self.error(format!("{referrer} refers to {} {index}, which does not exist", T::NAME))
        })
    }

    /// `mesh 3 "Chair"`, for messages.
    pub(super) fn label<T: Kind>(&self, index: json::Index<T>) -> String
    where
        json::Root: json::root::Get<T>,
    {
        match self.root.get(index).and_then(T::name) {
            Some(name) => format!("{} {index} {}", T::NAME, quoted(name)),
            None => format!("{} {index}", T::NAME),
        }
    }

    /// The object's name in the file, or `mesh 3`.
    pub(super) fn name<T: Kind>(&self, index: json::Index<T>) -> String
    where
        json::Root: json::root::Get<T>,
    {
        match self.root.get(index).and_then(T::name) {
            Some(name) if !name.is_empty() => name.into(),
            _ => format!("{} {index}", T::NAME),
        }
    }
}

/// Text of the file for a message: quoted, escaped, and cut where it is long.
pub(super) fn quoted(text: &str) -> String {
    const SHOWN: usize = 80;
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{:?}…", &text[..end]),
        None => format!("{text:?}"),
    }
}

/// A kind of glTF object with an index.
pub(super) trait Kind {
    /// What messages call it.
    const NAME: &str;
    /// Its name in the file.
    fn name(&self) -> Option<&str>;
}

macro_rules! kinds {
    ($($kind:ty: $name:literal;)*) => {$(
        impl Kind for $kind {
            const NAME: &str = $name;
            fn name(&self) -> Option<&str> {
                self.name.as_deref()
            }
        }
    )*};
}

kinds! {
    json::Accessor: "accessor";
    json::Buffer: "buffer";
    json::buffer::View: "bufferView";
    json::Camera: "camera";
    json::Image: "image";
    json::extensions::scene::khr_lights_punctual::Light: "light";
    json::Material: "material";
    json::Mesh: "mesh";
    json::Node: "node";
    json::Scene: "scene";
    json::Texture: "texture";
    json::texture::Sampler: "sampler";
}

/// Removes a top-level list and reads it.
fn take_list<T: DeserializeOwned>(
    raw: &mut Value,
    name: &str,
) -> std::result::Result<Vec<T>, String> {
    match raw.as_object_mut().and_then(|members| members.remove(name)) {
        Some(list) => serde_json::from_value(list).map_err(|e| format!("{name}: {e}")),
        None => Ok(Vec::new()),
    }
}

fn check_version(raw: &Value) -> std::result::Result<(), String> {
    let asset = raw.get("asset").ok_or("it has no asset object")?;
    let version = asset.get("version").and_then(Value::as_str).ok_or("asset has no version")?;
    if version.split('.').next() != Some("2") {
        return Err(format!("asset.version is {version:?}; only 2.x is read"));
    }
    match asset.get("minVersion").and_then(Value::as_str) {
        None | Some("2.0") => Ok(()),
        Some(minimum) => Err(format!("it needs glTF {minimum:?}; this program reads 2.0")),
    }
}

/// Writes integers as such where the file says `3.0` or `3e0`, as it may
/// (glTF 2.0, 2.7), and refuses those beyond 32 bits, which the parsed types
/// would cut down to another, valid index. No offset or length comes near: all
/// input together is limited to 4 GiB. Extras belong to other programs.
fn normalize_integers(raw: &mut Value) -> std::result::Result<(), String> {
    const MAX: u64 = u32::MAX as u64;
    let mut pending = vec![raw];
    while let Some(value) = pending.pop() {
        match value {
            Value::Array(items) => pending.extend(items),
            Value::Object(members) => {
                pending.extend(members.iter_mut().filter(|(k, _)| *k != "extras").map(|(_, v)| v));
            }
            Value::Number(number) => match (number.as_u64(), number.as_f64()) {
                (Some(n), _) if n > MAX => {
                    return Err(format!("the integer {n} does not fit 32 bits"));
                }
                (None, Some(n)) if n.fract() == 0.0 && (0.0..=MAX as f64).contains(&n) => {
                    *value = Value::from(n as u64);
                }
                _ => {}
            },
            _ => {}
        }
    }
    Ok(())
}
