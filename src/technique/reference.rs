//! `reference`: path tracing, accumulated over any number of frames, with the variance of the result.

use super::{PassOptions, Technique};
use crate::display::accumulate;
use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;
use crate::paths::gbuffer;

pub(super) const TECHNIQUE: Technique = Technique {
    name: "reference",
    help: "path tracing without a filter, accumulated over all frames",
    accumulates: true,
    rounds: false,
    extra_outputs: &[],
    // Many samples filter textures themselves, and better.
    defaults: &[("textures.level", "zero")],
    fixed: &[],
    passes,
};

fn passes(frame: &mut FrameBuilder, options: PassOptions) -> Result<ImageHandle, GpuError> {
    if options.wants(&gbuffer::OUTPUTS) {
        gbuffer::add(frame)?;
    }
    let radiance = options.kernel().add_radiance(frame)?;
    accumulate::add(frame, radiance)
}
