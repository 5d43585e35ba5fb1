//! The window's content without a window: what keys, mouse and widgets make of a wish.

use super::app::App;
use super::command;
use super::engine::scene_info;
use super::keys::Action;
use super::link::Link;
use super::navigate::{self, Axis};
use super::preferences::Preferences;
use super::wish::{Frame, Message, Phase, Picked, Request, Wish};
use crate::cli::flags::{JobFlags, RenderFlags};
use crate::cli::job::Job;
use clap::{Args, Command, FromArgMatches};
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use steradian::image::ToneCurve;
use steradian::settings::{Crop, Sampler, Strategy};
use steradian::stopping::{CalibratedRule, Preset, StoppingRule};
use steradian::view::View;

const SIZE: Vec2 = Vec2::new(1000.0, 700.0);

pub(super) fn bundled(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    folder.join(name).join(format!("{name}.gltf"))
}

/// Flags as on a command line.
pub(super) fn flags(words: &[&str]) -> JobFlags {
    let command = JobFlags::augment_args(Command::new("test"));
    let words = ["test"].iter().chain(words);
    JobFlags::from_arg_matches(&command.try_get_matches_from(words).unwrap()).unwrap()
}

/// A window with the box of spheres, of a size that is given, and no engine.
fn open(words: &[&str]) -> (Harness<'static, App>, Link) {
    let (path, flags) = (bundled("cornell-spheres"), flags(words));
    let job = Job::new(&path, &flags).unwrap();
    let info = scene_info(&path, &job, &flags, 1, 1);
    let link = Link::new(|| ());
    link.tell(|report| report.scene = Some(Arc::new(info)));
    let app = App::new(link.clone(), Preferences::default(), None);
    let builder = Harness::builder().with_size(SIZE).with_max_steps(16).with_step_dt(1.0 / 60.0);
    let mut harness = builder.build_ui_state(|ui, app: &mut App| app.ui(ui), app);
    harness.run_steps(3);
    (harness, link)
}

const SMALL: &[&str] = &["--resolution", "64x48"];

/// The newest wish and what was asked since the last call.
fn news(link: &Link) -> (Wish, Vec<Request>) {
    let news = link.news(Duration::ZERO);
    (news.wish.map(|(_, w)| w.as_ref().clone()).unwrap(), news.requests)
}

fn press(harness: &mut Harness<App>, key: Key, modifiers: Modifiers) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(2);
}

#[test]
fn the_first_wish_is_that_of_the_command_line() {
    let words = ["--resolution", "64x48", "--spp", "32", "--strategy", "bsdf", "--exposure", "-1"];
    let (_, link) = open(&words);
    let (wish, requests) = news(&link);
    assert_eq!((wish.settings.spp, wish.settings.resolution), (32, (64, 48)));
    assert_eq!(wish.settings.strategy, Strategy::Bsdf);
    assert_eq!(wish.display.exposure_ev, -1.0);
    assert!(requests.is_empty());
}

/// Each key of the table changes what its name says, and nothing else of these.
#[test]
fn keys_change_the_wish() {
    type Change = fn(&mut Wish);
    let none = Modifiers::NONE;
    let cases: &[(Key, Modifiers, Change)] = &[
        (Key::OpenBracket, none, |w| (w.settings.spp, w.settings.block_size) = (32, 8)),
        (Key::CloseBracket, none, |w| w.settings.spp = 128),
        (Key::Plus, none, |w| w.settings.light_samples = 2),
        (Key::Comma, Modifiers::SHIFT, |w| w.settings.max_bounces = Some(16)),
        (Key::O, none, |w| w.settings.only_bounce = Some(1)),
        (Key::H, none, |w| w.settings.strategy = Strategy::Hemisphere),
        (Key::P, none, |w| w.is_paused = true),
        (Key::PageUp, none, |w| w.display.exposure_ev = 0.5),
        (Key::T, none, |w| w.display.tone_curve = ToneCurve::Neutral),
        (Key::G, none, |w| w.view = Some(View::Normals)),
        (Key::Quote, none, |w| w.camera.focus_distance *= 1.1),
        (Key::Semicolon, none, |w| w.camera.focus_distance /= 1.1),
    ];
    for (key, modifiers, change) in cases {
        let (mut harness, link) = open(SMALL);
        let (mut expected, _) = news(&link);
        change(&mut expected);
        press(&mut harness, *key, *modifiers);
        assert_eq!(news(&link).0, expected, "{key:?}");
    }
}

