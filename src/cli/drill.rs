//! Faults on order, to see that they are survived: `STERADIAN_DRILL=lose-device@3,lose-device@9`
//! destroys the device before the third step of the render, and again before the ninth.

use steradian::gpu::Device;
use steradian::{Error, Result};

/// The variable.
const VARIABLE: &str = "STERADIAN_DRILL";

/// Steps before which the device is lost.
pub(super) struct Drill {
    steps: Vec<u64>,
    step: u64,
}

impl Drill {
    /// What the variable asks for.
    pub(super) fn from_environment() -> Result<Self> {
        let text = std::env::var(VARIABLE).unwrap_or_default();
        let parse = |part: &str| part.strip_prefix("lose-device@").and_then(|n| n.parse().ok());
        let steps: Option<Vec<u64>> =
            text.split(',').filter(|part| !part.is_empty()).map(parse).collect();
        let wrong = || format!("{VARIABLE}={text}: expected lose-device@N, or several with commas");
        Ok(Self { steps: steps.ok_or_else(|| Error::Settings(wrong()))?, step: 0 })
    }

    /// Before every step.
    pub(super) fn step(&mut self, device: &Device) {
        self.step += 1;
        if self.steps.contains(&self.step) {
            device.destroy();
        }
    }
}
