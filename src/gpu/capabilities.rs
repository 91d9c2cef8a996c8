//! What a device can do, what it lacks, and what is used instead.

use ash::{ext, khr, vk};
use serde::Serialize;
use std::ffi::CStr;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DeviceKind {
    /// A driver that runs on the CPU.
    Software,
    Virtual,
    Integrated,
    Discrete,
}

/// One device, as `pathspace devices` shows it. Sizes are bytes.
#[derive(Debug, Clone, Serialize)]
pub struct Capabilities {
    pub name: String,
    pub driver: String,
    pub kind: DeviceKind,
    pub vulkan: String,
    pub ray_query: bool,
    pub position_fetch: bool,
    pub float_atomics: bool,
    pub int64_atomics: bool,
    pub half_precision: bool,
    pub timestamps: bool,
    /// Nanoseconds per timestamp tick.
    pub timestamp_period: f32,
    pub subgroup_size: u32,
    /// In compute shaders.
    pub subgroup_ballot: bool,
    pub max_storage_buffer_range: u64,
    pub max_workgroup_invocations: u32,
    /// Texels along one side of an image.
    pub max_image_side: u32,
    pub max_textures: u32,
    /// Of one texel buffer.
    pub max_texels: u32,
    pub device_local_memory: u64,
    /// Required features that are missing: the device cannot be used.
    pub missing: Vec<&'static str>,
    /// Identifies device and driver for caches on disk.
    #[serde(skip)]
    pub pipeline_cache_uuid: [u8; 16],
    #[serde(skip)]
    pub(super) queue_family: Option<u32>,
}

/// An optional feature that a device lacks, and what happens without it.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Substitute {
    pub lacks: &'static str,
    pub instead: &'static str,
}

