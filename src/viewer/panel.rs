//! The panel at the side: everything that decides the picture, and how it is shown.

use super::app::App;
use super::keys::Action;
use super::navigate::Axis;
use super::wish::{Report, Wish};
use crate::cli::job::default_block_size;
use crate::cli::values::{SAMPLERS, STRATEGIES, TONE_CURVES, VIEWS, word_for};
use egui::{CollapsingHeader, ComboBox, DragValue, Grid, Id, ScrollArea, Slider, Ui};
use steradian::RenderSettings;
use steradian::scene::{Camera, Projection};
use steradian::stopping::{CalibratedRule, Preset, StoppingRule};
use steradian::view::View;

/// Scenes without a lens begin with one this share of their size.
const FIRST_LENS: f32 = 1e-3;

/// Draws the panel.
pub(super) fn show(ui: &mut Ui, app: &mut App, report: &Report) {
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.add_space(4.0);
        files(ui, app);
        let Some(mut wish) = app.wish.clone() else { return };
        section(ui, "Picture", |ui| picture(ui, app, &mut wish));
        section(ui, "Sampling", |ui| sampling(ui, &mut wish.settings));
        section(ui, "Stopping", |ui| stopping(ui, &mut wish.settings));
        section(ui, "Camera", |ui| camera(ui, app, &mut wish));
        section(ui, "Environment", |ui| environment(ui, app, &mut wish));
        section(ui, "Scene", |ui| scene(ui, app, report));
        app.wish = Some(wish);
    });
}

fn section(ui: &mut Ui, title: &str, content: impl FnOnce(&mut Ui)) {
    CollapsingHeader::new(title).default_open(true).show(ui, |ui| {
        content(ui);
        ui.add_space(4.0);
    });
}

fn button(ui: &mut Ui, app: &mut App, text: &str, hint: &str, action: Action) {
    if ui.button(text).on_hover_text(hint).clicked() {
        app.asked.push(action);
    }
}

fn files(ui: &mut Ui, app: &mut App) {
    ui.horizontal_wrapped(|ui| {
        button(ui, app, "Open", "a scene or an environment (Ctrl O)", Action::Open);
        button(ui, app, "Save PNG", "what the display shows (S)", Action::SavePng);
        button(ui, app, "Save EXR", "linear radiance (Shift S)", Action::SaveExr);
        button(ui, app, "Copy command", "that renders this picture (Ctrl C)", Action::CopyCommand);
    });
}

fn picture(ui: &mut Ui, app: &mut App, wish: &mut Wish) {
    rows(ui, "picture", |ui| {
        let name = ui.label("View").id;
        let text = |view: Option<View>| view.map_or("light", |view| word_for(VIEWS, &view));
        let list = ComboBox::from_id_salt(name).width(140.0).selected_text(text(wish.view));
        let list = list.show_ui(ui, |ui| {
            ui.selectable_value(&mut wish.view, None, text(None));
            for (word, view, help) in VIEWS {
                ui.selectable_value(&mut wish.view, Some(*view), *word).on_hover_text(*help);
            }
        });
        list.response.labelled_by(name);
        ui.end_row();
        let name = ui.label("Exposure").id;
        ui.horizontal(|ui| {
            let ev = &mut wish.display.exposure_ev;
            let slider = Slider::new(ev, -8.0..=8.0).clamping(egui::SliderClamping::Never);
            ui.add(slider.suffix(" EV")).labelled_by(name);
        });
        ui.end_row();
        let name = ui.label("Tone curve").id;
        let before = wish.display.tone_curve;
        words(ui, name, TONE_CURVES, &mut wish.display.tone_curve);
        if wish.display.tone_curve != before {
            app.preferences.set_tone_curve(wish.display.tone_curve);
        }
        ui.end_row();
        ui.label("Size");
        let (width, height) = wish.settings.resolution;
        ui.label(format!("{width} × {height}"));
        ui.end_row();
        if app.scene.as_ref().is_some_and(|s| !s.has_fixed_size) {
            let name = ui.label("Pixel size").id;
            let text = |size: u32| format!("{size} × {size}");
            let list = ComboBox::from_id_salt("pixel size").selected_text(text(app.pixel_size));
            let list = list.show_ui(ui, |ui| {
                for size in [1, 2, 3, 4, 8] {
                    ui.selectable_value(&mut app.pixel_size, size, text(size));
                }
            });
            list.response.labelled_by(name);
            ui.end_row();
        }
    });
    ui.horizontal(|ui| {
        let label = if wish.is_paused { "Go on" } else { "Pause" };
        button(ui, app, label, "(P)", Action::Pause);
        button(ui, app, "Step", "one piece of work (N)", Action::Step);
        button(ui, app, "Restart", "all samples again (R)", Action::Restart);
        let part = if wish.settings.crop.is_some() { "Whole" } else { "Part" };
        let action = if wish.settings.crop.is_some() { Action::Escape } else { Action::Crop };
        button(ui, app, part, "drag a rectangle to render only that (C, Esc)", action);
    });
}

