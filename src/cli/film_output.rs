//! `.film` output: the sums of a part of a render, for `steradian merge`.

use super::destination::Destinations;
use super::exr_file;
use super::flags::RenderFlags;
use super::identity::Identity;
use super::job::Job;
use super::layer_flags::LAYERS;
use super::output;
use super::render::Call;
use super::report::Outcome;
use super::shard::Shard;
use super::values::word_for;
use serde::{Deserialize, Serialize};
use std::path::Path;
use steradian::film::{Film, FilmFile, FilmHead, write_film_file};
use steradian::image::{Attribute, ChannelData, Layer};
use steradian::renderer::Counts;
use steradian::settings::Crop;
use steradian::{Error, RenderSettings, Result};

/// The head of a part.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct PartHead {
    pub(super) part: Identity,
    pub(super) shard: Shard,
    pub(super) resolution: (u32, u32),
    /// Of the whole.
    pub(super) window: Crop,
    /// Whether samples are missing.
    pub(super) is_partial: bool,
    pub(super) film: FilmHead,
    pub(super) counts: Counts,
    /// Of the picture, as this part alone would have it.
    pub(super) metadata: Vec<(String, Attribute)>,
    /// Of an EXR beside it.
    pub(super) exr_metadata: Vec<(String, Attribute)>,
    /// Layers that were asked for: words of `--layers`.
    pub(super) layers: Vec<String>,
    /// Layers that camera rays tell of: name, channels, and whether they count.
    pub(super) traced: Vec<(String, Vec<(String, bool)>)>,
    /// Samples per pixel that were asked for.
    pub(super) spp: u32,
}

/// The only part.
const WHOLE: Shard = Shard { index: 0, count: 1 };

/// Whether the name asks for a film file.
pub(super) fn is_film(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("film"))
}

/// That a render can be a film.
pub(super) fn check(
    flags: &RenderFlags,
    shard: Option<Shard>,
    destinations: &Destinations,
    job: &Job,
) -> Result<()> {
    let refused = |message: &str| Err(Error::Settings(message.into()));
    let is_film = destinations.film.is_some();
    if shard.is_some() && !is_film {
        return refused(
            "--shard: a part is a .film; name the output so, and `steradian merge` joins them",
        );
    }
    if is_film && flags.layers.denoise.is_some() {
        return refused("--denoise: a .film holds sums; denoise the picture of the whole");
    }
    if is_film && (job.settings.stopping_rule().is_some() || job.is_reference) {
        return refused(
            "a .film holds as many samples for every pixel: not with --noise, --adaptive or --reference",
        );
    }
    Ok(())
}

/// Writes the film of a render, which may be a part.
pub(super) fn write(path: &Path, call: &Call, outcome: &Outcome) -> Result<()> {
    let (job, film) = (outcome.job, outcome.film);
    // Of parts of the samples, the first has the layers.
    let has_layers = job.settings.samples().first == 0;
    let traced = match outcome.layers.filter(|_| has_layers) {
        Some(layers) => layers.trace(film.window())?,
        None => Vec::new(),
    };
    let kinds = call.flags.layers.kinds();
    let region = call.flags.job.picture.region();
    let whole = RenderSettings { crop: region, ..job.settings.clone() };
    let head = PartHead {
        part: Identity::new(job, region, (outcome.device, outcome.driver)),
        shard: call.shard.unwrap_or(WHOLE),
        resolution: whole.resolution,
        window: whole.window(),
        is_partial: outcome.is_partial(),
        film: film.head(),
        counts: Counts::of(outcome.statistics),
        metadata: output::metadata(outcome),
        exr_metadata: exr_file::metadata(outcome),
        layers: kinds.iter().map(|kind| word_for(LAYERS, kind).to_owned()).collect(),
        traced: traced.iter().map(shape).collect(),
        spp: job.settings.spp,
    };
    let mut sections = film.sections();
    for (layer, (name, channel)) in traced.iter().flat_map(channels) {
        let bytes: &[u8] = match channel {
            ChannelData::F32(values) => bytemuck::cast_slice(values),
            ChannelData::U32(values) => bytemuck::cast_slice(values),
        };
        sections.push((section(&layer.name, name), bytes.into()));
    }
    write_film_file(path, &head, &sections)
}

fn channels(layer: &Layer) -> impl Iterator<Item = (&Layer, &(String, ChannelData))> {
    layer.channels.iter().map(move |channel| (layer, channel))
}

fn shape(layer: &Layer) -> (String, Vec<(String, bool)>) {
    let channel =
        |(name, data): &(String, ChannelData)| (name.clone(), matches!(data, ChannelData::U32(_)));
    (layer.name.clone(), layer.channels.iter().map(channel).collect())
}

fn section(layer: &str, channel: &str) -> String {
    format!("layer {layer} {channel}")
}

/// Whether the file at `path` is what this render would write, by whatever device.
pub(super) fn is_valid(path: &Path, call: &Call, job: &Job) -> bool {
    let flags = call.flags;
    let Ok((head, _)) = read(path) else { return false };
    let (device, driver) = (head.part.device.clone(), head.part.driver.clone());
    let same = Identity::new(job, flags.job.picture.region(), (&device, &driver));
    let shard = call.shard.unwrap_or(WHOLE);
    let kinds = flags.layers.kinds();
    same == head.part
        && head.shard == shard
        && !head.is_partial
        && head.layers.iter().eq(kinds.iter().map(|kind| word_for(LAYERS, kind)))
}

/// Reads a part.
pub(super) fn read(path: &Path) -> Result<(PartHead, FilmFile)> {
    let file = FilmFile::open(path)?;
    let head = file.head()?;
    Ok((head, file))
}

impl PartHead {
    /// Its film.
    pub(super) fn film(&self, file: &FilmFile) -> Result<Film> {
        Film::read(file, &self.film)
    }

    /// Its layers that camera rays tell of.
    pub(super) fn traced(&self, file: &FilmFile) -> Result<Vec<Layer>> {
        let n = self.film.window.area() as usize;
        let read = |(layer, channels): &(String, Vec<(String, bool)>)| {
            let channel = |(name, counts): &(String, bool)| {
                let section = section(layer, name);
                let data = match counts {
                    true => ChannelData::U32(file.section(&section, n)?),
                    false => ChannelData::F32(file.section(&section, n)?),
                };
                Ok((name.clone(), data))
            };
            let channels = channels.iter().map(channel).collect::<Result<_>>()?;
            Ok(Layer { name: layer.clone(), channels })
        };
        self.traced.iter().map(read).collect()
    }
}
