//! Which extensions a file uses, and what becomes of each.

use super::document::Document;
use super::notices::Notices;
use crate::Result;
use serde_json::Value;
use std::collections::BTreeSet;

/// Extensions that are rendered. What of one is approximated has a notice of
/// its own where it is read.
const SUPPORTED: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Extensions that by their specification change nothing in a picture.
const WITHOUT_PICTURE: [&str; 4] =
    ["KHR_xmp", "KHR_xmp_json_ld", "KHR_node_selectability", "KHR_node_hoverability"];

/// Supported where this build has a decoder.
const DRACO: &str = "KHR_draco_mesh_compression";
/// Supported where this build has a transcoder.
const BASIS: &str = "KHR_texture_basisu";

fn is_supported(name: &str) -> bool {
    SUPPORTED.contains(&name)
        || (name == DRACO && cfg!(feature = "draco"))
        || (name == BASIS && cfg!(feature = "basis"))
}

/// Refuses a file that requires what is not supported; notes every other
/// extension that occurs.
pub(super) fn check(document: &Document, notices: &mut Notices) -> Result<()> {
    for name in &document.root.extensions_required {
        if is_supported(name) || WITHOUT_PICTURE.contains(&name.as_str()) {
            continue;
        }
        let remedy = match name.as_str() {
            DRACO => "this needs a build with the cargo feature `draco`",
            BASIS => "this needs a build with the cargo feature `basis`",
            _ => "it is not supported; export the file without",
        };
        return Err(document.error(format!("the file requires the extension {name:?}: {remedy}")));
    }
    let mut seen = BTreeSet::new();
    visit_extensions(&document.raw, |name, place, is_own| {
        seen.insert(name.to_owned());
        note(name, place, is_own, notices);
    });
    for name in &document.root.extensions_used {
        if seen.insert(name.clone()) {
            note(name, EXTENSIONS_USED, true, notices);
        }
    }
    Ok(())
}

fn note(name: &str, place: &str, is_own: bool, notices: &mut Notices) {
    match name {
        _ if is_out_of_place(name, place, is_own) => {
            notices.ignored(format!("extension {name} where it has no meaning"), place);
        }
        "EXT_lights_image_based" => {
            let message = "EXT_lights_image_based: give the light with --environment";
            notices.ignored(message, place);
        }
        _ if is_supported(name) => notices.honoured(name, place),
        // What becomes of the texture is noted where it is read.
        BASIS => {}
        _ if WITHOUT_PICTURE.contains(&name) => {
            notices.honoured(&format!("{name}: no part of the picture"), place);
        }
        _ => notices.ignored(format!("extension {name}"), place),
    }
}

/// Whether the extension of this name says nothing at this place, by its specification.
/// Where it is an object of the wrong kind nothing reads it, so it must not be said to be
/// honoured. Of a name that is not known here the place is not judged.
/// `is_own`: it belongs to the object at `place` itself, not to one within.
fn is_out_of_place(name: &str, place: &str, is_own: bool) -> bool {
    if place == EXTENSIONS_USED {
        return false;
    }
    let kind = place.split('[').next().unwrap_or(place);
    let kinds: &[&str] = match name {
        "KHR_lights_punctual" => &[THE_FILE, "nodes"],
        "EXT_lights_image_based" => &[THE_FILE, "scenes"],
        "KHR_materials_variants" => &[THE_FILE, "meshes"],
        "KHR_texture_transform" => &["materials"],
        "KHR_texture_basisu" | "EXT_texture_webp" => &["textures"],
        "EXT_mesh_gpu_instancing" | "KHR_node_visibility" => &["nodes"],
        "KHR_draco_mesh_compression" => &["meshes"],
        "EXT_meshopt_compression" | "KHR_meshopt_compression" => &["buffers", "bufferViews"],
        "KHR_animation_pointer" => &["animations"],
        // Only ever listed.
        "KHR_mesh_quantization" => &[],
        _ if name.starts_with("KHR_materials_") && !is_own => &[],
        _ if name.starts_with("KHR_materials_") => &["materials"],
        _ => return false,
    };
    !kinds.contains(&kind)
}

/// The place of an extension that is listed and occurs nowhere.
const EXTENSIONS_USED: &str = "extensionsUsed";
/// The place of an extension of the file itself.
const THE_FILE: &str = "the file";

/// Calls `visit(name, place, is_own)` for every member of every `extensions` object;
/// `place` is the top-level object around it, as `materials[3]`, and whether it is that object's own.
fn visit_extensions(raw: &Value, mut visit: impl FnMut(&str, &str, bool)) {
    let Value::Object(members) = raw else { return };
    for (key, value) in members {
        match value {
            Value::Array(items) => {
                for (index, item) in items.iter().enumerate() {
                    visit_within(item, &format!("{}[{index}]", key.escape_debug()), &mut visit);
                }
            }
            Value::Object(extensions) if key == "extensions" => {
                for (name, value) in extensions {
                    visit(name, THE_FILE, true);
                    visit_within(value, THE_FILE, &mut visit);
                }
            }
            _ => visit_within(value, &key.escape_debug().to_string(), &mut visit),
        }
    }
}

fn visit_within(value: &Value, place: &str, visit: &mut impl FnMut(&str, &str, bool)) {
    let mut pending = vec![(value, true)];
    while let Some((value, is_own)) = pending.pop() {
        match value {
            Value::Array(items) => pending.extend(items.iter().map(|item| (item, false))),
            Value::Object(members) => {
                for (key, member) in members.iter().filter(|(key, _)| *key != "extras") {
                    if let ("extensions", Value::Object(extensions)) = (key.as_str(), member) {
                        extensions.keys().for_each(|name| visit(name, place, is_own));
                    }
                    pending.push((member, false));
                }
            }
            _ => {}
        }
    }
}
