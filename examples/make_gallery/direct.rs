//! Direct light: two ways to sample it, and how many samples of the lights to take.

use crate::error::{epsilon, error, luminance, slope, window};
use crate::page::{commands, sheet, short, table, time};
use crate::renders::{Job, Program, Shot, bundled};
use steradian::image::compare::mse;
use steradian::settings::Crop;

const SIDE: u32 = 96;

/// Side of the picture of which soft shadows are a part: at one ray per pixel, small pixels.
const LARGE_SIDE: u32 = 384;

/// The right sphere's shadow, in that picture.
const SHADOW: &str = "--crop 176,288,192,84";

/// The floor in it: half-shadow, and no edge.
const FLOOR: Crop = Crop { x: 64, y: 62, width: 96, height: 20 };

fn job(spp: u32, flags: &str) -> Job {
    let flags = format!("--max-bounces 1 {flags}");
    Job::new(bundled("cornell-spheres-diffuse"), SIDE, spp, flags.trim())
}

/// Both strategies at once, many samples of each.
fn reference(program: &Program) -> Result<Shot, String> {
    program.shot(&job(1024, "--light-samples 4").reference(1024))
}

/// The strategies at 16 and 64 samples per pixel.
pub(crate) fn hemisphere_and_lights(program: &Program) -> Result<String, String> {
    let reference = reference(program)?;
    let mut shots = Vec::new();
    let mut rows = Vec::new();
    for (spp, lights) in [(16, 8), (64, 32)] {
        let ways = [
            ("hemisphere", 1, job(spp, "--strategy hemisphere")),
            ("hemisphere", 1, job(spp * lights, "--strategy hemisphere")),
            ("lights", lights, job(spp, &format!("--strategy light --light-samples {lights}"))),
        ];
        for (what, per_vertex, job) in ways {
            let shot = program.shot(&job)?;
            rows.push(vec![
                (shots.len() + 1).to_string(),
                what.to_owned(),
                job.spp.to_string(),
                (job.spp * per_vertex).to_string(),
                short(error(&shot.picture, &reference.picture)),
                time(shot.seconds),
            ]);
            shots.push(shot);
        }
    }
    let pictures: Vec<_> = shots.iter().map(|shot| (&shot.picture, 0.0)).collect();
    let ratio = |hemisphere: usize, lights: usize| {
        let of = |i: usize| error(&shots[i].picture, &reference.picture);
        of(hemisphere) / of(lights)
    };
    let head = ["picture", "sampled", "samples per pixel", "directions per pixel", "error", "time"];
    Ok(format!(
        "{}\n\
         Direct light only (`--max-bounces 1`). Uniform directions over the hemisphere find the lamp by\n\
         chance; light sampling aims at it. The second picture of a row has as many directions as\n\
         the third: at that number light sampling has {:.0} and {:.0} times less squared error. What is left\n\
         of it is noise of the half-shadows and of the edges.\n\n{}\n\
         Reference: 1024 samples per pixel of 4 light samples, both strategies weighted (its own\n\
         error is {} by its own estimate); ε {}.\n\n{}",
        sheet("hemisphere", "Upper row 16 samples per pixel, lower row 64", &pictures, 3, 2)?,
        ratio(1, 2),
        ratio(4, 5),
        table(&head, rows),
        short(reference.estimate()),
        epsilon(&reference.picture),
        commands(shots.iter().chain([&reference]).map(|shot| shot.command.as_str())),
    ))
}

/// One sample per pixel, 1 to 64 samples of the lights.
pub(crate) fn soft_shadows(program: &Program) -> Result<String, String> {
    let job = |spp, flags: &str| Job { side: LARGE_SIDE, ..job(spp, &format!("{flags} {SHADOW}")) };
    let reference = program.shot(&job(256, "--light-samples 16").reference(256))?;
    let floor = window(&reference.picture, FLOOR);
    let mut shots = Vec::new();
    let mut points = Vec::new();
    let mut rows = Vec::new();
    for lights in [1, 4, 16, 64] {
        let flags = format!("--strategy light --light-samples {lights}");
        let shot = program.shot(&job(1, &flags))?;
        let square = mse(&window(&shot.picture, FLOOR), &floor) / luminance(&floor).powi(2);
        points.push((f64::from(lights), square));
        let e = error(&shot.picture, &reference.picture);
        rows.push(vec![lights.to_string(), short(e), short(square)]);
        shots.push(shot);
    }
    let pictures: Vec<_> = shots.iter().map(|shot| (&shot.picture, 0.0)).collect();
    let head = ["light samples", "error", "square error on the floor"];
    Ok(format!(
        "{}\n\
         One camera ray per pixel; 1 and 4 samples of the lamp above, 16 and 64 below. The noise of\n\
         the half-shadow goes, the stairs at the sphere's rim stay: they are noise of the camera ray, of\n\
         which there is still one. So the last column is that of the floor alone, where there are no\n\
         edges: mean square over the square of the mean luminance. Its root falls as the power {:.2} of\n\
         the number; independent samples have -0.5.\n\n{}\n\
         Reference: 256 samples per pixel of 16 light samples, both strategies weighted (its own\n\
         error is {} by its own estimate); ε {}.\n\n{}",
        sheet("shadows", "1, 4, 16, 64 light samples", &pictures, 2, 2)?,
        slope(&points),
        table(&head, rows),
        short(reference.estimate()),
        epsilon(&reference.picture),
        commands(shots.iter().chain([&reference]).map(|shot| shot.command.as_str())),
    ))
}
