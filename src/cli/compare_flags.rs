//! Flags of `compare`.

use clap::Args;
use std::path::PathBuf;
use steradian::image::compare::Rule;

use super::values::{self, Parsed};

/// Flags of `compare`.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(super) struct CompareFlags {
    /// The picture in question, .png or .exr, or a folder of them
    pub(super) actual: PathBuf,

    /// The picture that it should be, or a folder of pictures with the same names
    pub(super) expected: PathBuf,

    /// What must hold: METRIC<LIMIT (flip.mean<0.01), verdict (no more than noise), exact. May be
    /// given several times, and begin with a layer (albedo:mse<1e-6). Without: verdict where both
    /// files tell of their noise, exact elsewhere
    #[arg(short, long = "tolerance", value_name = "RULE", value_parser = rule)]
    pub(super) tolerance: Vec<Rule>,

    /// Compare only this layer; `colour` is the picture itself. May be given several times
    #[arg(long = "layer", value_name = "NAME")]
    pub(super) layers: Vec<String>,

    /// Rate of false alarms of the verdict
    #[arg(long, value_name = "P", default_value_t = 1e-3, value_parser = level)]
    pub(super) false_alarms: f64,

    /// Pixels along the side of a tile of the verdict
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(super) tile: u32,

    /// All figures as JSON; - is standard output
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,

    /// One page with the pictures, that needs nothing else: a .html file, or a folder for report.html
    #[arg(long, value_name = "FILE.html|DIR")]
    pub(super) report: Option<PathBuf>,

    /// Most that the report may take, in MB; pictures are shown smaller beyond
    #[arg(long, value_name = "MB", default_value_t = 9.0, requires = "report", value_parser = values::positive)]
    pub(super) report_size: f32,

    /// Make the actual pictures that do not pass the expected ones; refused where device or driver
    /// are others
    #[arg(long)]
    pub(super) accept: bool,

    /// Say nothing but errors
    #[arg(short, long)]
    pub(super) quiet: bool,
}

const EXIT_CODES: &str = "\
Exit codes: 0 every rule holds, 1 one does not or a picture is missing, 2 bad command line, or files \
that cannot be read or compared.";

fn rule(text: &str) -> Parsed<Rule> {
    text.parse()
}

fn level(text: &str) -> Parsed<f64> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value <= 0.5 => Ok(value),
        _ => Err("expected a rate above 0 and up to 0.5, such as 0.001".into()),
    }
}