#[test]
fn keys_that_go_there_and_back() {
    let (mut harness, link) = open(SMALL);
    let (first, _) = news(&link);
    for (there, back) in [
        (Key::CloseBracket, Key::OpenBracket),
        (Key::Plus, Key::Minus),
        (Key::H, Key::H),
        (Key::O, Key::O),
        (Key::L, Key::K),
        (Key::P, Key::E),
        (Key::PageDown, Key::Home),
    ] {
        press(&mut harness, there, Modifiers::NONE);
        let (changed, _) = news(&link);
        assert_ne!(changed, first, "{there:?}");
        press(&mut harness, back, Modifiers::NONE);
        assert_eq!(news(&link).0, first, "{there:?} {back:?}");
    }
}

#[test]
fn keys_that_ask_the_engine() {
    let (mut harness, link) = open(SMALL);
    let none = Modifiers::NONE;
    let cases = [
        (Key::R, none, Request::Restart),
        (Key::F5, none, Request::Reload),
        (Key::N, none, Request::Step),
        (Key::S, none, Request::Save("cornell-spheres.png".into())),
        (Key::S, Modifiers::SHIFT, Request::Save("cornell-spheres.exr".into())),
        (Key::V, none, Request::Tree),
    ];
    for (key, modifiers, request) in cases {
        press(&mut harness, key, modifiers);
        assert_eq!(news(&link).1, [request], "{key:?}");
    }
}

#[test]
fn cameras_move_by_keys() {
    let (mut harness, link) = open(SMALL);
    let (first, _) = news(&link);
    press(&mut harness, Key::Num7, Modifiers::NONE);
    let (top, _) = news(&link);
    assert!(navigate::forward(&top.camera).y < -0.999);
    press(&mut harness, Key::F, Modifiers::NONE);
    let (framed, _) = news(&link);
    assert_ne!(framed.camera, top.camera);
    press(&mut harness, Key::Space, Modifiers::NONE);
    assert_eq!(news(&link).0, first);
    harness.state_mut().asked.push(Action::Look(Axis::Left));
    harness.run_steps(2);
    assert!(navigate::forward(&news(&link).0.camera).x > 0.999);
}

#[test]
fn buttons_of_the_panel() {
    let (mut harness, link) = open(SMALL);
    news(&link);
    harness.get_by_label("Pause").click();
    harness.run_steps(3);
    assert!(news(&link).0.is_paused);
    harness.get_by_label("Go on").click();
    harness.run_steps(3);
    assert!(!news(&link).0.is_paused);
    harness.get_by_label("Save EXR").click();
    harness.run_steps(3);
    assert_eq!(news(&link).1, [Request::Save("cornell-spheres.exr".into())]);
    harness.get_by_label("limit").click();
    harness.run_steps(3);
    assert_eq!(news(&link).0.settings.max_bounces, Some(5));
    // Tab hides the panel.
    press(&mut harness, Key::Tab, Modifiers::NONE);
    assert!(harness.query_by_label("Save EXR").is_none());
}

#[test]
fn the_sheet_lists_the_keys() {
    let (mut harness, _) = open(SMALL);
    assert!(harness.query_by_label("Keys and mouse").is_none());
    press(&mut harness, Key::F1, Modifiers::NONE);
    for what in
        ["orbit the pivot", "next tone curve", "boxes of the tree", "copy the render command"]
    {
        harness.get_by_label(what);
    }
    press(&mut harness, Key::Escape, Modifiers::NONE);
    assert!(harness.query_by_label("orbit the pivot").is_none());
}

fn drag(harness: &mut Harness<App>, button: PointerButton, modifiers: Modifiers, by: Vec2) {
    let from = Pos2::new(300.0, 300.0);
    let event = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers };
    harness.event_modifiers(Event::PointerMoved(from), modifiers);
    harness.event_modifiers(event(from, true), modifiers);
    harness.run_steps(1);
    for step in 1..=4 {
        harness.event_modifiers(Event::PointerMoved(from + by * (step as f32 / 4.0)), modifiers);
        harness.run_steps(1);
    }
    harness.event_modifiers(event(from + by, false), modifiers);
    harness.run_steps(2);
}

