//! Temporal antialiasing: shaders_glsl/display/temporal.comp.
//!
//! Takes radiance and the g-buffer; returns `temporal`, the mean over frames of what has been seen of a point (w: frames). History: that, and
//! its depth. Reads 68 bytes per pixel (neighbours come from caches), 20 more where changes are
//! known, and writes 20; 52 and 12 at fp16.

use crate::frame::{FrameBuilder, History, ImageHandle, PassBuilder};
use crate::gpu::{GpuError, vk};
use crate::paths::gbuffer::GBuffer;

/// What earlier frames know.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    mean: History<ImageHandle>,
    depth: History<ImageHandle>,
}

impl Known {
    pub fn new(frame: &mut FrameBuilder) -> Result<Self, GpuError> {
        Ok(Self { mean: frame.color_history("temporal")?, depth: frame.image_history("temporal_depth", vk::Format::R32_SFLOAT)? })
    }

    /// For a pass whose shader includes display/history.glsl.
    pub fn looks_up<'a, 'b>(&self, pass: PassBuilder<'a, 'b>, gbuffer: &GBuffer) -> PassBuilder<'a, 'b> {
        let pass = pass.reads("motion", gbuffer.motion).reads("position", gbuffer.position);
        pass.reads("known", self.mean.previous).reads("known_depth", self.depth.previous)
    }
}

/// What is known of changes since the last frame.
#[derive(Debug, Clone, Copy)]
pub struct Changes {
    /// 0 where a pixel's vertex sends what it sent before.
    pub change: ImageHandle,
    /// w: above 0 where there is such a vertex, below it where a light is seen instead.
    pub vertices: ImageHandle,
}

/// Specialization constant.
const KNOWS_CHANGES: u32 = 234;

pub fn add(
    frame: &mut FrameBuilder,
    gbuffer: &GBuffer,
    known: &Known,
    radiance: ImageHandle,
    changes: Option<Changes>,
) -> Result<ImageHandle, GpuError> {
    let pass = frame.pass("temporal", "display/temporal").constant(KNOWS_CHANGES, changes.is_some().into());
    let pass = known.looks_up(pass.reads("radiance", radiance), gbuffer);
    let pass = match changes {
        Some(Changes { change, vertices }) => pass.reads("change", change).reads("vertices", vertices),
        // Bound, and not read.
        None => pass.reads("change", known.depth.previous).touching(0).reads("vertices", gbuffer.position).touching(0),
    };
    pass.writes("temporal", known.mean.current).writes("temporal_depth", known.depth.current).add()?;
    Ok(known.mean.current)
}
