//! `steradian merge`: the parts of a render, joined to the bits of the whole.

use super::destination::{self, Picture};
use super::film_output::{self, PartHead};
use super::output;
use super::talk;
use clap::Args;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use steradian::film::{Film, FilmFile};
use steradian::image::{Attribute, ToneCurve};
use steradian::renderer::Counts;
use steradian::{Error, Result};

/// Flags of `merge`.
#[derive(Debug, Args)]
pub(crate) struct MergeFlags {
    /// The .film files of all parts, in any order
    #[arg(required = true)]
    parts: Vec<PathBuf>,

    /// The picture: .png or .exr
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Join what different devices or drivers did, whose bits may differ
    #[arg(long)]
    allow_mixed_devices: bool,

    /// Bits of a colour component of a PNG: 8 (default) or 16
    #[arg(long, value_name = "8|16", value_parser = ["8", "16"])]
    bits: Option<String>,

    /// Exposure of a PNG in stops
    #[arg(long, value_name = "EV", value_parser = super::values::finite, allow_negative_numbers = true)]
    exposure: Option<f32>,

    /// Tone curve of a PNG, after the exposure; none by default
    #[arg(long, value_parser = super::values::one_of(super::values::TONE_CURVES))]
    tone_map: Option<ToneCurve>,

    /// Say nothing but errors and warnings
    #[arg(short, long)]
    quiet: bool,
}

struct Part {
    path: PathBuf,
    head: PartHead,
    file: FilmFile,
}

/// Joins and writes.
pub(crate) fn run(flags: &MergeFlags) -> Result<ExitCode> {
    let picture = picture(flags)?;
    let mut parts = Vec::new();
    for path in &flags.parts {
        let (head, file) = film_output::read(path)?;
        parts.push(Part { path: path.clone(), head, file });
    }
    parts.sort_by_key(|part| part.head.shard.index);
    check(&parts, flags.allow_mixed_devices)?;
    let (film, counts) = join(&parts)?;
    let head = &parts[0].head;
    let metadata = metadata(&parts, &film, &counts);
    output::write_film(&picture, &film, head.resolution, metadata)?;
    if !flags.quiet {
        let (count, path) = (parts.len(), picture.path.display());
        let parts = if count == 1 { "part" } else { "parts" };
        talk::line(&format!(
            "{path}: {count} {parts}, {} samples of a pixel",
            film.least_samples()
        ));
        talk::line(&super::report::error_line(film.estimated_error().as_ref()));
    }
    Ok(ExitCode::SUCCESS)
}

fn picture(flags: &MergeFlags) -> Result<Picture> {
    destination::check_place(&flags.output)?;
    let depth = destination::bit_depth(flags.bits.as_deref());
    let is_shown = flags.bits.is_some() || flags.exposure.is_some() || flags.tone_map.is_some();
    destination::picture(&flags.output, depth, flags.exposure, flags.tone_map, is_shown)
}

/// That they are all the parts of one render, each once and whole.
fn check(parts: &[Part], allows_devices: bool) -> Result<()> {
    let refused = |path: &Path, message: String| {
        Err(Error::Settings(format!("{}: {message}", path.display())))
    };
    let first = &parts[0];
    let count = first.head.shard.count;
    for part in parts {
        first.head.part.check(&part.path, &part.head.part, allows_devices)?;
        if part.head.shard.count != count {
            let message = format!(
                "is part {}, but {} is part {}: parts of different numbers do not join",
                part.head.shard,
                first.path.display(),
                first.head.shard
            );
            return refused(&part.path, message);
        }
        if part.head.is_partial {
            let message = format!(
                "part {} was stopped before its end: render it again, with --resume if it has a \
                 checkpoint",
                part.head.shard
            );
            return refused(&part.path, message);
        }
    }
    for pair in parts.windows(2) {
        if pair[0].head.shard == pair[1].head.shard {
            let message =
                format!("is part {}, and so is {}", pair[1].head.shard, pair[0].path.display());
            return refused(&pair[1].path, message);
        }
    }
    let is_there = |index: &u32| parts.iter().any(|part| part.head.shard.index == *index);
    let missing: Vec<_> = (0..count).filter(|i| !is_there(i)).map(|i| i.to_string()).collect();
    if missing.is_empty() {
        return Ok(());
    }
    const NAMED: usize = 16;
    let more = if missing.len() > NAMED { ", ..." } else { "" };
    let missing = missing[..missing.len().min(NAMED)].join(", ");
    Err(Error::Settings(format!("of {count} parts these are missing: {missing}{more}")))
}

/// Samples in their order, or pixels in their places.
fn join(parts: &[Part]) -> Result<(Film, Counts)> {
    let (first, rest) = (&parts[0], &parts[1..]);
    let mut counts = first.head.counts.clone();
    let mut film = first.head.film(&first.file)?;
    let is_whole_window = first.head.film.window == first.head.window;
    if !is_whole_window {
        let mut whole = Film::for_parts_of(first.head.window, &film);
        whole.insert(&film)?;
        film = whole;
    }
    for part in rest {
        let next = part.head.film(&part.file)?;
        if is_whole_window {
            film.append(&next)?
        } else {
            film.insert(&next)?
        }
        counts.add(&part.head.counts);
    }
    Ok((film, counts))
}

/// What the whole render would have said of itself.
fn metadata(parts: &[Part], film: &Film, counts: &Counts) -> Vec<(String, Attribute)> {
    let mut entries = parts[0].head.metadata.clone();
    output::set_result(&mut entries, film, counts.faults.iter().sum());
    let mut devices: Vec<_> =
        parts.iter().map(|p| (p.head.part.device.clone(), p.head.part.driver.clone())).collect();
    devices.dedup();
    for (name, value) in &mut entries {
        let joined = |of: fn(&(String, String)) -> &str| {
            let all: Vec<_> = devices.iter().map(of).collect();
            Attribute::Text(all.join(", "))
        };
        match name.as_str() {
            "steradian.device" => *value = joined(|d| &d.0),
            "steradian.driver" => *value = joined(|d| &d.1),
            _ => {}
        }
    }
    entries
}
