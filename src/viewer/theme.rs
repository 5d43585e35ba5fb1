//! How the window looks: dark and without colour, so that the picture is judged by itself.

use egui::{Color32, Context, CornerRadius, FontFamily, FontId, Stroke, TextStyle, Theme, Visuals};

/// Sets fonts, spacing and colours.
pub(super) fn apply(ctx: &Context) {
    ctx.set_theme(Theme::Dark);
    ctx.set_visuals(visuals());
    ctx.all_styles_mut(|style| {
        style.spacing.item_spacing = egui::vec2(6.0, 5.0);
        style.spacing.slider_width = 108.0;
        style.text_styles = [
            (TextStyle::Small, FontId::new(11.0, FontFamily::Proportional)),
            (TextStyle::Body, FontId::new(13.0, FontFamily::Proportional)),
            (TextStyle::Button, FontId::new(13.0, FontFamily::Proportional)),
            (TextStyle::Heading, FontId::new(16.0, FontFamily::Proportional)),
            (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
        ]
        .into();
    });
    ctx.options_mut(|options| {
        // Ctrl and + or - belong to the picture.
        options.zoom_with_keyboard = false;
    });
}

fn visuals() -> Visuals {
    let grey = Color32::from_gray;
    let mut v = Visuals::dark();
    v.panel_fill = grey(34);
    v.window_fill = grey(40);
    v.extreme_bg_color = grey(22);
    v.faint_bg_color = grey(38);
    v.window_stroke = Stroke::new(1.0, grey(60));
    v.selection.bg_fill = grey(86);
    v.selection.stroke = Stroke::new(1.0, grey(240));
    v.error_fg_color = Color32::from_rgb(240, 120, 110);
    v.warn_fg_color = Color32::from_rgb(225, 180, 90);
    for widget in [
        &mut v.widgets.noninteractive,
        &mut v.widgets.inactive,
        &mut v.widgets.hovered,
        &mut v.widgets.active,
        &mut v.widgets.open,
    ] {
        widget.corner_radius = CornerRadius::same(4);
    }
    v.widgets.noninteractive.fg_stroke = Stroke::new(1.0, grey(190));
    v.widgets.noninteractive.bg_stroke = Stroke::new(1.0, grey(52));
    v.widgets.inactive.weak_bg_fill = grey(54);
    v.widgets.inactive.bg_fill = grey(54);
    v.widgets.inactive.fg_stroke = Stroke::new(1.0, grey(215));
    v
}
