//! Radiance and OpenEXR environments: any bytes.

#![no_main]

use libfuzzer_sys::fuzz_target;
use std::path::Path;
use steradian_fuzz::scene::Environment;

fuzz_target!(|bytes: &[u8]| {
    match Environment::from_bytes(Path::new("sky"), bytes) {
        Ok((sky, negative_count)) => {
            assert_eq!(sky.radiance.len() as u64, u64::from(sky.width) * u64::from(sky.height));
            assert!(sky.radiance.iter().all(|r| r.is_finite() && r.min_element() >= 0.0));
            assert!(negative_count <= sky.radiance.len());
        }
        Err(error) => assert_eq!(error.exit_code(), 3, "{error}"),
    }
});
