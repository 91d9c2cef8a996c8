//! The filter vertices of paths behind their first one: shaders_glsl/paths/vertices.glsl.

use crate::frame::{BufferHandle, FrameBuilder, ImageHandle, PassBuilder};
use crate::gpu::{GpuError, vk};

/// How long lists become, and how they end.
#[derive(Debug, Clone, Copy)]
pub struct ListOptions {
    /// Vertices of a list at most; the path ends there, or with the ray from there, which can find a light and nothing else.
    pub most: u32,
    /// It ends there: the last vertex is there to be looked up, no light is looked for at it, and it has no sample.
    pub last_is_read: bool,
}

impl ListOptions {
    /// Vertices of a list that have samples: the first ones.
    pub fn sampled(&self) -> u32 {
        self.most - u32::from(self.last_is_read)
    }

    /// Of a kernel that makes lists.
    pub fn constants<'b, 'a>(&self, pass: PassBuilder<'b, 'a>) -> PassBuilder<'b, 'a> {
        pass.constant(MOST_VERTICES, self.most).constant(LAST_IS_READ, self.last_is_read.into())
    }
}

/// A list of vertices for each pixel's path; 48 bytes a vertex.
#[derive(Debug, Clone, Copy)]
pub struct PathVertices {
    pub options: ListOptions,
    /// Length of the pixel's list.
    pub count: ImageHandle,
    /// What becomes of the first one's radiance on the way to `specular_indirect`.
    pub specular_attenuation: ImageHandle,
    pub places: BufferHandle,
    pub links: BufferHandle,
    pub light: BufferHandle,
}

/// Where paths can be continued: at the last vertex of a list, which is only looked up.
#[derive(Debug, Clone, Copy)]
pub struct PathEnds {
    /// One for each pixel, 48 bytes (shaders_glsl/paths/end.glsl).
    pub places: BufferHandle,
    /// Rays so far, to be counted on.
    pub ray_count: ImageHandle,
}

/// Declares for a kernel where it looks up whether a list may end: so many keys at most.
pub type LooksUp<'k> = dyn for<'b, 'a> Fn(PassBuilder<'b, 'a>, u64) -> PassBuilder<'b, 'a> + 'k;

/// Of a vertex, in each of a list's buffers.
const BYTES: u64 = 16;

/// Specialization constants.
const MOST_VERTICES: u32 = 204;
const LAST_IS_READ: u32 = 205;

impl PathVertices {
    /// # Errors
    /// More bytes than a kernel of this device can see of one buffer.
    pub(super) fn new(frame: &mut FrameBuilder, options: ListOptions) -> Result<Self, GpuError> {
        let bytes = BYTES * u64::from(frame.pixels()) * u64::from(options.most);
        Ok(Self {
            options,
            count: frame.image("path_vertices", vk::Format::R32_UINT)?,
            specular_attenuation: frame.color_image("specular_attenuation")?,
            places: frame.buffer("places of path vertices", bytes)?,
            links: frame.buffer("links of path vertices", bytes)?,
            light: frame.buffer("light of path vertices", bytes)?,
        })
    }

    pub(super) fn written_by<'b, 'a>(&self, pass: PassBuilder<'b, 'a>) -> PassBuilder<'b, 'a> {
        let pass = self.options.constants(pass);
        let pass = pass.writes("path_vertices", self.count).writes("specular_attenuation", self.specular_attenuation);
        pass.writes("vertex_places", self.places).writes("vertex_links", self.links).writes("vertex_light", self.light)
    }

    /// By a kernel that begins lists: empty ones.
    pub(super) fn begun_by<'b, 'a>(&self, pass: PassBuilder<'b, 'a>) -> PassBuilder<'b, 'a> {
        pass.writes("path_vertices", self.count).writes("specular_attenuation", self.specular_attenuation)
    }

    /// By a kernel that adds a vertex to each of so many lists.
    pub(super) fn lengthened_by<'b, 'a>(&self, pass: PassBuilder<'b, 'a>, lists: u64) -> PassBuilder<'b, 'a> {
        let bytes = lists * BYTES;
        let pass = self.options.constants(pass);
        let pass = pass.updates("path_vertices", self.count).writes("specular_attenuation", self.specular_attenuation).touching(0);
        let pass = pass.writes("vertex_places", self.places).touching(bytes).writes("vertex_links", self.links).touching(bytes);
        pass.updates("vertex_light", self.light).touching(bytes)
    }

    /// By a kernel that adds light to a vertex of each of so many lists.
    pub(super) fn lit_by<'b, 'a>(&self, pass: PassBuilder<'b, 'a>, lists: u64) -> PassBuilder<'b, 'a> {
        pass.updates("vertex_light", self.light).touching(lists * BYTES)
    }
}
