//! The measured part of the page.

use crate::methods::{LEVEL, METHODS};
use crate::{Amount, LONG, REFERENCE_RUNS, Result, SIDE, Study};
use std::fmt::Write;
use std::path::Path;
use steradian::gpu::DeviceInfo;
use steradian::statistics::wilson_interval;

const BEGIN: &str = "<!-- measured: cargo run --release --example detection_power -->";
const END: &str = "<!-- end of what was measured -->";

/// Replaces what stands between the marks.
pub(crate) fn write(
    path: &Path,
    studies: &[Study],
    amount: &Amount,
    device: &DeviceInfo,
) -> Result<()> {
    let page = std::fs::read_to_string(path)?;
    let (Some(begin), Some(end)) = (page.find(BEGIN), page.find(END)) else {
        return Err(format!("{}: the marks are missing", path.display()).into());
    };
    let measured = text(studies, amount, device)?;
    let page = format!("{}{measured}{}", &page[..begin + BEGIN.len()], &page[end..]);
    Ok(std::fs::write(path, page)?)
}

fn text(studies: &[Study], amount: &Amount, device: &DeviceInfo) -> Result<String> {
    let mut text = String::new();
    writeln!(
        text,
        "\n\nDevice: {}, {}. {SIDE}x{SIDE} pixels, {} clean pictures and {} of each defect, with seeds of their \
         own; the reference has {REFERENCE_RUNS} runs of as many samples, the long render {LONG} times the \
         samples.",
        device.name, device.driver, amount.clean, amount.defective
    )?;
    writeln!(text, "\n### False alarms\n")?;
    writeln!(
        text,
        "Clean pictures of other seeds whose p-value is below a rate. In brackets the 95 % interval of \
         the true rate.\n"
    )?;
    writeln!(text, "| spp | verdict against | asked 5 % | asked 1 % | asked 0.1 % |")?;
    writeln!(text, "|---:|---|---|---|---|")?;
    for study in studies {
        for (k, against) in ["reference of runs", "one long render"].iter().enumerate() {
            write!(text, "| {} | {against} |", study.spp)?;
            for (_, alarms) in &study.levels {
                let n = study.clean.count;
                let (low, high) = wilson_interval(alarms[k], n, 0.95);
                let (low, high) = (100.0 * low.max(0.0), 100.0 * high);
                write!(text, " {} of {n} ({low:.1} to {high:.1} %) |", alarms[k])?;
            }
            writeln!(text)?;
        }
    }
    writeln!(text, "\n### Defects found\n")?;
    for study in studies {
        writeln!(
            text,
            "At {} samples per pixel, where a pixel's noise is {:.0} % of the mean. Calibrated limits: FLIP \
             {:.4}, SSIM {:.4}, RMS {:.4}; the verdict's rate of false alarms is {LEVEL}.\n",
            study.spp,
            100.0 * study.relative_noise,
            study.limits[0],
            1.0 - study.limits[1],
            study.limits[2],
        )?;
        writeln!(text, "| | mean | visibility | {} |", METHODS.join(" | "))?;
        writeln!(text, "|---|---:|---:|{}", "---:|".repeat(METHODS.len()))?;
        let percent = |rate: f64| match rate {
            0.0 => "–".to_owned(),
            rate => format!("{:.0} %", 100.0 * rate),
        };
        let cells = |rates: &[f64; 8]| rates.map(percent).join(" | ");
        writeln!(text, "| *clean* | | | {} |", cells(&study.clean.found))?;
        for row in &study.rows {
            writeln!(
                text,
                "| {} | {:+.2} % | {:.1} | {} |",
                row.defect.name(),
                100.0 * row.bias,
                row.visibility,
                cells(&row.rates.found)
            )?;
        }
        writeln!(text)?;
    }
    Ok(text)
}
