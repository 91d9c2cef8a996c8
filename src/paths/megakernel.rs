//! Whole paths in one kernel: shaders_glsl/paths/megakernel.glsl, with radiance summed up (megakernel.comp) or its terms apart
//! (megakernel_terms.comp; Meijer, section 4.1, algorithm 1), with some of the last frame's paths traced again (megakernel_retraced.comp), or
//! with the vertices behind the filter vertex (megakernel_vertices.comp).
//!
//! Takes the scene. Also returns `ray_count`: scattered rays in the low, shadow rays in the high 16 bits. No history. Writes 20 bytes per
//! pixel, or 128 with terms (12 and 80 at fp16), 28 of them for the filter vertex; traces up to 2 (bounces + 1) + 1 rays per sample, and more from the
//! first vertex as rays.first_shadow_rays and lights.sole say. Radiance
//! keeps 16 more, which only frames in several submissions touch.

use super::terms::Terms;
use super::tiles;
use super::vertices::{ListOptions, LooksUp, PathEnds, PathVertices};
use crate::frame::{BufferHandle, FrameBuilder, ImageHandle, PassBuilder};
use crate::gpu::{DeviceKind, GpuError, vk};

/// Specialization constant: tiles of a workgroup.
const TILES: u32 = 201;
/// The first workgroup that retraces.
const RETRACING_GROUP: u32 = 203;

/// Bytes of a path that is kept for the next frame, and of one that is retraced.
const KEPT: u64 = 32;
const RETRACED: u64 = 56;

/// Bytes (shaders_glsl/paths/end.glsl).
const END: u64 = 48;
/// Bytes of what one submission leaves to the next (megakernel.comp).
const SUM: u64 = 16;

/// Tiles of 8x4 pixels that a workgroup works off, one pixel per thread and tile. More of them keep more threads busy while long paths
/// go on; fewer keep more workgroups for wide devices.
fn tiles_per_group(frame: &FrameBuilder) -> u32 {
    let most = if frame.gpu().capabilities().kind == DeviceKind::Software { 16 } else { 4 };
    // Enough workgroups for small pictures, too.
    (tiles(frame.extent()) / 64).clamp(1, most)
}

/// Workgroups for a field of so many pixels.
fn groups_for(frame: &FrameBuilder, extent: [u32; 2]) -> u32 {
    tiles(extent).div_ceil(tiles_per_group(frame))
}

/// Radiance, the mean of the frame's samples per pixel.
pub fn add(frame: &mut FrameBuilder) -> Result<ImageHandle, GpuError> {
    let radiance = frame.color_image("radiance")?;
    let ray_count = frame.image("ray_count", vk::Format::R32_UINT)?;
    let sums = frame.buffer("sums over samples", SUM * u64::from(frame.pixels()))?;
    let (per_group, groups) = (tiles_per_group(frame), groups_for(frame, frame.extent()));
    let first = frame.next_pass();
    let pass = frame.pass("megakernel", "paths/megakernel").constant(TILES, per_group).groups(groups);
    pass.writes("radiance", radiance).writes("ray_count", ray_count).updates("sums", sums).touching(0).add()?;
    frame.share_samples(first);
    Ok(radiance)
}

/// One sample per pixel, through the same point of the pixel as the g-buffer's.
pub fn add_with_terms(frame: &mut FrameBuilder) -> Result<Terms, GpuError> {
    let terms = Terms::new(frame)?;
    let ray_count = frame.image("ray_count", vk::Format::R32_UINT)?;
    terms.written_by(terms_pass(frame, "paths/megakernel_terms", ray_count)).add()?;
    Ok(terms)
}

/// As [`add_with_terms`], with the vertices of the path behind its filter vertex: 48 bytes for each, and 20 for each pixel.
pub fn add_with_vertices(frame: &mut FrameBuilder, options: ListOptions, known: &LooksUp) -> Result<(Terms, PathVertices), GpuError> {
    let terms = Terms::new(frame)?;
    let vertices = PathVertices::new(frame, options)?;
    let ray_count = frame.image("ray_count", vk::Format::R32_UINT)?;
    let keys = u64::from(frame.pixels());
    let pass = terms.written_by(terms_pass(frame, "paths/megakernel_vertices", ray_count));
    known(vertices.written_by(pass), keys).add()?;
    Ok((terms, vertices))
}

/// Paths that are traced in two frames: shaders_glsl/paths/retraced.glsl.
#[derive(Debug, Clone, Copy)]
pub struct Retraced {
    /// One for each square of pixels.
    pub paths: u32,
    /// What they found in the last frame, and what they find now.
    pub before: BufferHandle,
    pub now: BufferHandle,
}

/// The same, and once more one of the last frame's paths for each square of `side` pixels a side: 88 bytes and up to 2 (bounces + 1) + 1 rays
/// for each. History: those of this frame that the next one will retrace, 32 bytes each. Also returns `retraced_ray_count`, in its first pixels.
pub fn add_with_retraced(frame: &mut FrameBuilder, side: u32) -> Result<(Terms, Retraced), GpuError> {
    let terms = Terms::new(frame)?;
    let ray_count = frame.image("ray_count", vk::Format::R32_UINT)?;
    let retraced_ray_count = frame.image("retraced_ray_count", vk::Format::R32_UINT)?;
    let squares = frame.extent().map(|pixels| pixels.div_ceil(side));
    let paths = squares[0] * squares[1];
    let kept = frame.buffer_history("kept paths", u64::from(paths) * KEPT)?;
    let now = frame.buffer("retraced paths", u64::from(paths) * RETRACED)?;
    let (own, further) = (groups_for(frame, frame.extent()), groups_for(frame, squares));
    let per_group = tiles_per_group(frame);
    let pass = frame.pass("megakernel", "paths/megakernel_retraced").constant(TILES, per_group).groups(own + further);
    let pass = pass.constant(RETRACING_GROUP, own).writes("ray_count", ray_count);
    let pass = pass.writes("retraced_ray_count", retraced_ray_count).touching(4 * u64::from(paths));
    terms.written_by(pass.writes("kept", kept.current).writes("retraced", now)).add()?;
    Ok((terms, Retraced { paths, before: kept.previous, now }))
}

/// The same as [`add_with_vertices`], and where paths can be continued: 48 bytes a pixel (shaders_glsl/paths/end.glsl), where a list's last
/// vertex is there to be looked up.
pub fn add_with_ends(frame: &mut FrameBuilder, options: ListOptions, known: &LooksUp) -> Result<(Terms, PathVertices, PathEnds), GpuError> {
    let terms = Terms::new(frame)?;
    let vertices = PathVertices::new(frame, options)?;
    let pixels = u64::from(frame.pixels());
    let places = frame.buffer("ends of paths", END * pixels)?;
    let ends = PathEnds { places, ray_count: frame.image("ray_count", vk::Format::R32_UINT)? };
    let pass = terms.written_by(terms_pass(frame, "paths/megakernel_ends", ends.ray_count)).writes("ends", ends.places);
    known(vertices.written_by(pass), pixels).add()?;
    Ok((terms, vertices, ends))
}

fn terms_pass<'b, 'a>(frame: &'b mut FrameBuilder<'a>, stem: &'static str, ray_count: ImageHandle) -> PassBuilder<'b, 'a> {
    let (per_group, groups) = (tiles_per_group(frame), groups_for(frame, frame.extent()));
    frame.pass("megakernel", stem).constant(TILES, per_group).groups(groups).writes("ray_count", ray_count)
}
