//! `steradian merge`: the parts of a render, joined to the bits of the whole.

use super::destination::{self, Picture, PngFlags};
use super::existing;
use super::film_output::{self, PartHead};
use super::layer_flags::{ExrOptions, LAYERS, PRECISIONS};
use super::output::{self, Developed};
use super::talk;
use clap::Args;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use steradian::film::{Film, FilmFile};
use steradian::image::{Attribute, ChannelData, Layer, OutputFormat, Precision};
use steradian::layers::LayerKind;
use steradian::renderer::Counts;
use steradian::settings::Crop;
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

    #[command(flatten)]
    png: PngFlags,

    /// Bits of the picture's R, G and B in an EXR; all layers have 32
    #[arg(long, value_parser = super::values::one_of(PRECISIONS))]
    exr_precision: Option<Precision>,

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
    let mut parts = Vec::new();
    for path in &flags.parts {
        let (head, file) = film_output::read(path)?;
        parts.push(Part { path: path.clone(), head, file });
    }
    parts.sort_by_key(|part| part.head.shard.index);
    check(&parts, flags.allow_mixed_devices)?;
    let (film, counts) = join(&parts)?;
    let head = &parts[0].head;
    let kind = |name: &String| LAYERS.iter().find(|word| word.0 == name).map(|word| word.1);
    let kinds: Vec<_> = head.layers.iter().filter_map(kind).collect();
    let picture = picture(flags, &kinds)?;
    let traced = Traced::of(&parts)?;
    let settings = u64::from_str_radix(&head.part.settings_hash, 16).unwrap_or_default();
    let mut entries = metadata(&parts, &head.metadata, &film, &counts);
    entries.push(existing::request_of_whole(&picture, settings, head.spp));
    let developed = Developed {
        film: &film,
        resolution: head.resolution,
        metadata: entries,
        exr_metadata: metadata(&parts, &head.exr_metadata, &film, &Counts::default()),
        render_seconds: counts.render_seconds,
        traced: &|band| Ok(traced.rows(band)),
        denoised: &|_| Ok(None),
    };
    developed.write(&picture)?;
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

fn picture(flags: &MergeFlags, kinds: &[LayerKind]) -> Result<Picture> {
    destination::check_place(&flags.output)?;
    let format = OutputFormat::from_path(&flags.output)?;
    let precision = flags.exr_precision.unwrap_or_default();
    let exr = ExrOptions { layers: kinds.to_vec(), precision, times: false };
    destination::picture(&flags.output, format, &flags.png, exr)
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
    const NAMED: usize = 16;
    let missing = (0..count).filter(|i| !is_there(i)).map(|i| i.to_string());
    let missing: Vec<_> = missing.take(NAMED + 1).collect();
    if missing.is_empty() {
        return check_pixels(parts);
    }
    let more = if missing.len() > NAMED { ", ..." } else { "" };
    let missing = missing[..missing.len().min(NAMED)].join(", ");
    Err(Error::Settings(format!("of {count} parts these are missing: {missing}{more}")))
}

/// That parts of the pixels are all of them, before memory is taken for the whole.
fn check_pixels(parts: &[Part]) -> Result<()> {
    let whole = &parts[0].head.window;
    let of = |part: &Part| part.head.film.window;
    let is_whole = parts.iter().all(|part| of(part) == *whole);
    let area: u64 = parts.iter().map(|part| of(part).area()).sum();
    let lie_within = parts.iter().all(|part| whole.contains(&of(part)));
    if is_whole || lie_within && area == whole.area() {
        return Ok(());
    }
    Err(parts[0].file.misfit("is of parts that do not make up the picture"))
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

/// Layers of the parts, each of some rows.
struct Traced {
    parts: Vec<(Crop, Vec<Layer>)>,
}

impl Traced {
    fn of(parts: &[Part]) -> Result<Self> {
        let with_layers = parts.iter().filter(|part| !part.head.traced.is_empty());
        let read = |part: &Part| Ok((part.head.film.window, part.head.traced(&part.file)?));
        Ok(Self { parts: with_layers.map(read).collect::<Result<_>>()? })
    }

    /// The layers of the rows of a band, which has the width of the parts.
    fn rows(&self, band: Crop) -> Vec<Layer> {
        let mut layers: Vec<Layer> = Vec::new();
        for (window, part) in &self.parts {
            let first = band.y.max(window.y);
            let end = (band.y + band.height).min(window.y + window.height);
            if first >= end {
                continue;
            }
            let at = |y: u32| ((y - window.y) * window.width) as usize;
            let rows = at(first)..at(end);
            let cut = |data: &ChannelData| match data {
                ChannelData::F32(values) => ChannelData::F32(values[rows.clone()].to_vec()),
                ChannelData::U32(values) => ChannelData::U32(values[rows.clone()].to_vec()),
            };
            for (i, layer) in part.iter().enumerate() {
                let channels = layer.channels.iter().map(|(name, data)| (name.clone(), cut(data)));
                let next = Layer { name: layer.name.clone(), channels: channels.collect() };
                match layers.get_mut(i) {
                    Some(layer) => extend(layer, next),
                    None => layers.push(next),
                }
            }
        }
        layers
    }
}

/// Adds the rows that follow.
fn extend(layer: &mut Layer, next: Layer) {
    for ((_, data), (_, more)) in layer.channels.iter_mut().zip(next.channels) {
        match (data, more) {
            (ChannelData::F32(data), ChannelData::F32(more)) => data.extend(more),
            (ChannelData::U32(data), ChannelData::U32(more)) => data.extend(more),
            // The parts were asked for the same layers.
            _ => {}
        }
    }
}

/// What the whole render would have said of itself.
fn metadata(
    parts: &[Part],
    entries: &[(String, Attribute)],
    film: &Film,
    counts: &Counts,
) -> Vec<(String, Attribute)> {
    let mut entries = entries.to_vec();
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
            "steradian.settings_hash" => {
                *value = Attribute::Text(parts[0].head.part.settings_hash.clone());
            }
            "steradian.driver" => *value = joined(|d| &d.1),
            _ => {}
        }
    }
    entries
}
