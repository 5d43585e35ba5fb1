//! Adapters, and the device that everything runs on.

use super::Kernel;
use crate::{Error, Result};
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

/// What to do where no device is found.
const NO_DEVICE_REMEDY: &str = "install a Vulkan driver; for rendering on the CPU: \
    apt-get install libvulkan1 mesa-vulkan-drivers (make demo does this)";

/// Bytes that are on their way to the device at a time; they take as much of its memory again.
const UPLOAD_SIZE: usize = 64 << 20;

/// The kind of a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceKind {
    /// A GPU of its own.
    Discrete,
    /// A GPU that shares the processor's memory.
    Integrated,
    /// A GPU passed through to a virtual machine.
    Virtual,
    /// Software on the processor.
    Cpu,
    /// Not told by the driver.
    Other,
}

/// One line about an adapter.
#[derive(Debug, Clone)]
pub struct DeviceInfo {
    /// Place in the list; what `--device` takes.
    pub index: usize,
    /// The adapter's name.
    pub name: String,
    /// Driver name and version.
    pub driver: String,
    /// Kind.
    pub kind: DeviceKind,
    /// Smallest and largest subgroup.
    pub subgroup_size: (u32, u32),
    /// Largest storage buffer binding, bytes.
    pub max_binding_size: u64,
    /// Storage buffers that one shader stage can bind.
    pub max_storage_buffers: u32,
}

/// An open device with its queue.
pub struct Device {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    /// Those that were compiled, by their texts.
    pub(super) kernels: Mutex<HashMap<String, Kernel>>,
    info: DeviceInfo,
    texture_binding_size: u64,
    geometry_binding_size: u64,
    /// The first error that no call reported.
    failure: Arc<Mutex<Option<String>>>,
}

/// All Vulkan adapters; see [`Device::open_within`] for `memory_percent`.
fn adapters(memory_percent: Option<u8>) -> Vec<wgpu::Adapter> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    descriptor.backends = wgpu::Backends::VULKAN;
    descriptor.memory_budget_thresholds.for_resource_creation = memory_percent;
    let instance = wgpu::Instance::new(descriptor);
    pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN))
}

fn describe(index: usize, adapter: &wgpu::Adapter) -> DeviceInfo {
    let info = adapter.get_info();
    let limits = adapter.limits();
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => DeviceKind::Discrete,
        wgpu::DeviceType::IntegratedGpu => DeviceKind::Integrated,
        wgpu::DeviceType::VirtualGpu => DeviceKind::Virtual,
        wgpu::DeviceType::Cpu => DeviceKind::Cpu,
        wgpu::DeviceType::Other => DeviceKind::Other,
    };
    DeviceInfo {
        index,
        name: info.name,
        driver: format!("{} {}", info.driver, info.driver_info),
        kind,
        subgroup_size: (info.subgroup_min_size, info.subgroup_max_size),
        max_binding_size: limits.max_storage_buffer_binding_size,
        max_storage_buffers: limits.max_storage_buffers_per_shader_stage,
    }
}

fn describe_error(error: &wgpu::Error) -> String {
    match error {
        wgpu::Error::OutOfMemory { .. } => "the device's memory is full: end what else uses it, \
            or make the scene smaller (--max-texture-size, --max-environment-size)"
            .into(),
        _ => error.to_string(),
    }
}

impl Device {
    /// All Vulkan adapters.
    pub fn list() -> Vec<DeviceInfo> {
        adapters(None).iter().enumerate().map(|(i, a)| describe(i, a)).collect()
    }

    /// Opens the adapter whose index or part of whose name is `selector`; without
    /// one the best: discrete before integrated before virtual before software.
    ///
    /// # Errors
    /// [`Error::NoDevice`] where none is found, none fits, or it cannot be opened.
    pub fn open(selector: Option<&str>) -> Result<Self> {
        Self::open_within(selector, None)
    }

