//! The primary hit of each pixel: shaders_glsl/paths/gbuffer.comp.
//!
//! Takes the scene and this frame's jitter. Returns `position` (relative to the frame's origin, metres; w: distance, negative for a
//! miss), `normal` (shading; w: its cosine with the geometric one), `albedo` (of the diffuse lobe; w: roughness), `motion` (pixels, to
//! where the point was in the last frame; z: change of depth, metres; w: was in front of the camera) and `identity` (instance,
//! primitive, material, metalness bits). Position and motion, which are
//! coordinates, stay in single precision. No history. Writes 80 bytes per pixel, 64 at fp16; traces one ray.

use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::{GpuError, vk};

#[derive(Debug, Clone, Copy)]
pub struct GBuffer {
    pub position: ImageHandle,
    pub normal: ImageHandle,
    pub albedo: ImageHandle,
    pub motion: ImageHandle,
    pub identity: ImageHandle,
}

/// Names of what the pass puts out.
pub const OUTPUTS: [&str; 5] = ["position", "normal", "albedo", "motion", "identity"];

pub fn add(frame: &mut FrameBuilder) -> Result<GBuffer, GpuError> {
    let rgba = vk::Format::R32G32B32A32_SFLOAT;
    let buffer = GBuffer {
        position: frame.image("position", rgba)?,
        normal: frame.color_image("normal")?,
        albedo: frame.color_image("albedo")?,
        motion: frame.image("motion", rgba)?,
        identity: frame.image("identity", vk::Format::R32G32B32A32_UINT)?,
    };
    let pass = frame.pass("gbuffer", "paths/gbuffer").writes("position", buffer.position).writes("normal", buffer.normal);
    pass.writes("albedo", buffer.albedo).writes("motion", buffer.motion).writes("identity", buffer.identity).add()?;
    Ok(buffer)
}
