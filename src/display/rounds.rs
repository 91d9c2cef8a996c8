//! The mean over the rounds of a frame: shaders_glsl/display/rounds.comp.
//!
//! Takes a round's picture; returns `rounds`, the mean so far, which the last round completes. Updated in place and begun anew by a frame's
//! first round. Reads 32 and writes 16 bytes per pixel, half of it at fp16.

use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;

pub fn add(frame: &mut FrameBuilder, picture: ImageHandle) -> Result<ImageHandle, GpuError> {
    let mean = frame.color_image("rounds")?;
    frame.pass("rounds", "display/rounds").reads("picture", picture).updates("mean", mean).add()?;
    Ok(mean)
}
