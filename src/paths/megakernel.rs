//! Whole paths in one kernel: shaders_glsl/paths/megakernel.glsl, with radiance summed up (megakernel.comp) or its terms apart
//! (megakernel_terms.comp; Meijer, section 4.1, algorithm 1).
//!
//! Takes the scene. Also returns `ray_count`: scattered rays in the low, shadow rays in the high 16 bits. No history. Writes 20 bytes per
//! pixel, or 124 with terms (12 and 76 at fp16), 24 of them for the filter vertex; traces up to 2 (bounces + 1) + 1 rays per sample.

use super::terms::Terms;
use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::{DeviceKind, GpuError, vk};

/// Specialization constant: tiles of a workgroup.
const TILES: u32 = 201;

/// Tiles of 8x4 pixels that a workgroup works off, one pixel per thread and tile. More of them keep more threads busy while long paths
/// go on; fewer keep more workgroups for wide devices.
fn tiles_per_group(frame: &FrameBuilder) -> u32 {
    let most = if frame.gpu().capabilities().kind == DeviceKind::Software { 16 } else { 4 };
    // Enough workgroups for small pictures, too.
    (tiles(frame) / 64).clamp(1, most)
}

fn tiles(frame: &FrameBuilder) -> u32 {
    let [width, height] = frame.extent();
    width.div_ceil(8) * height.div_ceil(4)
}

/// Radiance, the mean of the frame's samples per pixel.
pub fn add(frame: &mut FrameBuilder) -> Result<ImageHandle, GpuError> {
    let radiance = frame.color_image("radiance")?;
    let ray_count = frame.image("ray_count", vk::Format::R32_UINT)?;
    let (per_group, groups) = (tiles_per_group(frame), tiles(frame).div_ceil(tiles_per_group(frame)));
    let pass = frame.pass("megakernel", "paths/megakernel").constant(TILES, per_group).groups(groups);
    pass.writes("radiance", radiance).writes("ray_count", ray_count).add()?;
    Ok(radiance)
}

/// One sample per pixel, through the same point of the pixel as the g-buffer's.
pub fn add_with_terms(frame: &mut FrameBuilder) -> Result<Terms, GpuError> {
    let terms = Terms::new(frame)?;
    let ray_count = frame.image("ray_count", vk::Format::R32_UINT)?;
    let (per_group, groups) = (tiles_per_group(frame), tiles(frame).div_ceil(tiles_per_group(frame)));
    let pass = frame.pass("megakernel", "paths/megakernel_terms").constant(TILES, per_group).groups(groups);
    let pass = pass.writes("ray_count", ray_count).writes("filter_position", terms.vertex.position);
    let pass = pass.writes("filter_normal", terms.vertex.normal).writes("filter_incident", terms.vertex.incident);
    terms.named().into_iter().fold(pass, |pass, (name, image)| pass.writes(name, image)).add()?;
    Ok(terms)
}
