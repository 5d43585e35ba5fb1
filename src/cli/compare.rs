//! `steradian compare`: how far pictures are from each other, and whether that is too far.

use super::compare_flags::CompareFlags;
use super::talk;
use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;
use steradian::image::compare::report::{ReportOptions, json, report_path, write_report};
use steradian::image::compare::{
    Case, CaseStatus, Comparison, ComparisonOptions, LayerComparison, NoiseVerdict, Outcome, Run,
    VerdictSettings,
};
use steradian::image::write_atomically;
use steradian::{Error, Result};

/// Files that cannot be read or compared, like a bad command line.
const UNUSABLE: u8 = 2;

/// Cases of a folder that are shown with all their figures.
const SHOWN_IN_FULL: usize = 3;

/// Compares, says what was found, and gives the exit code.
pub(super) fn run(flags: &CompareFlags) -> Result<ExitCode> {
    match compare(flags) {
        Ok(status) => Ok(match status {
            CaseStatus::Same => ExitCode::SUCCESS,
            CaseStatus::Differs | CaseStatus::Missing => ExitCode::FAILURE,
            CaseStatus::Unusable => ExitCode::from(UNUSABLE),
        }),
        Err(error) => {
            talk::line(&format!("error: {error}"));
            Ok(ExitCode::from(UNUSABLE))
        }
    }
}

fn compare(flags: &CompareFlags) -> Result<CaseStatus> {
    let layer = |name: &String| if name == "colour" { String::new() } else { name.clone() };
    let options = ComparisonOptions {
        layers: flags.layers.iter().map(layer).collect(),
        rules: flags.tolerance.clone(),
        verdict: VerdictSettings {
            level: flags.false_alarms,
            tile: flags.tile,
            ..VerdictSettings::default()
        },
    };
    let run = Run::of(&flags.actual, &flags.expected, &options)?;
    let status = run.status();
    let prints_json = flags.json.as_deref() == Some(Path::new("-"));
    if !flags.quiet && !prints_json {
        talk::data(&text(&run))?;
    }
    // First the report, which makes its folder: the figures may go there.
    if let Some(path) = &flags.report {
        let options = ReportOptions {
            most_bytes: (f64::from(flags.report_size) * 1e6) as usize,
            accept_command: accept_command(flags),
            ..ReportOptions::default()
        };
        let path = report_path(path)?;
        write_report(&path, &run, &options)?;
        if !flags.quiet {
            talk::line(&format!("report: {}", path.display()));
        }
    }
    if let Some(path) = &flags.json {
        let text = format!("{:#}\n", json(&run));
        match prints_json {
            true => talk::data(&text)?,
            false => write_atomically(path, |file| {
                std::io::Write::write_all(file, text.as_bytes()).map_err(|e| Error::io(path, e))
            })?,
        }
    }
    if flags.accept { accept(&run) } else { Ok(status) }
}

/// Accepts every case that does not pass and could. What is refused stays a failure.
fn accept(run: &Run) -> Result<CaseStatus> {
    let mut status = CaseStatus::Same;
    for case in run.cases.iter().filter(|case| case.status() != CaseStatus::Same) {
        match case.accept() {
            Ok(()) => talk::line(&format!("accepted: {}", case.name)),
            Err(error) => {
                talk::line(&format!("not accepted: {error}"));
                status = status.min(CaseStatus::Differs);
            }
        }
    }
    Ok(status)
}

/// The command that accepts everything of this call.
fn accept_command(flags: &CompareFlags) -> String {
    let quote = |path: &Path| quote(&path.display().to_string());
    format!("steradian compare --accept {} {}", quote(&flags.actual), quote(&flags.expected))
}

/// A word for a shell.
fn quote(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "._-/=,:+".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// What was found, for people.
fn text(run: &Run) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    for (k, case) in run.cases.iter().enumerate() {
        let is_single = run.cases.len() == 1;
        let _ = writeln!(text, "{:8}  {}", case.status().word(), case.name);
        for reason in case.reasons() {
            let _ = writeln!(text, "  {reason}");
        }
        if let Outcome::Compared(comparison) = &case.outcome
            && (is_single || (k < SHOWN_IN_FULL && !comparison.passes()))
        {
            figures(&mut text, comparison);
        }
    }
    if run.cases.len() > 1 {
        let count = |status| run.cases.iter().filter(|c: &&Case| c.status() == status).count();
        let all =
            [CaseStatus::Same, CaseStatus::Differs, CaseStatus::Missing, CaseStatus::Unusable];
        let counts = all.map(|status| format!("{} {}", count(status), status.word()));
        let _ = writeln!(text, "{} pictures: {}", run.cases.len(), counts.join(", "));
    }
    text
}

fn figures(text: &mut String, comparison: &Comparison) {
    for layer in &comparison.layers {
        metrics(text, layer, comparison.layers.len() > 1);
    }
    if let Some(found) = &comparison.verdict {
        verdict(text, found);
    }
    for note in &comparison.notes {
        let _ = writeln!(text, "  note: {note}");
    }
}

fn metrics(text: &mut String, layer: &LayerComparison, is_named: bool) {
    if is_named {
        let _ = writeln!(text, "  {}", layer.title());
    }
    for (name, value) in layer.metrics.iter() {
        let remark = match (name, layer.metrics.exposures) {
            ("relmse", _) => format!("  epsilon {:.3e}", layer.metrics.epsilon),
            ("relmse.trimmed", _) => "  without the worst 0.1 % of the pixels".into(),
            ("hdrflip.mean", Some(e)) => {
                format!("  {} exposures from {:+.2} to {:+.2} EV", e.count, e.start, e.stop)
            }
            ("different", _) => "  share of the pixels".into(),
            ("error.max", _) => layer
                .worst
                .as_ref()
                .map_or(String::new(), |w| format!("  in {} at ({}, {})", w.channel, w.x, w.y)),
            _ => String::new(),
        };
        let _ = writeln!(text, "  {name:16} {value:<12.5e}{remark}");
    }
}

fn verdict(text: &mut String, verdict: &NoiseVerdict) {
    let word = if verdict.agrees { "no more than noise" } else { "more than noise" };
    let _ = writeln!(
        text,
        "  verdict: {word}, p {:.2e} (false alarms {:.0e}); noise from {}",
        verdict.p_value, verdict.level, verdict.basis
    );
    for plane in &verdict.planes {
        let pixel = plane.worst_pixel.map_or(String::new(), |pixel| {
            format!(
                ", pixel ({}, {}) z {:+.1}, {} of {} p-values below 0.05",
                pixel.x, pixel.y, pixel.z, plane.small_p_values, plane.noisy_pixels
            )
        });
        let _ = writeln!(
            text,
            "    {:9} mean {:+.3} % (z {:+.1}; {:.2} % would show), worst tile z {:+.1} ({:.1} % would show in half \
             of them){pixel}",
            plane.name,
            100.0 * plane.difference / plane.reference_mean,
            plane.z,
            100.0 * plane.visible_bias,
            plane.tiles[plane.worst_tile],
            100.0 * plane.visible_tile_bias,
        );
    }
}
