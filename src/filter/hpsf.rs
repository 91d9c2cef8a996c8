//! Hashed path space filtering: shaders_glsl/filter/hpsf/, Binder, chapter 3; Meijer, section 4.2.
//!
//! Takes the diffuse terms and their filter vertices; returns `diffuse`, the mean over a cell of the world, and puts out `hpsf_samples`, the
//! samples that it is over (0: unfiltered). For hpsf.glossy the same for the specular terms, `specular` and `specular_samples`, with 4 bytes
//! of layer read per pixel and pass more. History: the table, persistent or swapped with every frame.
//!
//! Three passes, and before them up to two that give slots in a fixed order (24 bytes of vertex and 4 of key read per pixel and level).
//! collect: each pixel's sample into a cell, 56 bytes read per pixel, and per level 4 bytes of key (exact: 8) read and 28 (float: 16) of
//! sums updated. merge: over slots, 4 bytes read each, and for those taken 32 (16) of sums, 16 (at fp16: 8) of seed and as much of
//! cell. resolve: 56 bytes read and 20 written per pixel, 4 of key and 16 (8) of cell read per lookup and level. Where one of
//! [`STATISTICS`] is asked for, a fourth pass puts out what became of the insertions, and a fifth before it whose keys the slots hold.
//! hpsf/changes.rs lets cells forget where light has changed, and hpsf/iterate.rs filters again what has been filtered.

mod changes;
mod iterate;

use super::nhpsf::{self, Sending};
use super::smooth::Noisy;
use crate::frame::{BufferHandle, FrameBuilder, History, ImageHandle, PassBuilder};
use crate::gpu::{GpuError, vk};
use crate::paths::Retraced;
use crate::paths::terms::Terms;
use crate::paths::vertices::PathVertices;
pub use changes::Changes;
use iterate::Targets;

/// Specialization constants.
const CAPACITY: u32 = 221;
const SAMPLE_BITS: u32 = 222;
const FLOAT_SUMS: u32 = 223;
const PART: u32 = 231;
const ITERATION: u32 = 235;

/// Names of outputs about the table: slots looked at for each pixel's sample, its failed insertions, those that share another key's slot;
/// slots, and taken ones.
pub const STATISTICS: [&str; 5] = ["hpsf_probed", "hpsf_failed", "hpsf_collided", "hpsf_slots", "hpsf_taken"];

/// Bytes per slot.
const WORD: u64 = 4;

/// A float plus 1 is the same float from here on: all of a frame's samples may meet in one cell.
const MOST_COUNTED_IN_FLOATS: u64 = 1 << 24;

/// Which light a table is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    Both,
    Direct,
    Indirect,
    /// Of the lobes other than the diffuse one.
    Glossy,
    /// All light, at the vertices behind the first one.
    Behind,
}

/// Names of a table's passes and outputs.
struct Names {
    clear: &'static str,
    claim: &'static str,
    evict: &'static str,
    collect: &'static str,
    merge: &'static str,
    resolve: &'static str,
    changes: &'static str,
    forget: &'static str,
    change: &'static str,
    mean: &'static str,
    mean_before: &'static str,
    samples: &'static str,
}

impl Part {
    fn names(self) -> Names {
        match self {
            Self::Both => Names {
                clear: "hpsf clear",
                claim: "hpsf claim",
                evict: "hpsf evict",
                collect: "hpsf collect",
                merge: "hpsf merge",
                resolve: "hpsf resolve",
                changes: "hpsf changes",
                forget: "hpsf forget",
                change: "hpsf_change",
                mean: "diffuse",
                mean_before: "diffuse_before",
                samples: "hpsf_samples",
            },
            Self::Direct => Names { mean: "direct", mean_before: "direct_before", ..Self::Both.names() },
            Self::Indirect => Names {
                clear: "hpsf clear indirect",
                claim: "hpsf claim indirect",
                evict: "hpsf evict indirect",
                collect: "hpsf collect indirect",
                merge: "hpsf merge indirect",
                resolve: "hpsf resolve indirect",
                forget: "hpsf forget indirect",
                change: "hpsf_change_indirect",
                mean: "indirect",
                mean_before: "indirect_before",
                samples: "hpsf_samples_indirect",
                ..Self::Both.names()
            },
            Self::Glossy => Names {
                clear: "hpsf clear glossy",
                claim: "hpsf claim glossy",
                evict: "hpsf evict glossy",
                collect: "hpsf collect glossy",
                merge: "hpsf merge glossy",
                resolve: "hpsf resolve glossy",
                changes: "hpsf changes glossy",
                forget: "hpsf forget glossy",
                change: "specular_change",
                mean: "specular",
                mean_before: "specular_before",
                samples: "specular_samples",
            },
            Self::Behind => Names { clear: "nhpsf clear", merge: "nhpsf merge", ..Self::Both.names() },
        }
    }
}

