//! What passes read and write: images of the picture's size and buffers, of one frame or kept from frame to frame.
//!
//! A frame's own resources hold nothing when it begins. What is kept is a [`History`], or is updated in place; a restart resets
//! both, so that no frame before it can be seen.

use crate::gpu::{Buffer, Commands, Gpu, GpuError, Image, ImageInfo, MemoryLocation, vk};

/// An image of the frame under construction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ImageHandle(usize);

/// A storage buffer of the frame under construction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct BufferHandle(usize);

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Resource {
    Image(ImageHandle),
    Buffer(BufferHandle),
}

impl From<ImageHandle> for Resource {
    fn from(image: ImageHandle) -> Self {
        Self::Image(image)
    }
}

impl From<BufferHandle> for Resource {
    fn from(buffer: BufferHandle) -> Self {
        Self::Buffer(buffer)
    }
}

/// Two of a kind that change places with every frame: what the last frame left in `current` is in `previous` now. Zero after a restart.
#[derive(Debug, Clone, Copy)]
pub struct History<Handle> {
    pub previous: Handle,
    pub current: Handle,
}

/// Of a frame: even or odd, which tells the places of a [`History`] apart.
pub(super) type Parity = usize;

/// One handle's memory, by the frame's parity.
type Places = [usize; 2];

/// Everything that a frame's passes may touch.
#[derive(Default)]
pub(super) struct Resources {
    images: Vec<Image>,
    buffers: Vec<Buffer>,
    image_places: Vec<Places>,
    buffer_places: Vec<Places>,
    /// What can be looked at, by the name of its output.
    named: Vec<(&'static str, ImageHandle)>,
    /// Indices of the memory that a restart makes zero.
    kept_images: Vec<usize>,
    kept_buffers: Vec<usize>,
}

impl Resources {
    pub fn image(&mut self, gpu: &Gpu, name: &'static str, info: ImageInfo) -> Result<ImageHandle, GpuError> {
        let place = self.new_image(gpu, name, info)?;
        let handle = self.image_at([place; 2]);
        self.named.push((name, handle));
        Ok(handle)
    }

    pub fn image_history(&mut self, gpu: &Gpu, name: &'static str, info: ImageInfo) -> Result<History<ImageHandle>, GpuError> {
        let (a, b) = (self.new_image(gpu, name, info)?, self.new_image(gpu, name, info)?);
        self.kept_images.extend([a, b]);
        let history = History { previous: self.image_at([b, a]), current: self.image_at([a, b]) };
        self.named.push((name, history.current));
        Ok(history)
    }

    pub fn buffer(&mut self, gpu: &Gpu, name: &str, size: u64) -> Result<BufferHandle, GpuError> {
        let place = self.new_buffer(gpu, name, size)?;
        Ok(self.buffer_at([place; 2]))
    }

    pub fn kept_buffer(&mut self, gpu: &Gpu, name: &str, size: u64) -> Result<BufferHandle, GpuError> {
        let place = self.new_buffer(gpu, name, size)?;
        self.kept_buffers.push(place);
        Ok(self.buffer_at([place; 2]))
    }

    pub fn buffer_history(&mut self, gpu: &Gpu, name: &str, size: u64) -> Result<History<BufferHandle>, GpuError> {
        let (a, b) = (self.new_buffer(gpu, name, size)?, self.new_buffer(gpu, name, size)?);
        self.kept_buffers.extend([a, b]);
        Ok(History { previous: self.buffer_at([b, a]), current: self.buffer_at([a, b]) })
    }

    fn new_image(&mut self, gpu: &Gpu, name: &str, info: ImageInfo) -> Result<usize, GpuError> {
        self.images.push(gpu.create_image(name, info)?);
        Ok(self.images.len() - 1)
    }

    fn new_buffer(&mut self, gpu: &Gpu, name: &str, size: u64) -> Result<usize, GpuError> {
        let most = gpu.capabilities().max_storage_buffer_range;
        if size > most {
            let message = format!("this device's kernels see at most {most} bytes of a buffer; try a smaller --size");
            return Err(GpuError::Memory { what: name.to_owned(), bytes: size, message });
        }
        self.buffers.push(gpu.create_buffer(name, size, vk::BufferUsageFlags::empty(), MemoryLocation::GpuOnly)?);
        Ok(self.buffers.len() - 1)
    }

    fn image_at(&mut self, places: Places) -> ImageHandle {
        self.image_places.push(places);
        ImageHandle(self.image_places.len() - 1)
    }

    fn buffer_at(&mut self, places: Places) -> BufferHandle {
        self.buffer_places.push(places);
        BufferHandle(self.buffer_places.len() - 1)
    }

    pub fn image_of(&self, handle: ImageHandle, parity: Parity) -> &Image {
        &self.images[self.image_places[handle.0][parity]]
    }

    pub fn buffer_of(&self, handle: BufferHandle, parity: Parity) -> &Buffer {
        &self.buffers[self.buffer_places[handle.0][parity]]
    }

    /// Whether it is at another place in every other frame.
    pub fn alternates(&self, resource: Resource) -> bool {
        let [even, odd] = match resource {
            Resource::Image(handle) => self.image_places[handle.0],
            Resource::Buffer(handle) => self.buffer_places[handle.0],
        };
        even != odd
    }

    pub fn byte_size(&self, resource: Resource) -> u64 {
        match resource {
            Resource::Image(handle) => self.image_of(handle, 0).byte_size(),
            Resource::Buffer(handle) => self.buffer_of(handle, 0).size(),
        }
    }

    pub fn named(&self) -> impl Iterator<Item = (&'static str, ImageHandle)> {
        self.named.iter().copied()
    }

    /// A buffer's handle without memory.
    #[cfg(test)]
    pub fn placeholder(&mut self) -> Resource {
        self.buffer_at([0; 2]).into()
    }

    /// Makes zero what is kept.
    pub fn reset(&self, commands: &Commands) {
        self.kept_images.iter().for_each(|&place| commands.clear_image(&self.images[place]));
        self.kept_buffers.iter().for_each(|&place| commands.fill_buffer(&self.buffers[place], 0));
    }

    /// Whether [`Self::reset`] has anything to do.
    pub fn keeps_anything(&self) -> bool {
        !(self.kept_images.is_empty() && self.kept_buffers.is_empty())
    }
}
