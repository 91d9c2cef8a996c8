//! Temporal antialiasing: shaders_glsl/display/temporal.comp.
//!
//! Takes radiance and the g-buffer; returns `temporal`, the mean over frames of what has been seen of a point (w: frames). History: that, and
//! its depth. Reads 68 bytes per pixel (neighbours come from caches) and writes 20; 52 and 12 at fp16.

use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::{GpuError, vk};
use crate::paths::gbuffer::GBuffer;

pub fn add(frame: &mut FrameBuilder, gbuffer: &GBuffer, radiance: ImageHandle) -> Result<ImageHandle, GpuError> {
    let mean = frame.color_history("temporal")?;
    let depth = frame.image_history("temporal_depth", vk::Format::R32_SFLOAT)?;
    let pass = frame.pass("temporal", "display/temporal").reads("radiance", radiance);
    let pass = pass.reads("motion", gbuffer.motion).reads("position", gbuffer.position);
    let pass = pass.reads("known", mean.previous).writes("temporal", mean.current);
    pass.reads("known_depth", depth.previous).writes("temporal_depth", depth.current).add()?;
    Ok(mean.current)
}
