//! The picture in the window, and what the mouse does on it.

use super::app::App;
use super::navigate;
use super::wish::{Frame, Phase, Report, Wish};
use egui::{Color32, Pos2, Rect, Sense, TextureHandle, TextureOptions, Ui, Vec2};
use glam::Vec3;
use std::time::Duration;
use steradian::scene::Camera;
use steradian::settings::Crop;

/// Around the picture: grey that says nothing about it.
const SURROUND: Color32 = Color32::from_gray(24);
/// Time after which a person wants to know what takes so long.
const PATIENCE: Duration = Duration::from_millis(300);

/// What of the picture's place the window remembers.
#[derive(Default)]
pub(super) struct Canvas {
    /// What the camera turns about.
    pub(super) pivot: Vec3,
    /// The mouse draws a rectangle.
    pub(super) is_cropping: bool,
    /// The right button is held: keys move the camera.
    pub(super) is_flying: bool,
    /// The right button turns the environment.
    pub(super) is_turning_light: bool,
    pub(super) crop_from: Option<Pos2>,
    texture: Option<TextureHandle>,
    /// The frame in the texture.
    pub(super) shown: Option<Frame>,
    /// Where the whole picture is in the window, points.
    pub(super) rect: Option<Rect>,
    /// The same in pixels of the display: left, top, right, bottom.
    pub(super) pixels: Option<[f32; 4]>,
}

impl Canvas {
    /// Columns and rows of what is on the display.
    #[cfg(test)]
    pub(super) fn texture_size(&self) -> Option<[usize; 2]> {
        self.texture.as_ref().map(TextureHandle::size)
    }

    /// A camera that was not moved from another: the pivot is where it is in focus.
    pub(super) fn begin(&mut self, camera: &Camera) {
        let distance = camera.focus_distance;
        self.pivot = navigate::eye(camera) + navigate::forward(camera) * distance;
    }
}

/// Draws the picture and follows the mouse.
pub(super) fn show(ui: &mut Ui, app: &mut App, report: &Report) {
    let area = ui.available_rect_before_wrap();
    ui.painter().rect_filled(area, 0.0, SURROUND);
    fit_resolution(app, area, ui.ctx().pixels_per_point());
    upload(ui, app, report);
    let response = ui.allocate_rect(area, Sense::click_and_drag());
    let Some(wish) = &app.wish else {
        return empty(ui, area, report);
    };
    let scale = ui.ctx().pixels_per_point();
    let rect = place(wish, area, scale);
    app.canvas.rect = Some(rect);
    let edges = [rect.min.x, rect.min.y, rect.max.x, rect.max.y];
    app.canvas.pixels = Some(edges.map(|v| (v * scale).round()));
    draw(ui, app, rect);
    super::tree::draw(ui, app, rect, report);
    legend(ui, rect, report);
    super::mouse::follow(ui, app, &response, rect);
    busy(ui, area, report);
}

/// The picture has the window's size, unless the command line says otherwise.
fn fit_resolution(app: &mut App, area: Rect, pixels_per_point: f32) {
    let (Some(wish), Some(info)) = (&mut app.wish, &app.scene) else { return };
    if info.has_fixed_size {
        return;
    }
    let size = area.size() * pixels_per_point / app.pixel_size.max(1) as f32;
    let side = |s: f32| (s.floor() as u32).clamp(16, 16_384);
    let resolution = (side(size.x), side(size.y));
    if wish.settings.resolution != resolution {
        wish.settings.resolution = resolution;
        wish.settings.crop = None;
    }
}

/// The largest rectangle of the picture's shape in the middle of `area`. Its pixels are whole
/// multiples of the display's, unless the picture is larger than its place.
fn place(wish: &Wish, area: Rect, pixels_per_point: f32) -> Rect {
    let (width, height) = wish.settings.resolution;
    let size = Vec2::new(width as f32, height as f32);
    let room = area.size() * pixels_per_point;
    let fit = (room.x / size.x).min(room.y / size.y);
    let scale = if fit >= 1.0 { fit.floor() } else { fit };
    let size = size * scale;
    let corner = (area.min.to_vec2() * pixels_per_point + (room - size) * 0.5).round();
    Rect::from_min_size((corner / pixels_per_point).to_pos2(), size / pixels_per_point)
}

fn upload(ui: &Ui, app: &mut App, report: &Report) {
    let Some(frame) = &report.frame else { return };
    if app.canvas.shown.as_ref().is_some_and(|f| f.serial == frame.serial) {
        return;
    }
    let image = egui::ColorImage::from_rgba_unmultiplied(frame.size, frame.rgba.as_flattened());
    // Coarse pictures are smooth; of fine ones every pixel can be seen.
    let options = match frame.scale {
        1 => TextureOptions {
            magnification: egui::TextureFilter::Nearest,
            minification: egui::TextureFilter::Linear,
            ..TextureOptions::LINEAR
        },
        _ => TextureOptions::LINEAR,
    };
    match &mut app.canvas.texture {
        Some(texture) => texture.set(image, options),
        None => app.canvas.texture = Some(ui.ctx().load_texture("picture", image, options)),
    }
    app.canvas.shown = Some(frame.clone());
}

