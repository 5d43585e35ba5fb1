//! Structs that the host fills agree with WGSL by field name, offset and size. Needs no device.

use steradian::gpu::{layouts, validate};
use steradian::shader::{Feature, Features, compose, generated, library};

fn module(entry: &str) -> naga::Module {
    let set = Features::default().with_all_of_scenes().with(Feature::Nee).with(Feature::Mis);
    let composed = compose(&library(), entry, set, &generated::wgsl(32, 64)).unwrap();
    validate(entry, &composed).unwrap()
}

/// (fields with offsets, span) of the WGSL struct of that name.
fn wgsl_layout(module: &naga::Module, name: &str) -> Option<(Vec<(String, usize)>, usize)> {
    module.types.iter().find_map(|(_, t)| match &t.inner {
        naga::TypeInner::Struct { members, span } if t.name.as_deref() == Some(name) => {
            let fields = members
                .iter()
                .map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize))
                .collect();
            Some((fields, *span as usize))
        }
        _ => None,
    })
}

#[test]
fn host_and_wgsl_agree() {
    let modules = ["path_trace", "compact", "first_hit"].map(module);
    for layout in layouts() {
        let (fields, span) = modules
            .iter()
            .find_map(|module| wgsl_layout(module, layout.name))
            .unwrap_or_else(|| panic!("no WGSL struct {}", layout.name));
        let host: Vec<(String, usize)> =
            layout.fields.iter().map(|(n, o)| (n.to_string(), *o)).collect();
        assert_eq!(host, fields, "{}", layout.name);
        assert_eq!(layout.size, span, "size of {}", layout.name);
    }
}

/// The comparison sees a swap of two fields of one size.
#[test]
fn a_swap_is_seen() {
    let module = module("path_trace");
    let (fields, _) = wgsl_layout(&module, "Light").unwrap();
    let mut swapped = fields.clone();
    let (a, b) = (swapped[1].0.clone(), swapped[2].0.clone());
    (swapped[1].0, swapped[2].0) = (b, a);
    assert_ne!(swapped, fields);
}