fn sampling(ui: &mut Ui, settings: &mut RenderSettings) {
    rows(ui, "sampling", |ui| {
        let name = ui.label("Strategy").id;
        words(ui, name, STRATEGIES, &mut settings.strategy);
        ui.end_row();
        let name = ui.label("Sampler").id;
        words(ui, name, SAMPLERS, &mut settings.sampler);
        ui.end_row();
        let name = ui.label("Light samples").id;
        let value = DragValue::new(&mut settings.light_samples).range(1..=1024);
        ui.add(value.speed(0.1)).labelled_by(name);
        ui.end_row();
        let name = ui.label("Bounces").id;
        optional(ui, name, "limit", &mut settings.max_bounces, 5);
        ui.end_row();
        let name = ui.label("Only bounce").id;
        optional(ui, name, "one", &mut settings.only_bounce, 1);
        ui.end_row();
        let name = ui.label("Roulette").id;
        ui.checkbox(&mut settings.roulette, "").labelled_by(name);
        ui.end_row();
        let name = ui.label("Seed").id;
        ui.add(DragValue::new(&mut settings.seed)).labelled_by(name);
        ui.end_row();
    });
    if let (Some(only), Some(most)) = (settings.only_bounce, settings.max_bounces) {
        settings.max_bounces = Some(most.max(only));
    }
}

fn stopping(ui: &mut Ui, settings: &mut RenderSettings) {
    rows(ui, "stopping", |ui| {
        let name = ui.label("Samples").id;
        let mut spp = settings.spp;
        let value = DragValue::new(&mut spp).range(1..=1_u32 << 30).speed(1.0);
        ui.add(value).labelled_by(name).on_hover_text("[ ]");
        if spp != settings.spp {
            set_spp(settings, spp);
        }
        ui.end_row();
        let name = ui.label("Noise").id;
        ui.horizontal(|ui| {
            let mut has_rule = settings.stopping.is_some();
            let hint = "pixels stop one by one, at this half-width of their mean's interval";
            if ui.checkbox(&mut has_rule, "").labelled_by(name).on_hover_text(hint).changed() {
                settings.stopping = has_rule.then(first_rule);
                set_spp(settings, settings.spp);
            }
            if let Some(StoppingRule::Calibrated(rule)) = &mut settings.stopping {
                let mut percent = rule.tolerance * 100.0;
                let value =
                    DragValue::new(&mut percent).range(0.05..=50.0).speed(0.05).suffix(" %");
                if ui.add(value).labelled_by(name).changed() {
                    rule.tolerance = percent / 100.0;
                }
            }
        });
        ui.end_row();
        if let Some(StoppingRule::Calibrated(rule)) = &mut settings.stopping {
            let name = ui.label("Preset").id;
            words(ui, name, crate::cli::stopping::PRESETS, &mut rule.preset);
            ui.end_row();
        }
    });
}

fn first_rule() -> StoppingRule {
    StoppingRule::Calibrated(CalibratedRule {
        tolerance: super::NOISE,
        confidence: 0.95,
        preset: Preset::Default,
    })
}

