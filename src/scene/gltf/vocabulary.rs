//! Notes what of a file's JSON glTF 2.0 does not have: a misspelt factor has no effect, and
//! whoever wrote it should hear of that.

use super::notices::Notices;
use serde_json::Value;

/// A kind of object: its members, and those of them that are objects, or lists of such,
/// whose members are known too.
struct Kind {
    members: &'static [&'static str],
    objects: &'static [(&'static str, &'static Kind)],
}

const fn plain(members: &'static [&'static str]) -> Kind {
    Kind { members, objects: &[] }
}

const FILE: Kind = Kind {
    members: &["extensionsUsed", "extensionsRequired", "scene"],
    objects: &[
        ("accessors", &ACCESSOR),
        ("animations", &ANIMATION),
        ("asset", &plain(&["copyright", "generator", "version", "minVersion"])),
        ("buffers", &plain(&["uri", "byteLength", "name"])),
        (
            "bufferViews",
            &plain(&["buffer", "byteOffset", "byteLength", "byteStride", "target", "name"]),
        ),
        ("cameras", &CAMERA),
        ("images", &plain(&["uri", "mimeType", "bufferView", "name"])),
        ("materials", &MATERIAL),
        ("meshes", &MESH),
        ("nodes", &NODE),
        ("samplers", &plain(&["magFilter", "minFilter", "wrapS", "wrapT", "name"])),
        ("scenes", &plain(&["nodes", "name"])),
        ("skins", &plain(&["inverseBindMatrices", "skeleton", "joints", "name"])),
        ("textures", &plain(&["sampler", "source", "name"])),
    ],
};

const ACCESSOR: Kind = Kind {
    members: &[
        "bufferView",
        "byteOffset",
        "componentType",
        "normalized",
        "count",
        "type",
        "max",
        "min",
        "name",
    ],
    objects: &[(
        "sparse",
        &Kind {
            members: &["count"],
            objects: &[
                ("indices", &plain(&["bufferView", "byteOffset", "componentType"])),
                ("values", &plain(&["bufferView", "byteOffset"])),
            ],
        },
    )],
};

const ANIMATION: Kind = Kind {
    members: &["name"],
    objects: &[
        (
            "channels",
            &Kind { members: &["sampler"], objects: &[("target", &plain(&["node", "path"]))] },
        ),
        ("samplers", &plain(&["input", "interpolation", "output"])),
    ],
};

const CAMERA: Kind = Kind {
    members: &["type", "name"],
    objects: &[
        ("orthographic", &plain(&["xmag", "ymag", "zfar", "znear"])),
        ("perspective", &plain(&["aspectRatio", "yfov", "zfar", "znear"])),
    ],
};

const MATERIAL: Kind = Kind {
    members: &["name", "emissiveFactor", "alphaMode", "alphaCutoff", "doubleSided"],
    objects: &[
        (
            "pbrMetallicRoughness",
            &Kind {
                members: &["baseColorFactor", "metallicFactor", "roughnessFactor"],
                objects: &[("baseColorTexture", &TEXTURE), ("metallicRoughnessTexture", &TEXTURE)],
            },
        ),
        ("normalTexture", &plain(&["index", "texCoord", "scale"])),
        ("occlusionTexture", &plain(&["index", "texCoord", "strength"])),
        ("emissiveTexture", &TEXTURE),
    ],
};

const TEXTURE: Kind = plain(&["index", "texCoord"]);

const MESH: Kind = Kind {
    members: &["weights", "name"],
    // Attributes have rules of their own.
    objects: &[("primitives", &plain(&["attributes", "indices", "material", "mode", "targets"]))],
};

const NODE: Kind = plain(&[
    "camera",
    "children",
    "skin",
    "matrix",
    "mesh",
    "rotation",
    "scale",
    "translation",
    "weights",
    "name",
]);

/// Notes every member of the core's objects that it does not define, and attributes that
/// neither it nor an application (by an underscore) could have named.
pub(super) fn check(raw: &Value, notices: &mut Notices) {
    let mut pending = vec![(raw, &FILE, Place::File)];
    while let Some((value, kind, place)) = pending.pop() {
        let Value::Object(members) = value else { continue };
        for (name, member) in members {
            let known = kind.objects.iter().find(|(object, _)| object == name);
            match (known, member) {
                (Some((list, kind)), Value::Array(items)) => {
                    let items = items.iter().enumerate();
                    pending.extend(items.map(|(i, item)| (item, *kind, place.item(list, i))));
                }
                (Some((object, kind)), _) => pending.push((member, kind, place.member(object))),
                (None, _) if kind.members.contains(&name.as_str()) => match name.as_str() {
                    "attributes" => check_attributes(member, place, notices),
                    "targets" => check_targets(member, place, notices),
                    _ => {}
                },
                (None, _) if name == "extensions" || name == "extras" => {}
                (None, _) => {
                    notices
                        .ignored(format!("{name:?}, which glTF 2.0 does not have"), &place.label());
                }
            }
        }
    }
}

