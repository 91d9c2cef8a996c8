//! Vulkan through ash, and nothing above it: one device with one compute queue, its memory, pipelines and timers.
//!
//! Every other module reaches Vulkan through [`Gpu`]; `unsafe` stays in here (and where acceleration structures are built).

mod buffer;
mod capabilities;
mod command;
mod descriptor;
mod device;
mod error;
mod image;
mod instance;
mod pipeline;
mod pipeline_cache;
mod shader;
mod submit;
mod timer;

pub use ash::vk;
pub use buffer::{Buffer, TexelBuffer};
pub use capabilities::{Capabilities, DeviceKind, Substitute};
pub use command::Commands;
pub use descriptor::{DescriptorSet, SetLayout};
pub use device::{DeviceOptions, Gpu};
pub use error::GpuError;
pub use gpu_allocator::MemoryLocation;
pub use image::{Image, ImageInfo, TextureImage};
pub use instance::list_devices;
pub use pipeline::{ComputePipeline, Specialization};
pub use shader::{load_shader, shader_stems, traces_rays};
pub use submit::FrameRing;
pub use timer::Timer;
