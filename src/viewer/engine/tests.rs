//! The engine on a real device, with a test in the window's place.

use super::{Engine, Options};
use crate::cli::job::Job;
use crate::viewer::link::Link;
use crate::viewer::navigate;
use crate::viewer::tests::{bundled, flags};
use crate::viewer::wish::{Frame, Phase, Report, Request, SceneInfo, Wish};
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use steradian::Renderer;
use steradian::gpu::Device;
use steradian::image::{DisplayTransform, read_picture};
use steradian::passes::{Extras, Tuning};
use steradian::renderer::PreparedScene;
use steradian::view::{View, of_first_hits};

/// No step of these takes as long on a machine that has nothing else to do.
const PATIENCE: Duration = Duration::from_secs(120);
const SMALL: &[&str] = &["--resolution", "32x24", "--spp", "8"];

/// An engine at work, and what it has said.
struct Bench {
    link: Link,
    news: Arc<(Mutex<u64>, Condvar)>,
    thread: Option<JoinHandle<()>>,
    /// The newest wish.
    sent: Cell<u64>,
}

impl Bench {
    fn start(scene: &Path, words: &[&str]) -> Self {
        Self::start_with(scene, words, None)
    }

    fn start_with(scene: &Path, words: &[&str], shaders: Option<PathBuf>) -> Self {
        let news = Arc::new((Mutex::new(0), Condvar::new()));
        let heard = news.clone();
        let link = Link::new(move || {
            *heard.0.lock().unwrap() += 1;
            heard.1.notify_all();
        });
        let scene = Some(scene.to_owned());
        let options = Options { flags: flags(words), device: None, shaders, scene };
        let thread = Some(Engine::start(link.clone(), options).unwrap());
        Self { link, news, thread, sent: Cell::new(0) }
    }

    /// The first report that `fits`.
    fn wait(&self, what: &str, fits: impl Fn(&Report) -> bool) -> Report {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let count = *self.news.0.lock().unwrap();
            let report = self.link.report();
            if fits(&report) {
                return report;
            }
            let left = deadline.saturating_duration_since(Instant::now());
            assert!(!left.is_zero(), "{what}: never came; {:?} {:?}", report.phase, report.message);
            let heard = self.news.0.lock().unwrap();
            let _ = self.news.1.wait_timeout_while(heard, left, |n| *n == count).unwrap();
        }
    }

    fn wait_for_message(&self, part: &str) -> Report {
        self.wait(part, |r| r.message.as_ref().is_some_and(|m| m.text.contains(part)))
    }

    /// Waits for the scene of a generation, and wishes for what its command line says.
    fn begin(&self, generation: u64) -> Wish {
        let has_it = |r: &Report| r.scene.as_ref().is_some_and(|s| s.generation == generation);
        let info = self.wait("the scene", has_it).scene.unwrap();
        let wish = first_wish(&info);
        self.send(&wish);
        wish
    }

    fn send(&self, wish: &Wish) {
        self.sent.set(self.link.send(wish.clone()));
    }

    /// The first picture that obeys the newest wish.
    fn wait_for_picture(&self) -> Frame {
        let obeys = |f: &Frame| f.wish >= self.sent.get();
        self.wait("a picture", |r| r.frame.as_ref().is_some_and(obeys)).frame.unwrap()
    }

    fn wait_until_done(&self) -> Frame {
        let is_done = |r: &Report| {
            let is_whole = |f: &Frame| f.is_whole && f.wish >= self.sent.get();
            r.phase == Phase::Done && r.frame.as_ref().is_some_and(is_whole)
        };
        self.wait("the end", is_done).frame.unwrap()
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.link.end();
        let ended = self.thread.take().unwrap().join();
        if !std::thread::panicking() {
            ended.unwrap();
        }
    }
}

