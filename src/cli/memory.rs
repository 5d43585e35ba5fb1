//! The host's memory: what a render takes of it, and whether it is there.
//!
//! What cannot be had is refused before anything is rendered: the system would end the program without a
//! word when it uses what it was given.

use super::drill;
use super::job::Job;
use super::talk;
use std::fs;
use std::path::{Path, PathBuf};
use steradian::{Error, RenderSettings, Result};

/// Bytes of a pixel of a picture.
const PICTURE_PIXEL: u64 = size_of::<[f32; 3]>() as u64;
/// Bytes of the standard error of a pixel.
const ERROR_PIXEL: u64 = size_of::<f32>() as u64;

/// What there is, bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Memory {
    /// That this program could ever have.
    pub(super) total: u64,
    /// That it could have now.
    pub(super) free: u64,
}

/// Refuses a render whose film and picture do not fit.
///
/// # Errors
/// [`Error::Limit`] if they never can, [`Error::Busy`] if they cannot now.
pub(super) fn check(job: &Job, is_denoised: bool) -> Result<()> {
    match drill::memory()?.or_else(|| Memory::of_machine(Path::new("/"))) {
        Some(memory) => memory.check(&job.settings, needed(&job.settings, is_denoised)),
        None => Ok(()),
    }
}

/// Bytes of the host that grow with the picture: the film, and what is made of it when it is
/// written. Layers are made band by band; the device has its own memory, or its driver asks for it.
fn needed(settings: &RenderSettings, is_denoised: bool) -> u64 {
    let window = settings.window();
    let pixels = u64::from(window.width) * u64::from(window.height);
    // The denoised picture, and its guides: albedo and normals.
    let pictures = if is_denoised { 4 } else { 1 };
    settings.film_bytes() + pixels * (pictures * PICTURE_PIXEL + ERROR_PIXEL)
}

impl Memory {
    /// By Linux, of whose files `root` is the first folder; `None` elsewhere. What the program's control
    /// groups allow counts too.
    pub(super) fn of_machine(root: &Path) -> Option<Self> {
        let text = fs::read_to_string(root.join("proc/meminfo")).ok()?;
        let entry = |name: &str| kibibytes(&text, name);
        let machine = Self {
            total: entry("MemTotal")? + entry("SwapTotal").unwrap_or(0),
            free: entry("MemAvailable")? + entry("SwapFree").unwrap_or(0),
        };
        let groups = fs::read_to_string(root.join("proc/self/cgroup")).unwrap_or_default();
        Some(groups.lines().fold(machine, |memory, line| memory.within_group(root, line)))
    }

    /// At most what the control group of a line of /proc/self/cgroup, and those around it, allow.
    fn within_group(mut self, root: &Path, line: &str) -> Self {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (parts.next(), parts.next()) else { return self };
        let (hierarchy, names) = match controllers {
            "" => ("sys/fs/cgroup", ["memory.max", "memory.current"]),
            "memory" => {
                ("sys/fs/cgroup/memory", ["memory.limit_in_bytes", "memory.usage_in_bytes"])
            }
            _ => return self,
        };
        let top = root.join(hierarchy);
        let group: PathBuf = top.join(path.trim_start_matches('/'));
        for folder in group.ancestors().take_while(|folder| folder.starts_with(&top)) {
            let number = |name: &str| {
                let text = fs::read_to_string(folder.join(name)).ok()?;
                text.trim().parse::<u64>().ok()
            };
            // "max" is no number.
            let Some(limit) = number(names[0]) else { continue };
            self.total = self.total.min(limit);
            let Some(used) = number(names[1]) else { continue };
            // Files in memory make room when it is needed.
            let statistics = fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
            let files: u64 = ["active_file", "inactive_file"]
                .iter()
                .filter_map(|name| number_after(&statistics, name))
                .sum();
            self.free = self.free.min(limit.saturating_sub(used.saturating_sub(files)));
        }
        self
    }

