//! `hpsf`: the radiance behind the filter vertex, averaged over cells of the world that a hash table keeps.

use super::{PassOptions, Technique};
use crate::display::{composite, temporal};
use crate::filter::hpsf::{self, Options};
use crate::filter::smooth;
use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;
use crate::paths::terms::Terms;
use crate::paths::{Retraced, gbuffer};

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

pub(super) fn passes(frame: &mut FrameBuilder, options: PassOptions) -> Result<ImageHandle, GpuError> {
    let over_frames = options.parameters.number("hpsf.temporal") == 1.0;
    let wanted = over_frames || options.wants(&gbuffer::OUTPUTS);
    let gbuffer = wanted.then(|| gbuffer::add(frame)).transpose()?;
    let (terms, retraced) = add_paths(frame, options)?;
    let filtered = hpsf::add(frame, &terms, Options { retraced, ..table(options) })?;
    let diffuse = smooth::add(frame, &terms.vertex, filtered, options.parameters.number("hpsf.smooth") as usize)?;
    let radiance = composite::add_filtered(frame, &terms, diffuse)?;
    match gbuffer {
        Some(gbuffer) if over_frames => temporal::add(frame, &gbuffer, radiance),
        _ => Ok(radiance),
    }
}

/// Paths; some of the last frame's, too, where cells want to know of changes.
fn add_paths(frame: &mut FrameBuilder, options: PassOptions) -> Result<(Terms, Option<Retraced>), GpuError> {
    if options.parameters.number("hpsf.time") != HYBRID {
        return Ok((options.kernel().add_with_terms(frame)?, None));
    }
    let (terms, retraced) = options.kernel().add_with_retraced(frame, options.parameters.number("hpsf.retrace") as u32)?;
    Ok((terms, Some(retraced)))
}

fn table(options: PassOptions) -> Options {
    let number = |key| options.parameters.number(key);
    Options {
        cells_per_pixel: number("hpsf.cells"),
        levels: number("hpsf.levels") as u32,
        swapped: number("hpsf.table") == 1.0,
        ordered: number("hpsf.insertion") == 1.0,
        evicts: number("hpsf.eviction") == 1.0,
        exact_keys: number("hpsf.keys") == 1.0,
        float_sums: number("hpsf.sums") == 1.0,
        statistics: options.wants(&hpsf::STATISTICS),
        retraced: None,
    }
}