#[test]
fn the_mouse_moves_the_camera() {
    let (mut harness, link) = open(SMALL);
    let (first, _) = news(&link);
    let pivot = harness.state().canvas.pivot;
    let distance = navigate::eye(&first.camera).distance(pivot);

    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, Vec2::new(80.0, 0.0));
    let (orbited, _) = news(&link);
    let eye = navigate::eye(&orbited.camera);
    assert_ne!(orbited.camera, first.camera);
    assert!((eye.distance(pivot) - distance).abs() < 1e-4 * distance);

    drag(&mut harness, PointerButton::Middle, Modifiers::NONE, Vec2::new(0.0, 60.0));
    let (panned, _) = news(&link);
    // The scene follows the mouse down: the camera goes up.
    assert!(navigate::eye(&panned.camera).y > eye.y);
    assert_eq!(navigate::forward(&panned.camera), navigate::forward(&orbited.camera));

    drag(&mut harness, PointerButton::Secondary, Modifiers::NONE, Vec2::new(50.0, 0.0));
    let (looked, _) = news(&link);
    assert_eq!(navigate::eye(&looked.camera), navigate::eye(&panned.camera));
    assert_ne!(navigate::forward(&looked.camera), navigate::forward(&panned.camera));
}

#[test]
fn the_wheel_goes_to_the_cursor() {
    let (mut harness, link) = open(SMALL);
    let (first, _) = news(&link);
    harness.event(Event::PointerMoved(Pos2::new(400.0, 250.0)));
    harness.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: Vec2::new(0.0, 2.0),
        phase: egui::TouchPhase::Move,
        modifiers: Modifiers::NONE,
        source: egui::MouseWheelSource::Unknown,
    });
    harness.run_steps(12);
    let (nearer, _) = news(&link);
    let pivot = harness.state().canvas.pivot;
    let distance = |w: &Wish| navigate::eye(&w.camera).distance(pivot);
    assert!(distance(&nearer) < distance(&first));
}

#[test]
fn a_dragged_rectangle_is_the_crop() {
    let (mut harness, link) = open(SMALL);
    press(&mut harness, Key::C, Modifiers::NONE);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE, Vec2::new(120.0, 90.0));
    let crop = news(&link).0.settings.crop.unwrap();
    assert!(crop.width > 1 && crop.height > 1 && crop.x + crop.width <= 64, "{crop:?}");
    press(&mut harness, Key::Escape, Modifiers::NONE);
    assert_eq!(news(&link).0.settings.crop, None);
}

/// Without a size of its own the picture has that of its place in the window.
#[test]
fn the_picture_follows_the_window() {
    let (mut harness, link) = open(&[]);
    let (first, _) = news(&link);
    assert!(first.settings.resolution.0 > 400 && first.settings.resolution.1 > 400);
    harness.set_size(SIZE + Vec2::new(100.0, 50.0));
    harness.run_steps(3);
    let (width, height) = news(&link).0.settings.resolution;
    assert_eq!(
        (width, height),
        (first.settings.resolution.0 + 100, first.settings.resolution.1 + 50)
    );
    harness.state_mut().pixel_size = 2;
    harness.run_steps(2);
    assert_eq!(news(&link).0.settings.resolution, (width / 2, height / 2));
    // On a finer display a point has more pixels.
    harness.set_pixels_per_point(2.0);
    harness.run_steps(3);
    let (width, height) = news(&link).0.settings.resolution;
    let points = harness.state().canvas.rect.unwrap().size();
    assert!((points.x - width as f32).abs() < 2.0, "{points} {width}");
    assert!((points.y - height as f32).abs() < 2.0, "{points} {height}");
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("not read here".into())
    }
}

#[test]
fn dropped_files_are_opened() {
    let (mut harness, link) = open(SMALL);
    news(&link);
    let mut drop = |path: &str| {
        harness.input_mut().dropped_files.push(Arc::new(Dropped(path.into())));
        harness.run_steps(2);
        news(&link)
    };
    assert_eq!(drop("a/other.glb").1, [Request::Open("a/other.glb".into())]);
    let (wish, requests) = drop("sky.HDR");
    assert_eq!(wish.environment.environment, Some("sky.HDR".into()));
    assert!(requests.is_empty());
}

