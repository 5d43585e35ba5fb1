//! Processor time: unlike the clock on the wall it does not count what others do.

/// Clock ticks of a second in `/proc`: 100 on every Linux that Rust supports.
const TICKS: f64 = 100.0;

/// Processor time of all children that have ended, seconds.
pub(crate) fn children_seconds() -> f64 {
    fields(15)
}

/// Processor time of this process, seconds.
pub(crate) fn own_seconds() -> f64 {
    fields(13)
}

/// User and system time of `/proc/self/stat`, from field `first`, counted from 0 (proc(5));
/// where there is no such file, not a number.
fn fields(first: usize) -> f64 {
    let Ok(text) = std::fs::read_to_string("/proc/self/stat") else { return f64::NAN };
    // The name, in brackets, may hold spaces.
    let Some((_, rest)) = text.rsplit_once(')') else { return f64::NAN };
    let fields = rest.split_whitespace().skip(first - 2).take(2);
    fields.map(|f| f.parse().unwrap_or(f64::NAN)).sum::<f64>() / TICKS
}
