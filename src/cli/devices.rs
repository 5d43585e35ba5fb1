//! `steradian devices`.

use super::talk;
use std::process::ExitCode;
use steradian::Result;
use steradian::gpu::{Device, DeviceInfo, DeviceKind};
use steradian::passes::FloatEnvironment;

/// Prints one line for each device.
pub(super) fn run() -> Result<ExitCode> {
    let devices = Device::list();
    if devices.is_empty() {
        // The error of opening one says what to install.
        Device::open(None)?;
    }
    let lines: String =
        devices.iter().map(|d| format!("{}, {}\n", line(d), arithmetic(d))).collect();
    talk::data(&lines)?;
    Ok(ExitCode::SUCCESS)
}

/// How the device computes, or why that is not known.
fn arithmetic(device: &DeviceInfo) -> String {
    let opened = Device::open(Some(&device.index.to_string()));
    match opened.and_then(|device| FloatEnvironment::of(&device)) {
        Ok(environment) => format!("float environment {environment}"),
        Err(error) => format!("cannot compute: {error}"),
    }
}

fn line(device: &DeviceInfo) -> String {
    let subgroup = match device.subgroup_size {
        (least, most) if least == most => least.to_string(),
        (least, most) => format!("{least} to {most}"),
    };
    format!(
        "{} {}, {}, {}, subgroups of {subgroup}, {} in a binding, {} storage buffers in a stage",
        device.index,
        device.name,
        device.driver.trim(),
        kind(device.kind),
        talk::size(device.max_binding_size),
        device.max_storage_buffers,
    )
}

fn kind(kind: DeviceKind) -> &'static str {
    match kind {
        DeviceKind::Discrete => "discrete GPU",
        DeviceKind::Integrated => "integrated GPU",
        DeviceKind::Virtual => "virtual GPU",
        DeviceKind::Cpu => "software on the processor",
        DeviceKind::Other => "unknown kind",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_is_one_line_with_its_limits() {
        let device = DeviceInfo {
            index: 1,
            name: "llvmpipe".into(),
            driver: "llvmpipe Mesa 25.0.7".into(),
            kind: DeviceKind::Cpu,
            subgroup_size: (8, 8),
            max_binding_size: 1 << 27,
            max_storage_buffers: 32,
        };
        assert_eq!(
            line(&device),
            "1 llvmpipe, llvmpipe Mesa 25.0.7, software on the processor, subgroups of 8, \
             128.0 MiB in a binding, 32 storage buffers in a stage"
        );
    }
}
