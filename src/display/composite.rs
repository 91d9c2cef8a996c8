//! Recombines a path's terms to radiance: shaders_glsl/display/composite.comp, Meijer, section 4.1.
//!
//! Takes the six terms; returns `radiance`. No history. Reads 96 and writes 16 bytes per pixel, half of it at fp16.

use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;
use crate::paths::megakernel::Terms;

pub fn add(frame: &mut FrameBuilder, terms: &Terms) -> Result<ImageHandle, GpuError> {
    let radiance = frame.color_image("radiance")?;
    let pass = frame.pass("composite", "display/composite").writes("radiance", radiance);
    terms.named().into_iter().fold(pass, |pass, (name, image)| pass.reads(name, image)).add()?;
    Ok(radiance)
}
