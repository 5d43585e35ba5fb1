//! JSON texts and GLBs through the whole loader. Half of the changes are to bytes, half to
//! the JSON's tree: those get further.

#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use steradian_fuzz::edit::Edits;
use steradian_fuzz::{glb, load, split};

fuzz_target!(|bytes: &[u8]| load(bytes));

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    let mut edits = Edits::new(seed);
    let parts = if edits.toss() { split(&data[..size]) } else { None };
    let Some((mut json, mut bin)) = parts else { return fuzzer_mutate(data, size, max_size) };
    if !bin.is_empty() && edits.below(8) == 0 {
        let length = bin.len();
        let length = fuzzer_mutate(&mut bin, length, length);
        bin.truncate(length);
    } else {
        edits.change(&mut json);
    }
    let is_glb = data.starts_with(b"glTF");
    let bytes = if is_glb { glb(&json, &bin) } else { json.to_string().into_bytes() };
    if bytes.len() > max_size {
        return fuzzer_mutate(data, size, max_size);
    }
    data[..bytes.len()].copy_from_slice(&bytes);
    bytes.len()
});
