//! The device, chosen and opened.

use super::capabilities::Capabilities;
use super::error::{Context, GpuError};
use super::instance::Instance;
use super::pipeline_cache::PipelineCache;
use ash::{ext, khr, vk};
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use std::mem::ManuallyDrop;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};

/// Which device, and how.
#[derive(Debug, Clone)]
pub struct DeviceOptions {
    /// Part of its name, or its index in `pathspace devices`; the best one where nothing is said.
    pub device: Option<String>,
    /// Core and synchronization validation; slow.
    pub validation: bool,
    /// False hides the device's ray query.
    pub ray_query: bool,
}

impl Default for DeviceOptions {
    fn default() -> Self {
        Self { device: None, validation: false, ray_query: true }
    }
}

/// An open device with one compute queue. Cheap to clone; what is made from it keeps it alive.
#[derive(Clone)]
pub struct Gpu(pub(super) Arc<Inner>);

pub(super) struct Inner {
    pub device: ash::Device,
    pub queue: Mutex<vk::Queue>,
    pub queue_family: u32,
    pub allocator: ManuallyDrop<Mutex<Allocator>>,
    pub allocated: AtomicU64,
    /// The most that it has been.
    pub most_allocated: AtomicU64,
    pub pipeline_cache: ManuallyDrop<PipelineCache>,
    pub capabilities: Capabilities,
    pub debug: Option<ext::debug_utils::Device>,
    acceleration_structure: Option<khr::acceleration_structure::Device>,
    instance: Instance,
    physical_device: vk::PhysicalDevice,
}

impl Gpu {
    /// Opens the wanted or the best device.
    ///
    /// # Errors
    /// No loader, no such device, or one that lacks a required feature (each is named).
    pub fn open(options: &DeviceOptions) -> Result<Self, GpuError> {
        let instance = Instance::new(options.validation)?;
        let (physical_device, mut capabilities) = choose(instance.physical_devices()?, options.device.as_deref())?;
        if !capabilities.usable() {
            return Err(GpuError::MissingFeatures { device: capabilities.name, missing: capabilities.missing.join(", ") });
        }
        capabilities.ray_query &= options.ray_query;
        let queue_family = capabilities.queue_family.expect("a usable device has one");
        let device = create_device(&instance.raw, physical_device, queue_family, &capabilities)?;
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.raw.clone(),
            device: device.clone(),
            physical_device,
            debug_settings: Default::default(),
            buffer_device_address: true,
            allocation_sizes: Default::default(),
        })
        .map_err(|error| GpuError::Memory { what: "the allocator".to_owned(), bytes: 0, message: error.to_string() })?;
        tracing::info!("device: {} ({})", capabilities.name, capabilities.driver);
        // SAFETY: the queue was asked for when the device was created.
        let queue = unsafe { device.get_device_queue(queue_family, 0) };
        Ok(Self(Arc::new(Inner {
            queue: Mutex::new(queue),
            queue_family,
            allocator: ManuallyDrop::new(Mutex::new(allocator)),
            allocated: AtomicU64::new(0),
            most_allocated: AtomicU64::new(0),
            pipeline_cache: ManuallyDrop::new(PipelineCache::load(&device, &capabilities)?),
            acceleration_structure: capabilities.ray_query.then(|| khr::acceleration_structure::Device::new(&instance.raw, &device)),
            debug: instance.debug_device(&device),
            capabilities,
            device,
            instance,
            physical_device,
        })))
    }

    pub fn raw(&self) -> &ash::Device {
        &self.0.device
    }

    pub fn capabilities(&self) -> &Capabilities {
        &self.0.capabilities
    }

    /// Where ray query is offered and not hidden.
    pub fn acceleration_structure_fns(&self) -> Option<&khr::acceleration_structure::Device> {
        self.0.acceleration_structure.as_ref()
    }

    /// Limits of acceleration structure builds.
    pub fn acceleration_structure_properties(&self) -> vk::PhysicalDeviceAccelerationStructurePropertiesKHR<'static> {
        let mut structure = vk::PhysicalDeviceAccelerationStructurePropertiesKHR::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut structure);
        // SAFETY: the physical device belongs to the living instance.
        unsafe { self.0.instance.raw.get_physical_device_properties2(self.0.physical_device, &mut properties) };
        structure
    }

    /// Bytes of buffers and images alive now.
    pub fn allocated_bytes(&self) -> u64 {
        self.0.allocated.load(Ordering::Relaxed)
    }

    /// The most that [`Self::allocated_bytes`] has been since [`Self::watch_memory`], staging included.
    pub fn peak_bytes(&self) -> u64 {
        self.0.most_allocated.load(Ordering::Relaxed)
    }

    /// Begins to look for the peak anew.
    pub fn watch_memory(&self) {
        self.0.most_allocated.store(self.allocated_bytes(), Ordering::Relaxed);
    }

    /// Everything that the validation layer has said; empty where it is off.
    pub fn validation_messages(&self) -> Vec<String> {
        self.0.instance.messages()
    }

    /// Waits until the device has nothing left to do.
    pub fn wait_idle(&self) -> Result<(), GpuError> {
        let _queue = self.queue();
        // SAFETY: the queue is locked, so nothing is submitted meanwhile.
        self.lost(unsafe { self.0.device.device_wait_idle() }, "wait for the device")
    }

    pub(super) fn queue(&self) -> MutexGuard<'_, vk::Queue> {
        self.0.queue.lock().expect("no panic while holding it")
    }

    pub(super) fn allocator(&self) -> MutexGuard<'_, Allocator> {
        self.0.allocator.lock().expect("no panic while holding it")
    }

    /// Gives a lost device an error of its own.
    pub(super) fn lost<T>(&self, result: Result<T, vk::Result>, what: &str) -> Result<T, GpuError> {
        match result {
            Err(vk::Result::ERROR_DEVICE_LOST) => Err(GpuError::Lost { device: self.0.capabilities.name.clone() }),
            other => other.context(what),
        }
    }

    /// Names an object for validation messages and captures.
    pub(super) fn set_name<H: vk::Handle>(&self, handle: H, name: &str) {
        if let (Some(debug), Ok(name)) = (&self.0.debug, std::ffi::CString::new(name)) {
            let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name);
            // SAFETY: the handle is alive and belongs to this device. A name that cannot be set is no loss.
            let _ = unsafe { debug.set_debug_utils_object_name(&info) };
        }
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        // SAFETY: this is the last owner, so nothing made from the device is alive; the order is that of dependence.
        unsafe {
            let _ = self.device.device_wait_idle();
            ManuallyDrop::drop(&mut self.pipeline_cache);
            ManuallyDrop::drop(&mut self.allocator);
            self.device.destroy_device(None);
        }
    }
}

