//! Descriptor set layouts and sets.

use super::buffer::{Buffer, TexelBuffer};
use super::device::Gpu;
use super::error::{Context, GpuError};
use super::image::{Image, TextureImage};
use ash::vk;
use shader_compiler::{Binding, BindingKind};
use std::sync::Arc;

/// A set's layout; unbounded arrays have a fixed capacity and may be partly bound.
pub struct SetLayout {
    gpu: Gpu,
    raw: vk::DescriptorSetLayout,
    bindings: Vec<(u32, vk::DescriptorType, u32)>,
}

fn descriptor_type(kind: BindingKind) -> vk::DescriptorType {
    match kind {
        BindingKind::UniformBuffer => vk::DescriptorType::UNIFORM_BUFFER,
        BindingKind::StorageBuffer => vk::DescriptorType::STORAGE_BUFFER,
        BindingKind::StorageImage => vk::DescriptorType::STORAGE_IMAGE,
        BindingKind::SampledImage => vk::DescriptorType::COMBINED_IMAGE_SAMPLER,
        BindingKind::TexelBuffer => vk::DescriptorType::UNIFORM_TEXEL_BUFFER,
        BindingKind::AccelerationStructure => vk::DescriptorType::ACCELERATION_STRUCTURE_KHR,
    }
}

impl SetLayout {
    /// `bindings`: number, type and count of descriptors. All may be partly bound: what a kernel uses must be there.
    pub fn new(gpu: &Gpu, bindings: Vec<(u32, vk::DescriptorType, u32)>) -> Result<Arc<Self>, GpuError> {
        let stage = vk::ShaderStageFlags::COMPUTE;
        let raw_bindings: Vec<_> = bindings
            .iter()
            .map(|&(binding, ty, count)| {
                vk::DescriptorSetLayoutBinding::default().binding(binding).descriptor_type(ty).descriptor_count(count)
            })
            .map(|binding| binding.stage_flags(stage))
            .collect();
        let flags = vec![vk::DescriptorBindingFlags::PARTIALLY_BOUND; bindings.len()];
        let mut flags = vk::DescriptorSetLayoutBindingFlagsCreateInfo::default().binding_flags(&flags);
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&raw_bindings).push_next(&mut flags);
        // SAFETY: plain creation, destroyed in drop.
        let raw = unsafe { gpu.raw().create_descriptor_set_layout(&info, None) }.context("create a descriptor set layout")?;
        Ok(Arc::new(Self { gpu: gpu.clone(), raw, bindings }))
    }

    /// The layout of one set of a kernel's bindings.
    pub(super) fn reflected<'a>(gpu: &Gpu, bindings: impl Iterator<Item = &'a Binding>) -> Result<Arc<Self>, GpuError> {
        Self::new(gpu, bindings.map(|b| (b.binding, descriptor_type(b.kind), 1)).collect())
    }

    pub(super) fn raw(&self) -> vk::DescriptorSetLayout {
        self.raw
    }

    /// Whether a kernel's binding finds its descriptor here.
    pub(super) fn provides(&self, binding: &Binding) -> bool {
        self.bindings.iter().any(|&(number, ty, _)| number == binding.binding && ty == descriptor_type(binding.kind))
    }
}

impl Drop for SetLayout {
    fn drop(&mut self) {
        // SAFETY: pipelines and sets keep their layouts alive.
        unsafe { self.gpu.raw().destroy_descriptor_set_layout(self.raw, None) };
    }
}

/// One set, with a pool of its own. Written before its first use; the resources must outlive it.
pub struct DescriptorSet {
    layout: Arc<SetLayout>,
    pool: vk::DescriptorPool,
    raw: vk::DescriptorSet,
}