fn camera(ui: &mut Ui, app: &mut App, wish: &mut Wish) {
    let Some(info) = app.scene.clone() else { return };
    rows(ui, "camera", |ui| {
        let name = ui.label("From").id;
        let text = |i: usize| format!("{i} {}", info.cameras[i].name);
        let before = wish.base;
        let list = ComboBox::from_id_salt("cameras").width(140.0).selected_text(text(wish.base));
        let list = list.show_ui(ui, |ui| {
            for i in 0..info.cameras.len() {
                ui.selectable_value(&mut wish.base, i, text(i));
            }
        });
        list.response.labelled_by(name);
        if wish.base != before {
            wish.camera = info.cameras[wish.base].clone();
            app.canvas.begin(&wish.camera);
        }
        ui.end_row();
        let camera = &mut wish.camera;
        match &mut camera.projection {
            Projection::Perspective { yfov } => {
                let name = ui.label("Field of view").id;
                let mut degrees = yfov.to_degrees();
                let value = DragValue::new(&mut degrees).range(1.0..=170.0).speed(0.2).suffix("°");
                if ui.add(value).labelled_by(name).changed() {
                    *yfov = degrees.to_radians();
                }
            }
            Projection::Orthographic { ymag } => {
                let name = ui.label("Half height").id;
                let speed = *ymag * 0.01;
                let value = DragValue::new(ymag).range(1e-6..=1e9).speed(speed).suffix(" m");
                ui.add(value).labelled_by(name);
            }
        }
        ui.end_row();
        let name = ui.label("Lens radius").id;
        let speed = camera.aperture_radius.max(1e-4) * 0.02;
        let lens = DragValue::new(&mut camera.aperture_radius).range(0.0..=1e6).speed(speed);
        ui.add(lens.max_decimals(5).suffix(" m"))
            .labelled_by(name)
            .on_hover_text("0 is a pinhole (K L)");
        ui.end_row();
        let name = ui.label("Focus").id;
        let speed = camera.focus_distance * 0.005;
        let focus = DragValue::new(&mut camera.focus_distance).range(1e-6..=1e9).speed(speed);
        ui.add(focus.max_decimals(4).suffix(" m"))
            .labelled_by(name)
            .on_hover_text("double click picks it (; ')");
        ui.end_row();
    });
    ui.horizontal_wrapped(|ui| {
        button(ui, app, "File's", "back to the file's camera (Space)", Action::ResetCamera);
        button(ui, app, "Frame all", "(F)", Action::FrameAll);
        button(ui, app, "Copy", "as JSON that --camera takes (D)", Action::DumpCamera);
    });
    ui.horizontal_wrapped(|ui| {
        for (axis, name) in Axis::ALL {
            if ui.small_button(name).clicked() {
                app.asked.push(Action::Look(axis));
            }
        }
    });
}

fn environment(ui: &mut Ui, app: &App, wish: &mut Wish) {
    if !app.has_environment() {
        ui.weak("None. Drop an .hdr or .exr file.");
        return;
    }
    let e = &mut wish.environment;
    rows(ui, "environment", |ui| {
        let name = ui.label("Turn").id;
        let mut degrees = e.environment_rotation.unwrap_or(0.0);
        let slider = Slider::new(&mut degrees, -180.0..=180.0).suffix("°");
        if ui.add(slider).labelled_by(name).changed() {
            e.environment_rotation = Some(degrees);
        }
        ui.end_row();
        let name = ui.label("Intensity").id;
        let mut intensity = e.environment_intensity.unwrap_or(1.0);
        let slider = Slider::new(&mut intensity, 0.0..=16.0).logarithmic(true);
        let slider = slider.clamping(egui::SliderClamping::Never);
        if ui.add(slider).labelled_by(name).changed() {
            e.environment_intensity = Some(intensity.max(0.0));
        }
        ui.end_row();
    });
}

