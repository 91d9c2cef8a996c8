//! `sspsf`: the radiance behind the filter vertex, averaged over a window of the screen.

use super::{PassOptions, Technique};
use crate::display::composite;
use crate::filter::sspsf;
use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;
use crate::paths::gbuffer;

pub(super) const TECHNIQUE: Technique = Technique {
    name: "sspsf",
    help: "one path per pixel; what arrives at its first diffuse vertex is averaged over similar vertices nearby on the screen",
    accumulates: false,
    rounds: true,
    extra_outputs: &[],
    defaults: &[],
    fixed: &[],
    passes,
};

fn passes(frame: &mut FrameBuilder, options: PassOptions) -> Result<ImageHandle, GpuError> {
    if options.wants(&gbuffer::OUTPUTS) {
        gbuffer::add(frame)?;
    }
    let terms = options.kernel().add_with_terms(frame)?;
    let diffuse = sspsf::add(frame, &terms)?;
    let radiance = composite::add_filtered(frame, &terms, diffuse)?;
    options.mean_of_rounds(frame, radiance)
}