fn draw(ui: &Ui, app: &App, rect: Rect) {
    let (Some(texture), Some(frame)) = (&app.canvas.texture, &app.canvas.shown) else { return };
    let part = part(rect, frame.resolution, frame.window);
    let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    ui.painter().image(texture.id(), part, all, Color32::WHITE);
    if let Some(from) = app.canvas.crop_from
        && let Some(to) = ui.ctx().pointer_latest_pos()
    {
        let chosen = Rect::from_two_pos(from, to).intersect(rect);
        let stroke = egui::Stroke::new(1.0, Color32::WHITE);
        ui.painter().rect_stroke(chosen, 0.0, stroke, egui::StrokeKind::Inside);
    }
}

/// Where some pixels of a picture are, if the whole of it is in `rect`.
pub(super) fn part(rect: Rect, (width, height): (u32, u32), window: Crop) -> Rect {
    let pixel = Vec2::new(rect.width() / width as f32, rect.height() / height as f32);
    let min = rect.min + Vec2::new(window.x as f32, window.y as f32) * pixel;
    Rect::from_min_size(min, Vec2::new(window.width as f32, window.height as f32) * pixel)
}

/// Before there is a scene.
fn empty(ui: &mut Ui, area: Rect, report: &Report) {
    let (title, line) = match (report.busy, &report.phase) {
        (Some((busy, _)), _) => (busy, ""),
        (None, Phase::Failed) => ("No device", "see the message below; R tries again"),
        _ => ("Drop a glTF scene here", "or press Ctrl O"),
    };
    let at = |dy: f32| area.center() + Vec2::new(0.0, dy);
    let center = egui::Align2::CENTER_CENTER;
    let painter = ui.painter();
    painter.text(
        at(-12.0),
        center,
        title,
        egui::FontId::proportional(22.0),
        Color32::from_gray(200),
    );
    painter.text(at(16.0), center, line, egui::FontId::proportional(14.0), Color32::from_gray(130));
    if report.busy.is_some() {
        spinner(ui, at(36.0));
    }
}

/// Something is under way while the picture before stays.
fn busy(ui: &mut Ui, area: Rect, report: &Report) {
    let Some((text, since)) = report.busy else { return };
    // What is over at once needs no word.
    let left = PATIENCE.saturating_sub(since.elapsed());
    if !left.is_zero() {
        return ui.ctx().request_repaint_after(left);
    }
    let font = egui::FontId::proportional(14.0);
    let galley = ui.painter().layout_no_wrap(format!("{text} …"), font, Color32::from_gray(230));
    let size = galley.size() + Vec2::new(44.0, 14.0);
    let rect = Rect::from_min_size(area.min + Vec2::splat(12.0), size);
    ui.painter().rect_filled(rect, 6.0, Color32::from_black_alpha(190));
    spinner(ui, rect.left_center() + Vec2::new(17.0, 0.0));
    let text_at = rect.left_center() + Vec2::new(34.0, -0.5 * galley.size().y);
    ui.painter().galley(text_at, galley, Color32::WHITE);
}

/// What the colours mean.
fn legend(ui: &Ui, rect: Rect, report: &Report) {
    if let Some(text) = &report.legend {
        note(ui, rect.left_bottom() + Vec2::new(12.0, -12.0), text, rect.width() - 40.0);
    }
}

/// Text on a dark ground, up and to the right of `corner`, as wide as `width` at most.
pub(super) fn note(ui: &Ui, corner: Pos2, text: &str, width: f32) {
    let font = egui::FontId::proportional(13.0);
    let grey = Color32::from_gray(235);
    let galley = ui.painter().layout(text.to_owned(), font, grey, width.max(80.0));
    let at = corner + Vec2::new(8.0, -galley.size().y - 5.0);
    let back = Rect::from_min_size(at, galley.size()).expand2(Vec2::new(8.0, 5.0));
    ui.painter().rect_filled(back, 6.0, Color32::from_black_alpha(190));
    ui.painter().galley(at, galley, Color32::WHITE);
}

fn spinner(ui: &mut Ui, center: Pos2) {
    let rect = Rect::from_center_size(center, Vec2::splat(16.0));
    egui::Spinner::new().size(16.0).paint_at(ui, rect);
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian::RenderSettings;

    #[test]
    fn pixels_are_whole_multiples_where_there_is_room() {
        let area = Rect::from_min_size(Pos2::new(3.0, 5.0), Vec2::new(400.0, 300.0));
        let camera = Camera::framing((Vec3::ZERO, Vec3::ONE));
        let settings = |resolution| RenderSettings { resolution, ..Default::default() };
        let wish = |resolution| Wish {
            generation: 1,
            base: 0,
            camera: camera.clone(),
            settings: settings(resolution),
            environment: Default::default(),
            display: Default::default(),
            view: None,
            is_paused: false,
        };
        for pixels_per_point in [1.0, 1.5, 2.0] {
            let rect = place(&wish((90, 50)), area, pixels_per_point);
            let scale = rect.width() * pixels_per_point / 90.0;
            assert!((scale - scale.round()).abs() < 1e-4 && area.contains_rect(rect), "{scale}");
            let corner = rect.min * pixels_per_point;
            assert!((corner - corner.round()).length() < 1e-3);
            let large = place(&wish((4000, 2000)), area, pixels_per_point);
            assert!((large.width() - 400.0).abs() < 1e-3 && (large.height() - 200.0).abs() < 1e-3);
        }
    }
}
