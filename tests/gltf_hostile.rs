//! Files made to exhaust memory or time: each is refused, or read, with a bounded peak of
//! memory. One test, because the peak is that of the whole program.

mod gltf_fixture;

use gltf_fixture::*;
use peak_alloc::PeakAlloc;
use serde_json::{Value, json};
use std::path::Path;
use steradian::scene::Environment;
use steradian::scene::gltf::{LoadOptions, load_bytes};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// What SECURITY.md promises for a file whose own size does not matter, bytes.
const MOST_MEMORY: usize = 1 << 30;

/// Runs `load` on input that is refused with `expected`, if there is one, and checks the
/// peak of memory, that of the input itself included.
#[track_caller]
fn bounded(what: &str, expected: Option<&str>, load: impl FnOnce() -> Result<(), String>) {
    MEMORY.reset_peak_usage();
    let start = std::time::Instant::now();
    let outcome = load();
    let peak = MEMORY.peak_usage();
    println!("{what}: {} MiB, {:.1} s", peak >> 20, start.elapsed().as_secs_f64());
    match expected {
        Some(expected) => assert_contains(&outcome.expect_err(what), expected),
        None => outcome.unwrap(),
    }
    assert!(peak <= MOST_MEMORY, "{what}: {peak} bytes");
}

fn load(bytes: &[u8]) -> Result<(), String> {
    load_bytes(Path::new("hostile.gltf"), None, bytes, &LoadOptions::default())
        .map(drop)
        .map_err(|e| e.to_string())
}

/// A text with a list of `item`, `count` times.
fn list(name: &str, item: &str, count: usize) -> Vec<u8> {
    let items = vec![item; count].join(",");
    format!(r#"{{"asset":{{"version":"2.0"}},"{name}":[{items}]}}"#).into_bytes()
}

/// A PNG of zeros: width and height, bits, colour type, bytes of a row.
fn flat_png(width: u32, height: u32, bits: u8, color: u8, row: usize) -> Vec<u8> {
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = |kind: &[u8; 4], data: &[u8]| {
        bytes.extend((data.len() as u32).to_be_bytes());
        let start = bytes.len();
        bytes.extend(kind);
        bytes.extend(data);
        let crc = crc32(&bytes[start..]);
        bytes.extend(crc.to_be_bytes());
    };
    let size = [width.to_be_bytes(), height.to_be_bytes()].concat();
    chunk(b"IHDR", &[&size[..], &[bits, color, 0, 0, 0]].concat());
    let rows = vec![0; (row + 1) * height as usize];
    chunk(b"IDAT", &miniz_oxide::deflate::compress_to_vec_zlib(&rows, 6));
    chunk(b"IEND", &[]);
    bytes
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            (crc >> 1) ^ (0xedb8_8320 & 0u32.wrapping_sub(crc & 1))
        })
    })
}

#[test]
fn memory_is_bounded() {
    json_of_many_values();
    data_that_is_read_again_and_again();
    images_larger_than_their_files();
    environments_larger_than_their_files();
}

