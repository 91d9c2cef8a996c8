//! Recording: what one command buffer can be told.

use super::buffer::Buffer;
use super::descriptor::DescriptorSet;
use super::device::Gpu;
use super::error::{Context, GpuError};
use super::image::Image;
use super::pipeline::ComputePipeline;
use ash::vk;

/// A command buffer that is being recorded.
pub struct Commands<'a> {
    gpu: &'a Gpu,
    raw: vk::CommandBuffer,
}

/// Whatever a later pass may do to memory that an earlier one touched.
const ANY_ACCESS: vk::AccessFlags =
    vk::AccessFlags::from_raw(vk::AccessFlags::MEMORY_READ.as_raw() | vk::AccessFlags::MEMORY_WRITE.as_raw());

impl<'a> Commands<'a> {
    pub(super) fn new(gpu: &'a Gpu, raw: vk::CommandBuffer) -> Self {
        Self { gpu, raw }
    }

    pub fn raw(&self) -> vk::CommandBuffer {
        self.raw
    }

    pub fn gpu(&self) -> &'a Gpu {
        self.gpu
    }

    /// `to` starts after `from`, and sees what it wrote: dispatches, transfers, builds.
    pub fn barrier(&self, from: vk::PipelineStageFlags, to: vk::PipelineStageFlags) {
        let memory = [vk::MemoryBarrier::default().src_access_mask(vk::AccessFlags::MEMORY_WRITE).dst_access_mask(ANY_ACCESS)];
        // SAFETY: recording is exclusive to this value.
        unsafe { self.gpu.raw().cmd_pipeline_barrier(self.raw, from, to, vk::DependencyFlags::empty(), &memory, &[], &[]) };
    }

    /// Groups what follows under a name in captures and validation messages.
    pub fn begin_label(&self, name: &std::ffi::CStr) {
        if let Some(debug) = &self.gpu.0.debug {
            // SAFETY: recording is exclusive to this value.
            unsafe { debug.cmd_begin_debug_utils_label(self.raw, &vk::DebugUtilsLabelEXT::default().label_name(name)) };
        }
    }

    pub fn end_label(&self) {
        if let Some(debug) = &self.gpu.0.debug {
            // SAFETY: paired with begin_label.
            unsafe { debug.cmd_end_debug_utils_label(self.raw) };
        }
    }

    /// Runs a kernel over `groups` workgroups with these sets, numbered from 0, and push constants.
    ///
    /// # Panics
    /// If the push constants are not as long as the kernel's block.
    pub fn dispatch(&self, pipeline: &ComputePipeline, sets: &[&DescriptorSet], push_constants: &[u8], groups: [u32; 3]) {
        self.bind(pipeline, sets, push_constants);
        // SAFETY: everything that the kernel needs is bound.
        unsafe { self.gpu.raw().cmd_dispatch(self.raw, groups[0], groups[1], groups[2]) };
    }

    /// Runs a kernel over as many workgroups as three words of a buffer say, `offset` bytes from its start, when its turn comes.
    ///
    /// # Panics
    /// If the push constants are not as long as the kernel's block.
    pub fn dispatch_indirect(
        &self,
        pipeline: &ComputePipeline,
        sets: &[&DescriptorSet],
        push_constants: &[u8],
        (groups, offset): (&Buffer, u64),
    ) {
        self.bind(pipeline, sets, push_constants);
        // SAFETY: everything that the kernel needs is bound; every buffer may hold sizes of dispatches.
        unsafe { self.gpu.raw().cmd_dispatch_indirect(self.raw, groups.raw(), offset) };
    }

    fn bind(&self, pipeline: &ComputePipeline, sets: &[&DescriptorSet], push_constants: &[u8]) {
        assert_eq!(push_constants.len(), pipeline.reflection().push_constant_size as usize, "push constants of {}", pipeline.name());
        let device = self.gpu.raw();
        // SAFETY: the pipeline was built for these sets' layouts, and the push constants fill its block.
        unsafe {
            device.cmd_bind_pipeline(self.raw, vk::PipelineBindPoint::COMPUTE, pipeline.raw());
            for (index, set) in (0..).zip(sets) {
                device.cmd_bind_descriptor_sets(self.raw, vk::PipelineBindPoint::COMPUTE, pipeline.layout(), index, &[set.raw()], &[]);
            }
            if !push_constants.is_empty() {
                device.cmd_push_constants(self.raw, pipeline.layout(), vk::ShaderStageFlags::COMPUTE, 0, push_constants);
            }
        }
    }

    pub fn copy_buffer(&self, from: &Buffer, to: &Buffer, bytes: u64) {
        if bytes > 0 {
            // SAFETY: both buffers are alive and at least that long; every buffer may be copied from and to.
            unsafe { self.gpu.raw().cmd_copy_buffer(self.raw, from.raw(), to.raw(), &[vk::BufferCopy::default().size(bytes)]) };
        }
    }

    pub fn fill_buffer(&self, buffer: &Buffer, value: u32) {
        // SAFETY: the buffer is alive; every buffer may be written by transfers.
        unsafe { self.gpu.raw().cmd_fill_buffer(self.raw, buffer.raw(), 0, vk::WHOLE_SIZE, value) };
    }

    pub fn clear_image(&self, image: &Image) {
        let zero = vk::ClearColorValue::default();
        // SAFETY: the image is in GENERAL layout and may be written by transfers.
        unsafe { self.gpu.raw().cmd_clear_color_image(self.raw, image.raw(), vk::ImageLayout::GENERAL, &zero, &[image.range()]) };
    }

    /// From undefined contents to the layout that images keep.
    pub(super) fn make_general(&self, image: &Image) {
        let barrier = vk::ImageMemoryBarrier::default()
            .dst_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .old_layout(vk::ImageLayout::UNDEFINED)
            .new_layout(vk::ImageLayout::GENERAL)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .image(image.raw())
            .subresource_range(image.range());
        let (from, to) = (vk::PipelineStageFlags::TOP_OF_PIPE, vk::PipelineStageFlags::TRANSFER);
        // SAFETY: recording is exclusive to this value.
        unsafe { self.gpu.raw().cmd_pipeline_barrier(self.raw, from, to, vk::DependencyFlags::empty(), &[], &[], &[barrier]) };
    }

    pub fn copy_image_to_buffer(&self, image: &Image, buffer: &Buffer) {
        let region = image_copy(image.info().extent, 0, 0);
        // SAFETY: the buffer holds the image's first level, which is in GENERAL layout.
        unsafe { self.gpu.raw().cmd_copy_image_to_buffer(self.raw, image.raw(), vk::ImageLayout::GENERAL, buffer.raw(), &[region]) };
    }

    pub(super) fn copy_buffer_to_mips(&self, buffer: &Buffer, image: &Image, sizes: impl Iterator<Item = u64>) {
        let [width, height] = image.info().extent;
        let mut offset = 0;
        let mut regions = Vec::new();
        for (level, size) in (0..).zip(sizes) {
            regions.push(image_copy([(width >> level).max(1), (height >> level).max(1)], level, offset));
            offset += size;
        }
        // SAFETY: the buffer holds all levels one after the other; the image is in GENERAL layout.
        unsafe { self.gpu.raw().cmd_copy_buffer_to_image(self.raw, buffer.raw(), image.raw(), vk::ImageLayout::GENERAL, &regions) };
    }

    pub(super) fn begin(&self) -> Result<(), GpuError> {
        let info = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the buffer is not in use: its owner has waited for the fence.
        unsafe { self.gpu.raw().begin_command_buffer(self.raw, &info) }.context("begin recording")
    }

    pub(super) fn submit(&self, fence: vk::Fence) -> Result<(), GpuError> {
        let buffers = [self.raw];
        let submit = [vk::SubmitInfo::default().command_buffers(&buffers)];
        let queue = self.gpu.queue();
        // SAFETY: recording has begun and the fence is unsignalled; the queue is locked.
        unsafe {
            self.gpu.raw().end_command_buffer(self.raw).context("end recording")?;
            self.gpu.lost(self.gpu.raw().queue_submit(*queue, &submit, fence), "submit")
        }
    }
}

fn image_copy([width, height]: [u32; 2], level: u32, offset: u64) -> vk::BufferImageCopy {
    let layers = vk::ImageSubresourceLayers::default().aspect_mask(vk::ImageAspectFlags::COLOR).mip_level(level).layer_count(1);
    let extent = vk::Extent3D { width, height, depth: 1 };
    vk::BufferImageCopy::default().buffer_offset(offset).image_subresource(layers).image_extent(extent)
}