    /// [`Self::open`]; where the driver tells what is free, nothing is allocated that would leave less
    /// than the rest of so many percent of the memory.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn open_within(selector: Option<&str>, memory_percent: Option<u8>) -> Result<Self> {
        let found = adapters(memory_percent);
        let infos: Vec<_> = found.iter().enumerate().map(|(i, a)| describe(i, a)).collect();
        if infos.is_empty() {
            return Err(Error::NoDevice(format!("no Vulkan device found: {NO_DEVICE_REMEDY}")));
        }
        let fits = |info: &&DeviceInfo| match selector {
            None => true,
            Some(s) => match s.parse::<usize>() {
                Ok(index) => info.index == index,
                Err(_) => info.name.to_lowercase().contains(&s.to_lowercase()),
            },
        };
        let order = [
            DeviceKind::Discrete,
            DeviceKind::Integrated,
            DeviceKind::Virtual,
            DeviceKind::Other,
            DeviceKind::Cpu,
        ];
        let rank = |info: &&DeviceInfo| order.iter().position(|k| *k == info.kind);
        let Some(info) = infos.iter().filter(fits).min_by_key(rank) else {
            let names: Vec<_> = infos.iter().map(|i| format!("{} {}", i.index, i.name)).collect();
            return Err(Error::NoDevice(format!(
                "no device fits {:?}; there are: {}",
                selector.unwrap_or_default(),
                names.join(", ")
            )));
        };
        Self::open_adapter(&found[info.index], info.clone())
    }

    fn open_adapter(adapter: &wgpu::Adapter, info: DeviceInfo) -> Result<Self> {
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("steradian"),
            required_features: adapter.features() & wgpu::Features::SUBGROUP,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let opened = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) =
            opened.map_err(|e| Error::NoDevice(format!("{} cannot be opened: {e}", info.name)))?;
        let failure = Arc::new(Mutex::new(None));
        let keep_first = |failure: &Arc<Mutex<Option<String>>>, message: String| {
            failure.lock().unwrap().get_or_insert(message);
        };
        let on_error = failure.clone();
        device.on_uncaptured_error(Arc::new(move |e| keep_first(&on_error, describe_error(&e))));
        let on_loss = failure.clone();
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                keep_first(&on_loss, format!("device lost: {message}"));
            }
        });
        let texture_binding_size = info.max_binding_size;
        let geometry_binding_size = info.max_binding_size;
        let kernels = Mutex::default();
        Ok(Self {
            device,
            queue,
            kernels,
            info,
            texture_binding_size,
            geometry_binding_size,
            failure,
        })
    }

    /// Whether packets pay: a processor whose vector registers hold subgroups of eight.
    /// There, shared loads cost less than divergent ones; on GPUs it is the reverse.
    pub fn traces_packets(&self) -> bool {
        self.info.kind == DeviceKind::Cpu
            && self.info.subgroup_size == (8, 8)
            && self.device.features().contains(wgpu::Features::SUBGROUP)
    }

    /// About the adapter.
    pub fn info(&self) -> &DeviceInfo {
        &self.info
    }

    /// Spreads textures over bindings of at most `bytes`, less than the device offers: so that a
    /// small scene can show what a large one does.
    pub fn limit_texture_bindings(&mut self, bytes: u64) {
        self.texture_binding_size = bytes.min(self.info.max_binding_size);
    }

    /// The same for nodes, primitives and their attributes.
    pub fn limit_geometry_bindings(&mut self, bytes: u64) {
        self.geometry_binding_size = bytes.min(self.info.max_binding_size);
    }

    /// Bytes of a table of the geometry in one binding at most.
    pub(super) fn geometry_binding_size(&self) -> u64 {
        self.geometry_binding_size
    }

    /// Bytes of textures in one binding at most.
    pub(super) fn texture_binding_size(&self) -> u64 {
        self.texture_binding_size
    }

    /// Loses the device on purpose: whatever comes after fails with [`Error::DeviceLost`].
    pub fn destroy(&self) {
        self.device.destroy();
        let mut failure = self.failure.lock().unwrap();
        failure.get_or_insert_with(|| "device lost: destroyed on order".into());
    }

    /// Waits for all submitted work.
    ///
    /// # Errors
    /// [`Error::DeviceLost`] if anything failed since the last call.
    pub fn wait(&self) -> Result<()> {
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        if let Some(message) = self.failure.lock().unwrap().take() {
            return Err(Error::DeviceLost(format!("{}: {message}", self.info.name)));
        }
        polled.map(|_| ()).map_err(|e| Error::DeviceLost(format!("{}: {e}", self.info.name)))
    }

    /// A uniform buffer with these contents.
    pub(super) fn uniform_buffer(&self, label: &str, contents: &[u8]) -> wgpu::Buffer {
        self.buffer(label, contents, wgpu::BufferUsages::UNIFORM)
    }

    /// A table that shaders can read both from storage and as uniforms: filled up with zeros to
    /// `size` bytes.
    pub(super) fn table_buffer(&self, label: &str, bytes: &[u8], size: usize) -> wgpu::Buffer {
        let mut contents = bytes.to_vec();
        contents.resize(size, 0);
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE;
        self.buffer(label, &contents, usage)
    }

    /// A buffer that shaders can read and copies can fill.
    pub(crate) fn storage_buffer(&self, label: &str, bytes: &[u8]) -> wgpu::Buffer {
        // A binding must have room for one element: an array that the scene leaves empty holds
        // zeros.
        const LARGEST_ELEMENT: usize = size_of::<super::GpuMaterial>();
        let padding = [0_u8; LARGEST_ELEMENT];
        let contents = if bytes.is_empty() { &padding[..] } else { bytes };
        self.buffer(label, contents, wgpu::BufferUsages::STORAGE)
    }

    /// A buffer with these contents, whole words. Where the device has no room for it, the next
    /// [`Self::wait`] fails. (A buffer that is mapped when it is made would panic instead.)
    fn buffer(&self, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: contents.len() as u64,
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        for (k, part) in contents.chunks(UPLOAD_SIZE).enumerate() {
            if k > 0 {
                self.queue.submit([]);
                // What fails here, `wait` says.
                let _ = self.device.poll(wgpu::PollType::wait_indefinitely());
            }
            self.queue.write_buffer(&buffer, (k * UPLOAD_SIZE) as u64, part);
        }
        buffer
    }
}
