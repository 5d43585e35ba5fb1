//! Parts of a render for several machines: `--shard I/N`.

use super::job::Job;
use super::values::Parsed;
use serde::{Deserialize, Serialize};
use std::fmt;
use steradian::film::SampleRange;
use steradian::settings::Crop;
use steradian::shader::generated::TILE_SIDE;
use steradian::{Error, Result};

/// One of several parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Shard {
    /// Which, from 0.
    pub(crate) index: u32,
    /// Of how many.
    pub(crate) count: u32,
}

impl Shard {
    /// Every so many of a list: so that what is costly next to each other is shared.
    pub(crate) fn of_list<T: Clone>(&self, list: &[T]) -> Vec<T> {
        list.iter().skip(self.index as usize).step_by(self.count as usize).cloned().collect()
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

/// `I/N`, I from 0.
pub(crate) fn parse(text: &str) -> Parsed<Shard> {
    let form = || "expected I/N with I from 0 to N-1, such as 0/8".to_owned();
    let (index, count) = text.split_once('/').ok_or_else(form)?;
    let shard = Shard {
        index: index.parse().map_err(|_| form())?,
        count: count.parse().map_err(|_| form())?,
    };
    if shard.index < shard.count { Ok(shard) } else { Err(form()) }
}

/// Leaves of the render only its part: of the samples where there are enough, else of the rows.
pub(crate) fn apply(job: &mut Job, shard: Shard) -> Result<()> {
    let settings = &mut job.settings;
    let refused = |why: &str| Err(Error::Settings(format!("--shard {shard}: {why}")));
    if settings.stopping_rule().is_some() {
        return refused(
            "pixels that stop one by one (--noise, --adaptive) decide by all of their neighbours' \
             samples; share out frames (--frames) instead",
        );
    }
    if settings.time.is_some() || job.requested_spp.is_none() {
        return refused("what a time allows differs from machine to machine; give --spp alone");
    }
    if let Some(part) =
        SampleRange::whole(settings.spp).part(settings.block_size, shard.index, shard.count)
    {
        settings.part = Some(part);
        return Ok(());
    }
    let window = settings.window();
    // Of the picture's own tiles, so that pixels that share paths stay together.
    let first_row = window.y / TILE_SIDE;
    let rows = (window.y + window.height).div_ceil(TILE_SIDE) - first_row;
    if shard.count > rows {
        let spp = settings.spp;
        return refused(&format!(
            "neither {spp} samples in blocks of {} nor {rows} rows of tiles make so many parts; a \
             smaller --block makes more",
            settings.block_size
        ));
    }
    let edge = |i: u32| {
        let row = first_row + (u64::from(rows) * u64::from(i) / u64::from(shard.count)) as u32;
        (row * TILE_SIDE).clamp(window.y, window.y + window.height)
    };
    let (y, end) = (edge(shard.index), edge(shard.index + 1));
    settings.crop = Some(Crop { y, height: end - y, ..window });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shard_is_an_index_of_a_count() {
        assert_eq!(parse("0/1"), Ok(Shard { index: 0, count: 1 }));
        assert_eq!(parse("7/8"), Ok(Shard { index: 7, count: 8 }));
        for bad in ["", "1", "8/8", "1/0", "-1/2", "1/2/3", "a/b", "1/99999999999"] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }
}