fn first_wish(info: &SceneInfo) -> Wish {
    Wish {
        generation: info.generation,
        base: info.settings.camera,
        camera: info.cameras[info.settings.camera].clone(),
        settings: info.settings.clone(),
        environment: info.environment.clone(),
        display: DisplayTransform::default(),
        view: None,
        is_paused: false,
    }
}

/// The bytes that `steradian render` would show.
fn rendered(scene: &Path, words: &[&str], change: impl Fn(&mut Job)) -> Vec<[u8; 4]> {
    let mut job = Job::new(scene, &flags(words)).unwrap();
    change(&mut job);
    let device = Arc::new(Device::open(None).unwrap());
    let mut renderer = Renderer::new(device, &job.scene, &job.settings).unwrap();
    while renderer.step().unwrap() {}
    renderer.finish().unwrap();
    DisplayTransform::default().srgb8(&renderer.film().picture().rgb)
}

/// With all samples alike, and with pixels that stop one by one.
#[test]
fn the_picture_is_that_of_render_and_saves_as_it() {
    let scene = bundled("cornell-box");
    let adaptive = ["--resolution", "32x24", "--noise", "0.3", "--spp", "64"];
    for words in [SMALL, &adaptive] {
        let bench = Bench::start(&scene, words);
        bench.begin(1);
        let frame = bench.wait_until_done();
        let expected = rendered(&scene, words, |_| ());
        assert!(frame.rgba.as_ref() == &expected, "{words:?}");
        assert!(expected.iter().any(|p| p[0] > 20), "black");

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        bench.link.ask(Request::Save(path.clone()));
        bench.wait_for_message("saved");
        let saved = read_picture(&path).unwrap();
        assert!(DisplayTransform::default().srgb8(&saved.rgb) == expected, "{words:?}");
    }
}

#[test]
fn a_moved_camera_is_followed_first_coarse_then_whole() {
    let scene = bundled("cornell-box");
    // So large that one turn cannot take all its samples.
    let words = ["--resolution", "320x240", "--spp", "2"];
    let bench = Bench::start(&scene, &words);
    let mut wish = bench.begin(1);
    navigate::orbit(&mut wish.camera, glam::Vec3::new(0.0, 0.27, -0.28), 0.4, 0.1);
    bench.send(&wish);
    let coarse = bench.wait_for_picture();
    assert!(coarse.scale > 1 && coarse.size[0] < 320, "{:?}", coarse.size);
    let whole = bench.wait_until_done();
    assert_eq!((whole.scale, whole.size, &whole.camera), (1, [320, 240], &wish.camera));
    let expected = rendered(&scene, &words, |job| {
        let camera = job.settings.camera;
        job.scene.cameras[camera] = wish.camera.clone();
    });
    assert!(whole.rgba.as_ref() == &expected);

    // Exposure takes no new samples.
    let before = bench.link.report().progress;
    wish.display.exposure_ev = 1.0;
    bench.send(&wish);
    assert!(bench.wait_for_picture().rgba.as_ref() != &expected);
    assert_eq!(bench.link.report().progress, before);
}

/// Of first hits by as many rays, of the film by the same samples; light comes back as it was.
#[test]
fn views_are_those_of_the_library() {
    let scene = bundled("cornell-spheres");
    // So large that first hits take several turns.
    let words = ["--resolution", "200x301", "--spp", "2"];
    let bench = Bench::start(&scene, &words);
    let mut wish = bench.begin(1);
    let light = bench.wait_until_done();
    let job = Job::new(&scene, &flags(&words)).unwrap();
    let device = Arc::new(Device::open(None).unwrap());
    let prepared = PreparedScene::new(device.clone(), &job.scene, &job.settings).unwrap();
    for view in [View::Normals, View::Material, View::NodeVisits] {
        wish.view = Some(view);
        bench.send(&wish);
        let frame = bench.wait_until_done();
        let counts = view == View::NodeVisits;
        let tuning = Tuning::default();
        let mut hits = prepared
            .first_hits(&job.scene, &job.settings, Extras::visits(counts), &tuning)
            .unwrap();
        hits.run(&device, super::views::RAYS).unwrap();
        let expected = of_first_hits(view, hits.hits(), (200, 301)).unwrap();
        let expected = DisplayTransform::default().srgb8(&expected.picture.rgb);
        assert!(frame.rgba.as_ref() == &expected, "{view:?}");
        assert!(bench.link.report().legend.is_some());
    }
    wish.view = Some(View::SampleCount);
    bench.send(&wish);
    let counts = bench.wait_until_done();
    assert!(counts.rgba.iter().all(|p| *p == counts.rgba[0]), "all have 2 samples");
    wish.view = None;
    bench.send(&wish);
    assert!(bench.wait_until_done().rgba == light.rgba);
    assert_eq!(bench.link.report().legend, None);
}

