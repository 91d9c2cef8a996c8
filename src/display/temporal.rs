//! Temporal antialiasing: shaders_glsl/display/temporal.comp.
//!
//! Takes radiance and the g-buffer; returns `temporal`, the mean over frames of what has been seen of a point (w: frames). History: that, and
//! its depth. Reads 68 bytes per pixel (neighbours come from caches), 20 more where changes are
//! known, and writes 20; 52 and 12 at fp16.

use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::{GpuError, vk};
use crate::paths::gbuffer::GBuffer;

/// What is known of changes since the last frame.
#[derive(Debug, Clone, Copy)]
pub struct Changes {
    /// 0 where a pixel's vertex sends what it sent before.
    pub change: ImageHandle,
    /// w: above 0 where there is such a vertex.
    pub vertices: ImageHandle,
}

/// Specialization constant.
const KNOWS_CHANGES: u32 = 234;

pub fn add(frame: &mut FrameBuilder, gbuffer: &GBuffer, radiance: ImageHandle, changes: Option<Changes>) -> Result<ImageHandle, GpuError> {
    let mean = frame.color_history("temporal")?;
    let depth = frame.image_history("temporal_depth", vk::Format::R32_SFLOAT)?;
    let pass = frame.pass("temporal", "display/temporal").reads("radiance", radiance);
    let pass = pass.reads("motion", gbuffer.motion).reads("position", gbuffer.position);
    let pass = pass.reads("known", mean.previous).writes("temporal", mean.current);
    let pass = pass.constant(KNOWS_CHANGES, changes.is_some().into());
    let pass = match changes {
        Some(Changes { change, vertices }) => pass.reads("change", change).reads("vertices", vertices),
        // Bound, and not read.
        None => pass.reads("change", depth.previous).touching(0).reads("vertices", gbuffer.position).touching(0),
    };
    pass.reads("known_depth", depth.previous).writes("temporal_depth", depth.current).add()?;
    Ok(mean.current)
}