fn scene(ui: &mut Ui, app: &App, report: &Report) {
    let Some(info) = &app.scene else { return };
    let path = info.path.display().to_string();
    ui.label(&info.name).on_hover_text(path);
    let count = crate::cli::talk::with_prefix(info.primitive_count as f64);
    let (read, build) = info.seconds;
    let [read, build] = [read, build].map(crate::cli::talk::duration);
    ui.weak(format!("{count} primitives, read in {read}, trees in {build}"));
    for notice in &info.notices {
        ui.weak(notice);
    }
    if report.progress.faults > 0 {
        let text = format!("{} faulty samples", report.progress.faults);
        ui.colored_label(ui.visuals().error_fg_color, text);
    }
}

fn rows(ui: &mut Ui, name: &str, content: impl FnOnce(&mut Ui)) {
    Grid::new(name).num_columns(2).spacing([8.0, 5.0]).min_col_width(78.0).show(ui, content);
}

/// One of a list of words, with its explanation.
fn words<T: PartialEq + Copy>(
    ui: &mut Ui,
    name: Id,
    words: &[(&'static str, T, &'static str)],
    value: &mut T,
) {
    let word = words.iter().find(|(_, v, _)| v == value).map_or("", |(word, _, _)| word);
    let list = ComboBox::from_id_salt(name).width(140.0).selected_text(word);
    let list = list.show_ui(ui, |ui| {
        for (word, v, help) in words {
            ui.selectable_value(value, *v, *word).on_hover_text(*help);
        }
    });
    list.response.labelled_by(name);
}

/// A number of bounces or none; `name`: of the label before it.
fn optional(ui: &mut Ui, name: Id, label: &str, value: &mut Option<u32>, first: u32) {
    ui.horizontal(|ui| {
        let mut is_set = value.is_some();
        if ui.checkbox(&mut is_set, label).changed() {
            *value = is_set.then_some(first);
        }
        if let Some(number) = value {
            ui.add(DragValue::new(number).range(0..=1000).speed(0.05)).labelled_by(name);
        }
    });
}

/// Sets the samples, and the blocks that `steradian render` would take for so many.
pub(super) fn set_spp(settings: &mut RenderSettings, spp: u32) {
    settings.spp = spp;
    settings.block_size = default_block_size(Some(spp));
}

/// One bounce more or less; below 0 there is nothing, and less than no limit is 16.
pub(super) fn set_bounces(settings: &mut RenderSettings, step: i64) {
    let bounces = match settings.max_bounces {
        Some(n) => (i64::from(n) + step).clamp(0, 1000) as u32,
        None if step < 0 => 16,
        None => return,
    };
    settings.max_bounces = Some(bounces);
    settings.only_bounce = settings.only_bounce.map(|_| bounces);
}

/// A lens half as wide again, or smaller by as much.
pub(super) fn scale_lens(camera: &mut Camera, bounds: (glam::Vec3, glam::Vec3), larger: bool) {
    let least = (bounds.1 - bounds.0).length() * FIRST_LENS;
    let radius = camera.aperture_radius;
    camera.aperture_radius = if larger {
        least.max(radius * 1.5)
    } else if radius <= least {
        0.0
    } else {
        radius / 1.5
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounces_end_at_none() {
        let mut settings = RenderSettings { max_bounces: Some(1), ..Default::default() };
        set_bounces(&mut settings, -1);
        set_bounces(&mut settings, -1);
        assert_eq!(settings.max_bounces, Some(0));
        settings.only_bounce = Some(0);
        set_bounces(&mut settings, 1);
        assert_eq!((settings.max_bounces, settings.only_bounce), (Some(1), Some(1)));
        settings.max_bounces = None;
        set_bounces(&mut settings, 1);
        assert_eq!(settings.max_bounces, None);
    }

    #[test]
    fn a_lens_grows_from_a_pinhole_and_shrinks_to_one() {
        let bounds = (glam::Vec3::ZERO, glam::Vec3::ONE);
        let mut camera = Camera::framing(bounds);
        scale_lens(&mut camera, bounds, true);
        let first = camera.aperture_radius;
        assert!(first > 0.0);
        scale_lens(&mut camera, bounds, true);
        assert!(camera.aperture_radius > first);
        for _ in 0..2 {
            scale_lens(&mut camera, bounds, false);
        }
        assert_eq!(camera.aperture_radius, 0.0);
    }
}