/// The middle of the upper half shows the back wall.
#[test]
fn a_pick_is_a_point_of_the_surface_that_is_seen() {
    let bench = Bench::start(&bundled("cornell-box"), SMALL);
    let wish = bench.begin(1);
    bench.wait_until_done();
    bench.link.ask(Request::Pick((16, 9)));
    let picked = bench.wait("a pick", |r| r.picked.is_some()).picked.unwrap();
    let (from, to) = picked.ray;
    assert!(from.distance(navigate::eye(&wish.camera)) < 1e-6);
    assert!((to.z + 0.5592).abs() < 2e-3, "{to}");
    let (x, y) = navigate::project(&wish.camera, to, 32.0 / 24.0).unwrap();
    assert!((x - (16.5 / 16.0 - 1.0)).abs() < 0.04 && (y - (1.0 - 9.5 / 12.0)).abs() < 0.05);
}

#[test]
fn pausing_stops_and_steps_go_on() {
    let words = ["--resolution", "64x48", "--spp", "100000"];
    let bench = Bench::start(&bundled("cornell-box"), &words);
    let mut wish = bench.begin(1);
    bench.wait("samples", |r| r.progress.spp.1 > 0);
    wish.is_paused = true;
    bench.send(&wish);
    let paused = bench.wait("the pause", |r| r.phase == Phase::Paused);
    std::thread::sleep(Duration::from_millis(300));
    // One piece of work may have been under way.
    let resting = bench.link.report().progress;
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(bench.link.report().progress, resting);
    assert!(resting.samples >= paused.progress.samples);
    bench.link.ask(Request::Step);
    bench.wait("a step", |r| r.progress.samples > resting.samples);
}

#[test]
fn a_bad_file_leaves_the_scene() {
    let bench = Bench::start(&bundled("cornell-box"), SMALL);
    bench.begin(1);
    bench.wait_until_done();
    let folder = tempfile::tempdir().unwrap();
    let bad = folder.path().join("bad.gltf");
    std::fs::write(&bad, "{").unwrap();
    bench.link.ask(Request::Open(bad));
    let report = bench.wait_for_message("bad.gltf");
    assert!(report.message.unwrap().is_error);
    assert_eq!(report.scene.unwrap().name, "cornell-box");
    // And it goes on with the next one.
    bench.link.ask(Request::Open(bundled("veach-mis")));
    bench.begin(2);
    bench.wait_until_done();
    assert_eq!(bench.link.report().scene.unwrap().name, "veach-mis");
}

#[test]
fn an_environment_that_cannot_be_read_is_given_up() {
    let bench = Bench::start(&bundled("environment"), SMALL);
    let mut wish = bench.begin(1);
    let before = bench.wait_until_done();
    wish.environment.environment = Some("missing.hdr".into());
    bench.send(&wish);
    let report = bench.wait_for_message("missing.hdr");
    let (serial, good) = report.refused.unwrap();
    assert_eq!((serial, &good.unwrap().environment), (bench.sent.get(), &Default::default()));
    // What follows is of the old light.
    wish.environment = Default::default();
    wish.settings.seed = 1;
    bench.send(&wish);
    let other = bench.wait_until_done();
    let expected = rendered(&bundled("environment"), SMALL, |job| job.settings.seed = 1);
    assert!(other.rgba.as_ref() == &expected && other.rgba != before.rgba);

    // A turn and an intensity are followed as `render` has them.
    wish.environment.environment_rotation = Some(70.0);
    bench.send(&wish);
    bench.wait_until_done();
    wish.environment.environment_intensity = Some(0.5);
    bench.send(&wish);
    let turned = bench.wait_until_done();
    let words =
        [SMALL, &["--environment-rotation", "70", "--environment-intensity", "0.5"]].concat();
    let expected = rendered(&bundled("environment"), &words, |job| job.settings.seed = 1);
    assert!(turned.rgba.as_ref() == &expected);
}

