//! Where light changes, cells forget: shaders_glsl/filter/hpsf/changes.comp and forget.comp; Binder, section 3.4.1.
//!
//! Takes paths of the last frame as they were then and are now, and this frame's filter vertices; lowers the samples that cells of the table
//! claim to know. Puts out `hpsf_change` (`hpsf_change_indirect`, `specular_change`), the relative change in each pixel's cells. No history
//! of its own.
//!
//! changes, once for the tables of direct and of indirect light: 88 bytes read per retraced path, and 64 updated for each of the filter's levels
//! and two more, of a table of 64 bytes for each of four more, which is cleared before. forget: 24 bytes read (of glossy lobes 28) and 4 written per
//! pixel, and per level 64 read and, where there is change, 20 updated for each lookup.
//!
//! What a table of changes says does not depend on the order of threads. That of cells can, where keys find no slot, unless hpsf.insertion orders
//! them: with hpsf+ and an object that moves that happens to no or a few pixels of a frame.

use super::{CAPACITY, FLOAT_SUMS, PART, Part, SAMPLE_BITS, Table, sample_bits};
use crate::frame::{BufferHandle, FrameBuilder, ImageHandle};
use crate::gpu::{GpuError, vk};
use crate::paths::Retraced;
use crate::paths::terms::Terms;

/// Specialization constant.
const CHANGE_CAPACITY: u32 = 225;

/// Slots per path, besides the filter's levels: more than it has keys, two further levels and one for what comes into view or other lobes,
/// so that no key is left without a slot, and every search ends.
const FURTHER_SLOTS: u32 = 4;

/// Bytes per slot.
const CHANGE: u64 = 64;

/// What retraced paths say, by cell.
#[derive(Debug, Clone, Copy)]
pub struct Changes {
    buffer: BufferHandle,
    slots: u32,
}

impl Changes {
    /// Of the lobes that tables of `part` are about: the same for all but the glossy one. `levels`: that a sample is added to.
    pub(super) fn add(frame: &mut FrameBuilder, retraced: Retraced, part: Part, levels: u32) -> Result<Self, GpuError> {
        let slots = retraced.paths * (levels + FURTHER_SLOTS);
        let buffer = frame.buffer("hpsf changes", u64::from(slots) * CHANGE)?;
        frame.fill("hpsf changes clear", buffer, 0);
        let pass = frame.pass(part.names().changes, "filter/hpsf/changes").elements(retraced.paths);
        let pass = pass.constant(CHANGE_CAPACITY, slots).constant(SAMPLE_BITS, sample_bits(slots.into())).constant(PART, part as u32);
        pass.reads("kept", retraced.before).reads("retraced", retraced.now).updates("changes", buffer).add()?;
        Ok(Self { buffer, slots })
    }

    /// Lets a table's cells forget.
    pub(super) fn forget(&self, frame: &mut FrameBuilder, table: &Table, terms: &Terms) -> Result<ImageHandle, GpuError> {
        let names = table.options.part.names();
        let change = frame.image(names.change, vk::Format::R32_SFLOAT)?;
        let touched = table.insertions;
        let pass = table.reads_points(frame.pass(names.forget, "filter/hpsf/forget"), terms).constant(CHANGE_CAPACITY, self.slots);
        let pass = pass.constant(SAMPLE_BITS, sample_bits(self.slots.into())).constant(CAPACITY, table.capacity);
        let pass = pass.constant(FLOAT_SUMS, table.float_sums.into()).reads("changes", self.buffer).touching(touched * CHANGE);
        let pass = pass.reads("keys", table.keys.current).touching(touched * table.key_bytes);
        let pass = pass.reads("sums", table.sums).touching(touched * 4).updates("cells", table.cells.current).touching(touched * 4);
        pass.updates("seeds", table.seeds).touching(touched * 4).writes("change", change).add()?;
        Ok(change)
    }
}
