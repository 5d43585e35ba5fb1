//! A panic in a decoder is a refusal.

use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs a decoder of a library on bytes of a stranger. One that panics, which fuzzing
/// has found to happen, leaves nothing behind but its message and an error.
pub(crate) fn decoding<T>(decode: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(decode))
        .unwrap_or_else(|_| Err("is damaged: its decoder failed".into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_an_error() {
        assert_eq!(decoding(|| Ok(3)), Ok(3));
        let error = decoding(|| -> Result<(), String> { panic!("planted") }).unwrap_err();
        assert!(error.contains("decoder failed"), "{error}");
    }
}
