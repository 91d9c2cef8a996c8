//! Set 0, which every kernel may read: the frame's data and parameters, textures, the top-level structure.
//! One uniform buffer and one set per frame in flight, so that the host never writes what the device reads.

use crate::gpu::{Buffer, DescriptorSet, Gpu, GpuError, MemoryLocation, SetLayout, TextureImage, vk};
use crate::shared::{FrameData, Parameters};
use std::sync::Arc;

const FRAME_BLOCK: u32 = 0;
const TEXTURES: u32 = 1;
/// For acceleration structures: the driver's own, or texel buffers (nodes, triangles).
pub const TOP_LEVEL: u32 = 2;
pub const STRUCTURE_TEXELS: [u32; 2] = [3, 4];

/// What the sets are made for.
pub struct GlobalsInfo<'a> {
    pub textures: &'a [TextureImage],
    /// Writes the acceleration structure's descriptors into the set of a frame in flight.
    pub bind_structure: &'a dyn Fn(usize, &DescriptorSet),
    pub frames_in_flight: usize,
}

/// Descriptors and uniform buffers of set 0.
pub struct Globals {
    layout: Arc<SetLayout>,
    slots: Vec<(DescriptorSet, Buffer)>,
}

/// The layout of set 0 for a number of textures.
fn globals_layout(gpu: &Gpu, textures: usize) -> Result<Arc<SetLayout>, GpuError> {
    let mut bindings = vec![
        (FRAME_BLOCK, vk::DescriptorType::UNIFORM_BUFFER, 1),
        (TEXTURES, vk::DescriptorType::COMBINED_IMAGE_SAMPLER, textures.max(1) as u32),
        (STRUCTURE_TEXELS[0], vk::DescriptorType::UNIFORM_TEXEL_BUFFER, 1),
        (STRUCTURE_TEXELS[1], vk::DescriptorType::UNIFORM_TEXEL_BUFFER, 1),
    ];
    if gpu.capabilities().ray_query {
        bindings.push((TOP_LEVEL, vk::DescriptorType::ACCELERATION_STRUCTURE_KHR, 1));
    }
    SetLayout::new(gpu, bindings)
}

impl Globals {
    /// # Errors
    /// More textures than the device can bind.
    pub fn new(gpu: &Gpu, info: &GlobalsInfo) -> Result<Self, GpuError> {
        let limit = gpu.capabilities().max_textures as usize;
        if info.textures.len() > limit {
            let missing = format!("room for {} textures (it binds at most {limit})", info.textures.len());
            return Err(GpuError::MissingFeatures { device: gpu.capabilities().name.clone(), missing });
        }
        let layout = globals_layout(gpu, info.textures.len())?;
        let size = (size_of::<FrameData>() + size_of::<Parameters>()) as u64;
        let slot = |index: usize| {
            let usage = vk::BufferUsageFlags::UNIFORM_BUFFER;
            let buffer = gpu.create_buffer("frame data", size, usage, MemoryLocation::CpuToGpu)?;
            let set = DescriptorSet::new(&layout)?;
            set.write_buffer(FRAME_BLOCK, &buffer, size);
            set.write_textures(TEXTURES, info.textures);
            (info.bind_structure)(index, &set);
            Ok((set, buffer))
        };
        let slots = (0..info.frames_in_flight).map(slot).collect::<Result<_, GpuError>>()?;
        Ok(Self { layout, slots })
    }

    pub fn layout(&self) -> &Arc<SetLayout> {
        &self.layout
    }

    /// The set of one frame in flight.
    pub fn set(&self, slot: usize) -> &DescriptorSet {
        &self.slots[slot].0
    }

    /// What the next frame in this slot reads; the slot's last frame must be done.
    pub fn write(&mut self, slot: usize, data: &FrameData, parameters: &Parameters) {
        let bytes = self.slots[slot].1.mapped_mut().expect("host-visible memory is mapped");
        let (head, tail) = bytes.split_at_mut(size_of::<FrameData>());
        head.copy_from_slice(bytemuck::bytes_of(data));
        tail[..size_of::<Parameters>()].copy_from_slice(bytemuck::bytes_of(parameters));
    }
}
