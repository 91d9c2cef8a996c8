//! Radiance terms of one path per pixel, kept apart at the filter vertex: shaders_glsl/paths/terms.glsl, Meijer, section 4.1, algorithm 1.

use crate::frame::{FrameBuilder, ImageHandle, PassBuilder};
use crate::gpu::{GpuError, vk};

/// What one path per pixel is made of; shaders_glsl/paths/terms.glsl says how the terms sum up.
#[derive(Debug, Clone, Copy)]
pub struct Terms {
    pub before: ImageHandle,
    pub attenuation: ImageHandle,
    pub diffuse_direct: ImageHandle,
    pub diffuse_indirect: ImageHandle,
    pub specular_direct: ImageHandle,
    pub specular_indirect: ImageHandle,
    pub vertex: FilterVertex,
}

/// Where the terms are kept apart: the first vertex with a diffuse lobe.
#[derive(Debug, Clone, Copy)]
pub struct FilterVertex {
    /// Relative to the frame's origin, metres; w: view-plane distance of the path up to it, 0 where there is no such vertex.
    pub position: ImageHandle,
    /// Octahedral, 32 bits: shading normal, and the way the path arrives.
    pub normal: ImageHandle,
    pub incident: ImageHandle,
    /// Of the lobes other than the diffuse one (shaders_glsl/lib/layer.glsl), where the specular terms may be filtered; else 0.
    pub layer: ImageHandle,
}

impl Terms {
    pub(super) fn new(frame: &mut FrameBuilder) -> Result<Self, GpuError> {
        Ok(Self {
            before: frame.color_image("before")?,
            attenuation: frame.color_image("attenuation")?,
            diffuse_direct: frame.color_image("diffuse_direct")?,
            diffuse_indirect: frame.color_image("diffuse_indirect")?,
            specular_direct: frame.color_image("specular_direct")?,
            specular_indirect: frame.color_image("specular_indirect")?,
            vertex: FilterVertex {
                position: frame.image("filter_position", vk::Format::R32G32B32A32_SFLOAT)?,
                normal: frame.image("filter_normal", vk::Format::R32_UINT)?,
                incident: frame.image("filter_incident", vk::Format::R32_UINT)?,
                layer: frame.image("filter_layer", vk::Format::R32_UINT)?,
            },
        })
    }

    /// By a kernel with paths/write_terms.glsl.
    pub(super) fn written_by<'b, 'a>(&self, pass: PassBuilder<'b, 'a>) -> PassBuilder<'b, 'a> {
        let pass = pass.writes("filter_position", self.vertex.position).writes("filter_normal", self.vertex.normal);
        let pass = pass.writes("filter_incident", self.vertex.incident).writes("filter_layer", self.vertex.layer);
        self.named().into_iter().fold(pass, |pass, (name, image)| pass.writes(name, image))
    }

    /// Each with its name in shaders.
    pub fn named(&self) -> [(&'static str, ImageHandle); 6] {
        [
            ("before", self.before),
            ("attenuation", self.attenuation),
            ("diffuse_direct", self.diffuse_direct),
            ("diffuse_indirect", self.diffuse_indirect),
            ("specular_direct", self.specular_direct),
            ("specular_indirect", self.specular_indirect),
        ]
    }
}