impl Capabilities {
    pub(super) fn query(instance: &ash::Instance, device: vk::PhysicalDevice) -> Self {
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut subgroup = vk::PhysicalDeviceSubgroupProperties::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver).push_next(&mut subgroup);
        // SAFETY: the device belongs to the instance, and the chain lives through the call.
        unsafe { instance.get_physical_device_properties2(device, &mut properties) };
        let properties = properties.properties;
        let limits = properties.limits;
        let (major, minor) = (vk::api_version_major(properties.api_version), vk::api_version_minor(properties.api_version));
        let mut capabilities = Self {
            name: text(&properties.device_name),
            driver: format!("{} {}", text(&driver.driver_name), text(&driver.driver_info)),
            kind: kind(properties.device_type),
            vulkan: format!("{major}.{minor}.{}", vk::api_version_patch(properties.api_version)),
            ray_query: false,
            position_fetch: false,
            float_atomics: false,
            int64_atomics: false,
            half_precision: false,
            timestamps: limits.timestamp_compute_and_graphics == vk::TRUE,
            timestamp_period: limits.timestamp_period,
            subgroup_size: subgroup.subgroup_size,
            subgroup_ballot: subgroup.supported_operations.contains(vk::SubgroupFeatureFlags::BALLOT)
                && subgroup.supported_stages.contains(vk::ShaderStageFlags::COMPUTE),
            max_storage_buffer_range: limits.max_storage_buffer_range.into(),
            max_workgroup_invocations: limits.max_compute_work_group_invocations,
            max_image_side: limits.max_image_dimension2_d,
            max_textures: limits.max_per_stage_descriptor_sampled_images.min(limits.max_per_stage_descriptor_samplers),
            max_texels: limits.max_texel_buffer_elements,
            device_local_memory: device_local_memory(instance, device),
            missing: Vec::new(),
            pipeline_cache_uuid: properties.pipeline_cache_uuid,
            queue_family: compute_queue_family(instance, device),
        };
        if (major, minor) < (1, 2) {
            capabilities.missing.push("Vulkan 1.2");
            return capabilities;
        }
        capabilities.query_features(instance, device);
        if capabilities.queue_family.is_none() {
            capabilities.missing.push("a compute queue");
        }
        capabilities
    }

    fn query_features(&mut self, instance: &ash::Instance, device: vk::PhysicalDevice) {
        // SAFETY: the device belongs to the instance.
        let extensions = unsafe { instance.enumerate_device_extension_properties(device) }.unwrap_or_default();
        let has = |name: &CStr| extensions.iter().any(|e| e.extension_name_as_c_str() == Ok(name));
        let mut vulkan12 = vk::PhysicalDeviceVulkan12Features::default();
        let mut ray_query = vk::PhysicalDeviceRayQueryFeaturesKHR::default();
        let mut structure = vk::PhysicalDeviceAccelerationStructureFeaturesKHR::default();
        let mut position = vk::PhysicalDeviceRayTracingPositionFetchFeaturesKHR::default();
        let mut atomics = vk::PhysicalDeviceShaderAtomicFloatFeaturesEXT::default();
        let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut vulkan12);
        if has(khr::ray_query::NAME) && has(khr::acceleration_structure::NAME) && has(khr::deferred_host_operations::NAME) {
            features = features.push_next(&mut ray_query).push_next(&mut structure);
        }
        if has(khr::ray_tracing_position_fetch::NAME) {
            features = features.push_next(&mut position);
        }
        if has(ext::shader_atomic_float::NAME) {
            features = features.push_next(&mut atomics);
        }
        // SAFETY: the chain lives through the call and holds only structures of extensions that the device has.
        unsafe { instance.get_physical_device_features2(device, &mut features) };
        self.ray_query = ray_query.ray_query == vk::TRUE && structure.acceleration_structure == vk::TRUE;
        self.position_fetch = position.ray_tracing_position_fetch == vk::TRUE;
        self.float_atomics = atomics.shader_buffer_float32_atomic_add == vk::TRUE;
        self.int64_atomics = vulkan12.shader_buffer_int64_atomics == vk::TRUE;
        self.half_precision = vulkan12.shader_float16 == vk::TRUE;
        let required = [
            (vulkan12.buffer_device_address, "buffer device addresses (bufferDeviceAddress)"),
            (vulkan12.runtime_descriptor_array, "descriptor indexing (runtimeDescriptorArray)"),
            (vulkan12.descriptor_binding_partially_bound, "descriptor indexing (descriptorBindingPartiallyBound)"),
            (vulkan12.shader_sampled_image_array_non_uniform_indexing, "descriptor indexing (shaderSampledImageArrayNonUniformIndexing)"),
            (vulkan12.scalar_block_layout, "scalar block layout (scalarBlockLayout)"),
        ];
        self.missing.extend(required.iter().filter(|(present, _)| *present == vk::FALSE).map(|(_, name)| *name));
    }

    /// Whether the renderer can run on it at all.
    pub fn usable(&self) -> bool {
        self.missing.is_empty()
    }

    /// Optional features that it lacks.
    pub fn substitutes(&self) -> Vec<Substitute> {
        let optional = [
            (self.ray_query, "ray query", "the compute BVH traces all rays"),
            (self.float_atomics, "float32 atomic add on buffers", "fixed-point accumulation"),
            (self.int64_atomics, "64-bit atomics on buffers", "two 32-bit words"),
            (self.half_precision, "16-bit floats in shaders", "single precision"),
            (self.subgroup_ballot, "ballots of subgroups", "only the megakernel traces paths"),
            (self.timestamps, "timestamps on compute queues", "no GPU times are reported"),
        ];
        optional.iter().filter(|(has, ..)| !has).map(|&(_, lacks, instead)| Substitute { lacks, instead }).collect()
    }

    /// Larger is better: a GPU with ray query, then any GPU, then a software driver.
    pub(super) fn rank(&self) -> (bool, bool, bool, DeviceKind) {
        (self.usable(), self.kind != DeviceKind::Software, self.ray_query, self.kind)
    }
}

fn kind(ty: vk::PhysicalDeviceType) -> DeviceKind {
    match ty {
        vk::PhysicalDeviceType::DISCRETE_GPU => DeviceKind::Discrete,
        vk::PhysicalDeviceType::INTEGRATED_GPU => DeviceKind::Integrated,
        vk::PhysicalDeviceType::VIRTUAL_GPU => DeviceKind::Virtual,
        _ => DeviceKind::Software,
    }
}

fn compute_queue_family(instance: &ash::Instance, device: vk::PhysicalDevice) -> Option<u32> {
    // SAFETY: the device belongs to the instance.
    let families = unsafe { instance.get_physical_device_queue_family_properties(device) };
    families.iter().position(|family| family.queue_flags.contains(vk::QueueFlags::COMPUTE)).map(|index| index as u32)
}

fn device_local_memory(instance: &ash::Instance, device: vk::PhysicalDevice) -> u64 {
    // SAFETY: the device belongs to the instance.
    let memory = unsafe { instance.get_physical_device_memory_properties(device) };
    let heaps = memory.memory_heaps_as_slice().iter();
    heaps.filter(|heap| heap.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL)).map(|heap| heap.size).sum()
}

/// A fixed-size C string of the driver's.
fn text(raw: &[std::ffi::c_char]) -> String {
    raw.iter().take_while(|&&c| c != 0).map(|&c| c as u8 as char).collect()
}
