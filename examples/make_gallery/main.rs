//! Writes docs/gallery.md and its pictures: studies of what each part of the renderer does.
//!
//! ```sh
//! make gallery                  # all studies
//! make gallery STUDY=roulette   # one of them; the page keeps the others
//! ```
//!
//! Run it in the repository root, after `cargo build --release --bins --examples`. Pictures
//! are rendered by calls of the program, which the page prints, into out/gallery/; those that are
//! newer than the program and their scene are not rendered again.

mod adaptive;
mod bounces;
mod clock;
mod direct;
mod error;
mod page;
mod rates;
mod renders;
mod roulette;
mod trees;
mod trees_count;

use page::PAGE;
use renders::Program;
use std::process::ExitCode;
use steradian::gpu::Device;

/// A section of the page.
struct Study {
    /// For the command line.
    name: &'static str,
    title: &'static str,
    /// Renders, and gives the section's text.
    run: fn(&Program) -> Result<String, String>,
}

/// In the order of the page.
const STUDIES: &[Study] = &[
    Study { name: "trees", title: "Trees", run: trees::run },
    Study { name: "hemisphere", title: "Hemisphere or lights", run: direct::hemisphere_and_lights },
    Study { name: "shadows", title: "Soft shadows", run: direct::soft_shadows },
    Study { name: "parts", title: "Each bounce alone", run: bounces::parts },
    Study { name: "bounces", title: "Limits on bounces", run: bounces::limits },
    Study { name: "rates", title: "Samples per pixel", run: rates::run },
    Study { name: "roulette", title: "Russian roulette", run: roulette::run },
    Study { name: "adaptive", title: "Adaptive sampling", run: adaptive::run },
];

fn main() -> ExitCode {
    let names: Vec<String> = std::env::args().skip(1).collect();
    match run(&names) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("make_gallery: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run(names: &[String]) -> Result<(), String> {
    let known: Vec<&str> = STUDIES.iter().map(|study| study.name).collect();
    if let Some(name) = names.iter().find(|name| !known.contains(&name.as_str())) {
        return Err(format!("no study {name:?}; there are {}", known.join(", ")));
    }
    let program = Program::find()?;
    let old = std::fs::read_to_string(PAGE).unwrap_or_default();
    let mut text = introduction()?;
    for study in STUDIES {
        let is_chosen = names.is_empty() || names.iter().any(|name| name == study.name);
        let section = match page::section(&old, study.title) {
            Some(section) if !is_chosen => section,
            None if !is_chosen => continue,
            _ => {
                eprintln!("study {}", study.name);
                let body = (study.run)(&program)?;
                let Study { name, title, .. } = study;
                format!("## {title}\n\n`make gallery STUDY={name}`\n\n{}\n", body.trim())
            }
        };
        text += &format!("\n{section}");
        let page: &std::path::Path = PAGE.as_ref();
        // After each study, so that a run that is stopped keeps what it has.
        std::fs::write(page, &text).map_err(|e| format!("{PAGE}: {e}"))?;
    }
    Ok(())
}

fn introduction() -> Result<String, String> {
    let device = Device::open(None).map_err(|e| e.to_string())?;
    let info = device.info();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    Ok(format!(
        "# Gallery\n\n\
         What each part of the renderer does, in pictures and figures. Written by `make gallery`;\n\
         each section by the command under its heading, which calls the program as the section lists.\n\
         `steradian` is `target/release/steradian`.\n\
         Device: {}, {}; {cores} processor cores.\n\n\
         *Error* is relMSE, the mean over pixels and channels of (x - r)² / (r² + ε), with\n\
         ε = (0.01 × mean luminance of the reference)² as printed. References have more samples\n\
         and another seed, so no sample is shared; their own noise is part of the figures. Where a\n\
         reference is made by this renderer, the figures show noise and the effect of a setting, not\n\
         whether the renderer is right: the tests are for that.\n\
         *Time* is processor time of all threads together, loading and compiling taken off. It still\n\
         depends on what else the machine does: the same call was seen to take up to half as long again.\n\
         Pictures are enlarged pixel by pixel, and clip where light sources are.\n",
        info.name,
        info.driver.trim(),
    ))
}
