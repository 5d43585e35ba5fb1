//! glTF 2.0 and GLB to [`Scene`].
//!
//! The JSON is parsed into the `gltf` crate's plain structs; everything else is
//! here, because files are not trusted: every index, count, offset and number is
//! checked, and nothing outside the scene's folder is opened. A file can make
//! loading fail with a message, and not more. [`load_with`] lists the steps.

mod accessor;
mod buffers;
mod cameras;
mod container;
mod deform;
mod document;
#[cfg(feature = "draco")]
mod draco;
mod environment;
mod extensions;
mod extras;
mod geometry;
mod images;
mod instances;
mod instancing;
mod keyframes;
mod ktx2_images;
mod lights;
mod limits;
mod material_extensions;
mod materials;
mod members;
mod meshopt;
mod motion;
mod nodes;
mod normals;
mod notices;
mod resize;
mod skins;
mod tangents;
mod textures;
mod triangles;
mod uri;
mod uv_sets;
mod variants;
mod vocabulary;

use super::{Notice, Scene, Treatment};
use crate::{Error, Result};
use accessor::Accessors;
use buffers::Buffers;
use document::Document;
use glam::Vec3;
use limits::Budget;
use notices::Notices;
use std::path::{Path, PathBuf};
use uri::Reach;
use variants::Variants;

/// How to treat what cannot be rendered as the file says.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LoadOptions {
    /// Refuse a file with any feature that is approximated or ignored.
    pub strict: bool,
    /// Folders besides the scene's own whose files it may name: by `..`, as an absolute
    /// path or through a link. Without any, a scene reads nothing outside its folder.
    pub allow_external: Vec<PathBuf>,
    /// Time at which animations are sampled, seconds; the rest pose by default.
    pub frame_time: Option<f64>,
    /// Name or index of the animation, or `all`; the first by default.
    pub animation: Option<String>,
    /// KHR_materials_variants: the variant whose materials are used; without one the default.
    pub variant: Option<String>,
    /// Bring images down whose sides are longer than this, in texels; at least 1.
    pub max_texture_size: Option<u32>,
}

/// Loads a `.gltf` or `.glb` file with default options.
///
/// # Errors
///
/// [`Error::Scene`] with the file at fault, the object in it and what is wrong.
pub fn load(path: &Path) -> Result<Scene> {
    load_with(path, &LoadOptions::default())
}

/// Loads a `.gltf` or `.glb` file.
///
/// # Errors
///
/// [`Error::Scene`] with the file at fault, the object in it and what is wrong;
/// also where there is no geometry to render.
pub fn load_with(path: &Path, options: &LoadOptions) -> Result<Scene> {
    let budget = Budget::default();
    let bytes = buffers::read_file(path, &budget)?;
    let folder = match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    load_within(path, Some(folder), &bytes, options, budget)
}

/// Loads the bytes of a `.gltf` or `.glb` file. `name` stands for its path in messages,
/// and its stem names the scene. The files that it refers to lie in `folder`; without a
/// folder it may only refer to data URIs.
///
/// # Errors
///
/// As [`load_with`].
pub fn load_bytes(
    name: &Path,
    folder: Option<&Path>,
    bytes: &[u8],
    options: &LoadOptions,
) -> Result<Scene> {
    let budget = Budget::default();
    budget.take_bytes(bytes.len() as u64).map_err(|message| Error::scene(name, message))?;
    load_within(name, folder, bytes, options, budget)
}

/// The steps of loading; `budget` has the size of `bytes` already.
fn load_within(
    path: &Path,
    folder: Option<&Path>,
    bytes: &[u8],
    options: &LoadOptions,
    budget: Budget,
) -> Result<Scene> {
    let mut notices = Notices::default();
    let container = container::split(bytes).map_err(|message| Error::scene(path, message))?;
    let reach = Reach::new(folder, &options.allow_external).map_err(|(folder, e)| {
        Error::scene(path, format!("the folder {} cannot be read: {e}", folder.display()))
    })?;
    let document = &Document::parse(path, container.json, reach, budget)?;
    extensions::check(document, &mut notices)?;
    vocabulary::check(&document.raw, &mut notices);
    let buffers = &Buffers::load(document, container.bin)?;

    let scene = nodes::default_scene(document)?;
    nodes::note_scene(document, scene, &mut notices);
    let accessors = &Accessors { document, buffers };
    let (animations, pose) = motion::read(accessors, options, &mut notices)?;
    let placements = &nodes::walk(document, scene, &pose, &mut notices)?;
    let variants = Variants::read(document, options.variant.as_deref())?;
    let max_texture_size = options.max_texture_size;
    let mut materials = materials::read(document, buffers, max_texture_size, &mut notices)?;
    let (shapes, meshes) =
        geometry::read(accessors, placements, &variants, &mut materials, &mut notices)?;
    let placed = instances::place(accessors, placements, &shapes, &meshes, &mut notices)?;
    let bounds = placed.bounds.ok_or_else(|| {
        document.error("nothing to render: its scene has no triangles and no spheres")
    })?;
    check_extent(bounds).map_err(|message| document.error(message))?;

    let mut scene = Scene {
        name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        meshes,
        instances: placed.instances,
        spheres: placed.spheres,
        materials: materials.materials,
        images: materials.images,
        variants: variants.names,
        lights: lights::read(document, placements, &mut notices)?,
        environment: environment::read(document, scene, &mut notices)?,
        cameras: cameras::read(document, placements, bounds, &mut notices)?,
        animations,
        notices: notices.into_lines(),
    };
    scene.notices.extend(scene.precision_notices());
    if options.strict {
        refuse_differences(path, &scene.notices)?;
    }
    Ok(scene)
}

/// Farthest coordinate and least size of a scene, metres: beyond, squares and their quotients
/// leave the range of f32.
const EXTENTS: (f32, f32) = (1e12, 1e-12);

/// Refuses what is too far or too small for the device's arithmetic.
fn check_extent((low, high): (Vec3, Vec3)) -> std::result::Result<(), String> {
    let (farthest, least) = EXTENTS;
    let reach = low.abs().max(high.abs()).max_element();
    let size = (high - low).max_element();
    if reach > farthest {
        return Err(format!(
            "its scene reaches {reach:e} m from the origin; the limit is {farthest:e} m: scale it down"
        ));
    }
    // A scene of one point has no size that could be lost.
    if size > 0.0 && size < least {
        return Err(format!(
            "its scene is {size:e} m large; the least is {least:e} m: scale it up"
        ));
    }
    Ok(())
}

/// An error that lists everything which is not rendered as the file says.
fn refuse_differences(path: &Path, notices: &[Notice]) -> Result<()> {
    let differences: Vec<&str> = notices
        .iter()
        .filter(|notice| notice.treatment != Treatment::Honoured)
        .map(|notice| notice.message.as_str())
        .collect();
    match differences.is_empty() {
        true => Ok(()),
        false => Err(Error::scene(
            path,
            format!(
                "strict loading refuses what is not rendered as specified: {}",
                differences.join("; ")
            ),
        )),
    }
}
