//! `unfiltered`: one path per pixel, its terms apart and recombined: what every filter starts from, without one.

use super::{PassOptions, Technique};
use crate::display::composite;
use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;
use crate::paths::gbuffer;

pub(super) const TECHNIQUE: Technique = Technique {
    name: "unfiltered",
    help: "one path per pixel, its radiance terms kept apart and recombined; each frame stands alone",
    accumulates: false,
    rounds: true,
    extra_outputs: &[],
    defaults: &[],
    fixed: &[],
    passes,
};

fn passes(frame: &mut FrameBuilder, options: PassOptions) -> Result<ImageHandle, GpuError> {
    gbuffer::add(frame)?;
    let terms = options.kernel().add_with_terms(frame)?;
    let radiance = composite::add(frame, &terms)?;
    options.mean_of_rounds(frame, radiance)
}
