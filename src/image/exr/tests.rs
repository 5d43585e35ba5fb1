use super::*;

/// Values whose bits are easily lost: signed zero, denormal, limits, odd bits.
const ODD: [f32; 6] = [-0.0, 1e-45, f32::MAX, -3.402_823e38, 0.1, f32::from_bits(0x3f80_0001)];

/// A crop of 3x2 pixels at (4, 1) in a picture of 9x5 with two more layers.
fn sample() -> ExrImage {
    let rgb = (0..6).map(|i| [ODD[i], ODD[(i + 1) % 6], ODD[(i + 2) % 6]]).collect();
    let window = Crop { x: 4, y: 1, width: 3, height: 2 };
    let mut image = ExrImage::from_crop(&Picture::new(3, 2, rgb), (9, 5), window);
    let variance = ODD.iter().map(|v| v.abs()).collect();
    image.layers.push(Layer {
        name: "film".into(),
        channels: vec![
            ("count".into(), ChannelData::U32(vec![0, 1, 16_777_217, u32::MAX, 5, 6])),
            ("variance".into(), ChannelData::F32(variance)),
        ],
    });
    let depth = ChannelData::F32(vec![1.0, f32::INFINITY, f32::NEG_INFINITY, 2.5, 3.0, 4.0]);
    image.layers.push(Layer { name: "surface.first".into(), channels: vec![("Z".into(), depth)] });
    for (name, value) in [
        ("steradian.seed", Attribute::Number(f64::from(u32::MAX))),
        ("steradian.scene", Attribute::Text("größer".into())),
        ("steradian.spp", Attribute::Number(64.0)),
        ("steradian.a_name_longer_than_the_31_bytes_of_old", Attribute::Number(0.1)),
        ("steradian.device", Attribute::Text("llvmpipe".into())),
    ] {
        image.metadata.insert(name.into(), value);
    }
    image
}

/// Equality of bits: `==` takes 0 for -0.
fn bits(image: &ExrImage) -> Vec<(String, Vec<u32>)> {
    let mut all = Vec::new();
    for layer in &image.layers {
        for (name, data) in &layer.channels {
            let values = match data {
                ChannelData::F32(values) => values.iter().map(|v| v.to_bits()).collect(),
                ChannelData::U32(values) => values.clone(),
            };
            all.push((full_name(&layer.name, name), values));
        }
    }
    all.sort();
    all
}

#[test]
fn everything_survives_the_round_trip_bit_by_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let image = sample();
    write_exr(&path, &image, Precision::Float).unwrap();
    let back = read_exr(&path).unwrap();
    assert_eq!(bits(&back), bits(&image));
    assert_eq!(back.resolution, (9, 5));
    assert_eq!(back.window, image.window);
    assert_eq!(back.metadata, image.metadata);
    assert_eq!(back.picture(), image.picture());
    let Some(ChannelData::U32(counts)) = back.channel("film", "count") else { panic!() };
    assert_eq!(counts[2], 16_777_217);
    assert!(back.channel("surface.first", "Z").is_some());
    assert!(back.channel("surface", "Z").is_none());
}

#[test]
fn a_nan_keeps_its_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let nan = f32::from_bits(0x7fc0_1234);
    let image = ExrImage::from_picture(&Picture::new(1, 1, vec![[nan, 0.0, 1.0]]));
    write_exr(&path, &image, Precision::Float).unwrap();
    assert_eq!(bits(&read_exr(&path).unwrap()), bits(&image));
}

#[test]
fn equal_images_give_equal_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let write = || {
        write_exr(&path, &sample(), Precision::Float).unwrap();
        std::fs::read(&path).unwrap()
    };
    let first = write();
    // The library's hash map has five entries of ours, in a new order each time.
    for _ in 0..8 {
        assert!(write() == first);
    }
}

#[test]
fn half_rounds_the_picture_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let mut image = sample();
    let picture = Picture::new(3, 2, vec![[0.1, -0.0, 65504.0]; 6]);
    image.layers[0] = ExrImage::from_picture(&picture).layers.remove(0);
    write_exr(&path, &image, Precision::Half).unwrap();
    let back = read_exr(&path).unwrap();
    // 0.1 = 1.6 × 2^-4; 1.6 × 2^10 = 1638.4 rounds to 1638.
    assert_eq!(back.picture().unwrap().rgb[5], [1638.0 / 16384.0, 0.0, 65504.0]);
    assert_eq!(bits(&back)[3..], bits(&image)[3..]);

    image.layers[0].channels[1].1 = ChannelData::F32(vec![65520.0; 6]);
    let message = write_exr(&path, &image, Precision::Half).unwrap_err().to_string();
    assert!(message.contains("channel G holds 65520"), "{message}");
}

#[test]
fn the_file_says_which_primaries_its_colours_have() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    write_exr(&path, &sample(), Precision::Float).unwrap();
    let meta = ::exr::meta::MetaData::read_from_file(&path, true).unwrap();
    assert_eq!(meta.headers[0].shared_attributes.chromaticities, Some(REC_709));
    assert_eq!(meta.headers[0].compression, ::exr::prelude::Compression::ZIP16);
}