/// What the table depends on.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    pub part: Part,
    pub cells_per_pixel: f64,
    /// Cells that a sample is added to.
    pub levels: u32,
    /// Vertices of a pixel's path that are added to cells.
    pub vertices: u32,
    /// Two tables that change places with every frame.
    pub swapped: bool,
    /// Keys of two words that hold all of the key, not a hash of it.
    pub exact_keys: bool,
    /// Slots are given in a fixed order, before samples are added; keys are not exact then.
    pub ordered: bool,
    /// Keys without a slot take those of cells that nobody has touched; `ordered` then.
    pub evicts: bool,
    /// Float atomics, where the device has them.
    pub float_sums: bool,
    /// How often pixels are filtered, 1 or more.
    pub iterations: u32,
    /// Put out [`STATISTICS`].
    pub statistics: bool,
}

/// What paths have found.
#[derive(Debug, Clone, Copy)]
pub struct Paths {
    pub terms: Terms,
    /// Vertices behind the first one, which send it what the last frame's cells know of them, and are filtered in the same cells.
    pub behind: Option<PathVertices>,
    /// And those of paths that are continued over frames.
    pub chains: Option<PathVertices>,
    /// Paths of the last frame that were traced again, which tell of changes.
    pub retraced: Option<Retraced>,
}

/// What a table says of each pixel.
#[derive(Debug, Clone, Copy)]
pub struct Filtered {
    pub noisy: Noisy,
    /// Relative change of the light since the last frame, 0..1, where paths were traced again.
    pub change: Option<ImageHandle>,
}

/// Cells of the world, and what is known of them.
pub struct Table {
    capacity: u32,
    keys: History<BufferHandle>,
    /// Of a slot.
    key_bytes: u64,
    cells: History<BufferHandle>,
    /// Of a slot: filter/hpsf/stored_cell.glsl.
    cell_bytes: u64,
    seeds: BufferHandle,
    sums: BufferHandle,
    float_sums: bool,
    options: Options,
    /// How often what it filters has been filtered before.
    iteration: u32,
    /// Of a frame's samples: at most one per pixel, vertex and level.
    insertions: u64,
}

impl Table {
    pub fn new(frame: &mut FrameBuilder, options: Options) -> Result<Self, GpuError> {
        let most_samples = u64::from(frame.pixels()) * u64::from(options.vertices);
        let (atomics, countable) = (frame.gpu().capabilities().float_atomics, most_samples <= MOST_COUNTED_IN_FLOATS);
        let float_sums = options.float_sums && atomics && countable;
        if options.float_sums && !float_sums {
            let why = if atomics { "a float cannot count so many samples" } else { "the device has no float atomics" };
            tracing::warn!("{why}: hpsf sums in fixed point");
        }
        let sums = if float_sums { 16 } else { 32 };
        let most = frame.gpu().capabilities().max_storage_buffer_range / sums;
        let wanted = (f64::from(frame.pixels()) * options.cells_per_pixel).ceil() as u64;
        let capacity = wanted.clamp(64, most.min(u32::MAX.into()));
        let exact_keys = options.exact_keys && !(options.ordered || options.evicts);
        if exact_keys != options.exact_keys {
            tracing::warn!("hpsf.keys=exact is for hpsf.insertion=first: fingerprints are used");
        }
        let key_bytes = if exact_keys { 2 * WORD } else { WORD };
        let cell_bytes = frame.precision().cell_bytes();
        Ok(Self {
            capacity: capacity as u32,
            keys: kept(frame, "hpsf keys", capacity * key_bytes, options.swapped)?,
            key_bytes,
            cells: kept(frame, "hpsf cells", capacity * cell_bytes, options.swapped)?,
            cell_bytes,
            seeds: frame.buffer("hpsf seeds", capacity * cell_bytes)?,
            sums: frame.kept_buffer("hpsf sums", capacity * sums)?,
            float_sums,
            options,
            iteration: 0,
            insertions: u64::from(frame.pixels()) * u64::from(options.levels) * u64::from(options.vertices),
        })
    }

