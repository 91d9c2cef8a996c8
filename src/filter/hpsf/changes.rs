//! Where light changes, cells forget: shaders_glsl/filter/hpsf/changes.comp and forget.comp; Binder, section 3.4.1.
//!
//! Takes paths of the last frame as they were then and are now, and this frame's filter vertices; lowers the samples that cells of the table
//! claim to know. Puts out `hpsf_change`, the relative change at each pixel's vertex. No history of its own.
//!
//! changes: 52 bytes read per retraced path, and per level 56 updated of a table of as many slots, which is cleared before. forget: 24 bytes
//! read and 4 written per pixel, and per level 56 read and, where there is change, 20 updated.

use super::{CAPACITY, FLOAT_SUMS, SAMPLE_BITS, Table, reads_vertices, sample_bits};
use crate::frame::FrameBuilder;
use crate::gpu::{GpuError, vk};
use crate::paths::Retraced;
use crate::paths::terms::Terms;

/// Specialization constant.
const CHANGE_CAPACITY: u32 = 225;

/// Levels that the shader adds to the filter's.
const FURTHER_LEVELS: u32 = 2;

/// Bytes per slot.
const CHANGE: u64 = 56;

pub(super) fn add(frame: &mut FrameBuilder, table: &Table, terms: &Terms, retraced: Retraced, levels: u32) -> Result<(), GpuError> {
    let slots = retraced.paths * (levels + FURTHER_LEVELS);
    let bits = sample_bits(table.insertions);
    let changes = frame.buffer("hpsf changes", u64::from(slots) * CHANGE)?;
    frame.fill("hpsf changes clear", changes, 0);
    let pass = frame.pass("hpsf changes", "filter/hpsf/changes").elements(retraced.paths).constant(CHANGE_CAPACITY, slots);
    let pass = pass.constant(SAMPLE_BITS, bits).reads("kept", retraced.before).reads("retraced", retraced.now);
    pass.updates("changes", changes).add()?;

    let change = frame.image("hpsf_change", vk::Format::R32_SFLOAT)?;
    let touched = table.insertions;
    let pass = reads_vertices(frame.pass("hpsf forget", "filter/hpsf/forget"), terms).constant(CHANGE_CAPACITY, slots);
    let pass = pass.constant(SAMPLE_BITS, bits).constant(CAPACITY, table.capacity).constant(FLOAT_SUMS, table.float_sums.into());
    let pass = pass.reads("changes", changes).touching(touched * CHANGE);
    let pass = pass.reads("keys", table.keys.current).touching(touched * table.key_bytes);
    let pass = pass.reads("sums", table.sums).touching(touched * 4).updates("cells", table.cells.current).touching(touched * 4);
    pass.updates("seeds", table.seeds).touching(touched * 4).writes("hpsf_change", change).add()
}