/// Further sets of colours and names that are none. Texture coordinates and joints have
/// notices where something uses them.
fn check_attributes(attributes: &Value, place: Place, notices: &mut Notices) {
    const KNOWN: [&str; 3] = ["POSITION", "NORMAL", "TANGENT"];
    let Value::Object(attributes) = attributes else { return };
    for name in attributes.keys().filter(|name| !name.starts_with('_')) {
        let set = |prefix: &str| {
            let digits = name.strip_prefix(prefix)?;
            digits.bytes().all(|b| b.is_ascii_digit()).then(|| digits.parse::<u32>().ok())?
        };
        let is_colors = set("COLOR_");
        let is_known = KNOWN.contains(&name.as_str())
            || is_colors == Some(0)
            || ["TEXCOORD_", "JOINTS_", "WEIGHTS_"].iter().any(|prefix| set(prefix).is_some());
        if is_colors > Some(0) {
            notices.ignored("vertex colours beyond COLOR_0", &place.label());
        } else if !is_known {
            let message = format!("attribute {name:?}, which glTF 2.0 does not have");
            notices.ignored(message, &place.label());
        }
    }
}

/// Morph targets of what is not morphed here.
fn check_targets(targets: &Value, place: Place, notices: &mut Notices) {
    const MORPHED: [&str; 3] = ["POSITION", "NORMAL", "TANGENT"];
    let targets = targets.as_array().into_iter().flatten().filter_map(Value::as_object);
    for name in targets.flat_map(|target| target.keys()) {
        if !MORPHED.contains(&name.as_str()) && !name.starts_with('_') {
            notices.ignored(format!("morph target of {name:?}: not morphed"), &place.label());
        }
    }
}

/// Where an object is, for messages: written out only where there is one.
#[derive(Clone, Copy)]
enum Place {
    File,
    /// In a list at the top, or the object at the top with this name.
    Top(&'static str, Option<usize>),
    /// Somewhere below that.
    Within(&'static str, Option<usize>, &'static str),
}

impl Place {
    fn item(self, list: &'static str, index: usize) -> Self {
        match self {
            Self::File => Self::Top(list, Some(index)),
            _ => self.member(list),
        }
    }

    fn member(self, name: &'static str) -> Self {
        match self {
            Self::File => Self::Top(name, None),
            Self::Top(top, index) | Self::Within(top, index, _) => Self::Within(top, index, name),
        }
    }

    fn label(self) -> String {
        let index = |index: Option<usize>| index.map_or(String::new(), |i| format!("[{i}]"));
        match self {
            Self::File => "the file".into(),
            Self::Top(top, i) => format!("{top}{}", index(i)),
            Self::Within(top, i, name) => format!("{top}{}, {name}", index(i)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn lines(raw: Value) -> Vec<String> {
        let mut notices = Notices::default();
        check(&raw, &mut notices);
        notices.into_lines().into_iter().map(|notice| notice.message).collect()
    }

    #[test]
    fn what_gltf_does_not_have_is_named_with_its_place() {
        let raw = json!({
            "asset": {"version": "2.0", "author": "me"},
            "materails": [],
            "materials": [{}, {"pbrMetallicRoughness": {"metalicFactor": 1}}],
            "accessors": [{"sparse": {"values": {"offset": 3}}}],
        });
        let no = "which glTF 2.0 does not have";
        assert_eq!(
            lines(raw),
            [
                format!("\"author\", {no} (asset)"),
                format!("\"materails\", {no} (the file)"),
                format!("\"metalicFactor\", {no} (materials[1], pbrMetallicRoughness)"),
                format!("\"offset\", {no} (accessors[0], values)"),
            ]
        );
    }

    #[test]
    fn extras_extensions_and_what_applications_name_is_theirs() {
        let attributes = json!({
            "POSITION": 0, "COLOR_0": 0, "TEXCOORD_5": 0, "JOINTS_1": 0, "WEIGHTS_1": 0, "_ID": 0,
        });
        let raw = json!({
            "extras": {"a": 1}, "extensions": {"X": {"b": 2}}, "extensionsUsed": ["X"],
            "meshes": [{"primitives": [{"attributes": attributes, "extras": 3}], "extras": {}}],
        });
        assert_eq!(lines(raw), [""; 0]);
    }

    #[test]
    fn morph_targets_without_effect_are_noted() {
        let targets = json!([{"POSITION": 0}, {"NORMAL": 0, "COLOR_0": 1, "_HEAT": 2}]);
        let raw = json!({"meshes": [{"primitives": [{"attributes": {}, "targets": targets}]}]});
        assert_eq!(
            lines(raw),
            ["morph target of \"COLOR_0\": not morphed (meshes[0], primitives)"]
        );
    }

    #[test]
    fn attributes_without_effect_are_noted() {
        let attributes =
            json!({"POSITION": 0, "COLOR_1": 0, "NORMALS": 0, "TEXCOORD_x": 0, "COLOR_": 0});
        let raw = json!({"meshes": [{"primitives": [{"attributes": attributes}]}]});
        let no = "which glTF 2.0 does not have (meshes[0], primitives)";
        assert_eq!(
            lines(raw),
            [
                format!("attribute \"COLOR_\", {no}"),
                format!("attribute \"NORMALS\", {no}"),
                format!("attribute \"TEXCOORD_x\", {no}"),
                "vertex colours beyond COLOR_0 (meshes[0], primitives)".into(),
            ]
        );
    }
}
