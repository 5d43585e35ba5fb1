//! What the loader makes of texture coordinates, tangents and images.

mod gltf_fixture;

use glam::{Vec2, Vec3, Vec4};
use gltf_fixture::*;
use image::{ImageFormat, RgbaImage};
use serde_json::{Value, json};
use steradian::scene::gltf::LoadOptions;
use steradian::scene::{Image, Scene, Treatment};

/// A material with this base colour texture, which is `image`.
fn with_image(image: &[u8]) -> Fixture {
    let texture = json!({"baseColorTexture": {"index": 0}});
    let mut fixture = Fixture::with_material(json!({"pbrMetallicRoughness": texture}));
    let view = fixture.view(image);
    fixture.push("images", json!({"bufferView": view}));
    fixture.push("textures", json!({"source": 0}));
    fixture
}

fn encoded(image: &RgbaImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// Sixteen different texels.
fn sixteen() -> RgbaImage {
    RgbaImage::from_fn(4, 4, |x, y| image::Rgba([60 * x as u8, 60 * y as u8, 7, 255 - 9 * y as u8]))
}

#[track_caller]
fn assert_texels(image: &Image, expected: &RgbaImage) {
    assert_eq!((image.width, image.height), expected.dimensions());
    assert_eq!(image.rgba, expected.as_raw().as_chunks().0);
}

#[test]
fn any_two_sets_of_texture_coordinates_are_read() {
    let slot = |set: u32| json!({"index": 0, "texCoord": set});
    let mut fixture = Fixture::with_material(json!({
        "pbrMetallicRoughness": {"baseColorTexture": slot(3)}, "emissiveTexture": slot(1),
    }));
    fixture.push("textures", json!({}));
    for set in 1..=3 {
        let uvs = fixture.floats("VEC2", &[set as f32; 6]);
        fixture.attribute(&format!("TEXCOORD_{set}"), uvs);
    }
    let view = fixture.view(&png());
    fixture.push("images", json!({"bufferView": view}));
    fixture.json["textures"] = json!([{"source": 0}]);
    let scene = fixture.scene();
    let material = &scene.materials[0];
    let coordinates = |texture: Option<steradian::scene::TextureRef>| {
        scene.meshes[0].uvs[texture.unwrap().uv_set as usize][0]
    };
    assert_eq!(coordinates(material.base_color_texture), Vec2::splat(3.0));
    assert_eq!(coordinates(material.emission_texture), Vec2::ONE);

    // A third one: the later texture is left out.
    let transmission = json!({"transmissionFactor": 1, "transmissionTexture": slot(0)});
    fixture.json["materials"][0]["extensions"] =
        json!({"KHR_materials_transmission": transmission});
    let scene = fixture.scene();
    assert!(has_notice(&scene, Treatment::Ignored, "third set of texture coordinates"));
    assert!(scene.materials[0].transmission_texture.is_none());
    assert!(scene.materials[0].emission_texture.is_some());
}

/// A square of two triangles that share two vertices, facing +Z, whose u grows with x on the left
/// triangle; `mirrored` turns that round on the right one.
fn normal_mapped(mirrored: bool) -> Fixture {
    let mut fixture = Fixture::with_material(json!({"normalTexture": {"index": 0}}));
    let view = fixture.view(&png());
    fixture.push("images", json!({"bufferView": view}));
    fixture.push("textures", json!({"source": 0}));
    let corners = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    let positions = fixture.floats("VEC3", corners.as_flattened());
    let normals = fixture.floats("VEC3", [[0.0, 0.0, 1.0]; 4].as_flattened());
    let far = if mirrored { -1.0 } else { 1.0 };
    // v grows downwards.
    let uvs = [[0.0, 1.0], [0.0, 0.0], [-1.0, 1.0], [far, 1.0]];
    let uvs = fixture.floats("VEC2", uvs.as_flattened());
    for (name, accessor) in [("POSITION", positions), ("NORMAL", normals), ("TEXCOORD_0", uvs)] {
        fixture.attribute(name, accessor);
    }
    fixture.indices(&[2, 0, 1, 0, 3, 1]);
    fixture
}

/// Tangents of the corners of each triangle.
fn tangents(scene: &Scene) -> Vec<[Vec4; 3]> {
    let mesh = &scene.meshes[0];
    let of = |corners: &[u32; 3]| corners.map(|i| mesh.tangents[i as usize]);
    mesh.triangles.iter().map(of).collect()
}

#[test]
fn tangents_point_along_u_with_the_bitangent_up_in_the_image() {
    let scene = normal_mapped(false).scene();
    assert_eq!(scene.meshes[0].positions.len(), 4, "nothing to split");
    for tangent in tangents(&scene).as_flattened() {
        // cross(+Z, +X) = +Y, which is up in the image.
        assert!(tangent.distance(Vec4::new(1.0, 0.0, 0.0, 1.0)) < 1e-6, "{tangent}");
    }
}

#[test]
fn vertices_split_where_the_coordinates_are_mirrored() {
    let scene = normal_mapped(true).scene();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions.len(), 6, "the two shared vertices have two tangents each");
    assert_eq!((mesh.normals.len(), mesh.uvs[0].len()), (6, 6));
    let expected = [Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::new(-1.0, 0.0, 0.0, -1.0)];
    for (corners, expected) in tangents(&scene).iter().zip(expected) {
        for tangent in corners {
            assert!(tangent.distance(expected) < 1e-6, "{tangent}");
        }
    }
    // The corners stay where they were.
    let at = |t: usize| mesh.triangles[t].map(|i| mesh.positions[i as usize]);
    assert_eq!(at(0), [Vec3::NEG_X, Vec3::ZERO, Vec3::Y]);
    assert_eq!(at(1), [Vec3::ZERO, Vec3::X, Vec3::Y]);
}

