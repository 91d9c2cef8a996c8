//! Where light changes, cells forget: shaders_glsl/filter/hpsf/changes.comp and forget.comp; Binder, section 3.4.1.
//!
//! Takes paths of the last frame as they were then and are now, and this frame's filter vertices; lowers the samples that cells of the table
//! claim to know. Puts out `hpsf_change` (`hpsf_change_indirect`, `specular_change`), the relative change in each pixel's cells. No history
//! of its own.
//!
//! changes: 80 bytes read per retraced path, and per level 64 updated of a table of as many slots, which is cleared before. forget: 24 bytes
//! read (of glossy lobes 28) and 4 written per pixel, and per level 64 read and, where there is change, 20 updated for each lookup.

use super::{CAPACITY, FLOAT_SUMS, PART, SAMPLE_BITS, Table, sample_bits};
use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::{GpuError, vk};
use crate::paths::Retraced;
use crate::paths::terms::Terms;

/// Specialization constant.
const CHANGE_CAPACITY: u32 = 225;

/// Levels that the shader adds to the filter's, those of what comes into view among them.
const FURTHER_LEVELS: u32 = 4;

/// Bytes per slot.
const CHANGE: u64 = 64;

pub(super) fn add(
    frame: &mut FrameBuilder,
    table: &Table,
    terms: &Terms,
    retraced: Retraced,
    levels: u32,
) -> Result<ImageHandle, GpuError> {
    let slots = retraced.paths * (levels + FURTHER_LEVELS);
    let bits = sample_bits(table.insertions);
    let names = table.options.part.names();
    let changes = frame.buffer("hpsf changes", u64::from(slots) * CHANGE)?;
    frame.fill("hpsf changes clear", changes, 0);
    let pass = frame.pass(names.changes, "filter/hpsf/changes").elements(retraced.paths).constant(CHANGE_CAPACITY, slots);
    let pass = pass
        .constant(PART, table.options.part as u32)
        .constant(SAMPLE_BITS, bits)
        .reads("kept", retraced.before)
        .reads("retraced", retraced.now);
    pass.updates("changes", changes).add()?;

    let change = frame.image(names.change, vk::Format::R32_SFLOAT)?;
    let touched = table.insertions;
    let pass = table.reads_points(frame.pass(names.forget, "filter/hpsf/forget"), terms).constant(CHANGE_CAPACITY, slots);
    let pass = pass.constant(SAMPLE_BITS, bits).constant(CAPACITY, table.capacity).constant(FLOAT_SUMS, table.float_sums.into());
    let pass = pass.reads("changes", changes).touching(touched * CHANGE);
    let pass = pass.reads("keys", table.keys.current).touching(touched * table.key_bytes);
    let pass = pass.reads("sums", table.sums).touching(touched * 4).updates("cells", table.cells.current).touching(touched * 4);
    pass.updates("seeds", table.seeds).touching(touched * 4).writes("change", change).add()?;
    Ok(change)
}