    /// Sends what cells know to the vertices before, and collects vertices behind the first one alone: of a table that is about these. What
    /// they send to the pixels' comes last, when cells know what this frame's paths have found.
    pub fn learn(&self, frame: &mut FrameBuilder, terms: &Terms, vertices: &PathVertices) -> Result<(), GpuError> {
        nhpsf::transport(frame, self, terms, vertices, Sending::Behind)?;
        self.clear(frame);
        self.give_slots(frame, None, || std::iter::once(vertices))?;
        nhpsf::collect(frame, self, vertices)?;
        self.merge(frame)?;
        nhpsf::transport(frame, self, terms, vertices, Sending::First)
    }

    fn clear(&self, frame: &mut FrameBuilder) {
        if self.options.swapped {
            frame.fill(self.options.part.names().clear, self.keys.current, 0);
        }
    }

    /// What the paths that were traced again say of the light that the table is about: the same for tables of direct and of indirect light.
    pub fn changes(&self, frame: &mut FrameBuilder, paths: &Paths) -> Result<Option<Changes>, GpuError> {
        paths.retraced.map(|retraced| Changes::add(frame, retraced, self.options.part, self.options.levels)).transpose()
    }

    pub fn filter(&self, frame: &mut FrameBuilder, paths: &Paths, changes: Option<Changes>) -> Result<Filtered, GpuError> {
        let terms = &paths.terms;
        if let Some(vertices) = &paths.behind {
            nhpsf::transport(frame, self, terms, vertices, Sending::All)?;
        }
        self.clear(frame);
        let behind = || [&paths.behind, &paths.chains].into_iter().flatten().filter(|vertices| vertices.options.sampled() > 0);
        self.give_slots(frame, Some(terms), behind)?;
        self.collect(frame, terms)?;
        for vertices in behind() {
            nhpsf::collect(frame, self, vertices)?;
        }
        let change = changes.map(|changes| changes.forget(frame, self, terms)).transpose()?;
        self.merge(frame)?;
        if self.options.statistics {
            self.statistics(frame, terms)?;
        }
        let targets = Targets::new(frame, self)?;
        let first = self.resolve(frame, terms, targets.of(0))?;
        Ok(Filtered { noisy: iterate::add(frame, self, terms, first, targets)?, change })
    }

    /// To the pixels' keys, if they are in the table, and those behind, where slots are given before samples are added.
    fn give_slots<'v, V>(&self, frame: &mut FrameBuilder, terms: Option<&Terms>, behind: impl Fn() -> V) -> Result<(), GpuError>
    where
        V: Iterator<Item = &'v PathVertices>,
    {
        if !(self.options.ordered || self.options.evicts) {
            return Ok(());
        }
        let samples = frame.pixels();
        let names = self.options.part.names();
        if let Some(terms) = terms {
            self.claim(self.reads_points(frame.pass(names.claim, "filter/hpsf/claim_ordered"), terms), samples)?;
        }
        for vertices in behind() {
            nhpsf::claim(frame, self, vertices)?;
        }
        if self.options.evicts {
            if let Some(terms) = terms {
                self.evict(self.reads_points(frame.pass(names.evict, "filter/hpsf/evict"), terms), samples)?;
            }
            for vertices in behind() {
                nhpsf::evict(frame, self, vertices)?;
            }
        }
        Ok(())
    }

