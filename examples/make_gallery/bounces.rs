//! What each bounce brings, and what a limit on bounces takes away.

use crate::error::{epsilon, error, largest_difference, luminance, sum};
use crate::page::{commands, sheet, short, table, time};
use crate::renders::{Job, Program, Shot, bundled};
use steradian::image::Picture;

const SIDE: u32 = 80;
const SPP: u32 = 1024;
const REFERENCE_SPP: u32 = 4096;
/// The last bounce that is looked at alone.
const LAST: u32 = 5;

fn job(flags: &str) -> Job {
    Job::new(bundled("cornell-box"), SIDE, SPP, flags)
}

/// Long renders of each bounce alone, from 0 to [`LAST`].
pub(crate) fn references(program: &Program) -> Result<Vec<Shot>, String> {
    (0..=LAST)
        .map(|k| program.shot(&job(&format!("--only-bounce {k}")).reference(REFERENCE_SPP)))
        .collect()
}

/// The sum of the first `count` pictures.
pub(crate) fn sum_of_first(shots: &[Shot], count: usize) -> Picture {
    sum(shots[..count].iter().map(|shot| &shot.picture))
}

/// Bounces alone, direct and indirect light, and their sums.
pub(crate) fn parts(program: &Program) -> Result<String, String> {
    let references = references(program)?;
    let alone: Vec<Shot> = (0..=LAST)
        .map(|k| program.shot(&job(&format!("--only-bounce {k}"))))
        .collect::<Result<_, _>>()?;
    let direct = program.shot(&job("--max-bounces 1"))?;
    let whole = program.shot(&job(&format!("--max-bounces {LAST}")))?;
    let indirect = sum(alone[2..].iter().map(|shot| &shot.picture));
    let indirect_reference = sum(references[2..].iter().map(|shot| &shot.picture));
    let total = sum([&direct.picture, &indirect]);
    let all = sum_of_first(&alone, alone.len());
    let [direct_reference, whole_reference] =
        [2, references.len()].map(|count| sum_of_first(&references, count));

    let row = |what: String, picture: &Picture, reference: &Picture, seconds: String| {
        let share = 100.0 * luminance(picture) / luminance(&whole.picture);
        let e = short(error(picture, reference));
        vec![what, format!("{share:.2} %"), e, epsilon(reference), seconds]
    };
    let mut rows: Vec<_> = alone
        .iter()
        .zip(&references)
        .enumerate()
        .map(|(k, (s, r))| {
            row(format!("bounce {k} alone"), &s.picture, &r.picture, time(s.seconds))
        })
        .collect();
    rows.push(row("direct".into(), &direct.picture, &direct_reference, time(direct.seconds)));
    rows.push(row("indirect: 2 to 5 added".into(), &indirect, &indirect_reference, String::new()));
    rows.push(row("whole".into(), &whole.picture, &whole_reference, time(whole.seconds)));
    let stops = |k: usize| if k < 2 { 0.0 } else { 2.0 };
    let mut pictures: Vec<_> =
        alone.iter().enumerate().map(|(k, shot)| (&shot.picture, stops(k))).collect();
    pictures.extend([(&direct.picture, 0.0), (&indirect, 0.0), (&whole.picture, 0.0)]);
    Ok(format!(
        "{}\n\
         Upper two rows: light that was scattered exactly 0 to 5 times (2 to 5 are shown at four times\n\
         their brightness). Lower row: direct light, indirect light, and the whole, which ends after 5\n\
         bounces. {SPP} samples per pixel. All have the same seed and so the same paths: the sum of\n\
         the six differs from the whole by {} of the mean luminance at most in any pixel, direct and\n\
         indirect together by {}: rounding.\n\n{}\n\
         References: each bounce alone with {REFERENCE_SPP} samples per pixel, and their sums.\n\n{}",
        sheet("parts", "Bounces 0 to 5; direct, indirect, whole", &pictures, 3, 2)?,
        short(largest_difference(&all, &whole.picture)),
        short(largest_difference(&total, &whole.picture)),
        table(&["", "light of the whole", "error", "ε", "time"], rows),
        commands(
            alone
                .iter()
                .chain([&direct, &whole])
                .chain(&references)
                .map(|shot| shot.command.as_str())
        ),
    ))
}

/// Paths that end after a number of bounces.
pub(crate) fn limits(program: &Program) -> Result<String, String> {
    let references = references(program)?;
    let unlimited = program.shot(&job("").reference(REFERENCE_SPP))?;
    let mut shots = Vec::new();
    let mut rows = Vec::new();
    for limit in [0, 1, 2, 3, 4, 5, 100] {
        let shot = program.shot(&job(&format!("--max-bounces {limit}")))?;
        let reference = match limit {
            0..=LAST => sum_of_first(&references, limit as usize + 1),
            _ => unlimited.picture.clone(),
        };
        let share = 100.0 * luminance(&shot.picture) / luminance(&unlimited.picture);
        let rays = shot.stats["rays_closest"].as_f64().unwrap_or(f64::NAN)
            / shot.stats["samples"].as_f64().unwrap_or(f64::NAN);
        rows.push(vec![
            limit.to_string(),
            format!("{share:.2} %"),
            short(error(&shot.picture, &unlimited.picture)),
            short(error(&shot.picture, &reference)),
            epsilon(&reference),
            format!("{rays:.2}"),
            time(shot.seconds),
        ]);
        shots.push(shot);
    }
    let pictures: Vec<_> = shots.iter().map(|shot| (&shot.picture, 0.0)).collect();
    let ratio = shots[6].seconds / shots[4].seconds;
    let head = [
        "limit",
        "light kept",
        "error against no limit",
        "against the same limit",
        "ε of that",
        "segments per path",
        "time",
    ];
    Ok(format!(
        "{}\n\
         `--max-bounces` 0, 1, 2, 3 above, 4, 5, 100 below; {SPP} samples per pixel. A limit is a bias: what\n\
         lies beyond is missing, and no number of samples brings it. At 100 roulette ends the\n\
         paths, and the whole costs {ratio:.2} times what 4 bounces cost.\n\n{}\n\
         References: no limit, {REFERENCE_SPP} samples per pixel (its own error is {} by its own\n\
         estimate, ε {}); for the limits to 5 the sums of the long renders of single bounces.\n\n{}",
        sheet("bounces", "At most 0, 1, 2, 3, 4, 5, 100 bounces", &pictures, 4, 2)?,
        table(&head, rows),
        short(unlimited.estimate()),
        epsilon(&unlimited.picture),
        commands(
            shots.iter().chain([&unlimited]).chain(&references).map(|shot| shot.command.as_str())
        ),
    ))
}
