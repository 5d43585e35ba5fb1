//! Writes docs/numerics.md from the figures that the tests recorded:
//! `write_numerics FIGURES PAGE CASES`. `make numerics` runs the tests and this.

mod bars;

use bars::{BARS, Bar, LETTERS};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::process::ExitCode;
use steradian::gpu::Device;
use steradian::passes::FloatEnvironment;

/// A line of the recorded figures.
#[derive(Deserialize)]
struct Figure {
    case: String,
    what: String,
    kind: Kind,
    figure: Number,
    bound: Option<Bound>,
    limit: Option<Number>,
}

#[derive(Deserialize, Clone, Copy, PartialEq)]
#[serde(rename_all = "lowercase")]
enum Kind {
    /// The renderer against its bar.
    Product,
    /// A usual technique that fails.
    Naive,
    /// Told, not judged.
    Report,
}

#[derive(Deserialize, Clone, Copy, PartialEq)]
enum Bound {
    #[serde(rename = "at most")]
    AtMost,
    #[serde(rename = "at least")]
    AtLeast,
}

/// A float; as text where JSON has none for it.
#[derive(Deserialize)]
#[serde(untagged)]
enum Number {
    Finite(f64),
    Other(String),
}

impl Number {
    fn value(&self) -> f64 {
        match self {
            Self::Finite(value) => *value,
            Self::Other(text) => text.parse().unwrap_or(f64::NAN),
        }
    }
}

impl Figure {
    fn holds(&self) -> bool {
        let limit = self.limit.as_ref().map(Number::value);
        match (self.bound, limit) {
            (Some(Bound::AtMost), Some(limit)) => self.figure.value() <= limit,
            (Some(Bound::AtLeast), Some(limit)) => self.figure.value() >= limit,
            _ => true,
        }
    }

    /// How near the limit it is: above 1 beyond it.
    fn strain(&self) -> f64 {
        let (figure, limit) = (self.figure.value(), self.limit.as_ref().map_or(0.0, Number::value));
        match self.bound {
            _ if figure == limit && limit == 0.0 => 0.0,
            _ if figure == limit => 1.0,
            Some(Bound::AtMost) if limit > 0.0 => figure / limit,
            Some(Bound::AtLeast) if figure > 0.0 => limit / figure,
            _ if self.holds() => 0.0,
            _ => f64::INFINITY,
        }
    }

    fn bound_text(&self) -> String {
        let Some(limit) = self.limit.as_ref().map(|l| number(l.value())) else {
            return String::new();
        };
        match self.bound {
            Some(Bound::AtLeast) => format!("≥ {limit}"),
            _ => format!("≤ {limit}"),
        }
    }
}

/// Counts in full, everything else to three digits.
fn number(x: f64) -> String {
    if x == x.trunc() && x.abs() < 1e6 {
        return format!("{x}");
    }
    if (0.01..1e4).contains(&x.abs()) { format!("{x:.4}") } else { format!("{x:.2e}") }
}

/// Text as it may stand in a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn read(path: &str) -> Result<Vec<Figure>, String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("{path}: {e}"))?;
    let parse =
        |(i, line)| serde_json::from_str(line).map_err(|e| format!("{path}, line {}: {e}", i + 1));
    text.lines().enumerate().map(parse).collect()
}

fn bar_row(bar: &Bar, figures: &[Figure]) -> String {
    let of_bar = |f: &&Figure| f.kind == Kind::Product && bar.cases.contains(&f.case.as_str());
    let judged: Vec<_> = figures.iter().filter(of_bar).collect();
    // Lower bounds are mostly of counts that make a case worth its name: errors come first.
    let strain = |f: &&&Figure| (f.bound == Some(Bound::AtMost), f.strain());
    let by_strain = |a: &(bool, f64), b: &(bool, f64)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1));
    let worst = judged.iter().max_by(|a, b| by_strain(&strain(a), &strain(b)));
    let measured = match worst {
        None if bar.number == 18 => "below".into(),
        None => "not measured".into(),
        Some(w) => format!(
            "{} of {} figures hold; nearest to its limit: {} {} ({}: {})",
            judged.iter().filter(|f| f.holds()).count(),
            judged.len(),
            number(w.figure.value()),
            w.bound_text(),
            w.case,
            w.what
        ),
    };
    let row = [bar.text, &measured, bar.elsewhere].map(cell);
    format!("| {} | {} | {} | {} |\n", bar.number, row[0], row[1], row[2])
}