#[test]
fn reports_are_shown() {
    let (mut harness, link) = open(SMALL);
    link.tell(|report| {
        report.phase = Phase::Done;
        report.progress.spp = (16, 16);
        report.is_software = true;
        report.message =
            Some(Message { text: "broken.gltf: no scene".into(), is_error: true, serial: 1 });
    });
    harness.run_steps(2);
    for label in ["done", "software renderer", "broken.gltf: no scene"] {
        harness.get_by_label(label);
    }
    // A message is worth more than figures, for a while.
    assert_eq!(harness.query_all_by_label_contains("16 spp").count(), 0);
}

/// The picture that a double click asks about is the one under the cursor.
#[test]
fn a_double_click_picks_a_pixel() {
    let (mut harness, link) = open(SMALL);
    news(&link);
    let rect = harness.state().canvas.rect.unwrap();
    let at = rect.min + rect.size() * Vec2::new(0.25, 0.75);
    let button = PointerButton::Primary;
    for pressed in [true, false, true, false] {
        harness.event(Event::PointerMoved(at));
        let modifiers = Modifiers::NONE;
        harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        harness.run_steps(1);
    }
    harness.run_steps(1);
    assert_eq!(news(&link).1, [Request::Pick((16, 36))]);
}

/// A scene that is read again keeps the view; another one begins with its own.
#[test]
fn a_scene_read_again_keeps_camera_and_pivot() {
    let (mut harness, link) = open(SMALL);
    drag(&mut harness, PointerButton::Middle, Modifiers::NONE, Vec2::new(40.0, 60.0));
    let (moved, _) = news(&link);
    let pivot = harness.state().canvas.pivot;
    for (generation, is_again) in [(2, true), (3, false)] {
        let (path, flags) = (bundled("cornell-spheres"), flags(SMALL));
        let job = Job::new(&path, &flags).unwrap();
        let mut info = scene_info(&path, &job, &flags, generation, 1);
        info.is_again = is_again;
        let first = info.cameras[0].clone();
        link.tell(|report| report.scene = Some(Arc::new(info)));
        harness.run_steps(2);
        let wish = news(&link).0;
        assert_eq!(wish.generation, generation);
        let expected = if is_again { &moved.camera } else { &first };
        assert_eq!(&wish.camera, expected);
        assert_eq!(harness.state().canvas.pivot == pivot, is_again);
    }
}

#[test]
fn a_refused_wish_is_given_up_once() {
    let (mut harness, link) = open(SMALL);
    let (good, _) = news(&link);
    press(&mut harness, Key::H, Modifiers::NONE);
    let serial = link.news(Duration::ZERO).wish.unwrap().0;
    link.tell(|report| report.refused = Some((serial, Some(Arc::new(good.clone())))));
    harness.run_steps(2);
    assert_eq!(news(&link).0, good);
    press(&mut harness, Key::H, Modifiers::NONE);
    assert_ne!(news(&link).0, good);
}

#[test]
fn what_was_picked_is_the_pivot_and_in_focus() {
    let (mut harness, link) = open(SMALL);
    let (first, _) = news(&link);
    let eye = navigate::eye(&first.camera);
    let to = eye + navigate::forward(&first.camera) * 0.7 + glam::Vec3::Y * 0.1;
    link.tell(|report| report.picked = Some(Picked { serial: 1, ray: (eye, to) }));
    harness.run_steps(2);
    assert_eq!(harness.state().canvas.pivot, to);
    assert!((news(&link).0.camera.focus_distance - 0.7).abs() < 1e-6);
}

/// All views come around to light.
#[test]
fn views_come_around() {
    let (mut harness, link) = open(SMALL);
    let (first, _) = news(&link);
    for view in View::ALL {
        press(&mut harness, Key::G, Modifiers::NONE);
        assert_eq!(news(&link).0.view, Some(view));
    }
    press(&mut harness, Key::G, Modifiers::NONE);
    assert_eq!(news(&link).0, first);
}