    /// A pass that gives slots to new keys.
    pub(super) fn claim(&self, pass: PassBuilder, samples: u32) -> Result<(), GpuError> {
        let touched = u64::from(samples) * u64::from(self.options.levels) * self.key_bytes;
        pass.constant(CAPACITY, self.capacity).updates("keys", self.keys.current).touching(touched).add()
    }

    /// A pass that gives them those of cells that nobody has touched.
    pub(super) fn evict(&self, pass: PassBuilder, samples: u32) -> Result<(), GpuError> {
        self.claim(pass.writes("cells", self.cells.current).touching(0), samples)
    }

    fn collect(&self, frame: &mut FrameBuilder, terms: &Terms) -> Result<(), GpuError> {
        let stem = self.stem("filter/hpsf/collect_float", "filter/hpsf/collect_fixed");
        let samples = frame.pixels();
        let pass = frame.pass(self.options.part.names().collect, stem);
        self.insert(self.reads_samples(pass, terms), samples)
    }

    /// The stem that is made for this table.
    pub(super) fn stem(&self, float_sums: &'static str, fixed_sums: &'static str) -> &'static str {
        if self.float_sums { float_sums } else { fixed_sums }
    }

    /// A pass that looks keys up, as `known_keys` and `known_cells`, in what earlier frames have left.
    pub fn looks_up<'b, 'a>(&self, pass: PassBuilder<'b, 'a>, keys: u64) -> PassBuilder<'b, 'a> {
        self.looks_up_in(pass, self.keys.previous, self.cells.previous, keys)
    }

    /// The same in what this frame's merge has left.
    pub(super) fn looks_up_now<'b, 'a>(&self, pass: PassBuilder<'b, 'a>, keys: u64) -> PassBuilder<'b, 'a> {
        self.looks_up_in(pass, self.keys.current, self.cells.current, keys)
    }

    fn looks_up_in<'b, 'a>(&self, pass: PassBuilder<'b, 'a>, keys: BufferHandle, cells: BufferHandle, count: u64) -> PassBuilder<'b, 'a> {
        let pass = pass.constant(CAPACITY, self.capacity).reads("known_keys", keys).touching(count * self.key_bytes);
        pass.reads("known_cells", cells).touching(count * self.cell_bytes)
    }

    /// A pass that adds samples to cells of each level.
    pub(super) fn insert(&self, pass: PassBuilder, samples: u32) -> Result<(), GpuError> {
        let (touched, sum) = (u64::from(samples) * u64::from(self.options.levels), if self.float_sums { 16 } else { 28 });
        let pass = pass.constant(CAPACITY, self.capacity).constant(SAMPLE_BITS, sample_bits(self.insertions));
        let pass = pass.updates("keys", self.keys.current).touching(touched * self.key_bytes);
        let pass = pass.updates("sums", self.sums).touching(touched * sum).writes("seeds", self.seeds);
        pass.reads("known_cells", self.cells.previous).reads("known_keys", self.keys.previous).add()
    }

    /// A pass over pixels that finds their samples' keys.
    fn reads_points<'b, 'a>(&self, pass: PassBuilder<'b, 'a>, terms: &Terms) -> PassBuilder<'b, 'a> {
        let pass = reads_vertices(pass, terms).constant(PART, self.options.part as u32).constant(ITERATION, self.iteration);
        let pass = pass.reads("filter_layer", terms.vertex.layer);
        if self.options.part == Part::Glossy { pass } else { pass.touching(0) }
    }

    fn reads_samples<'b, 'a>(&self, pass: PassBuilder<'b, 'a>, terms: &Terms) -> PassBuilder<'b, 'a> {
        let [direct, indirect] = match self.options.part {
            Part::Glossy => [terms.specular_direct, terms.specular_indirect],
            _ => [terms.diffuse_direct, terms.diffuse_indirect],
        };
        self.reads_points(pass.reads("direct", direct).reads("indirect", indirect), terms)
    }

    fn merge(&self, frame: &mut FrameBuilder) -> Result<(), GpuError> {
        let pass = frame.pass(self.options.part.names().merge, "filter/hpsf/merge").elements(self.capacity);
        let pass = pass.constant(PART, self.options.part as u32).constant(CAPACITY, self.capacity).constant(ITERATION, self.iteration);
        let pass = pass.constant(SAMPLE_BITS, sample_bits(self.insertions)).constant(FLOAT_SUMS, self.float_sums.into());
        let pass = pass.updates("keys", self.keys.current).updates("sums", self.sums);
        pass.reads("seeds", self.seeds).updates("cells", self.cells.current).add()
    }

    fn resolve(&self, frame: &mut FrameBuilder, terms: &Terms, mean: ImageHandle) -> Result<Noisy, GpuError> {
        let names = self.options.part.names();
        let samples = frame.image(names.samples, vk::Format::R32_UINT)?;
        let pixels = frame.pixels();
        let pass = self.reads_samples(frame.pass(names.resolve, "filter/hpsf/resolve"), terms);
        self.reads_cells(pass, pixels).writes("mean", mean).writes("samples", samples).add()?;
        Ok(Noisy { mean, samples })
    }

    /// A pass that looks this frame's keys up, one for each pixel.
    fn reads_cells<'b, 'a>(&self, pass: PassBuilder<'b, 'a>, pixels: u32) -> PassBuilder<'b, 'a> {
        let touched = u64::from(pixels);
        let pass = pass.constant(CAPACITY, self.capacity).reads("keys", self.keys.current).touching(touched * self.key_bytes);
        pass.reads("cells", self.cells.current).touching(touched * self.cell_bytes)
    }

    fn statistics(&self, frame: &mut FrameBuilder, terms: &Terms) -> Result<(), GpuError> {
        let owners = frame.buffer("hpsf owners", u64::from(self.capacity) * WORD)?;
        frame.fill("hpsf no owners", owners, u32::MAX);
        let pass = reads_vertices(frame.pass("hpsf owners", "filter/hpsf/owners"), terms).constant(CAPACITY, self.capacity);
        pass.reads("keys", self.keys.current).updates("owners", owners).add()?;
        let images = STATISTICS.map(|name| frame.image(name, vk::Format::R32_UINT).map(|image| (name, image)));
        let pass = reads_vertices(frame.pass("hpsf statistics", "filter/hpsf/statistics"), terms).constant(CAPACITY, self.capacity);
        let pass = pass.reads("keys", self.keys.current).reads("owners", owners).reads("filter_layer", terms.vertex.layer);
        images.into_iter().try_fold(pass, |pass, image| image.map(|(name, image)| pass.writes(name, image)))?.add()
    }
}

