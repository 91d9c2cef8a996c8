//! Filters again what a table has filtered: shaders_glsl/filter/hpsf/iteration.glsl.
//!
//! Takes the means of the filtering before and the filter vertices; returns means, with the samples and the variance that they came with. No
//! history: keys and cells are of this frame alone, and sums are the table's own, which its merge leaves at zero.
//!
//! Three passes each time, the table's own or like them. collect: 40 bytes read per pixel, and per level what the table's collect updates.
//! merge: as there, less the seed. resolve: 40 bytes read and 16 written per pixel, 20 read per lookup and level. Before them keys are
//! cleared, and given slots where the table orders them.

use super::{Noisy, Options, Table};
use crate::frame::{BufferHandle, FrameBuilder, History, ImageHandle};
use crate::gpu::GpuError;
use crate::paths::terms::Terms;

/// Images of means: the last filtering writes `last`, and those before it take turns with `before`.
#[derive(Clone, Copy)]
pub(super) struct Targets {
    last: ImageHandle,
    before: ImageHandle,
    iterations: u32,
}

impl Targets {
    /// One image where filtering is not repeated.
    pub(super) fn new(frame: &mut FrameBuilder, table: &Table) -> Result<Self, GpuError> {
        let (names, iterations) = (table.options.part.names(), table.options.iterations);
        let last = frame.color_image(names.mean)?;
        let before = if iterations > 1 { frame.color_image(names.mean_before)? } else { last };
        Ok(Self { last, before, iterations })
    }

    pub(super) fn of(self, iteration: u32) -> ImageHandle {
        if (self.iterations - iteration) % 2 == 1 { self.last } else { self.before }
    }
}

/// What a table's first filtering has made, filtered as often as its options say.
pub(super) fn add(frame: &mut FrameBuilder, table: &Table, terms: &Terms, first: Noisy, targets: Targets) -> Result<Noisy, GpuError> {
    if table.options.iterations == 1 {
        return Ok(first);
    }
    let again = of_one_frame(frame, table)?;
    (1..table.options.iterations).try_fold(first, |noisy, iteration| {
        let again = Table { iteration, ..again };
        Ok(Noisy { mean: again.filter_again(frame, terms, noisy.mean, targets.of(iteration))?, ..noisy })
    })
}

/// A table without history for the same sums.
fn of_one_frame(frame: &mut FrameBuilder, table: &Table) -> Result<Table, GpuError> {
    let mut own = |name, bytes| frame.buffer(name, u64::from(table.capacity) * bytes).map(in_both_places);
    let (keys, cells) = (own("hpsf keys again", table.key_bytes)?, own("hpsf cells again", table.cell_bytes)?);
    // All keys are of this frame: there is nothing to evict, but slots are given in an order where evicting asks for one.
    let options = Options { swapped: true, ordered: table.options.ordered || table.options.evicts, evicts: false, ..table.options };
    Ok(Table { keys, cells, options, ..*table })
}

fn in_both_places(buffer: BufferHandle) -> History<BufferHandle> {
    History { previous: buffer, current: buffer }
}

impl Table {
    fn filter_again(
        &self,
        frame: &mut FrameBuilder,
        terms: &Terms,
        filtered: ImageHandle,
        mean: ImageHandle,
    ) -> Result<ImageHandle, GpuError> {
        let names = self.options.part.names();
        self.clear(frame);
        self.give_slots(frame, Some(terms), std::iter::empty)?;
        let stem = self.stem("filter/hpsf/collect_filtered_float", "filter/hpsf/collect_filtered_fixed");
        let pixels = frame.pixels();
        let pass = self.reads_points(frame.pass(names.collect, stem), terms).reads("filtered", filtered);
        self.insert(pass, pixels)?;
        self.merge(frame)?;
        let pass = self.reads_points(frame.pass(names.resolve, "filter/hpsf/resolve_filtered"), terms).reads("filtered", filtered);
        self.reads_cells(pass, pixels).writes("mean", mean).add()?;
        Ok(mean)
    }
}