type Candidate = (vk::PhysicalDevice, Capabilities);

fn choose(candidates: Vec<Candidate>, wanted: Option<&str>) -> Result<Candidate, GpuError> {
    let found = candidates.iter().map(|(_, c)| c.name.clone()).collect::<Vec<_>>().join(", ");
    let Some(wanted) = wanted else {
        return candidates.into_iter().max_by_key(|(_, c)| c.rank()).ok_or(GpuError::NoDevice);
    };
    let index = match wanted.parse::<usize>() {
        Ok(index) => Some(index),
        Err(_) => candidates.iter().position(|(_, c)| c.name.to_lowercase().contains(&wanted.to_lowercase())),
    };
    let unknown = || GpuError::UnknownDevice { wanted: wanted.to_owned(), found };
    index.and_then(|index| candidates.into_iter().nth(index)).ok_or_else(unknown)
}

fn create_device(
    instance: &ash::Instance,
    physical_device: vk::PhysicalDevice,
    queue_family: u32,
    capabilities: &Capabilities,
) -> Result<ash::Device, GpuError> {
    let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(queue_family).queue_priorities(&[1.0])];
    let mut extensions = Vec::new();
    let mut vulkan12 = vk::PhysicalDeviceVulkan12Features::default()
        .buffer_device_address(true)
        .runtime_descriptor_array(true)
        .descriptor_binding_partially_bound(true)
        .shader_sampled_image_array_non_uniform_indexing(true)
        .scalar_block_layout(true)
        .shader_buffer_int64_atomics(capabilities.int64_atomics)
        .shader_float16(capabilities.half_precision);
    let mut ray_query = vk::PhysicalDeviceRayQueryFeaturesKHR::default().ray_query(true);
    let mut structure = vk::PhysicalDeviceAccelerationStructureFeaturesKHR::default().acceleration_structure(true);
    let mut atomics = vk::PhysicalDeviceShaderAtomicFloatFeaturesEXT::default().shader_buffer_float32_atomic_add(true);
    let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut vulkan12);
    if capabilities.ray_query {
        extensions.extend([khr::ray_query::NAME, khr::acceleration_structure::NAME, khr::deferred_host_operations::NAME]);
        features = features.push_next(&mut ray_query).push_next(&mut structure);
    }
    if capabilities.float_atomics {
        extensions.push(ext::shader_atomic_float::NAME);
        features = features.push_next(&mut atomics);
    }
    let extensions: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
    let info = vk::DeviceCreateInfo::default().queue_create_infos(&queues).enabled_extension_names(&extensions).push_next(&mut features);
    // SAFETY: the features and extensions were found in the capabilities, and the chain lives through the call.
    unsafe { instance.create_device(physical_device, &info, None) }.context("open the device")
}
