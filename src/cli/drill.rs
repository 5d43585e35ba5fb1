//! Faults on order, to see that they are survived. `STERADIAN_DRILL=lose-device@3,lose-device@9`
//! destroys the device before the third step of the render, and again before the ninth;
//! `memory@64` stands for a machine with 64 MiB of memory, `free-memory@64` for one that has so much
//! left, `device-memory@3` for a device that gives no more than 3 percent of its memory.

use super::memory::Memory;
use steradian::gpu::Device;
use steradian::{Error, Result};

/// The variable.
const VARIABLE: &str = "STERADIAN_DRILL";

const FAULTS: [&str; 4] = ["lose-device", "memory", "free-memory", "device-memory"];

/// Numbers by the faults that they belong to.
fn orders() -> Result<Vec<(String, u64)>> {
    let text = std::env::var(VARIABLE).unwrap_or_default();
    let parse = |part: &str| {
        let (fault, number) = part.split_once('@')?;
        let is_known = FAULTS.contains(&fault);
        is_known.then_some((fault.to_owned(), number.parse().ok()?))
    };
    let orders: Option<Vec<_>> =
        text.split(',').filter(|part| !part.is_empty()).map(parse).collect();
    let wrong = || {
        let known = "expected lose-device@STEP, memory@MIB, free-memory@MIB, \
             device-memory@PERCENT, or several with commas";
        Error::Settings(format!("{VARIABLE}={text}: {known}"))
    };
    orders.ok_or_else(wrong)
}

/// The memory to believe in.
pub(super) fn memory() -> Result<Option<Memory>> {
    let orders = orders()?;
    let bytes = |fault: &str| {
        let number = orders.iter().find(|order| order.0 == fault)?.1;
        Some(number.saturating_mul(1 << 20))
    };
    let (total, free) = (bytes("memory"), bytes("free-memory"));
    Ok((total.is_some() || free.is_some()).then(|| {
        let total = total.unwrap_or(u64::MAX);
        Memory { total, free: free.unwrap_or(total) }
    }))
}

/// Percent of its memory that the device gives.
pub(super) fn device_memory() -> Result<Option<u8>> {
    let order = orders()?.into_iter().find(|order| order.0 == "device-memory");
    Ok(order.map(|(_, percent)| percent.min(100) as u8))
}

/// Steps before which the device is lost.
pub(super) struct Drill {
    steps: Vec<u64>,
    step: u64,
}

impl Drill {
    /// What the variable asks for.
    pub(super) fn from_environment() -> Result<Self> {
        let steps = orders()?.into_iter().filter(|order| order.0 == "lose-device");
        Ok(Self { steps: steps.map(|order| order.1).collect(), step: 0 })
    }

    /// Before every step.
    pub(super) fn step(&mut self, device: &Device) {
        self.step += 1;
        if self.steps.contains(&self.step) {
            device.destroy();
        }
    }
}