/// A limit in time ends a render as a limit of samples does.
#[test]
fn time_ends_a_render() {
    let bench = Bench::start(&bundled("cornell-box"), &["--resolution", "32x24", "--time", "0.2s"]);
    bench.begin(1);
    let frame = bench.wait_until_done();
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(bench.link.report().frame.map(|f| f.serial), Some(frame.serial));
}

#[test]
fn a_changed_file_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let original = bundled("cornell-box");
    let source = original.parent().unwrap();
    for entry in std::fs::read_dir(source).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
    }
    let scene = folder.path().join("cornell-box.gltf");
    let bench = Bench::start(&scene, SMALL);
    bench.begin(1);
    let before = bench.wait_until_done();
    let text = std::fs::read_to_string(&scene).unwrap();
    std::fs::write(&scene, text.replace("0.63,0.065,0.05", "0.05,0.065,0.63")).unwrap();
    let info = bench.wait("the scene again", |r| r.scene.as_ref().unwrap().generation == 2);
    assert!(info.scene.unwrap().is_again);
    bench.begin(2);
    let after = bench.wait_until_done();
    assert!(after.rgba != before.rgba);
}

#[test]
fn a_lost_device_is_opened_again_once() {
    let bench = Bench::start(&bundled("cornell-box"), SMALL);
    bench.begin(1);
    let before = bench.wait_until_done();
    bench.link.ask(Request::LoseDevice);
    bench.wait_for_message("opened again");
    let after = bench.wait("the picture again", |r| {
        r.phase == Phase::Done && r.frame.as_ref().is_some_and(|f| f.serial > before.serial)
    });
    assert!(after.frame.unwrap().rgba == before.rgba);
    bench.link.ask(Request::LoseDevice);
    let report = bench.wait_for_message("R tries again");
    assert_eq!(report.phase, Phase::Failed);
    bench.link.ask(Request::Restart);
    bench.begin(2);
    bench.wait_until_done();
}

/// A shader that is wrong is told with its line, and the last good one stays.
#[test]
fn shaders_are_read_when_they_change() {
    let folder = tempfile::tempdir().unwrap();
    let shaders = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    copy_all(&shaders, folder.path());
    let bench = Bench::start_with(&bundled("cornell-box"), SMALL, Some(folder.path().to_owned()));
    bench.begin(1);
    let before = bench.wait_until_done();
    let file = folder.path().join("bsdf/lambert.wgsl");
    let good = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, format!("{good}\nfn broken( {{}}\n")).unwrap();
    let report = bench.wait_for_message("the shaders before stay");
    assert!(report.message.unwrap().text.contains("bsdf/lambert"));
    assert!(report.frame.unwrap().rgba == before.rgba);
    std::fs::write(&file, good.replace("/ PI", "/ (2.0 * PI)").replace("INV_PI", "(0.5 * INV_PI)"))
        .unwrap();
    bench.wait_for_message("shaders read again");
    bench.wait("a darker picture", |r| {
        r.frame.as_ref().is_some_and(|f| f.is_whole && f.rgba != before.rgba)
    });
}

fn copy_all(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        match path.is_dir() {
            true => copy_all(&path, &target),
            false => drop(std::fs::copy(&path, &target).unwrap()),
        }
    }
}