#[test]
fn what_cannot_be_stored_is_refused_and_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let refused = |change: &dyn Fn(&mut ExrImage), says: &str| {
        let mut image = sample();
        change(&mut image);
        let message = write_exr(&path, &image, Precision::Float).unwrap_err().to_string();
        assert!(message.contains(says), "{message}");
        assert!(!path.exists());
    };
    refused(&|i| i.window.x = 7, "does not lie in 9x5");
    refused(&|i| i.window.y = u32::MAX, "does not lie in 9x5");
    refused(&|i| i.window.width = 0, "does not lie in 9x5");
    refused(
        &|i| i.layers[1].channels[0].1 = ChannelData::U32(vec![1; 5]),
        "film.count has 5 values for 6 pixels",
    );
    let twice = |i: &mut ExrImage| {
        let channel = i.layers[0].channels[0].clone();
        i.layers[0].channels.push(channel);
    };
    refused(&twice, "not unique");
    let reserved = |i: &mut ExrImage| {
        i.metadata.insert("compression".into(), Attribute::Number(1.0));
    };
    refused(&reserved, "compression");
}

#[test]
fn damaged_files_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    assert!(matches!(read_exr(&path), Err(Error::Io { .. })));
    write_exr(&path, &sample(), Precision::Float).unwrap();
    let whole = std::fs::read(&path).unwrap();
    for length in 0..whole.len() {
        std::fs::write(&path, &whole[..length]).unwrap();
        assert!(matches!(read_exr(&path), Err(Error::Io { .. })), "{length} bytes");
    }
}

/// The picture of 7 by 40 pixels whose layers are numbered pixels, from a row of the window on.
fn numbered(window: Crop) -> Vec<Layer> {
    let pixels = (window.y - 2) * 7..(window.y - 2 + window.height) * 7;
    let floats = |scale: f32| ChannelData::F32(pixels.clone().map(|i| i as f32 * scale).collect());
    let colors = ["R", "G", "B"].map(|name| (name.to_owned(), floats(0.1)));
    let main = Layer { name: String::new(), channels: colors.into() };
    let id = Layer {
        name: "id".into(),
        channels: vec![("object".into(), ChannelData::U32(pixels.clone().collect()))],
    };
    vec![main, id]
}

#[test]
fn bands_give_the_file_of_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let (path, whole) = (folder.path().join("a.exr"), folder.path().join("b.exr"));
    let window = Crop { x: 1, y: 2, width: 7, height: 40 };
    let (resolution, metadata) = ((9, 50), sample().metadata);
    let image =
        ExrImage { resolution, window, layers: numbered(window), metadata: metadata.clone() };
    for precision in [Precision::Float, Precision::Half] {
        write_exr(&whole, &image, precision).unwrap();
        let header = ExrHeader { resolution, window, metadata: metadata.clone(), precision };
        for band_rows in [1, 16, 17, 32, 1000] {
            let mut rows = Vec::new();
            write_exr_bands(&path, &header, band_rows, |band| {
                rows.push((band.y, band.height));
                Ok(numbered(band))
            })
            .unwrap();
            assert!(std::fs::read(&path).unwrap() == std::fs::read(&whole).unwrap(), "{band_rows}");
            assert_eq!(rows.iter().map(|(_, height)| height).sum::<u32>(), 40);
            assert_eq!(rows.len() as u32, 40_u32.div_ceil(band_rows.next_multiple_of(16)));
        }
    }
}

#[test]
fn a_band_that_fails_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let header = ExrHeader {
        resolution: (9, 50),
        window: Crop { x: 1, y: 2, width: 7, height: 40 },
        metadata: BTreeMap::new(),
        precision: Precision::Float,
    };
    let write = |spoil: &dyn Fn(Vec<Layer>) -> Result<Vec<Layer>>| {
        let rows =
            |band: Crop| if band.y > 20 { spoil(numbered(band)) } else { Ok(numbered(band)) };
        let message = write_exr_bands(&path, &header, 16, rows).unwrap_err().to_string();
        assert!(std::fs::read_dir(folder.path()).unwrap().next().is_none());
        message
    };
    assert_eq!(write(&|_| Err(Error::DeviceLost("gone".into()))), "gone");
    let message = write(&|layers| Ok(layers[..1].to_vec()));
    assert!(message.contains("3 channels in a band, 4 in the first"), "{message}");
    let renamed = |mut layers: Vec<Layer>| {
        layers[1].name = "it".into();
        Ok(layers)
    };
    let message = write(&renamed);
    assert!(message.contains("id.object has 0 values for"), "{message}");
}

#[test]
fn standard_attributes_have_their_types() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let mut image = sample();
    let m = std::array::from_fn(|i| i as f32);
    for (name, value) in [
        ("worldToCamera", Attribute::Matrix(m)),
        ("worldToNDC", Attribute::Matrix(m.map(|v| -v))),
        ("samplesPerPixel", Attribute::Integer(64)),
        ("renderTimeSeconds", Attribute::Single(0.1)),
    ] {
        image.metadata.insert(name.into(), value);
    }
    write_exr(&path, &image, Precision::Float).unwrap();
    assert_eq!(read_exr(&path).unwrap().metadata, image.metadata);
    let meta = ::exr::meta::MetaData::read_from_file(&path, true).unwrap();
    assert_eq!(meta.headers[0].own_attributes.world_to_camera, Some(m));
}
