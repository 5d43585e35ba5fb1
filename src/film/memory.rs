//! What a film takes of the host's memory.

use super::run_means::{RUNS, runs};
use super::{Film, PixelStop, SampleRange};
use crate::settings::Crop;

/// One sum of radiance.
const SUM: u64 = size_of::<[f64; 3]>() as u64;

impl Film {
    /// Bytes of the film of a window of pixels in blocks of `unit` samples when it is full. Pixels take
    /// `samples`, or, where each stops by itself, up to `limit`. Counts of faulty samples, which
    /// hardly a render has, are not in it.
    pub fn bytes(window: Crop, unit: u32, samples: Option<&SampleRange>, limit: u32) -> u64 {
        let pixels = u64::from(window.width) * u64::from(window.height);
        let counts = 2 * size_of::<u32>() as u64;
        let observations = size_of::<[f64; RUNS]>() as u64;
        let units = samples.map_or(limit, |range| range.total) / unit;
        // Halves of the run under way: one of every power of two of units below its length.
        let halves = u64::from(runs(units).0.ilog2()) * size_of::<f64>() as u64;
        let sums = match samples {
            // The segment under way, and those before it: their sum, or each if the first is not there.
            Some(range) if range.first > 0 => {
                let segment = range.segment(unit);
                1 + u64::from(range.end / segment - range.first / segment)
            }
            Some(_) => 2,
            None => 1,
        };
        let stop = if samples.is_some() { 0 } else { size_of::<PixelStop>() as u64 };
        pixels * (sums * SUM + counts + observations + halves + stop)
    }
}

#[cfg(test)]
mod tests {
    use super::super::BlockMean;
    use super::*;

    /// By its parts.
    fn held(film: &Film) -> u64 {
        let sections = film.sections().iter().map(|(_, bytes)| bytes.len() as u64).sum::<u64>();
        sections + film.stops().map_or(0, |stops| size_of_val(stops) as u64)
    }

    #[test]
    fn a_full_film_holds_as_much_as_was_said() {
        // Runs that have just doubled have no halves yet.
        let assert_enough = |said: u64, film: &Film, what: String| {
            let rest = said.checked_sub(held(film));
            let level = 10 * size_of::<f64>() as u64;
            assert!(rest.is_some_and(|rest| rest <= level), "{what}: {said}, {}", held(film));
        };
        let window = Crop { x: 3, y: 4, width: 5, height: 2 };
        let unit = 4;
        let fill = |film: &mut Film, samples: u32| {
            for pixel in 0..10 {
                for at in (0..samples).step_by(unit as usize) {
                    let sample_count = unit.min(samples - at);
                    let block = BlockMean { mean: [1.0; 3], sample_count };
                    film.add_block(pixel % 5, pixel / 5, block);
                }
            }
        };
        for total in [1, 4, 60, 64, 124, 1000] {
            let whole = SampleRange::whole(total);
            let parts = [Some(whole), whole.part(unit, 0, 3), whole.part(unit, 1, 3)];
            for range in parts.into_iter().flatten() {
                let mut film = Film::of_samples(window, unit, &range);
                fill(&mut film, range.end - range.first);
                let said = Film::bytes(window, unit, Some(&range), total);
                assert_enough(said, &film, format!("{range:?}"));
            }
            let mut film = Film::new(window, unit);
            fill(&mut film, total);
            let stop =
                PixelStop { reason: crate::stopping::StopReason::Converged, half_width: 0.0 };
            film.set_stops(vec![stop; 10]);
            let said = Film::bytes(window, unit, None, total);
            assert_enough(said, &film, format!("{total}"));
        }
    }
}
