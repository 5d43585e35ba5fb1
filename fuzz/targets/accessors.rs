//! Accessors, bufferViews and sparse replacements with any numbers, over any buffer.

#![no_main]

use arbitrary::{Arbitrary, Unstructured};
use libfuzzer_sys::fuzz_target;
use serde_json::{Value, json};
use steradian_fuzz::{glb, load};

/// A number that is mostly small, so that something fits, and sometimes far out.
#[derive(Debug)]
struct Number(u64);

impl<'a> Arbitrary<'a> for Number {
    fn arbitrary(u: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        Ok(Self(match u8::arbitrary(u)? {
            0..=5 => u64::arbitrary(u)?,
            6..=20 => u32::arbitrary(u)?.into(),
            21..=40 => u16::arbitrary(u)?.into(),
            small => (small - 41).into(),
        }))
    }
}

#[derive(Debug, Arbitrary)]
struct View {
    offset: Option<Number>,
    length: Number,
    stride: Option<Number>,
}

#[derive(Debug, Arbitrary)]
struct Sparse {
    count: Number,
    index_view: u8,
    index_offset: Option<Number>,
    index_component: u8,
    value_view: u8,
    value_offset: Option<Number>,
}

#[derive(Debug, Arbitrary)]
struct Accessor {
    view: Option<u8>,
    offset: Option<Number>,
    component: u8,
    kind: u8,
    count: Number,
    normalized: bool,
    sparse: Option<Sparse>,
}

#[derive(Debug, Arbitrary)]
struct Input {
    views: Vec<View>,
    accessors: Vec<Accessor>,
    /// Accessors of the attributes in [`ATTRIBUTES`].
    attributes: [Option<u8>; ATTRIBUTES.len()],
    indices: Option<u8>,
    mode: u8,
    /// Accessors of a morph target's positions and normals.
    target: Option<[u8; 2]>,
    buffer: Vec<u8>,
}

const ATTRIBUTES: [&str; 8] =
    ["POSITION", "NORMAL", "TANGENT", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0", "JOINTS_0", "WEIGHTS_0"];
const COMPONENTS: [u32; 7] = [5126, 5120, 5121, 5122, 5123, 5125, 5124];
const KINDS: [&str; 7] = ["VEC3", "VEC2", "VEC4", "SCALAR", "MAT2", "MAT3", "MAT4"];

fn pick<T: Copy>(list: &[T], index: u8) -> T {
    list[index as usize % list.len()]
}

fn object(members: Vec<(&str, Option<Value>)>) -> Value {
    members.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))).collect()
}

fn number(number: &Option<Number>) -> Option<Value> {
    number.as_ref().map(|number| json!(number.0))
}

fn accessor(accessor: &Accessor) -> Value {
    let sparse = accessor.sparse.as_ref().map(|sparse| {
        json!({
            "count": sparse.count.0,
            "indices": object(vec![
                ("bufferView", Some(json!(sparse.index_view % 8))),
                ("byteOffset", number(&sparse.index_offset)),
                ("componentType", Some(json!(pick(&COMPONENTS, sparse.index_component)))),
            ]),
            "values": object(vec![
                ("bufferView", Some(json!(sparse.value_view % 8))),
                ("byteOffset", number(&sparse.value_offset)),
            ]),
        })
    });
    object(vec![
        ("bufferView", accessor.view.map(|view| json!(view % 8))),
        ("byteOffset", number(&accessor.offset)),
        ("componentType", Some(json!(pick(&COMPONENTS, accessor.component)))),
        ("type", Some(json!(pick(&KINDS, accessor.kind)))),
        ("count", Some(json!(accessor.count.0))),
        ("normalized", accessor.normalized.then_some(json!(true))),
        ("sparse", sparse),
    ])
}

fn scene(input: &Input) -> Value {
    let views: Vec<Value> = (input.views.iter())
        .map(|view| {
            object(vec![
                ("buffer", Some(json!(0))),
                ("byteOffset", number(&view.offset)),
                ("byteLength", Some(json!(view.length.0))),
                ("byteStride", number(&view.stride)),
            ])
        })
        .collect();
    let attributes = ATTRIBUTES.iter().zip(&input.attributes);
    let attributes = attributes.map(|(name, index)| (*name, index.map(|index| json!(index % 8))));
    let targets = input.target.map(|[p, n]| json!([{"POSITION": p % 8, "NORMAL": n % 8}]));
    let primitive = object(vec![
        ("attributes", Some(object(attributes.collect()))),
        ("indices", input.indices.map(|index| json!(index % 8))),
        ("mode", Some(json!((input.mode % 8) ^ 4))),
        ("targets", targets),
    ]);
    json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}], "meshes": [{"primitives": [primitive], "weights": [0.5]}],
        "bufferViews": views, "buffers": [{"byteLength": input.buffer.len()}],
        "accessors": input.accessors.iter().map(accessor).collect::<Vec<_>>(),
    })
}

fuzz_target!(|input: Input| load(&glb(&scene(&input), &input.buffer)));
