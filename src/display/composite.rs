//! Recombines a path's terms to radiance: shaders_glsl/display/composite.comp, Meijer, section 4.1.
//!
//! Takes the six terms, or a filter's result in place of the two diffuse ones; returns `radiance`. No history. Reads 96 bytes per pixel, or
//! 80 with a filter, and writes 16, half of it at fp16.

use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;
use crate::paths::terms::Terms;

/// Specialization constant: the diffuse terms are one.
const FILTERED: u32 = 202;

pub fn add(frame: &mut FrameBuilder, terms: &Terms) -> Result<ImageHandle, GpuError> {
    let radiance = frame.color_image("radiance")?;
    let pass = frame.pass("composite", "display/composite").writes("radiance", radiance);
    terms.named().into_iter().fold(pass, |pass, (name, image)| pass.reads(name, image)).add()?;
    Ok(radiance)
}

/// `diffuse`: what a filter has made of both diffuse terms.
pub fn add_filtered(frame: &mut FrameBuilder, terms: &Terms, diffuse: ImageHandle) -> Result<ImageHandle, GpuError> {
    let radiance = frame.color_image("radiance")?;
    let pass = frame.pass("composite", "display/composite").constant(FILTERED, 1).writes("radiance", radiance);
    let pass = pass.reads("before", terms.before).reads("attenuation", terms.attenuation).reads("diffuse_direct", diffuse);
    let pass = pass.reads("diffuse_indirect", diffuse).touching(0);
    pass.reads("specular_direct", terms.specular_direct).reads("specular_indirect", terms.specular_indirect).add()?;
    Ok(radiance)
}