#[test]
fn tangents_turn_with_the_texture() {
    let mut fixture = normal_mapped(false);
    let transform = json!({"rotation": std::f32::consts::FRAC_PI_2});
    fixture.json["materials"][0]["normalTexture"]["extensions"] =
        json!({"KHR_texture_transform": transform});
    // A quarter turn counter-clockwise of the coordinates takes (u, v) to (v, -u): the image's u
    // grows downwards on the square.
    for tangent in tangents(&fixture.scene()).as_flattened() {
        assert!(tangent.distance(Vec4::new(0.0, -1.0, 0.0, 1.0)) < 1e-6, "{tangent}");
    }
}

#[test]
fn flat_faces_have_tangents_too_and_the_files_are_ignored_there() {
    let mut fixture = normal_mapped(false);
    let wrong = fixture.floats("VEC4", [[0.0, 0.0, 1.0, 1.0]; 4].as_flattened());
    fixture.attribute("TANGENT", wrong);
    fixture.primitive()["attributes"].as_object_mut().unwrap().remove("NORMAL");
    let scene = fixture.scene();
    assert!(scene.meshes[0].normals.is_empty());
    for tangent in tangents(&scene).as_flattened() {
        assert!(tangent.distance(Vec4::new(1.0, 0.0, 0.0, 1.0)) < 1e-6, "{tangent}");
    }
}

#[test]
fn coordinates_without_area_have_arbitrary_tangents_and_a_notice() {
    let mut fixture = normal_mapped(false);
    let uvs = fixture.floats("VEC2", &[0.5; 8]);
    fixture.attribute("TEXCOORD_0", uvs);
    let scene = fixture.scene();
    assert!(has_notice(&scene, Treatment::Approximated, "have no area"));
    for tangent in tangents(&scene).as_flattened() {
        assert!(tangent.truncate().is_normalized() && tangent.w.abs() == 1.0);
    }
    // Numbers whose products overflow are no directions either.
    let uvs = fixture.floats("VEC2", &[0.0, 3e38, -3e38, 0.0, 3e38, -3e38, 0.0, 1e-38]);
    fixture.attribute("TEXCOORD_0", uvs);
    assert!(tangents(&fixture.scene()).as_flattened().iter().all(|t| t.is_finite()));
}

