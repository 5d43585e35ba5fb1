//! Textures on the device: spread over several buffers, and far away.

mod common;

use common::{Stage, emitter, quad_mesh, render, settings, with_uvs};
use glam::{Affine2, Affine3A, Vec2, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;
use steradian::film::Film;
use steradian::gpu::Device;
use steradian::passes::Tuning;
use steradian::scene::{ColorSpace, Image, Material, TextureRef, Wrap};
use steradian::shader::Feature;
use steradian::{Error, RenderSettings, Renderer};

fn texture(image: u32, nearest: bool) -> TextureRef {
    TextureRef {
        image,
        color_space: ColorSpace::Linear,
        uv_set: 0,
        transform: Affine2::IDENTITY,
        wrap: [Wrap::Repeat; 2],
        nearest,
    }
}

/// Texels of any colours.
fn noise(seed: u32, width: u32, height: u32) -> Image {
    let texel = |i: u32| {
        let hash = (i ^ seed.wrapping_mul(0x9E37_79B9)).wrapping_mul(0x85EB_CA6B);
        (hash ^ hash >> 15).to_le_bytes()
    };
    let rgba = (0..width * height).map(texel).collect();
    Image { name: format!("noise {seed}"), width, height, rgba }
}

/// A square of three strips, each of which emits an image.
fn three_images() -> Stage {
    let mut stage = Stage::orthographic(Vec3::Y, Vec3::ZERO, 0.5);
    for (k, (width, height)) in [(16, 12), (8, 16), (13, 11)].into_iter().enumerate() {
        stage.scene.images.push(noise(k as u32, width, height));
        let emission_texture = Some(texture(k as u32, k == 1));
        let glow = Material { emission_texture, ..emitter(1.0) };
        let center = Vec3::new(k as f32 / 3.0 - 1.0 / 3.0, 0.0, 0.0);
        let corners = [[0.0, 0.0], [0.0, 2.0], [2.0, 2.0], [2.0, 0.0]].map(Vec2::from);
        let mesh = quad_mesh(center, Vec3::Z * 0.5, Vec3::X / 6.0);
        let mesh = stage.mesh(with_uvs(mesh, corners), glow);
        stage.place(mesh, Affine3A::IDENTITY);
    }
    stage
}

/// The film with textures in bindings of at most `limit` bytes, and whether they were split.
fn spread(
    device: &mut Arc<Device>,
    stage: &Stage,
    limit: u64,
    tuning: &Tuning,
) -> Result<(Film, bool), Error> {
    Arc::get_mut(device).unwrap().limit_texture_bindings(limit);
    let settings = RenderSettings { max_bounces: Some(0), ..settings(48, 48, 4) };
    let mut renderer = Renderer::with_tuning(device.clone(), &stage.scene, &settings, tuning)?;
    while renderer.step()? {}
    renderer.finish()?;
    let is_split = renderer.statistics().features.has(Feature::SplitTextures);
    Ok((renderer.film().clone(), is_split))
}

/// 463 texels and three descriptors are 125 words: two buffers of 64, or four of 32. Images lie
/// across their borders.
#[test]
fn the_picture_does_not_depend_on_the_number_of_buffers() {
    let (stage, usual) = (three_images(), Tuning::default());
    let mut device = Arc::new(Device::open(None).unwrap());
    let (whole, is_split) = spread(&mut device, &stage, u64::MAX, &usual).unwrap();
    assert!(!is_split);
    for limit in [64 * 16, 32 * 16, 33 * 16] {
        let (film, is_split) = spread(&mut device, &stage, limit, &usual).unwrap();
        assert!(is_split);
        assert!(film.picture() == whole.picture(), "in bindings of {limit} bytes");
    }
    // A kernel that takes one buffer for another is caught.
    let mut defect = Tuning::default();
    let text = defect.library.get_mut("material/texture").unwrap();
    assert!(text.contains("select(textures_2[word]"));
    *text = text.replace("select(textures_2[word]", "select(textures_1[word]").into();
    let (film, _) = spread(&mut device, &stage, 32 * 16, &defect).unwrap();
    assert!(film.picture() != whole.picture());
}

#[test]
fn textures_beyond_all_bindings_are_refused_with_the_remedy() {
    let mut device = Arc::new(Device::open(None).unwrap());
    let result = spread(&mut device, &three_images(), 16 * 16, &Tuning::default());
    let Err(error) = result else { panic!("they fit") };
    assert!(matches!(error, Error::Limit(_)), "{error}");
    let message = error.to_string();
    assert!(message.contains("4 bindings of 0.0 MiB"), "{message}");
    assert!(message.contains("--max-texture-size"), "{message}");
}

/// A floor of one-metre squares of radiance 0 and 1 that reaches to the horizon, seen from 1 m
/// above it. Rows below the horizon cover from a fraction of a square to thousands.
#[test]
fn a_distant_checkerboard_has_the_mean_of_its_pixels() {
    const HALF: f32 = 8192.0;
    const SIDE: u32 = 16;
    const SPP: u32 = 1024;
    const YFOV: f64 = PI / 3.0;
    // Level, along a direction that is no axis of the floor.
    let forward = Vec3::new(0.8, 0.0, 0.6);
    let mut stage = Stage::perspective(Vec3::Y, Vec3::Y + forward, YFOV as f32);
    let camera = &mut stage.scene.cameras[0].world_from_camera.matrix3;
    let right = forward.cross(Vec3::Y);
    (camera.x_axis, camera.y_axis, camera.z_axis) =
        (right.into(), Vec3::Y.into(), (-forward).into());
    let code = |c: u8| [c, c, c, 255];
    let rgba = [0, 255, 255, 0].map(code).into();
    stage.scene.images.push(Image { name: "checker".into(), width: 2, height: 2, rgba });
    let glow = Material { emission_texture: Some(texture(0, true)), ..emitter(1.0) };
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]]
        .map(|corner| Vec2::from(corner) * HALF / 2.0);
    let floor = quad_mesh(Vec3::ZERO, Vec3::Z * HALF, Vec3::X * HALF);
    let mesh = stage.mesh(with_uvs(floor, corners), glow);
    stage.place(mesh, Affine3A::IDENTITY);

    let settings = RenderSettings { max_bounces: Some(0), ..settings(SIDE, SIDE, SPP) };
    let film = render(&stage.scene, &settings);
    let picture = film.picture();
    let half_height = (YFOV / 2.0).tan();
    // The radiance in a direction through the picture, by the squares' definition.
    let seen = |x: f64, y: f64| {
        let across = (x / f64::from(SIDE) * 2.0 - 1.0) * half_height;
        let down = (y / f64::from(SIDE) * 2.0 - 1.0) * half_height;
        let at = (forward.as_dvec3() + right.as_dvec3() * across) / down;
        if down <= 0.0 || at.x.abs().max(at.z.abs()) > f64::from(HALF) {
            return 0.0;
        }
        (at.x.floor() + at.z.floor()).rem_euclid(2.0)
    };
    let (mut worst, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
    for y in SIDE / 2..SIDE {
        for x in 0..SIDE {
            const STRATA: u32 = 256;
            let offset = |i: u32| (f64::from(i) + 0.5) / f64::from(STRATA);
            let rows = (0..STRATA).flat_map(|j| (0..STRATA).map(move |i| (i, j)));
            let total: f64 =
                rows.map(|(i, j)| seen(f64::from(x) + offset(i), f64::from(y) + offset(j))).sum();
            let truth = total / f64::from(STRATA * STRATA);
            let mean = f64::from(picture.rgb[(y * SIDE + x) as usize][1]);
            // A pixel's samples are 0 or 1: their mean has at most this deviation. The grid of the
            // truth errs as much as as many samples would, at the horizon.
            let samples = f64::from(SPP);
            let variance = truth * (1.0 - truth) + 1.0 / samples;
            let deviation = (variance * (1.0 / samples + 1.0 / f64::from(STRATA * STRATA))).sqrt();
            let z = (mean - truth) / deviation;
            worst = worst.max(z.abs());
            sum += z;
            count += 1.0;
        }
    }
    println!("largest deviation {worst:.2} of {count} pixels, sum {sum:.1}");
    // 128 pixels: one of them is beyond 5 by chance in 13,000 pictures; their sum is normal too.
    assert!(worst < 5.0, "{worst}");
    assert!((sum / f64::sqrt(count)).abs() < 4.0, "{sum}");
}
