//! What keys and buttons do.

use super::app::App;
use super::keys::Action;
use super::navigate;
use super::panel;
use super::wish::Request;
use crate::cli::values::{VIEWS, word_for};
use egui::Ui;
use std::path::PathBuf;
use steradian::image::ToneCurve;
use steradian::settings::Strategy;
use steradian::view::View;

impl App {
    /// Does what a key or a button asks for.
    pub(super) fn act(&mut self, ui: &Ui, action: Action) {
        match action {
            Action::Open => self.open_dialog(ui),
            Action::SavePng => self.save("png"),
            Action::SaveExr => self.save("exr"),
            Action::Reload => self.link.ask(Request::Reload),
            Action::Restart => self.link.ask(Request::Restart),
            Action::Hud => self.preferences.is_panel_open = !self.preferences.is_panel_open,
            Action::Help => self.is_help_open = !self.is_help_open,
            Action::Quit => self.is_over = true,
            Action::Escape if self.is_help_open => self.is_help_open = false,
            _ => {}
        }
        let Some(info) = self.scene.clone() else { return };
        let Some(wish) = &mut self.wish else { return };
        let settings = &mut wish.settings;
        match action {
            Action::CopyCommand => {
                let name = format!("{}.png", info.name);
                ui.ctx().copy_text(super::command::render(&info, wish, &name));
                self.say("copied the command".into());
            }
            Action::DumpCamera => {
                let json = super::command::camera(&wish.camera);
                // Also for a program that started this one.
                let _ = crate::cli::talk::data(&format!("{json}\n"));
                ui.ctx().copy_text(json);
                self.say("copied the camera".into());
            }
            Action::Pause => {
                wish.is_paused = !wish.is_paused;
                let text = if wish.is_paused { "paused" } else { "goes on" };
                self.say(text.into());
            }
            Action::Step => {
                wish.is_paused = true;
                self.link.ask(Request::Step);
            }
            Action::ResetCamera => {
                wish.camera = info.cameras[wish.base].clone();
                self.canvas.begin(&wish.camera);
            }
            Action::FrameAll => {
                let (width, height) = settings.resolution;
                let aspect_ratio = width as f32 / height as f32;
                self.canvas.pivot =
                    navigate::frame_all(&mut wish.camera, info.bounds, aspect_ratio);
            }
            Action::Look(axis) => {
                navigate::look_along(&mut wish.camera, axis, self.canvas.pivot);
            }
            Action::NextCamera => {
                wish.base = (wish.base + 1) % info.cameras.len();
                wish.camera = info.cameras[wish.base].clone();
                self.canvas.begin(&wish.camera);
            }
            Action::Hemisphere => {
                let before = settings.strategy;
                settings.strategy = match before {
                    Strategy::Hemisphere => self.strategy_before,
                    _ => Strategy::Hemisphere,
                };
                self.strategy_before = before;
            }
            Action::HalveSpp => panel::set_spp(settings, (settings.spp / 2).max(1)),
            Action::DoubleSpp => panel::set_spp(settings, settings.spp.saturating_mul(2)),
            Action::HalveLightSamples => {
                settings.light_samples = (settings.light_samples / 2).max(1);
            }
            Action::DoubleLightSamples => {
                settings.light_samples = (settings.light_samples * 2).min(1024);
            }
            Action::FewerBounces => panel::set_bounces(settings, -1),
            Action::MoreBounces => panel::set_bounces(settings, 1),
            Action::OnlyBounce => {
                settings.only_bounce = match settings.only_bounce {
                    Some(_) => None,
                    None => Some(settings.max_bounces.unwrap_or(1)),
                };
            }
            Action::SmallerLens | Action::LargerLens => {
                panel::scale_lens(&mut wish.camera, info.bounds, action == Action::LargerLens);
            }
            Action::NearerFocus => wish.camera.focus_distance /= 1.1,
            Action::FartherFocus => wish.camera.focus_distance *= 1.1,
            Action::Crop => self.canvas.is_cropping = !self.canvas.is_cropping,
            Action::Darker => wish.display.exposure_ev -= 0.5,
            Action::Brighter => wish.display.exposure_ev += 0.5,
            Action::NoExposure => wish.display.exposure_ev = 0.0,
            Action::NextView => {
                let now = wish.view.and_then(|v| View::ALL.iter().position(|view| *view == v));
                wish.view = View::ALL.get(now.map_or(0, |at| at + 1)).copied();
                let word = wish.view.map_or("light", |view| word_for(VIEWS, &view));
                self.say(format!("view: {word}"));
            }
            Action::NextToneCurve => {
                let all = ToneCurve::ALL;
                let now = all.iter().position(|c| *c == wish.display.tone_curve).unwrap_or(0);
                wish.display.tone_curve = all[(now + 1) % all.len()];
                self.preferences.set_tone_curve(wish.display.tone_curve);
            }
            Action::Tree => {
                self.tree.is_shown = !self.tree.is_shown;
                if self.tree.is_shown {
                    self.link.ask(Request::Tree);
                }
            }
            Action::TreeLeft => self.tree.descend(0),
            Action::TreeRight => self.tree.descend(1),
            Action::TreeUp => self.tree.ascend(),
            Action::TreeRay => self.tree.is_ray_shown = !self.tree.is_ray_shown,
            Action::Escape => {
                self.canvas.is_cropping = false;
                settings.crop = None;
            }
            _ => {}
        }
    }

    fn save(&mut self, ending: &str) {
        let Some(info) = &self.scene else { return };
        let path = match &self.output {
            Some(path) => path.with_extension(ending),
            None => free_name(&info.name, ending),
        };
        self.link.ask(Request::Save(path));
    }
}

/// `NAME.png`, or the first of `NAME-1.png`, `NAME-2.png` ... that is not taken.
fn free_name(name: &str, ending: &str) -> PathBuf {
    let numbered = (1..).map(|n| PathBuf::from(format!("{name}-{n}.{ending}")));
    std::iter::once(PathBuf::from(format!("{name}.{ending}")))
        .chain(numbered)
        .find(|path| !path.exists())
        .unwrap_or_default()
}