fn json_of_many_values() {
    let limit = Some("of memory; the limit is");
    // Just above a power of two, where lists have grown last.
    let items = [
        ("nodes", "{}"),
        ("nodes", r#"{"mesh":0}"#),
        ("materials", "{}"),
        ("meshes", r#"{"primitives":[]}"#),
    ];
    for (name, item) in items {
        let few = list(name, item, (1 << 19) + 1);
        bounded(item, None, || load(&few).or(Ok(())));
        let many = list(name, item, 1 << 20);
        bounded(item, limit, || load(&many));
    }
    bounded("materials", Some("nothing to render"), || load(&list("materials", "{}", 1 << 16)));
    let many = Some("65537 materials; the limit is 65536");
    bounded("materials", many, || load(&list("materials", "{}", (1 << 16) + 1)));
    bounded("lists", limit, || load(&list("extras", "[]", 16_000_000)));
    let numbers = Some("nothing to render");
    bounded("numbers", numbers, || load(&list("extras", "0", 6_000_000)));
    let text = format!(r#"{{"asset":{{"version":"2.0","copyright":"{}"}}}}"#, "x".repeat(64 << 20));
    bounded("a long string", Some("nothing to render"), || load(text.as_bytes()));
    let deep = [b"{\"asset\":".repeat(100_000), b"1".to_vec(), b"}".repeat(100_000)].concat();
    bounded("nested objects", Some("recursion limit"), || load(&deep));
    let names: Vec<String> = (0..100_000).map(|i| format!(r#""EXT_{i}":{{}}"#)).collect();
    let names = format!(r#"{{"asset":{{"version":"2.0"}},"extensions":{{{}}}}}"#, names.join(","));
    bounded("names", Some("nothing to render"), || load(names.as_bytes()));
}

fn data_that_is_read_again_and_again() {
    // 64 KiB of indices, for thousands of primitives.
    let mut fixture = Fixture::triangle();
    let strip = vec![0; 1 << 16];
    let indices = fixture.accessor(UNSIGNED_BYTE, "SCALAR", strip.len(), &strip);
    fixture.primitive()["indices"] = json!(indices);
    fixture.primitive()["mode"] = json!(5);
    let one = fixture.primitive().clone();
    let repeat = |fixture: &mut Fixture, one: &Value, count: usize| {
        fixture.json["meshes"][0]["primitives"] = vec![one.clone(); count].into();
        fixture.glb()
    };
    let glb = repeat(&mut fixture, &one, 10_000);
    bounded("a strip in 10,000 primitives", Some("triangles; the limit is 4194304"), || load(&glb));

    let mut fixture = Fixture::triangle();
    let zeros = json!({"componentType": FLOAT, "type": "VEC4", "count": 1 << 20});
    let zeros = fixture.push("accessors", zeros);
    fixture.attribute("TANGENT", zeros);
    fixture.json["accessors"][0] =
        json!({"componentType": FLOAT, "type": "VEC3", "count": 1 << 20});
    let one = fixture.primitive().clone();
    let glb = repeat(&mut fixture, &one, 1000);
    bounded("zeros in 1000 primitives", Some("; the limit is "), || load(&glb));

    // Placements: primitives times nodes.
    let mut fixture = Fixture::triangle();
    let one = fixture.primitive().clone();
    for _ in 0..2000 {
        fixture.node(json!({"mesh": 0}));
    }
    let glb = repeat(&mut fixture, &one, 2000);
    bounded("2000 nodes of 2000 primitives", Some("the limit is 1048576"), || load(&glb));
}

fn images_larger_than_their_files() {
    let with_images = |images: &[Vec<u8>]| {
        let mut fixture = Fixture::with_material(json!({}));
        for (i, image) in images.iter().enumerate() {
            let view = fixture.view(image);
            fixture.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
            fixture.push("textures", json!({"source": i}));
            let texture = json!({"baseColorTexture": {"index": i}});
            fixture.push("materials", json!({"pbrMetallicRoughness": texture}));
        }
        fixture.glb()
    };
    // What the sizes in the headers come to, before anything is decoded.
    let header = |width: u32, height: u32| {
        let mut png = flat_png(1, 1, 8, 0, 1);
        png[16..24].copy_from_slice(&[width.to_be_bytes(), height.to_be_bytes()].concat());
        let crc = crc32(&png[12..29]);
        png[29..33].copy_from_slice(&crc.to_be_bytes());
        png
    };
    let glb = with_images(&[header(60_000, 60_000)]);
    bounded("a header of 60,000 x 60,000", Some("image 0: "), || load(&glb));
    let glb = with_images(&[header(16_384, 16_385)]);
    bounded("a header of 2^28 pixels and more", Some("image 0: "), || load(&glb));
    // 8 KiB of file for 256 MiB of picture, within the limits.
    let glb = with_images(&[flat_png(8192, 8192, 1, 0, 1024)]);
    bounded("a flat picture of 2^26 pixels", None, || load(&glb));
}

fn environments_larger_than_their_files() {
    let load = |bytes: &[u8]| {
        Environment::from_bytes(Path::new("sky"), bytes).map(drop).map_err(|e| e.to_string())
    };
    let hdr = |size: &str| format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{size}\n").into_bytes();
    bounded("a map beyond the limit", Some("the limit is"), || load(&hdr("-Y 60000 +X 60000")));
    bounded("a map of 2^32 squared", Some("sky: "), || load(&hdr("-Y 4294967295 +X 4294967295")));
    bounded("a cut map", Some("sky: "), || load(&hdr("-Y 8192 +X 16384")));
}
