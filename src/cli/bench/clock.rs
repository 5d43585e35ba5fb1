//! What the system knows of this process and machine.

use std::time::Instant;

/// Wall and CPU seconds since a moment.
pub(super) struct Stopwatch {
    wall: Instant,
    cpu: f64,
}

impl Stopwatch {
    pub(super) fn start() -> Self {
        Self { cpu: cpu_seconds(), wall: Instant::now() }
    }

    /// Wall and CPU.
    pub(super) fn read(&self) -> (f64, f64) {
        (self.wall.elapsed().as_secs_f64(), cpu_seconds() - self.cpu)
    }
}

/// Seconds of this process on all cores; NaN where the system does not tell.
#[cfg(unix)]
pub(super) fn cpu_seconds() -> f64 {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

#[cfg(not(unix))]
pub(super) fn cpu_seconds() -> f64 {
    f64::NAN
}

/// The processor's name; Linux tells.
pub(super) fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split(':').nth(1)?.trim().to_owned())
}

/// Threads that the system gives to this process.
pub(super) fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn work_takes_cpu_seconds_and_memory_is_known() {
        let watch = Stopwatch::start();
        let mut sum = 0.0_f64;
        while watch.read().0 < 0.02 {
            sum += std::hint::black_box(sum).sqrt();
        }
        let (wall, cpu) = watch.read();
        assert!(cpu > 0.0 && wall >= 0.02, "{wall} {cpu}");
    }
}
