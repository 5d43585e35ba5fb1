//! Files of an earlier call: whether they are what this one would write.
//!
//! A picture says what it is of: the hash of the scene, and the hash of everything that was asked
//! for ([`request`]). Where both are those of the render to come, and the file is whole, was
//! finished, and is by this version of the program, another render would say the same. It may be by
//! another device or driver: whose it is stands in the file.

use super::destination::Picture;
use super::film_output;
use super::job::Job;
use super::render::Call;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;
use std::time::Duration;
use steradian::image::{Attribute, OutputFormat, read_exr, read_png};
use steradian::view::View;

/// The entry of a file's metadata that says what was asked for.
pub(crate) fn request(picture: &Picture, job: &Job, view: Option<View>) -> (String, Attribute) {
    let settings = &job.settings;
    let asked = (settings.content_hash(), settings.time, job.requested_spp);
    entry(picture, asked, job.is_reference, view)
}

/// That of a whole render of these settings, as which its parts are joined.
pub(crate) fn request_of_whole(picture: &Picture, settings: u64, spp: u32) -> (String, Attribute) {
    entry(picture, (settings, None, Some(spp)), false, None)
}

/// Hash of what was asked for: settings, and what the file is to show of the light.
fn entry(
    picture: &Picture,
    asked: (u64, Option<Duration>, Option<u32>),
    is_reference: bool,
    view: Option<View>,
) -> (String, Attribute) {
    let form = Picture { path: Default::default(), ..picture.clone() };
    // `{:?}` tells any two values apart.
    let text = format!("{:?}", (asked, is_reference, form, view));
    // 64-bit FNV-1a.
    let hash = text.bytes().fold(0xCBF2_9CE4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
    });
    ("steradian.request".into(), Attribute::Text(format!("{hash:016x}")))
}

/// Whether all files are there, whole, and what this render would write.
pub(super) fn is_valid(call: &Call, job: &Job) -> bool {
    let (destinations, flags) = (&call.destinations, call.flags);
    let others_are_there = || {
        destinations.stats.as_deref().is_none_or(is_finished_json)
            && destinations.sample_map.as_deref().is_none_or(|path| read_png(path).is_ok())
    };
    if let Some(film) = &destinations.film {
        return film_output::is_valid(film, call, job) && others_are_there();
    }
    let Some(picture) = &destinations.picture else { return false };
    let (name, request) = request(picture, job, flags.job.picture.view);
    let scene = job.scene.content_hash(job.settings.camera);
    let expected = [
        (name.as_str(), request.to_string()),
        ("steradian.scene_hash", format!("{scene:016x}")),
        ("steradian.version", env!("CARGO_PKG_VERSION").into()),
    ];
    let is_ours = entries(picture, job).is_some_and(|found| {
        expected.iter().all(|(name, value)| found.get(*name) == Some(value))
            && found.get("steradian.partial").is_none_or(|partial| partial == "false")
    });
    // The picture is written last: these are of the same render, or of none.
    is_ours && others_are_there()
}

/// Metadata of a picture that can be read to its end.
fn entries(picture: &Picture, job: &Job) -> Option<BTreeMap<String, String>> {
    match picture.format {
        OutputFormat::Exr => {
            let image = read_exr(&picture.path).ok()?;
            Some(
                image.metadata.into_iter().map(|(name, value)| (name, value.to_string())).collect(),
            )
        }
        OutputFormat::Png => {
            let window = job.settings.window();
            png_text(&picture.path, (window.width, window.height))
        }
    }
}

/// `None` also for another size, of which nothing is read.
fn png_text(path: &Path, size: (u32, u32)) -> Option<BTreeMap<String, String>> {
    let file = BufReader::new(File::open(path).ok()?);
    let mut reader = png::Decoder::new(file).read_info().ok()?;
    if reader.info().size() != size {
        return None;
    }
    let mut samples = vec![0; reader.output_buffer_size()?];
    reader.next_frame(&mut samples).ok()?;
    reader.finish().ok()?;
    let chunks = &reader.info().utf8_text;
    chunks.iter().map(|chunk| Some((chunk.keyword.clone(), chunk.get_text().ok()?))).collect()
}

fn is_finished_json(path: &Path) -> bool {
    let value = fs::read(path).ok().and_then(|bytes| serde_json::from_slice::<Value>(&bytes).ok());
    value.is_some_and(|stats| stats["partial"] == false)
}
