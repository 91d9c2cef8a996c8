//! Screen-space path space filtering: shaders_glsl/filter/sspsf.comp, Meijer, section 4.1.
//!
//! Takes the diffuse terms and their filter vertices; returns `diffuse`, their mean over similar vertices of the window. No history.
//! Reads 52 bytes per pixel (the window's other pixels come from caches) and writes 16.

use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;
use crate::paths::terms::Terms;

pub fn add(frame: &mut FrameBuilder, terms: &Terms) -> Result<ImageHandle, GpuError> {
    let diffuse = frame.color_image("diffuse")?;
    let pass = frame.pass("sspsf", "filter/sspsf").writes("diffuse", diffuse);
    let pass = pass.reads("diffuse_direct", terms.diffuse_direct).reads("diffuse_indirect", terms.diffuse_indirect);
    pass.reads("filter_position", terms.vertex.position).reads("filter_normal", terms.vertex.normal).add()?;
    Ok(diffuse)
}
