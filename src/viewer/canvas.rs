//! The picture in the window, and what the mouse does on it.

use super::app::App;
use super::navigate;
use super::wish::{Frame, Phase, Report, Request, Wish};
use egui::{
    Color32, PointerButton, Pos2, Rect, Response, Sense, TextureHandle, TextureOptions, Ui, Vec2,
};
use glam::Vec3;
use std::time::Duration;
use steradian::scene::Camera;
use steradian::settings::Crop;

/// Around the picture: grey that says nothing about it.
const SURROUND: Color32 = Color32::from_gray(24);
/// Radians of a drag across the whole height.
const TURN: f32 = std::f32::consts::PI;
/// Metres a second of flying, as a share of the scene's size.
const SPEED: f32 = 0.25;
/// Pixels in the longest line of a rectangle that is a click, not a drag.
const LEAST_CROP: f32 = 4.0;

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
    is_turning_light: bool,
    crop_from: Option<Pos2>,
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
    interact(ui, app, &response, rect);
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
fn part(rect: Rect, (width, height): (u32, u32), window: Crop) -> Rect {
    let pixel = Vec2::new(rect.width() / width as f32, rect.height() / height as f32);
    let min = rect.min + Vec2::new(window.x as f32, window.y as f32) * pixel;
    Rect::from_min_size(min, Vec2::new(window.width as f32, window.height as f32) * pixel)
}

/// Coordinates from -1 to 1, up and to the right, of a point of the window.
fn picture_point(rect: Rect, at: Pos2) -> (f32, f32) {
    let center = rect.center();
    (2.0 * (at.x - center.x) / rect.width(), 2.0 * (center.y - at.y) / rect.height())
}

fn interact(ui: &Ui, app: &mut App, response: &Response, rect: Rect) {
    let aspect_ratio = rect.width() / rect.height();
    let modifiers = ui.input(|i| i.modifiers);
    if app.canvas.is_cropping {
        return choose_crop(ui, app, response, rect);
    }
    let Some(wish) = &mut app.wish else { return };
    let canvas = &mut app.canvas;
    let camera = &mut wish.camera;
    let drag = response.drag_delta() / rect.height();
    let distance = navigate::eye(camera).distance(canvas.pivot);
    let is_pan = response.dragged_by(PointerButton::Middle)
        || response.dragged_by(PointerButton::Primary) && modifiers.shift;
    if is_pan && drag != Vec2::ZERO {
        let (_, height) = navigate::extent(camera, distance, aspect_ratio);
        let before = navigate::eye(camera);
        navigate::pan(camera, -drag.x * height, drag.y * height);
        canvas.pivot += navigate::eye(camera) - before;
    } else if response.dragged_by(PointerButton::Primary) && drag != Vec2::ZERO {
        navigate::orbit(camera, canvas.pivot, drag.x * TURN, drag.y * TURN);
    }
    fly(ui, app, response, drag);
    let Some(wish) = &mut app.wish else { return };
    let pointer = response.hover_pos().filter(|at| rect.contains(*at));
    let scroll = ui.input(|i| i.smooth_scroll_delta().y);
    if let Some(at) = pointer
        && scroll != 0.0
    {
        let camera = &mut wish.camera;
        let distance = navigate::eye(camera).distance(app.canvas.pivot);
        let (origin, direction) = navigate::ray(camera, picture_point(rect, at), aspect_ratio);
        navigate::dolly(camera, origin + direction * distance, (-scroll * 0.003).exp());
    }
    if response.double_clicked()
        && let Some(at) = pointer
    {
        let (width, height) = wish.settings.resolution;
        let at = (at - rect.min) / rect.size();
        let pixel = |share: f32, side: u32| ((share * side as f32) as u32).min(side - 1);
        app.ask(Request::Pick((pixel(at.x, width), pixel(at.y, height))));
    }
}

