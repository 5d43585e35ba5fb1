//! The line at the bottom: where the render stands, and what it runs on.

use super::app::App;
use super::wish::{Phase, Progress, Report};
use crate::cli::talk::{duration, with_prefix};
use egui::{Align, Color32, Layout, RichText, Ui};

/// Draws it: the device at the right, what is left for the rest.
pub(super) fn show(ui: &mut Ui, app: &App, report: &Report) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let device = RichText::new(&report.device).weak();
        ui.label(device).on_hover_text(format!("{}, {}", report.device, report.driver));
        if report.is_software {
            let hint = "This device is software on the processor: a graphics card would be many \
                        times faster.";
            ui.colored_label(ui.visuals().warn_fg_color, "software renderer").on_hover_text(hint);
        }
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| progress(ui, app, report));
    });
}

fn progress(ui: &mut Ui, app: &App, report: &Report) {
    let (word, color) = match report.phase {
        Phase::Empty => ("no scene", Color32::from_gray(140)),
        Phase::Rendering => ("rendering", Color32::from_rgb(120, 170, 235)),
        Phase::Paused => ("paused", ui.visuals().warn_fg_color),
        Phase::Done => ("done", Color32::from_rgb(120, 200, 130)),
        Phase::Failed => ("stopped", ui.visuals().error_fg_color),
    };
    ui.colored_label(color, word);
    ui.separator();
    // What does not fit is a hover away. A message is worth more than figures.
    let (text, color) = match app.fresh_message() {
        Some(message) if message.is_error => (message.text.clone(), ui.visuals().error_fg_color),
        Some(message) => (message.text.clone(), Color32::from_gray(225)),
        None if app.scene.is_some() => (line(&report.progress), ui.visuals().text_color()),
        None => return,
    };
    let label = egui::Label::new(RichText::new(&text).color(color)).truncate();
    ui.add(label).on_hover_text(text);
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
        let percent = with_prefix(100.0 * relmse.sqrt());
        parts.push(format!("relMSE {relmse:.1e} ({percent} %)"));
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
        assert!(line(&p).ends_with("25.0 % converged   relMSE 1.0e-4 (1 %)"));
    }
}
