//! The line at the bottom: where the render stands, and what it runs on.

use super::app::App;
use super::wish::{Phase, Progress, Report};
use crate::cli::talk::{duration, with_prefix};
use egui::{Color32, RichText, Ui};

/// Draws it.
pub(super) fn show(ui: &mut Ui, app: &App, report: &Report) {
    ui.horizontal(|ui| {
        let (word, color) = match report.phase {
            Phase::Empty => ("no scene", Color32::from_gray(140)),
            Phase::Rendering => ("rendering", Color32::from_rgb(120, 170, 235)),
            Phase::Paused => ("paused", Color32::from_rgb(225, 180, 90)),
            Phase::Done => ("done", Color32::from_rgb(120, 200, 130)),
            Phase::Failed => ("stopped", ui.visuals().error_fg_color),
        };
        ui.colored_label(color, word);
        if app.scene.is_some() {
            ui.separator();
            ui.label(line(&report.progress));
        }
        if let Some(message) = app.fresh_message() {
            ui.separator();
            let color = match message.is_error {
                true => ui.visuals().error_fg_color,
                false => Color32::from_gray(200),
            };
            // Errors are long; all of it is a hover away.
            let label = egui::Label::new(RichText::new(&message.text).color(color)).truncate();
            ui.add(label).on_hover_text(&message.text);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.add(egui::Label::new(RichText::new(&report.device).weak()).truncate());
            if report.is_software {
                let hint = "This device is software on the processor: a graphics card would be \
                    many times faster.";
                let color = Color32::from_rgb(225, 180, 90);
                ui.colored_label(color, "software renderer").on_hover_text(hint);
            }
        });
    });
}

/// Samples, time, speed, and how good the picture is.
fn line(p: &Progress) -> String {
    let spp = match p.spp {
        (least, most) if least == most => format!("{most} spp"),
        (least, most) => format!("{least} to {most} spp"),
    };
    let rate = |count: u64| with_prefix(count as f64 / p.seconds.max(1e-6));
    let mut parts = vec![
        spp,
        duration(p.seconds),
        format!("{} samples/s", rate(p.samples)),
        format!("{} rays/s", rate(p.rays)),
    ];
    if let Some(share) = p.converged {
        parts.push(format!("{:.1} % converged", 100.0 * share));
    }
    if let Some(relmse) = p.relmse {
        parts.push(format!(
            "relMSE {relmse:.1e}, about {} % per pixel",
            with_prefix(100.0 * relmse.sqrt())
        ));
    }
    parts.join("   ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_says_what_is_known() {
        let mut p = Progress {
            spp: (4, 4),
            seconds: 2.0,
            samples: 8000,
            rays: 32_000,
            ..Default::default()
        };
        assert_eq!(line(&p), "4 spp   2.0 s   4.00 k samples/s   16.0 k rays/s");
        p.spp = (4, 8);
        p.converged = Some(0.25);
        p.relmse = Some(1e-4);
        assert!(line(&p).starts_with("4 to 8 spp"));
        assert!(line(&p).ends_with("25.0 % converged   relMSE 1.0e-4, about 1 % per pixel"));
    }
}