/// What a copied command renders is what the window shows.
#[test]
fn the_copied_command_is_the_wish() {
    let (harness, link) = open(SMALL);
    let info = harness.state().scene.clone().unwrap();
    let (plain, _) = news(&link);
    let mut rich = plain.clone();
    navigate::orbit(&mut rich.camera, glam::Vec3::ZERO, 0.3, 0.1);
    rich.camera.aperture_radius = 0.01;
    rich.settings.strategy = Strategy::Light;
    rich.settings.sampler = Sampler::Independent;
    rich.settings.crop = Some(Crop { x: 1, y: 2, width: 30, height: 20 });
    rich.settings.max_bounces = Some(7);
    rich.settings.only_bounce = Some(2);
    rich.settings.roulette = false;
    rich.settings.seed = 9;
    rich.settings.light_samples = 3;
    rich.environment.environment_radiance = Some(glam::Vec3::new(0.5, 0.25, 1.0));
    rich.environment.environment_rotation = Some(-30.0);
    rich.environment.environment_intensity = Some(2.0);
    rich.display.exposure_ev = -1.5;
    rich.display.tone_curve = ToneCurve::Agx;
    let mut adaptive = plain.clone();
    let preset = Preset::Strict;
    let rule = CalibratedRule { tolerance: 0.03, confidence: 0.9, preset };
    adaptive.settings.stopping = Some(StoppingRule::Calibrated(rule));
    adaptive.view = Some(View::StopReason);
    let mut normals = plain.clone();
    normals.view = Some(View::Normals);
    normals.display.exposure_ev = 0.0;
    for wish in [plain, rich, adaptive, normals] {
        let text = command::render(&info, &wish, "it's.png");
        let words = shell_words(&text);
        assert_eq!(words[..2], ["steradian", "render"]);
        let command = RenderFlags::augment_args(Command::new("render"));
        let matches =
            command.try_get_matches_from(&words[1..]).unwrap_or_else(|e| panic!("{text}: {e}"));
        let flags = RenderFlags::from_arg_matches(&matches).unwrap();
        assert_eq!(flags.output, Some("it's.png".into()));
        assert_eq!(flags.scene, info.path);
        let job = Job::new(&flags.scene, &flags.job).unwrap();
        let camera = job.scene.cameras[job.settings.camera].clone();
        assert_eq!(camera, wish.camera, "{text}");
        let settings = steradian::RenderSettings { camera: 0, ..job.settings };
        assert_eq!(settings, steradian::RenderSettings { camera: 0, ..wish.settings.clone() });
        assert_eq!(flags.job.environment, wish.environment);
        let picture = &flags.job.picture;
        assert_eq!(picture.png.exposure.unwrap_or(0.0), wish.display.exposure_ev);
        assert_eq!(picture.png.tone_map.unwrap_or_default(), wish.display.tone_curve);
        assert_eq!(picture.view, wish.view);
    }
}

/// Words of a shell line with single quotes alone.
fn shell_words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let (mut in_quotes, mut is_escaped) = (false, false);
    for c in line.chars() {
        match c {
            _ if is_escaped => {
                words.last_mut().unwrap().push(c);
                is_escaped = false;
            }
            '\'' => in_quotes = !in_quotes,
            '\\' if !in_quotes => is_escaped = true,
            ' ' if !in_quotes => words.push(String::new()),
            c => words.last_mut().unwrap().push(c),
        }
    }
    words
}

/// A frame in the report comes onto the display, once.
#[test]
fn frames_become_the_texture() {
    let (mut harness, link) = open(SMALL);
    let camera = news(&link).0.camera;
    let window = Crop { x: 0, y: 0, width: 2, height: 1 };
    let rgba = Arc::new(vec![[10, 20, 30, 255], [200, 100, 50, 255]]);
    let frame = Frame {
        size: [2, 1],
        rgba,
        serial: 5,
        camera,
        wish: 1,
        scale: 1,
        window,
        resolution: (2, 1),
        is_whole: true,
        has_compiled: false,
    };
    link.tell(|report| report.frame = Some(frame));
    harness.run_steps(1);
    assert_eq!(harness.state().canvas.texture_size(), Some([2, 1]));
    assert_eq!(harness.state().canvas.shown.as_ref().map(|f| f.serial), Some(5));
}