/// The right button: look, and with keys fly; with Shift it turns the environment.
fn fly(ui: &Ui, app: &mut App, response: &Response, drag: Vec2) {
    let is_down = response.dragged_by(PointerButton::Secondary);
    let modifiers = ui.input(|i| i.modifiers);
    let canvas = &mut app.canvas;
    if !is_down {
        (canvas.is_flying, canvas.is_turning_light) = (false, false);
        return;
    }
    if response.drag_started_by(PointerButton::Secondary) {
        canvas.is_turning_light = modifiers.shift;
    }
    let is_turning_light = canvas.is_turning_light;
    canvas.is_flying = !is_turning_light;
    let has_environment = app.has_environment();
    let (Some(wish), Some(info)) = (&mut app.wish, &app.scene) else { return };
    if is_turning_light {
        if has_environment && drag.x != 0.0 {
            let turn = wish.environment.environment_rotation.unwrap_or(0.0);
            let turned = (turn + drag.x * 180.0 + 540.0).rem_euclid(360.0) - 180.0;
            wish.environment.environment_rotation = Some(turned);
        }
        return;
    }
    if drag != Vec2::ZERO {
        navigate::look(&mut wish.camera, -drag.x, -drag.y);
    }
    let axis =
        |plus, minus| ui.input(|i| f32::from(i.key_down(plus)) - f32::from(i.key_down(minus)));
    use egui::Key;
    let way = Vec3::new(axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S));
    if way != Vec3::ZERO {
        let size = (info.bounds.1 - info.bounds.0).length().max(f32::MIN_POSITIVE);
        let fast = if modifiers.shift { 4.0 } else { 1.0 };
        let seconds = ui.input(|i| i.stable_dt).min(0.1);
        let motion = way.normalize() * (SPEED * size * fast * seconds);
        navigate::fly(&mut wish.camera, motion);
        ui.ctx().request_repaint();
    }
    // What it turns about later is ahead.
    let distance = wish.camera.focus_distance;
    app.canvas.pivot = navigate::eye(&wish.camera) + navigate::forward(&wish.camera) * distance;
}

fn choose_crop(ui: &Ui, app: &mut App, response: &Response, rect: Rect) {
    ui.ctx().set_cursor_icon(egui::CursorIcon::Crosshair);
    if response.drag_started_by(PointerButton::Primary) {
        app.canvas.crop_from = ui.input(|i| i.pointer.press_origin());
    }
    if !response.drag_stopped() {
        return;
    }
    let (Some(from), Some(to)) = (app.canvas.crop_from.take(), ui.ctx().pointer_latest_pos())
    else {
        return;
    };
    app.canvas.is_cropping = false;
    let Some(wish) = &mut app.wish else { return };
    let chosen = Rect::from_two_pos(from, to).intersect(rect);
    if chosen.width().max(chosen.height()) >= LEAST_CROP && chosen.is_positive() {
        wish.settings.crop = Some(crop(rect, wish.settings.resolution, chosen));
    }
}

/// The pixels that a part of the window touches.
fn crop(rect: Rect, (width, height): (u32, u32), chosen: Rect) -> Crop {
    let low = |share: f32, side: u32| ((share * side as f32).floor() as u32).min(side - 1);
    let high = |share: f32, side: u32| ((share * side as f32).ceil() as u32).min(side);
    let (min, max) = ((chosen.min - rect.min) / rect.size(), (chosen.max - rect.min) / rect.size());
    let (x, y) = (low(min.x, width), low(min.y, height));
    let (right, bottom) = (high(max.x, width), high(max.y, height));
    Crop { x, y, width: (right - x).max(1), height: (bottom - y).max(1) }
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

fn spinner(ui: &mut Ui, center: Pos2) {
    let rect = Rect::from_center_size(center, Vec2::splat(16.0));
    egui::Spinner::new().size(16.0).paint_at(ui, rect);
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian::RenderSettings;

    const RECT: Rect = Rect { min: Pos2::new(100.0, 50.0), max: Pos2::new(300.0, 150.0) };

    #[test]
    fn corners_of_the_picture() {
        assert_eq!(picture_point(RECT, RECT.center()), (0.0, 0.0));
        assert_eq!(picture_point(RECT, RECT.left_top()), (-1.0, 1.0));
        assert_eq!(picture_point(RECT, RECT.right_bottom()), (1.0, -1.0));
    }

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

    #[test]
    fn a_crop_is_the_pixels_that_are_touched() {
        let resolution = (20, 10);
        let whole = Crop { x: 0, y: 0, width: 20, height: 10 };
        assert_eq!(crop(RECT, resolution, RECT), whole);
        let inner = Rect::from_min_max(Pos2::new(121.0, 75.0), Pos2::new(139.0, 90.0));
        let expected = Crop { x: 2, y: 2, width: 2, height: 2 };
        assert_eq!(crop(RECT, resolution, inner), expected);
        assert_eq!(part(RECT, resolution, whole), RECT);
        assert!(part(RECT, resolution, expected).contains_rect(inner));
    }
}
