//! How work is cut for the device.

use crate::shader::generated::WORKGROUP_SIZE;
use crate::shader::{Library, library};

/// Workgroups along one side of a dispatch that every device allows.
const MOST_GROUPS: u32 = 65_535;

/// Choices that no bit of a picture depends on, as long as the library is the program's own.
#[derive(Debug, Clone)]
pub struct Tuning {
    /// Texts that kernels are composed from.
    pub library: Library,
    /// Threads of a workgroup of the path tracer: a power of two from 8 to 256.
    pub workgroup_size: u32,
    /// Seconds that the work of one submission should take.
    pub submit_seconds: f64,
    /// Samples of a pixel in one submission, at most.
    pub submit_samples: u32,
    /// Workgroups in a row of a dispatch, at most.
    pub row_groups: u32,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            library: library(),
            workgroup_size: WORKGROUP_SIZE,
            submit_seconds: 0.075,
            submit_samples: u32::MAX,
            row_groups: MOST_GROUPS,
        }
    }
}