    fn check(self, settings: &RenderSettings, needed: u64) -> Result<()> {
        let window = settings.window();
        let (width, height) = (window.width, window.height);
        let say = |there: u64, rest: &str| {
            let (needed, there) = (talk::size(needed), talk::size(there));
            format!("{width}x{height} pixels need {needed} of memory and {there} {rest}")
        };
        if needed > self.total {
            let remedy = "is all there is; render parts with --crop, or of the rows with --shard";
            return Err(Error::Limit(say(self.total, remedy)));
        }
        if needed > self.free {
            return Err(Error::Busy(say(self.free, "is free now; try again later")));
        }
        Ok(())
    }
}

/// The entry of that name in /proc/meminfo or /proc/self/status, bytes.
fn kibibytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

fn number_after(text: &str, name: &str) -> Option<u64> {
    text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' ')?.parse().ok())
}

/// The most memory that this program has used, bytes; `None` where the system does not tell.
pub(crate) fn peak() -> Option<u64> {
    kibibytes(&fs::read_to_string("/proc/self/status").ok()?, "VmHWM")
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian::image::Picture;

    const MIB: u64 = 1 << 20;

    fn machine(files: &[(&str, &str)]) -> Option<Memory> {
        let root = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        Memory::of_machine(root.path())
    }

    const MEMINFO: (&str, &str) = (
        "proc/meminfo",
        "MemTotal:  8192 kB\nMemFree: 1 kB\nMemAvailable:  4096 kB\nSwapTotal: 1024 kB\nSwapFree: 0 kB\n",
    );

    #[test]
    fn the_machine_and_its_groups_tell_what_there_is() {
        assert_eq!(machine(&[]), None);
        let whole = Memory { total: 9 * MIB, free: 4 * MIB };
        assert_eq!(machine(&[MEMINFO]), Some(whole));
        let v2 = ("proc/self/cgroup", "0::/farm/job\n");
        let unlimited = ("sys/fs/cgroup/farm/job/memory.max", "max\n");
        assert_eq!(machine(&[MEMINFO, v2, unlimited]), Some(whole));
        // 3 MiB, of which 2 are used, but one of these by files.
        let around = [
            ("sys/fs/cgroup/farm/memory.max", "3145728\n"),
            ("sys/fs/cgroup/farm/memory.current", "2097152\n"),
            (
                "sys/fs/cgroup/farm/memory.stat",
                "anon 5\nactive_file 524288\ninactive_file 524288\n",
            ),
        ];
        let limited = machine(&[&[MEMINFO, v2, unlimited], &around[..]].concat());
        assert_eq!(limited, Some(Memory { total: 3 * MIB, free: 2 * MIB }));
        let v1 = [
            ("proc/self/cgroup", "5:cpu:/\n4:memory:/docker/a:b\n"),
            ("sys/fs/cgroup/memory/docker/a:b/memory.limit_in_bytes", "2097152\n"),
            ("sys/fs/cgroup/memory/docker/a:b/memory.usage_in_bytes", "1048576\n"),
        ];
        let limited = machine(&[&[MEMINFO], &v1[..]].concat());
        assert_eq!(limited, Some(Memory { total: 2 * MIB, free: MIB }));
    }

    #[test]
    fn what_does_not_fit_is_told_with_both_numbers() {
        let settings = RenderSettings { resolution: (1024, 1024), ..RenderSettings::default() };
        let needed = needed(&settings, false);
        let with = |total, free| Memory { total, free }.check(&settings, needed);
        assert!(with(needed, needed).is_ok());
        let never = with(needed - 1, 5).unwrap_err();
        assert_eq!(never.exit_code(), 3);
        let said = never.to_string();
        assert!(said.contains(&talk::size(needed)) && said.contains("--crop"), "{said}");
        let later = with(needed, MIB).unwrap_err();
        assert_eq!(later.exit_code(), 75);
        assert!(later.to_string().contains("1.0 MiB is free now"), "{later}");
    }

    /// A picture holds what is counted for it.
    #[test]
    fn a_pixel_of_a_picture_has_that_size() {
        let picture = Picture::new(2, 1, vec![[0.0; 3]; 2]);
        assert_eq!(size_of_val(&picture.rgb[..]) as u64, 2 * PICTURE_PIXEL);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_peak_is_known() {
        let held = vec![1_u8; 64 << 20];
        assert!(peak().unwrap() > 64 << 20, "{}", held[5]);
    }
}
