//! Composed WGSL to a compute pipeline. Bindings are found by the name of the
//! variable, so that their numbers stand in the WGSL alone.

use super::Device;
use crate::shader::{Composed, Features, Library, compose};
use crate::{Error, Result};
use std::collections::BTreeMap;

/// A compute pipeline and what it binds. A clone is the same pipeline.
#[derive(Debug, Clone)]
pub struct Kernel {
    pub(crate) pipeline: wgpu::ComputePipeline,
    bindings: BTreeMap<String, u32>,
}

/// Parses and validates composed text without a device.
///
/// # Errors
/// [`Error::Shader`] with the message and the file and line it is about.
pub fn validate(entry: &str, composed: &Composed) -> Result<naga::Module> {
    Ok(analyse(entry, composed)?.0)
}

/// [`validate`], and what each function uses.
fn analyse(entry: &str, composed: &Composed) -> Result<(naga::Module, naga::valid::ModuleInfo)> {
    let fail = |message: String, line: Option<u32>| {
        let at = line.map_or_else(String::new, |l| format!("{}: ", composed.locate(l as usize)));
        Error::Shader { entry: entry.to_owned(), message: format!("{at}{message}") }
    };
    let module = naga::front::wgsl::parse_str(&composed.text).map_err(|e| {
        let line = e.location(&composed.text).map(|l| l.line_number);
        fail(e.message().to_owned(), line)
    })?;
    let capabilities = naga::valid::Capabilities::all();
    let info = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|e| {
            let line = e.location(&composed.text).map(|l| l.line_number);
            let mut message = e.as_inner().to_string();
            let mut source = std::error::Error::source(e.as_inner());
            while let Some(s) = source {
                message.push_str(&format!(": {s}"));
                source = s.source();
            }
            fail(message, line)
        })?;
    Ok((module, info))
}

/// The text on the device. Indices are checked there as always; loops are not counted: naga would
/// end each after 2^64 turns, which no one lives to see, for six per cent of the time and a quarter
/// of the compilation on software devices.
#[allow(unsafe_code, reason = "wgpu has no safe way to leave the counting of loops out")]
fn trusted_module(device: &Device, entry: &str, composed: &Composed) -> wgpu::ShaderModule {
    let descriptor = wgpu::ShaderModuleDescriptor {
        label: Some(entry),
        source: wgpu::ShaderSource::Wgsl(composed.text.as_str().into()),
    };
    let checks = wgpu::ShaderRuntimeChecks { force_loop_bounding: false, ..Default::default() };
    // SAFETY: every loop of shaders/ ends: over a range, by halving one, down a tree that
    // has no cycles (a stack too small is a fault, not a loop), or at PATH_LENGTH_LIMIT.
    unsafe { device.device.create_shader_module_trusted(descriptor, checks) }
}

impl Kernel {
    /// Compiles the entry point `main` of `entry` for `features`, or gives what this device has
    /// compiled from the same text before.
    ///
    /// # Errors
    /// [`Error::Shader`].
    pub fn new(
        device: &Device,
        library: &Library,
        entry: &str,
        features: Features,
        generated: &str,
    ) -> Result<Self> {
        let composed = compose(library, entry, features, generated)?;
        if let Some(kernel) = device.kernels.lock().unwrap().get(&composed.text) {
            return Ok(kernel.clone());
        }
        let (module, info) = analyse(entry, &composed)?;
        // The layout has what the entry point uses, not all that its modules declare.
        let main = info.get_entry_point(0);
        let bindings = module
            .global_variables
            .iter()
            .filter(|(handle, _)| !main[*handle].is_empty())
            .filter_map(|(_, v)| Some((v.name.clone()?, v.binding.as_ref()?.binding)))
            .collect();
        let scope = device.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let shader = trusted_module(device, entry, &composed);
        let pipeline = device.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry),
            layout: None,
            module: &shader,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions {
                zero_initialize_workgroup_memory: false,
                ..Default::default()
            },
            cache: None,
        });
        if let Some(e) = pollster::block_on(scope.pop()) {
            return Err(Error::Shader { entry: entry.to_owned(), message: e.to_string() });
        }
        let kernel = Self { pipeline, bindings };
        device.kernels.lock().unwrap().insert(composed.text, kernel.clone());
        Ok(kernel)
    }

    /// Binds each buffer to the variable of its name; those that the kernel does not have are left out.
    pub fn bind(&self, device: &Device, buffers: &[(&str, &wgpu::Buffer)]) -> wgpu::BindGroup {
        let entries: Vec<_> = buffers
            .iter()
            .filter_map(|(name, buffer)| {
                let binding = *self.bindings.get(*name)?;
                Some(wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            })
            .collect();
        assert_eq!(entries.len(), self.bindings.len(), "unbound: {:?}", self.bindings);
        device.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &entries,
        })
    }
}
