//! Storage images that passes write, and sampled textures.

use super::capabilities::Capabilities;
use super::device::Gpu;
use super::error::{Context, GpuError};
use ash::vk;
use bytemuck::Pod;
use gpu_allocator::MemoryLocation;
use gpu_allocator::vulkan::Allocation;

/// A two-dimensional image. Always in `GENERAL` layout once it is made: the storage images of compute passes gain nothing from
/// other layouts, and barriers need not know images.
pub struct Image {
    gpu: Gpu,
    raw: vk::Image,
    view: vk::ImageView,
    allocation: Option<Allocation>,
    info: ImageInfo,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImageInfo {
    pub format: vk::Format,
    /// Pixels.
    pub extent: [u32; 2],
    pub mip_levels: u32,
}

impl ImageInfo {
    pub fn storage(format: vk::Format, extent: [u32; 2]) -> Self {
        Self { format, extent, mip_levels: 1 }
    }
}

impl Gpu {
    /// An image for storage and transfer, cleared to zero.
    pub fn create_image(&self, name: &str, info: ImageInfo) -> Result<Image, GpuError> {
        use vk::ImageUsageFlags as Usage;
        let image = self.image_with_usage(name, info, Usage::STORAGE | Usage::TRANSFER_SRC | Usage::TRANSFER_DST)?;
        self.submit_once(|commands| {
            commands.make_general(&image);
            commands.clear_image(&image);
        })?;
        Ok(image)
    }

    fn image_with_usage(&self, name: &str, info: ImageInfo, usage: vk::ImageUsageFlags) -> Result<Image, GpuError> {
        let [width, height] = info.extent;
        let Capabilities { max_image_side: most, name: device, .. } = self.capabilities();
        if width.max(height) > *most {
            return Err(GpuError::TooLarge { what: name.to_owned(), width, height, device: device.clone(), most: *most });
        }
        let create = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(info.format)
            .extent(vk::Extent3D { width, height, depth: 1 })
            .mip_levels(info.mip_levels)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(usage);
        // SAFETY: plain creation; Image's drop destroys what exists, also where a later step fails.
        let raw = unsafe { self.raw().create_image(&create, None) }.context(&format!("create image '{name}' of {width}x{height}"))?;
        let mut image = Image { gpu: self.clone(), raw, view: vk::ImageView::null(), allocation: None, info };
        // SAFETY: the image was just created.
        let requirements = unsafe { self.raw().get_image_memory_requirements(raw) };
        let allocation = self.allocate(name, requirements, MemoryLocation::GpuOnly, false)?;
        // SAFETY: the allocation was made for this image's requirements.
        let bound = unsafe { self.raw().bind_image_memory(raw, allocation.memory(), allocation.offset()) };
        image.allocation = Some(allocation);
        bound.map_err(|result| GpuError::Memory {
            what: format!("image '{name}'"),
            bytes: requirements.size,
            message: result.to_string(),
        })?;
        let view = vk::ImageViewCreateInfo::default()
            .image(raw)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(info.format)
            .subresource_range(image.range());
        // SAFETY: the image has memory.
        image.view = unsafe { self.raw().create_image_view(&view, None) }.context(&format!("view image '{name}'"))?;
        self.set_name(raw, name);
        Ok(image)
    }

    /// Texels of an image's first level, row by row; waits for the device.
    pub fn download_image<T: Pod>(&self, image: &Image) -> Result<Vec<T>, GpuError> {
        let size = image.byte_size();
        let target = self.create_buffer("image download", size, vk::BufferUsageFlags::empty(), MemoryLocation::GpuToCpu)?;
        self.submit_once(|commands| commands.copy_image_to_buffer(image, &target))?;
        Ok(bytemuck::pod_collect_to_vec(&target.mapped().expect("host-visible memory is mapped")[..size as usize]))
    }
}

impl Image {
    pub fn raw(&self) -> vk::Image {
        self.raw
    }

    pub fn view(&self) -> vk::ImageView {
        self.view
    }

    pub fn info(&self) -> ImageInfo {
        self.info
    }

    /// Bytes of the first level.
    pub fn byte_size(&self) -> u64 {
        let [width, height] = self.info.extent;
        u64::from(width) * u64::from(height) * texel_bytes(self.info.format)
    }

    /// As GLSL names it.
    pub fn format_qualifier(&self) -> &'static str {
        match self.info.format {
            vk::Format::R32G32B32A32_SFLOAT => "rgba32f",
            vk::Format::R16G16B16A16_SFLOAT => "rgba16f",
            vk::Format::R32G32B32A32_UINT => "rgba32ui",
            vk::Format::R32G32_SFLOAT => "rg32f",
            vk::Format::R32_SFLOAT => "r32f",
            vk::Format::R32_UINT => "r32ui",
            other => unreachable!("no pass stores to images of format {other:?}"),
        }
    }

    /// Device memory that it takes, all levels.
    pub fn allocated_bytes(&self) -> u64 {
        self.allocation.as_ref().map_or(0, |allocation| allocation.size())
    }

    pub(super) fn range(&self) -> vk::ImageSubresourceRange {
        let color = vk::ImageAspectFlags::COLOR;
        vk::ImageSubresourceRange::default().aspect_mask(color).level_count(self.info.mip_levels).layer_count(1)
    }
}

impl Drop for Image {
    fn drop(&mut self) {
        // SAFETY: the owner has seen to it that the device no longer uses the image. Null handles are ignored.
        unsafe {
            self.gpu.raw().destroy_image_view(self.view, None);
            self.gpu.raw().destroy_image(self.raw, None);
        }
        if let Some(allocation) = self.allocation.take() {
            self.gpu.free(allocation);
        }
    }
}

/// Bytes per texel of the formats in use.
fn texel_bytes(format: vk::Format) -> u64 {
    match format {
        vk::Format::R32G32B32A32_SFLOAT | vk::Format::R32G32B32A32_UINT => 16,
        vk::Format::R16G16B16A16_SFLOAT | vk::Format::R32G32_SFLOAT => 8,
        vk::Format::R32_SFLOAT | vk::Format::R32_UINT | vk::Format::R8G8B8A8_UNORM | vk::Format::R8G8B8A8_SRGB => 4,
        other => unreachable!("no pass uses images of format {other:?}"),
    }
}

/// A sampled image with its sampler.
pub struct TextureImage {
    pub image: Image,
    pub sampler: vk::Sampler,
}

impl TextureImage {
    /// Uploads a mip chain of RGBA8 levels.
    pub fn new(gpu: &Gpu, name: &str, info: ImageInfo, mips: &[Vec<u8>], sampler: &vk::SamplerCreateInfo) -> Result<Self, GpuError> {
        let image = gpu.image_with_usage(name, info, vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST)?;
        let staging = gpu.staging(name, &mips.concat())?;
        gpu.submit_once(|commands| {
            commands.make_general(&image);
            commands.copy_buffer_to_mips(&staging, &image, mips.iter().map(|mip| mip.len() as u64));
        })?;
        // SAFETY: plain creation, destroyed in drop.
        let sampler = unsafe { gpu.raw().create_sampler(sampler, None) }.context("create a sampler")?;
        Ok(Self { image, sampler })
    }
}

impl Drop for TextureImage {
    fn drop(&mut self) {
        // SAFETY: the owner has seen to it that the device no longer uses the texture.
        unsafe { self.image.gpu.raw().destroy_sampler(self.sampler, None) };
    }
}
