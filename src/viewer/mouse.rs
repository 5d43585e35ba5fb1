//! What the mouse does on the picture.

use super::app::App;
use super::navigate;
use super::wish::Request;
use egui::{PointerButton, Pos2, Rect, Response, Ui, Vec2};
use glam::Vec3;
use steradian::settings::Crop;

/// Pixels in the longest line of a rectangle that is a click, not a drag.
const LEAST_CROP: f32 = 4.0;

/// Metres a second of flying, as a share of the scene's size.
const SPEED: f32 = 0.25;
/// Radians of a drag across the whole height.
const TURN: f32 = std::f32::consts::PI;
/// Coordinates from -1 to 1, up and to the right, of a point of the window.
fn picture_point(rect: Rect, at: Pos2) -> (f32, f32) {
    let center = rect.center();
    (2.0 * (at.x - center.x) / rect.width(), 2.0 * (center.y - at.y) / rect.height())
}

/// Follows the mouse over the picture, whose whole is in `rect`.
pub(super) fn follow(ui: &Ui, app: &mut App, response: &Response, rect: Rect) {
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

#[cfg(test)]
mod tests {
    use super::super::canvas::part;
    use super::*;

    const RECT: Rect = Rect { min: Pos2::new(100.0, 50.0), max: Pos2::new(300.0, 150.0) };

    #[test]
    fn corners_of_the_picture() {
        assert_eq!(picture_point(RECT, RECT.center()), (0.0, 0.0));
        assert_eq!(picture_point(RECT, RECT.left_top()), (-1.0, 1.0));
        assert_eq!(picture_point(RECT, RECT.right_bottom()), (1.0, -1.0));
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
