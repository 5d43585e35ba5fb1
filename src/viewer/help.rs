//! The cheat sheet.

use super::keys::CHEAT_SHEET;
use egui::{Grid, RichText, Ui};

/// Draws it in the middle of the window.
pub(super) fn show(ui: &Ui, is_open: &mut bool) {
    egui::Window::new("Keys and mouse")
        .open(is_open)
        .collapsible(false)
        .resizable(false)
        .anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0])
        .show(ui.ctx(), |ui| {
            ui.columns(2, |columns| {
                for (i, (heading, lines)) in CHEAT_SHEET.iter().enumerate() {
                    let ui = &mut columns[i % 2];
                    ui.label(RichText::new(*heading).strong());
                    Grid::new(*heading).num_columns(2).spacing([12.0, 3.0]).show(ui, |ui| {
                        for (keys, what) in *lines {
                            ui.label(RichText::new(*keys).monospace());
                            ui.label(*what);
                            ui.end_row();
                        }
                    });
                    ui.add_space(10.0);
                }
            });
        });
}
