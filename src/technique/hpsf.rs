//! `hpsf`: the radiance behind the filter vertex, averaged over cells of the world that a hash table keeps.

use super::{PassOptions, Technique};
use crate::display::{composite, temporal};
use crate::filter::hpsf::{self, Options, Paths, Table};
use crate::filter::smooth;
use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;
use crate::paths::gbuffer;

/// The value of hpsf.time.
const HYBRID: f64 = 3.0;

pub(super) const TECHNIQUE: Technique = Technique {
    name: "hpsf",
    help: "one path per pixel; what arrives at its first diffuse vertex is averaged over hashed cells of the world, and over frames",
    accumulates: false,
    max_spp: 1,
    extra_outputs: &hpsf::STATISTICS,
    defaults: &[],
    passes,
};

fn passes(frame: &mut FrameBuilder, options: PassOptions) -> Result<ImageHandle, GpuError> {
    passes_of(frame, options, 1, |frame, _| add_paths(frame, options))
}

/// `vertices`: of a path that are added to cells.
pub(super) fn passes_of(
    frame: &mut FrameBuilder,
    options: PassOptions,
    vertices: u32,
    add_paths: impl FnOnce(&mut FrameBuilder, &Table) -> Result<Paths, GpuError>,
) -> Result<ImageHandle, GpuError> {
    let over_frames = options.parameters.number("hpsf.temporal") == 1.0;
    let wanted = over_frames || options.wants(&gbuffer::OUTPUTS);
    let gbuffer = wanted.then(|| gbuffer::add(frame)).transpose()?;
    let table = Table::new(frame, Options { vertices, ..table_options(options) })?;
    let paths = add_paths(frame, &table)?;
    let filtered = table.filter(frame, &paths)?;
    let diffuse = smooth::add(frame, &paths.terms.vertex, filtered, options.parameters.number("hpsf.smooth") as usize)?;
    let radiance = composite::add_filtered(frame, &paths.terms, diffuse)?;
    match gbuffer {
        Some(gbuffer) if over_frames => temporal::add(frame, &gbuffer, radiance),
        _ => Ok(radiance),
    }
}

/// Paths; some of the last frame's, too, where cells want to know of changes.
fn add_paths(frame: &mut FrameBuilder, options: PassOptions) -> Result<Paths, GpuError> {
    if options.parameters.number("hpsf.time") != HYBRID {
        return Ok(Paths { terms: options.kernel().add_with_terms(frame)?, behind: None, chains: None, retraced: None });
    }
    let (terms, retraced) = options.kernel().add_with_retraced(frame, options.parameters.number("hpsf.retrace") as u32)?;
    Ok(Paths { terms, behind: None, chains: None, retraced: Some(retraced) })
}

fn table_options(options: PassOptions) -> Options {
    let number = |key| options.parameters.number(key);
    Options {
        cells_per_pixel: number("hpsf.cells"),
        levels: number("hpsf.levels") as u32,
        vertices: 1,
        swapped: number("hpsf.table") == 1.0,
        ordered: number("hpsf.insertion") == 1.0,
        evicts: number("hpsf.eviction") == 1.0,
        exact_keys: number("hpsf.keys") == 1.0,
        float_sums: number("hpsf.sums") == 1.0,
        statistics: options.wants(&hpsf::STATISTICS),
    }
}