/// A pair that is swapped with every frame, or one buffer in both places.
fn kept(frame: &mut FrameBuilder, name: &str, size: u64, swapped: bool) -> Result<History<BufferHandle>, GpuError> {
    if swapped {
        return frame.buffer_history(name, size);
    }
    let buffer = frame.kept_buffer(name, size)?;
    Ok(History { previous: buffer, current: buffer })
}

fn reads_vertices<'b, 'a>(pass: PassBuilder<'b, 'a>, terms: &Terms) -> PassBuilder<'b, 'a> {
    let pass = pass.reads("filter_position", terms.vertex.position).reads("filter_normal", terms.vertex.normal);
    pass.reads("filter_incident", terms.vertex.incident)
}

/// Bits of the largest sample in fixed point, so that no sum of so many overflows 64 (fixed_point.glsl).
fn sample_bits(insertions: u64) -> u32 {
    (64 - (insertions + 1).next_power_of_two().trailing_zeros()).min(40)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_sum_of_largest_samples_overflows() {
        for insertions in [1, 640 * 360, 1920 * 1080 * 4, 3840 * 2160 * 4, 7680 * 4320 * 4] {
            let bits = sample_bits(insertions);
            let sum = u128::from(insertions) * (1u128 << bits);
            assert!(sum < 1 << 64, "{insertions}: {bits}");
            assert!(bits == 40 || 2 * sum >= 1 << 63, "{insertions}: {bits} wastes bits");
        }
    }
}