#[test]
fn a_material_without_normal_maps_brings_no_tangents() {
    let mut fixture = normal_mapped(false);
    fixture.json["materials"][0] = json!({"extensions": {"KHR_materials_anisotropy": {}}});
    assert!(fixture.scene().meshes[0].tangents.is_empty());
    fixture.json["materials"][0]["extensions"]["KHR_materials_anisotropy"] =
        json!({"anisotropyStrength": 1});
    assert_eq!(fixture.scene().meshes[0].tangents.len(), 4);
}

#[test]
fn lossless_formats_give_their_texels() {
    let texels = sixteen();
    for format in [ImageFormat::Png, ImageFormat::WebP] {
        assert_texels(&with_image(&encoded(&texels, format)).scene().images[0], &texels);
    }
    let wide = image::DynamicImage::from(texels.clone()).into_rgba16();
    let mut bytes = std::io::Cursor::new(Vec::new());
    wide.write_to(&mut bytes, ImageFormat::Png).unwrap();
    let scene = with_image(&bytes.into_inner()).scene();
    assert!(has_notice(&scene, Treatment::Approximated, "16 bits"));
    assert_texels(&scene.images[0], &texels);
}

#[test]
fn jpeg_gives_its_colours_nearly() {
    let grey = image::RgbImage::from_pixel(8, 8, image::Rgb([90, 120, 30]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    grey.write_to(&mut bytes, ImageFormat::Jpeg).unwrap();
    let [r, g, b, a] = with_image(&bytes.into_inner()).scene().images[0].rgba[0];
    // One even colour: only its conversion to YCbCr is rounded.
    assert!(r.abs_diff(90) <= 2 && g.abs_diff(120) <= 2 && b.abs_diff(30) <= 2 && a == 255);
}

#[test]
fn many_images_keep_their_order() {
    let mut fixture = with_image(&png());
    fixture.json["textures"] = json!([]);
    fixture.json["images"] = json!([]);
    fixture.json["materials"] = json!([]);
    for number in 0..20_u8 {
        let pixel = RgbaImage::from_pixel(1, 1, image::Rgba([number; 4]));
        let view = fixture.view(&encoded(&pixel, ImageFormat::Png));
        let image = fixture.push("images", json!({"bufferView": view}));
        let texture = fixture.push("textures", json!({"source": image}));
        fixture.push("materials", json!({"emissiveTexture": {"index": texture}}));
    }
    let scene = fixture.scene();
    for (number, material) in scene.materials.iter().enumerate() {
        let image = material.emission_texture.unwrap().image as usize;
        assert_eq!(scene.images[image].rgba, [[number as u8; 4]]);
    }
    // The first image at fault is named, whatever is decoded first.
    let broken = fixture.view(&png()[..40]);
    fixture.json["images"][3]["bufferView"] = json!(broken);
    fixture.json["images"][17]["bufferView"] = json!(broken);
    assert_contains(&fixture.refusal(), "image 3: ");
}

#[test]
fn an_extensions_image_comes_before_the_plain_one() {
    let texels = sixteen();
    let mut fixture = with_image(&png());
    let view = fixture.view(&encoded(&texels, ImageFormat::WebP));
    fixture.push("images", json!({"bufferView": view, "mimeType": "image/webp"}));
    let extension = json!({"EXT_texture_webp": {"source": 1}});
    fixture.json["textures"][0]["extensions"] = extension;
    fixture.json["extensionsRequired"] = json!(["EXT_texture_webp"]);
    let scene = fixture.scene();
    assert!(has_notice(&scene, Treatment::Honoured, "EXT_texture_webp"));
    assert_texels(&scene.images[0], &texels);
    fixture.json["textures"][0].as_object_mut().unwrap().remove("source");
    assert_texels(&fixture.scene().images[0], &texels);
    fixture.json["textures"][0]["extensions"]["EXT_texture_webp"] = json!({"source": "x"});
    assert_contains(&fixture.refusal(), "EXT_texture_webp.source must be an index");
}

#[test]
fn large_images_are_brought_down_where_that_is_asked_for() {
    let texels = RgbaImage::from_fn(8, 4, |x, _| image::Rgba([255 * (x % 2) as u8; 4]));
    let fixture = with_image(&encoded(&texels, ImageFormat::Png));
    let options = |size| LoadOptions { max_texture_size: Some(size), ..LoadOptions::default() };
    let scene = fixture.load_with(&options(4)).unwrap();
    assert!(has_notice(&scene, Treatment::Approximated, "larger than 4 texels a side"));
    let image = &scene.images[0];
    // Half of the light, half of the alpha.
    assert_eq!(
        (image.width, image.height, &image.rgba[..]),
        (4, 2, &[[188, 188, 188, 128]; 8][..])
    );
    let whole = fixture.load_with(&options(8)).unwrap();
    assert!(!has_notice(&whole, Treatment::Approximated, "texels a side"));
    assert_texels(&whole.images[0], &texels);
}

/// A KTX2 of one level: `format` by Vulkan's numbers, `model` and the channel of its descriptor.
fn ktx2(
    size: [u32; 2],
    format: u32,
    scheme: u32,
    model: u8,
    level: &[u8],
    plain: usize,
) -> Vec<u8> {
    let sample: [u32; 4] = [if model == 166 { 127 << 16 } else { 7 << 16 }, 0, 0, 255];
    let descriptor_words = [
        44_u32,
        0,
        2 | 40 << 16,
        u32::from(model) | 1 << 8 | 1 << 16,
        if model == 166 { 3 | 3 << 8 } else { 0 },
        if model == 166 { 16 } else { 4 },
        0,
    ];
    let descriptor: Vec<u32> = descriptor_words.into_iter().chain(sample).collect();
    let begin = 104 + 44_u32;
    let level_begin = begin.next_multiple_of(16);
    let mut bytes = vec![0xAB];
    bytes.extend(b"KTX 20\xBB\r\n\x1A\n");
    let header = [format, 1, size[0], size[1], 0, 0, 1, 1, scheme, 104, 44, 0, 0, 0, 0, 0, 0];
    for word in header {
        bytes.extend(word.to_le_bytes());
    }
    for long in [u64::from(level_begin), level.len() as u64, plain as u64] {
        bytes.extend(long.to_le_bytes());
    }
    for word in descriptor {
        bytes.extend(word.to_le_bytes());
    }
    bytes.resize(level_begin as usize, 0);
    bytes.extend(level);
    bytes
}

const RGBA8_UNORM: u32 = 37;
const BGRA8_SRGB: u32 = 50;
const ZSTANDARD: u32 = 2;
const ZLIB: u32 = 3;
const RGB_MODEL: u8 = 1;
const UASTC_MODEL: u8 = 166;

/// A Zstandard frame that holds `bytes`, uncompressed (RFC 8878: a raw block).
fn zstandard(bytes: &[u8]) -> Vec<u8> {
    let mut frame = vec![0x28, 0xB5, 0x2F, 0xFD, 0x20, bytes.len() as u8];
    frame.extend(&((bytes.len() as u32) << 3 | 1).to_le_bytes()[..3]);
    frame.extend(bytes);
    frame
}

#[test]
fn ktx2_gives_its_texels_plain_and_compressed() {
    let texels = sixteen();
    let raw = texels.as_raw();
    let zlib = miniz_oxide::deflate::compress_to_vec_zlib(raw, 6);
    let swapped: Vec<u8> =
        raw.as_chunks::<4>().0.iter().flat_map(|&[r, g, b, a]| [b, g, r, a]).collect();
    for (format, scheme, level) in [
        (RGBA8_UNORM, 0, raw.clone()),
        (BGRA8_SRGB, 0, swapped),
        (RGBA8_UNORM, ZSTANDARD, zstandard(raw)),
        (RGBA8_UNORM, ZLIB, zlib),
    ] {
        let file = ktx2([4, 4], format, scheme, RGB_MODEL, &level, 64);
        assert_texels(&with_image(&file).scene().images[0], &texels);
        // Too little and too much of it.
        let file = ktx2([5, 4], format, scheme, RGB_MODEL, &level, 80);
        assert_contains(&with_image(&file).refusal(), "image 0: KTX2");
        let file = ktx2([4, 3], format, scheme, RGB_MODEL, &level, 48);
        assert_contains(&with_image(&file).refusal(), "image 0: KTX2");
    }
    let file = ktx2([4, 4], 131, 0, RGB_MODEL, raw, 64);
    assert_contains(&with_image(&file).refusal(), "BC1_RGB_UNORM_BLOCK, which is not read");
    let file = ktx2([1 << 20, 4], RGBA8_UNORM, 0, RGB_MODEL, raw, 64);
    assert_contains(&with_image(&file).refusal(), "the limit is 32768 a side");
}

/// Every beginning of such a file, and every byte of its header changed: an answer, no panic.
#[test]
fn damaged_ktx2_is_refused_or_read() {
    let whole = ktx2([4, 4], RGBA8_UNORM, ZSTANDARD, RGB_MODEL, &zstandard(sixteen().as_raw()), 64);
    let mut refused = 0;
    for length in 12..whole.len() {
        refused += usize::from(with_image(&whole[..length]).load().is_err());
    }
    assert_eq!(refused, whole.len() - 12);
    for model in [RGB_MODEL, UASTC_MODEL] {
        let whole = ktx2([4, 4], 0, 0, model, &[0; 16], 16);
        for at in 12..whole.len() {
            for change in [1, 0x80, 0xFF] {
                let mut damaged = whole.clone();
                damaged[at] ^= change;
                let _ = with_image(&damaged).load();
            }
        }
    }
}

/// One block of UASTC, whose mode for a single colour is 5 bits and 8 for each channel.
fn uastc_block(color: [u8; 4]) -> [u8; 16] {
    const SOLID_COLOR_MODE: u128 = 0b10111;
    let bits = SOLID_COLOR_MODE | u128::from(u32::from_le_bytes(color)) << 5;
    bits.to_le_bytes()
}

#[cfg(feature = "basis")]
#[test]
fn basis_textures_are_transcoded() {
    let color = [200, 30, 90, 128];
    let block = uastc_block(color);
    let expected = RgbaImage::from_pixel(4, 4, image::Rgba(color));
    for (scheme, level) in [(0, block.to_vec()), (ZSTANDARD, zstandard(&block))] {
        let mut fixture = with_image(&png());
        let view = fixture.view(&ktx2([4, 4], 0, scheme, UASTC_MODEL, &level, 16));
        fixture.push("images", json!({"bufferView": view, "mimeType": "image/ktx2"}));
        let extension: Value = json!({"KHR_texture_basisu": {"source": 1}});
        fixture.json["textures"][0]["extensions"] = extension;
        let scene = fixture.scene();
        assert!(has_notice(&scene, Treatment::Honoured, "KHR_texture_basisu"));
        assert_texels(&scene.images[0], &expected);
    }
}

#[cfg(not(feature = "basis"))]
#[test]
fn basis_textures_name_the_feature_that_they_need() {
    let block = uastc_block([200, 30, 90, 128]);
    let file = ktx2([4, 4], 0, 0, UASTC_MODEL, &block, 16);
    assert_contains(&with_image(&file).refusal(), "cargo feature `basis`");
    let mut fixture = with_image(&png());
    let view = fixture.view(&file);
    fixture.push("images", json!({"bufferView": view, "mimeType": "image/ktx2"}));
    let extension: Value = json!({"KHR_texture_basisu": {"source": 1}});
    fixture.json["textures"][0]["extensions"] = extension;
    let scene = fixture.scene();
    assert!(has_notice(&scene, Treatment::Approximated, "the texture's plain image is used"));
    fixture.json["extensionsRequired"] = json!(["KHR_texture_basisu"]);
    assert_contains(&fixture.refusal(), "cargo feature `basis`");
}
