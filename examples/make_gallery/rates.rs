//! How the error falls with the number of samples.

use crate::bounces::{references, sum_of_first};
use crate::error::{epsilon, error, slope};
use crate::page::{commands, sheet, short, table, time};
use crate::renders::{Job, Program, bundled};

const COUNTS: [u32; 7] = [1, 2, 4, 8, 16, 64, 1024];
/// As many as the references of the bounces have.
const SIDE: u32 = 80;

/// 1 to 1024 samples per pixel, by Sobol points and by independent numbers.
pub(crate) fn run(program: &Program) -> Result<String, String> {
    let references = references(program)?;
    let reference = sum_of_first(&references, references.len());
    let flags = "--light-samples 4 --max-bounces 5";
    let mut shots = Vec::new();
    let (mut sobol, mut independent) = (Vec::new(), Vec::new());
    let mut rows = Vec::new();
    for spp in COUNTS {
        let job = |flags: &str| Job::new(bundled("cornell-box"), SIDE, spp, flags);
        let a = program.shot(&job(flags))?;
        let b = program.shot(&job(&format!("{flags} --sampler independent")))?;
        let errors = [&a, &b].map(|shot| error(&shot.picture, &reference));
        sobol.push((f64::from(spp), errors[0]));
        independent.push((f64::from(spp), errors[1]));
        let mut row = vec![spp.to_string()];
        row.extend(errors.map(short));
        row.push(format!("{:.2}", errors[1] / errors[0]));
        row.push(time(a.seconds));
        rows.push(row);
        shots.extend([a, b]);
    }
    let pictures: Vec<_> = shots.iter().step_by(2).map(|shot| (&shot.picture, 0.0)).collect();
    let head = ["samples per pixel", "error", "of independent numbers", "ratio of the two", "time"];
    Ok(format!(
        "{}\n\
         1, 2, 4, 8 samples per pixel above, 16, 64, 1024 below; 4 light samples at each vertex, at most 5\n\
         bounces. The root of the error falls as the power {:.3} of their number with the scrambled\n\
         Sobol points that are the default, and {:.3} with independent random numbers (`--sampler\n\
         independent`), where theory says -0.5.\n\n{}\n\
         Reference: the sum of the long renders of \"Each bounce alone\", 4096 samples per pixel; ε {}.\n\
         Its noise is in the last row too, and makes both slopes a little flatter.\n\n{}",
        sheet("rates", "1, 2, 4, 8, 16, 64, 1024 samples per pixel", &pictures, 4, 2)?,
        slope(&sobol),
        slope(&independent),
        table(&head, rows),
        epsilon(&reference),
        commands(shots.iter().chain(&references).map(|shot| shot.command.as_str())),
    ))
}
