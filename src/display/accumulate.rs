//! The mean over all frames and its variance: shaders_glsl/display/accumulate.comp.
//!
//! Takes radiance; returns `mean` and `variance` (of the mean, frames as batches; 0 after one frame). History: rounded sum, its lost part,
//! squared deviations, updated in place and started anew by frame 0. Reads 64 and writes 80 bytes per pixel.

use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::{GpuError, vk};

pub fn add(frame: &mut FrameBuilder, radiance: ImageHandle) -> Result<ImageHandle, GpuError> {
    let rgba = vk::Format::R32G32B32A32_SFLOAT;
    let (high, low, deviations) = (frame.image("sum_high", rgba)?, frame.image("sum_low", rgba)?, frame.image("deviations", rgba)?);
    let (mean, variance) = (frame.image("mean", rgba)?, frame.image("variance", rgba)?);
    let pass = frame.pass("accumulate", "display/accumulate").reads("radiance", radiance);
    let pass = pass.updates("sum_high", high).updates("sum_low", low).updates("deviations", deviations);
    pass.writes("mean", mean).writes("variance", variance).add()?;
    Ok(mean)
}
