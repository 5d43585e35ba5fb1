//! What fits on a device.

use super::DeviceInfo;
use crate::{Error, Result};

/// Bytes for people.
pub(super) fn mebibytes(bytes: u64) -> f64 {
    bytes as f64 / 1_048_576.0
}

/// Whether `bytes` can be bound as one storage buffer.
///
/// # Errors
/// [`Error::Limit`] with both numbers and the remedy.
pub(crate) fn check_binding(
    info: &DeviceInfo,
    what: &str,
    bytes: usize,
    remedy: &str,
) -> Result<()> {
    if bytes as u64 <= info.max_binding_size {
        return Ok(());
    }
    Err(Error::Limit(format!(
        "{what} need {:.1} MiB in one binding, {} offers {:.1} MiB: {remedy}",
        mebibytes(bytes as u64),
        info.name,
        mebibytes(info.max_binding_size),
    )))
}
