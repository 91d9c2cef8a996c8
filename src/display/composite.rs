//! Recombines a path's terms to radiance: shaders_glsl/display/composite.comp, Meijer, section 4.1.
//!
//! Takes the six terms, or filters' results in place of the diffuse or the specular ones; returns `radiance`. No history. Reads 96 bytes per
//! pixel, 16 less for each two that a filter has made one of, and writes 16, half of it at fp16.

use crate::frame::{FrameBuilder, ImageHandle, PassBuilder};
use crate::gpu::GpuError;
use crate::paths::terms::Terms;

/// Specialization constants: a filter has made one of both diffuse terms, or of both specular ones.
const ONE_DIFFUSE: u32 = 202;
const ONE_SPECULAR: u32 = 204;

pub fn add(frame: &mut FrameBuilder, terms: &Terms) -> Result<ImageHandle, GpuError> {
    let diffuse = [terms.diffuse_direct, terms.diffuse_indirect];
    add_parts(frame, terms, diffuse, [terms.specular_direct, terms.specular_indirect])
}

/// `diffuse`: what a filter has made of both diffuse terms.
pub fn add_filtered(frame: &mut FrameBuilder, terms: &Terms, diffuse: ImageHandle) -> Result<ImageHandle, GpuError> {
    add_parts(frame, terms, [diffuse; 2], [terms.specular_direct, terms.specular_indirect])
}

/// What filters have made of direct and indirect light; twice the same image where it is their sum.
pub fn add_parts(
    frame: &mut FrameBuilder,
    terms: &Terms,
    diffuse: [ImageHandle; 2],
    specular: [ImageHandle; 2],
) -> Result<ImageHandle, GpuError> {
    let radiance = frame.color_image("radiance")?;
    let pass = frame.pass("composite", "display/composite").writes("radiance", radiance);
    let pass = pass.constant(ONE_DIFFUSE, (diffuse[0] == diffuse[1]).into()).constant(ONE_SPECULAR, (specular[0] == specular[1]).into());
    let pass = pass.reads("before", terms.before).reads("attenuation", terms.attenuation);
    let pass = reads_two(pass, ["diffuse_direct", "diffuse_indirect"], diffuse);
    reads_two(pass, ["specular_direct", "specular_indirect"], specular).add()?;
    Ok(radiance)
}

fn reads_two<'b, 'a>(pass: PassBuilder<'b, 'a>, names: [&'static str; 2], images: [ImageHandle; 2]) -> PassBuilder<'b, 'a> {
    let pass = pass.reads(names[0], images[0]).reads(names[1], images[1]);
    if images[0] == images[1] { pass.touching(0) } else { pass }
}
