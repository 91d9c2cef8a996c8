//! Buffers, each with a device address.

use super::device::Gpu;
use super::error::{Context, GpuError};
use ash::vk;
use bytemuck::Pod;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};
use std::sync::atomic::Ordering;

/// Device memory with an address; freed when dropped (the owner sees to it that the device is done with it).
pub struct Buffer {
    gpu: Gpu,
    raw: vk::Buffer,
    allocation: Option<Allocation>,
    size: u64,
    address: u64,
}

const USAGE: vk::BufferUsageFlags = vk::BufferUsageFlags::from_raw(
    vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS.as_raw()
        | vk::BufferUsageFlags::STORAGE_BUFFER.as_raw()
        | vk::BufferUsageFlags::INDIRECT_BUFFER.as_raw()
        | vk::BufferUsageFlags::TRANSFER_SRC.as_raw()
        | vk::BufferUsageFlags::TRANSFER_DST.as_raw(),
);

impl Gpu {
    /// `size` bytes (at least 16 are allocated, so that an empty array has an address), contents undefined.
    /// Storage, transfer, indirect and device-address usage are always added to `usage`.
    pub fn create_buffer(&self, name: &str, size: u64, usage: vk::BufferUsageFlags, location: MemoryLocation) -> Result<Buffer, GpuError> {
        let info = vk::BufferCreateInfo::default().size(size.max(16)).usage(usage | USAGE);
        // SAFETY: plain creation; Buffer's drop destroys what exists, also where a later step fails.
        let raw = unsafe { self.raw().create_buffer(&info, None) }.context(&format!("create buffer '{name}'"))?;
        let mut buffer = Buffer { gpu: self.clone(), raw, allocation: None, size, address: 0 };
        // SAFETY: the buffer was just created.
        let requirements = unsafe { self.raw().get_buffer_memory_requirements(raw) };
        let allocation = self.allocate(name, requirements, location, true)?;
        // SAFETY: the allocation was made for this buffer's requirements.
        let bound = unsafe { self.raw().bind_buffer_memory(raw, allocation.memory(), allocation.offset()) };
        buffer.allocation = Some(allocation);
        bound.map_err(|result| GpuError::Memory {
            what: format!("buffer '{name}'"),
            bytes: requirements.size,
            message: result.to_string(),
        })?;
        // SAFETY: the buffer has memory and was created for device addresses.
        buffer.address = unsafe { self.raw().get_buffer_device_address(&vk::BufferDeviceAddressInfo::default().buffer(raw)) };
        self.set_name(raw, name);
        Ok(buffer)
    }

    /// A device-local buffer with these contents, through a staging buffer.
    pub fn upload<T: Pod>(&self, name: &str, data: &[T], usage: vk::BufferUsageFlags) -> Result<Buffer, GpuError> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let buffer = self.create_buffer(name, bytes.len() as u64, usage, MemoryLocation::GpuOnly)?;
        if !bytes.is_empty() {
            let staging = self.staging(name, bytes)?;
            self.submit_once(|commands| commands.copy_buffer(&staging, &buffer, bytes.len() as u64))?;
        }
        Ok(buffer)
    }

    /// A host-visible buffer with these contents.
    pub(super) fn staging(&self, name: &str, bytes: &[u8]) -> Result<Buffer, GpuError> {
        let mut staging = self.create_buffer(name, bytes.len() as u64, vk::BufferUsageFlags::empty(), MemoryLocation::CpuToGpu)?;
        staging.mapped_mut().expect("host-visible memory is mapped")[..bytes.len()].copy_from_slice(bytes);
        Ok(staging)
    }

    /// The whole contents of a buffer; waits for the device.
    pub fn download<T: Pod>(&self, buffer: &Buffer) -> Result<Vec<T>, GpuError> {
        let target = self.create_buffer("download", buffer.size, vk::BufferUsageFlags::empty(), MemoryLocation::GpuToCpu)?;
        self.submit_once(|commands| commands.copy_buffer(buffer, &target, buffer.size))?;
        Ok(bytemuck::pod_collect_to_vec(&target.mapped().expect("host-visible memory is mapped")[..buffer.size as usize]))
    }

    pub(super) fn allocate(
        &self,
        name: &str,
        requirements: vk::MemoryRequirements,
        location: MemoryLocation,
        linear: bool,
    ) -> Result<Allocation, GpuError> {
        let info = AllocationCreateDesc { name, requirements, location, linear, allocation_scheme: AllocationScheme::GpuAllocatorManaged };
        let allocation = self.allocator().allocate(&info).map_err(|error| GpuError::Memory {
            what: name.to_owned(),
            bytes: requirements.size,
            message: error.to_string(),
        })?;
        let before = self.0.allocated.fetch_add(allocation.size(), Ordering::Relaxed);
        self.0.most_allocated.fetch_max(before + allocation.size(), Ordering::Relaxed);
        Ok(allocation)
    }

    pub(super) fn free(&self, allocation: Allocation) {
        self.0.allocated.fetch_sub(allocation.size(), Ordering::Relaxed);
        if let Err(error) = self.allocator().free(allocation) {
            tracing::error!("memory could not be freed: {error}");
        }
    }
}

impl Buffer {
    pub fn raw(&self) -> vk::Buffer {
        self.raw
    }

    /// Bytes asked for.
    pub fn size(&self) -> u64 {
        self.size
    }

    pub fn address(&self) -> u64 {
        self.address
    }

    pub fn mapped(&self) -> Option<&[u8]> {
        self.allocation.as_ref()?.mapped_slice()
    }

    pub fn mapped_mut(&mut self) -> Option<&mut [u8]> {
        self.allocation.as_mut()?.mapped_slice_mut()
    }
}

/// A buffer that shaders read as texels of four 32-bit words: `usamplerBuffer`. Drivers fetch a texel at once, where they may load a
/// struct word by word.
pub struct TexelBuffer {
    buffer: Buffer,
    view: Option<vk::BufferView>,
}

impl Gpu {
    /// A device-local texel buffer with these contents; its texels are `[u32; 4]`. Where there are more of them than the device takes, it
    /// can be read by address only.
    pub fn upload_texels<T: Pod>(&self, name: &str, data: &[T]) -> Result<TexelBuffer, GpuError> {
        let buffer = self.upload(name, data, vk::BufferUsageFlags::UNIFORM_TEXEL_BUFFER)?;
        if size_of_val(data) / 16 > self.capabilities().max_texels as usize {
            return Ok(TexelBuffer { buffer, view: None });
        }
        let info = vk::BufferViewCreateInfo::default().buffer(buffer.raw()).format(vk::Format::R32G32B32A32_UINT).range(vk::WHOLE_SIZE);
        // SAFETY: the buffer was created for texels; drop destroys the view before it.
        let view = unsafe { self.raw().create_buffer_view(&info, None) }.context(&format!("view texels of '{name}'"))?;
        Ok(TexelBuffer { buffer, view: Some(view) })
    }
}

impl TexelBuffer {
    pub fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// None where the device takes fewer texels.
    pub fn view(&self) -> Option<vk::BufferView> {
        self.view
    }
}

impl Drop for TexelBuffer {
    fn drop(&mut self) {
        if let Some(view) = self.view {
            // SAFETY: the owner has seen to it that the device no longer uses the view.
            unsafe { self.buffer.gpu.raw().destroy_buffer_view(view, None) };
        }
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        // SAFETY: the owner has seen to it that the device no longer uses the buffer.
        unsafe { self.gpu.raw().destroy_buffer(self.raw, None) };
        if let Some(allocation) = self.allocation.take() {
            self.gpu.free(allocation);
        }
    }
}