impl DescriptorSet {
    pub fn new(layout: &Arc<SetLayout>) -> Result<Self, GpuError> {
        let device = layout.gpu.raw();
        let size = |ty, count| vk::DescriptorPoolSize { ty, descriptor_count: count };
        let mut sizes: Vec<_> = layout.bindings.iter().map(|&(_, ty, count)| size(ty, count)).collect();
        if sizes.is_empty() {
            sizes.push(size(vk::DescriptorType::STORAGE_BUFFER, 1));
        }
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
        // SAFETY: plain creation; drop destroys the pool and with it the set.
        let pool = unsafe { device.create_descriptor_pool(&info, None) }.context("create a descriptor pool")?;
        let mut set = Self { layout: layout.clone(), pool, raw: vk::DescriptorSet::null() };
        let layouts = [layout.raw];
        let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
        // SAFETY: the pool was made for exactly this set.
        set.raw = unsafe { device.allocate_descriptor_sets(&info) }.context("allocate a descriptor set")?[0];
        Ok(set)
    }

    pub fn raw(&self) -> vk::DescriptorSet {
        self.raw
    }

    /// A uniform or storage buffer, as the layout says: `range` bytes from its start.
    pub fn write_buffer(&self, binding: u32, buffer: &Buffer, range: u64) {
        let declared = self.layout.bindings.iter().find(|b| b.0 == binding);
        let ty = declared.map_or(vk::DescriptorType::STORAGE_BUFFER, |b| b.1);
        let info = [vk::DescriptorBufferInfo { buffer: buffer.raw(), offset: 0, range }];
        self.write(vk::WriteDescriptorSet::default().dst_binding(binding).descriptor_type(ty).buffer_info(&info));
    }

    pub fn write_storage_image(&self, binding: u32, image: &Image) {
        let info = [vk::DescriptorImageInfo::default().image_view(image.view()).image_layout(vk::ImageLayout::GENERAL)];
        let write = vk::WriteDescriptorSet::default().dst_binding(binding).descriptor_type(vk::DescriptorType::STORAGE_IMAGE);
        self.write(write.image_info(&info));
    }

    pub fn write_textures(&self, binding: u32, textures: &[TextureImage]) {
        let info = |t: &TextureImage| {
            let info = vk::DescriptorImageInfo::default().sampler(t.sampler).image_view(t.image.view());
            info.image_layout(vk::ImageLayout::GENERAL)
        };
        let infos: Vec<_> = textures.iter().map(info).collect();
        if !infos.is_empty() {
            let write = vk::WriteDescriptorSet::default().dst_binding(binding);
            self.write(write.descriptor_type(vk::DescriptorType::COMBINED_IMAGE_SAMPLER).image_info(&infos));
        }
    }

    /// Writes nothing where the device cannot take the buffer as texels.
    pub fn write_texel_buffer(&self, binding: u32, texels: &TexelBuffer) {
        let Some(view) = texels.view() else { return };
        let views = [view];
        let write = vk::WriteDescriptorSet::default().dst_binding(binding).descriptor_type(vk::DescriptorType::UNIFORM_TEXEL_BUFFER);
        self.write(write.texel_buffer_view(&views));
    }

    pub fn write_acceleration_structure(&self, binding: u32, structure: vk::AccelerationStructureKHR) {
        let structures = [structure];
        let mut info = vk::WriteDescriptorSetAccelerationStructureKHR::default().acceleration_structures(&structures);
        let write = vk::WriteDescriptorSet::default().dst_binding(binding).descriptor_count(1);
        self.write(write.descriptor_type(vk::DescriptorType::ACCELERATION_STRUCTURE_KHR).push_next(&mut info));
    }

    fn write(&self, write: vk::WriteDescriptorSet<'_>) {
        // SAFETY: the set is not in use by a frame in flight (its owner's contract), and the resources are alive.
        unsafe { self.layout.gpu.raw().update_descriptor_sets(&[write.dst_set(self.raw)], &[]) };
    }
}

impl Drop for DescriptorSet {
    fn drop(&mut self) {
        // SAFETY: the owner has seen to it that the device no longer uses the set.
        unsafe { self.layout.gpu.raw().destroy_descriptor_pool(self.pool, None) };
    }
}