/// The figures that miss their bars, if any do.
fn misses(figures: &[Figure]) -> String {
    let missed: Vec<_> = figures.iter().filter(|f| f.kind == Kind::Product && !f.holds()).collect();
    if missed.is_empty() {
        return String::new();
    }
    let mut text = "\nMissed:\n\n".to_owned();
    for f in missed {
        let (figure, bound) = (number(f.figure.value()), f.bound_text());
        // Writing to a string cannot fail.
        let _ = writeln!(text, "- {}, {}: {figure}, bar {bound}", f.case, f.what);
    }
    text
}

fn letter_table(letter: char, name: &str, figures: &[Figure]) -> String {
    let mut rows: Vec<&Figure> = figures.iter().filter(|f| f.case.starts_with(letter)).collect();
    if rows.is_empty() {
        return String::new();
    }
    // A sort by the number of the case; within a case the order of measuring.
    rows.sort_by_key(|f| f.case[1..].parse::<u32>().unwrap_or(u32::MAX));
    let mut text = format!(
        "\n## {letter}. {name}\n\n| case | what | measured | bar | |\n|---|---|---:|---:|---|\n"
    );
    for f in rows {
        let verdict = match (f.kind, f.holds()) {
            (Kind::Product, true) => "holds",
            (Kind::Product, false) => "**missed**",
            (Kind::Naive, _) => "the usual technique",
            (Kind::Report, _) => "",
        };
        let bound = if f.kind == Kind::Product { f.bound_text() } else { String::new() };
        let figure = number(f.figure.value());
        let _ =
            writeln!(text, "| {} | {} | {figure} | {bound} | {verdict} |", f.case, cell(&f.what));
    }
    text
}

fn page(figures: &[Figure], device: &str, cases: &str) -> String {
    let mut counts = BTreeMap::new();
    for f in figures.iter().filter(|f| f.kind == Kind::Product) {
        *counts.entry(f.holds()).or_insert(0) += 1;
    }
    let count = |holds| counts.get(&holds).copied().unwrap_or(0);
    let mut text = format!(
        "# Numerical stability, measured\n\n\
         Written by `make numerics`, which runs the catalogue of hard cases (`tests/numerics`) and the\n\
         scenes of known radiance (`tests/known_radiance`), {}. Of the figures that\n\
         have a bar, {} hold and {} miss it. Rows named \"the usual technique\" are copies of\n\
         common methods that the tests keep to show that a case is hard.\n\n{device}\n\n\
         | | held to | measured | best known elsewhere |\n|---|---|---|---|\n",
        match cases {
            "--include-ignored" => "all of them",
            "" => "without the long cases",
            other => other,
        },
        count(true),
        count(false),
    );
    text.extend(BARS.iter().map(|bar| bar_row(bar, figures)));
    text += &misses(figures);
    text.extend(LETTERS.iter().map(|(letter, name)| letter_table(*letter, name, figures)));
    text
}

fn device_line() -> Result<String, String> {
    let device = Device::open(None).map_err(|e| e.to_string())?;
    let environment = FloatEnvironment::of(&device).map_err(|e| e.to_string())?;
    let info = device.info();
    Ok(format!(
        "Device: {}, {}; float environment: `{environment}`.",
        info.name,
        info.driver.trim()
    ))
}

fn run() -> Result<(), String> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [figures, page_path, cases] = &arguments[..] else {
        return Err("usage: write_numerics FIGURES PAGE CASES".into());
    };
    let text = page(&read(figures)?, &device_line()?, cases);
    std::fs::write(page_path, text).map_err(|e| format!("{page_path}: {e}"))
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("write_numerics: {message}");
            ExitCode::FAILURE
        }
    }
}
