//! A film in sections of a film file, and back; and films of parts, joined.

use super::file::{FilmFile, Sections};
use super::{Film, SampleRange};
use crate::settings::Crop;
use crate::{Error, Result};
use serde::{Deserialize, Serialize};

/// What a film is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct FilmHead {
    /// The pixels that it covers.
    pub window: Crop,
    /// Samples of the smallest whole block.
    pub unit: u32,
    /// Where every pixel takes as many.
    pub samples: Option<SampleRange>,
    /// Segments of the sums that are kept apart.
    kept: usize,
    /// Levels of the means of the run under way.
    parts: usize,
}

impl Film {
    /// What it is of.
    pub fn head(&self) -> FilmHead {
        FilmHead {
            window: self.window,
            unit: self.unit,
            samples: self.samples,
            kept: self.sums.kept.as_ref().map_or(0, Vec::len),
            parts: self.means.parts.len(),
        }
    }

    /// All of it but how pixels ended, which their device knows.
    pub fn sections(&self) -> Sections<'_> {
        let name = |text: &str| text.to_owned();
        let mut sections: Sections = vec![
            (name("sum"), bytemuck::cast_slice(&self.sums.total).into()),
            (name("segment"), bytemuck::cast_slice(&self.sums.segment).into()),
            (name("sample_count"), bytemuck::cast_slice(&self.sample_count).into()),
            (name("runs"), bytemuck::cast_slice(&self.means.runs).into()),
            (name("unit_count"), bytemuck::cast_slice(&self.means.unit_counts).into()),
        ];
        for (i, segment) in self.sums.kept.iter().flatten().enumerate() {
            sections.push((format!("sum.{i}"), bytemuck::cast_slice(segment).into()));
        }
        for (i, part) in self.means.parts.iter().enumerate() {
            sections.push((format!("run.{i}"), bytemuck::cast_slice(part).into()));
        }
        if let Some(faults) = &self.faults {
            sections.push((name("faults"), bytemuck::cast_slice(faults).into()));
        }
        sections
    }

    /// The film of a file.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn read(file: &FilmFile, head: &FilmHead) -> Result<Self> {
        let n = u64::from(head.window.width) * u64::from(head.window.height);
        let fits = |s: SampleRange| s.fits(s.total, head.unit);
        // Before any memory is taken for what it says.
        if file.section_bytes("sample_count") != 4 * n
            || head.unit == 0
            || !head.samples.is_none_or(fits)
        {
            return Err(file.misfit("is damaged: its film does not fit its head"));
        }
        let mut film = Self::with(head.window, head.unit, head.samples);
        let n = n as usize;
        film.sums.total = file.section("sum", film.sums.total.len())?;
        film.sums.segment = file.section("segment", film.sums.segment.len())?;
        film.sample_count = file.section("sample_count", n)?;
        film.means.runs = file.section("runs", n)?;
        film.means.unit_counts = file.section("unit_count", n)?;
        let kept = (0..head.kept).map(|i| file.section(&format!("sum.{i}"), n));
        let kept = kept.collect::<Result<Vec<_>>>()?;
        if let Some(segments) = &mut film.sums.kept {
            *segments = kept;
        }
        let parts = (0..head.parts).map(|i| file.section(&format!("run.{i}"), n));
        film.means.parts = parts.collect::<Result<_>>()?;
        film.faults = file.has("faults").then(|| file.section("faults", n)).transpose()?;
        Ok(film)
    }

    /// Adds the film of the samples, of the same pixels, that come next after all of this one's: the
    /// bits are those of one film of all.
    ///
    /// # Errors
    /// [`Error::Settings`] if they do not come next.
    pub fn append(&mut self, next: &Self) -> Result<()> {
        let range = |film: &Self| film.samples.map(|s| (s.total, s.first, s.end));
        let (Some((total, first, end)), Some((next_total, next_first, next_end))) =
            (range(self), range(next))
        else {
            return Err(Error::Settings("films of pixels that stop one by one do not join".into()));
        };
        let follows = first == 0 && total == next_total && end == next_first;
        if !follows || self.window != next.window || self.unit != next.unit {
            return Err(Error::Settings(format!(
                "samples {next_first} to {next_end} of {next_total} do not follow samples {first} to \
                 {end} of {total}"
            )));
        }
        self.samples = Some(SampleRange { total, first, end: next_end });
        self.means.take_fixed_length(self.segment_units());
        self.sums.append(&next.sums);
        self.means.append(&next.means);
        for (count, more) in self.sample_count.iter_mut().zip(&next.sample_count) {
            *count += more;
        }
        if let Some(faults) = &next.faults {
            let all = self.faults.get_or_insert_with(|| vec![[0; 4]; faults.len()]);
            for (all, more) in all.iter_mut().flatten().zip(faults.iter().flatten()) {
                *all += more;
            }
        }
        Ok(())
    }

    /// An empty film of all pixels of `window`, for films of parts of it. `like`: one of them.
    pub fn for_parts_of(window: Crop, like: &Self) -> Self {
        let mut film = Self::with(window, like.unit, like.samples);
        film.means.take_fixed_length(film.segment_units());
        film
    }

    /// Puts the film of a part of the pixels, with the same samples, in its place.
    ///
    /// # Errors
    /// [`Error::Settings`] if it does not lie within, or is of other samples.
    pub fn insert(&mut self, part: &Self) -> Result<()> {
        let (window, inner) = (self.window, part.window);
        if !window.contains(&inner) || self.samples != part.samples || self.unit != part.unit {
            let message = format!("the part {inner:?} is none of the window {window:?}");
            return Err(Error::Settings(message));
        }
        let row = |y: u32| {
            let to = (inner.y - window.y + y) * window.width + inner.x - window.x;
            (to as usize, (y * inner.width) as usize, inner.width as usize)
        };
        for (to, from, n) in (0..inner.height).map(row) {
            self.sums.insert(&part.sums, to, from, n);
            self.means.insert(&part.means, to, from, n);
            self.sample_count[to..to + n].copy_from_slice(&part.sample_count[from..from + n]);
            if let Some(faults) = &part.faults {
                let count = self.sample_count.len();
                let all = self.faults.get_or_insert_with(|| vec![[0; 4]; count]);
                all[to..to + n].copy_from_slice(&faults[from..from + n]);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{BlockMean, write_film_file};

    const WINDOW: Crop = Crop { x: 3, y: 5, width: 5, height: 4 };

    fn block(i: u32, first: u32, n: u32) -> BlockMean {
        let value = |c: u32| {
            let word = (i * 97 + first * 13 + c).wrapping_mul(2_654_435_769).rotate_left(7);
            f64::from(word.wrapping_mul(2_246_822_519)) * 10.0_f64.powi((word % 9) as i32 - 14)
        };
        BlockMean { mean: [value(0), value(1), value(2)], sample_count: n }
    }

    /// The film of those samples of the pixels of `inner`.
    fn film(inner: Crop, unit: u32, samples: SampleRange) -> Film {
        let mut film = Film::of_samples(inner, unit, &samples);
        fill(&mut film, samples.first..samples.end);
        film
    }

    /// Takes samples, which differ in size by many decades.
    fn fill(film: &mut Film, samples: std::ops::Range<u32>) {
        let (unit, inner) = (film.unit, film.window);
        let mut first = samples.start;
        while first < samples.end {
            let n = unit.min(samples.end - first);
            for (x, y) in (0..inner.height).flat_map(|y| (0..inner.width).map(move |x| (x, y))) {
                let i = (y + inner.y) * 100 + x + inner.x;
                film.add_block(x, y, block(i, first, n));
                film.add_faults(x, y, [u32::from(first == 0 && x == 1), 0, 0, 0]);
            }
            first += n;
        }
    }

    fn assert_same(a: &Film, b: &Film) {
        let bits = |film: &Film| film.sums.of(7).map(f64::to_bits);
        assert_eq!(bits(a), bits(b));
        assert_eq!(a.picture(), b.picture());
        assert_eq!(a.standard_error(), b.standard_error());
        assert_eq!(a.sample_counts(), b.sample_counts());
        assert_eq!(a.faults(), b.faults());
        assert_eq!(a.estimated_error(), b.estimated_error());
    }

    #[test]
    fn parts_of_the_samples_join_to_the_bits_of_the_whole() {
        for (total, unit) in [(256, 16), (64, 16), (100, 8), (1000, 4), (37, 1), (96, 1)] {
            let all = SampleRange::whole(total);
            let whole = film(WINDOW, unit, all);
            for count in 1..=15 {
                let Some(mut joined) = all.part(unit, 0, count).map(|r| film(WINDOW, unit, r))
                else {
                    assert!(count > total.div_ceil(unit).min(8), "{count} parts of {total}");
                    continue;
                };
                for index in 1..count {
                    let range = all.part(unit, index, count).unwrap();
                    assert!(range.first < range.end, "an empty part");
                    joined.append(&film(WINDOW, unit, range)).unwrap();
                }
                assert_eq!(joined.samples, Some(all));
                assert_same(&joined, &whole);
            }
        }
    }

    #[test]
    fn a_part_that_does_not_follow_is_refused() {
        let all = SampleRange::whole(64);
        let part = |index| film(WINDOW, 4, all.part(4, index, 4).unwrap());
        let mut first = part(0);
        assert!(first.append(&part(2)).is_err());
        assert!(first.append(&part(0)).is_err());
        first.append(&part(1)).unwrap();
        assert!(first.append(&part(1)).is_err());
        assert!(part(1).append(&part(2)).is_err(), "nothing is before the first");
    }

    #[test]
    fn parts_of_the_pixels_join_to_the_bits_of_the_whole() {
        let all = SampleRange::whole(96);
        let whole = film(WINDOW, 4, all);
        let upper = Crop { height: 1, ..WINDOW };
        let lower = Crop { y: 6, height: 3, ..WINDOW };
        let mut joined = Film::for_parts_of(WINDOW, &film(upper, 4, all));
        for part in [lower, upper] {
            joined.insert(&film(part, 4, all)).unwrap();
        }
        assert_same(&joined, &whole);
        assert!(joined.insert(&film(Crop { y: 7, ..WINDOW }, 4, all)).is_err());
        assert!(joined.insert(&film(upper, 4, SampleRange::whole(100))).is_err());
    }

    /// Also in the middle of a run and of a segment, where it goes on with the same bits.
    #[test]
    fn a_film_in_a_file_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.film");
        let all = SampleRange::whole(1000);
        for range in [all, all.part(4, 1, 3).unwrap()] {
            let mut kept = Film::of_samples(WINDOW, 4, &range);
            fill(&mut kept, range.first..range.first + 300);
            write_film_file(&path, &kept.head(), &kept.sections()).unwrap();
            let file = FilmFile::open(&path).unwrap();
            let mut read = Film::read(&file, &file.head().unwrap()).unwrap();
            assert_same(&read, &kept);
            for film in [&mut read, &mut kept] {
                fill(film, range.first + 300..range.end);
            }
            assert_same(&read, &kept);
        }
    }
}
