//! The mean over all frames and its variance: shaders_glsl/display/accumulate.comp.
//!
//! Takes radiance; returns `mean` and `variance` (of the mean, frames as batches; 0 after one frame). History: rounded sum, its lost part,
//! squared deviations, updated in place and started anew by frame 0. Reads 64 and writes 80 bytes per pixel, half of it at fp16.

use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;

pub fn add(frame: &mut FrameBuilder, radiance: ImageHandle) -> Result<ImageHandle, GpuError> {
    let (high, low, deviations) = (frame.color_image("sum_high")?, frame.color_image("sum_low")?, frame.color_image("deviations")?);
    let (mean, variance) = (frame.color_image("mean")?, frame.color_image("variance")?);
    let pass = frame.pass("accumulate", "display/accumulate").reads("radiance", radiance);
    let pass = pass.updates("sum_high", high).updates("sum_low", low).updates("deviations", deviations);
    pass.writes("mean", mean).writes("variance", variance).add()?;
    Ok(mean)
}
