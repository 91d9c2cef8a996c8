//! Primary visibility and path tracing.

pub mod energy;
pub mod gbuffer;
mod megakernel;
pub mod terms;
pub mod vertices;
mod wavefront;

pub use megakernel::Retraced;
pub use wavefront::{FOOTPRINT, Options as WavefrontOptions, RAY, WEIGHTS};

use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;
use vertices::{ListOptions, LooksUp, PathVertices};

pub use megakernel::add_with_ends;

/// How paths are traced: `paths.kernel`. The picture is the same.
#[derive(Debug, Clone, Copy)]
pub enum Kernel {
    Megakernel,
    Wavefront(WavefrontOptions),
}

impl Kernel {
    /// Radiance, the mean of the frame's samples per pixel.
    pub fn add_radiance(self, frame: &mut FrameBuilder) -> Result<ImageHandle, GpuError> {
        match self {
            Self::Megakernel => megakernel::add(frame),
            Self::Wavefront(options) => wavefront::add(frame, options),
        }
    }

    /// One sample per pixel, through the same point of the pixel as the g-buffer's, its terms apart.
    pub fn add_with_terms(self, frame: &mut FrameBuilder) -> Result<terms::Terms, GpuError> {
        match self {
            Self::Megakernel => megakernel::add_with_terms(frame),
            Self::Wavefront(options) => wavefront::add_with_terms(frame, options),
        }
    }

    /// The same, with the vertices of the path behind its filter vertex. `known`: by their cells.
    pub fn add_with_vertices(
        self,
        frame: &mut FrameBuilder,
        list: ListOptions,
        known: &LooksUp,
    ) -> Result<(terms::Terms, PathVertices), GpuError> {
        match self {
            Self::Megakernel => megakernel::add_with_vertices(frame, list, known),
            Self::Wavefront(options) => wavefront::add_with_vertices(frame, options, list, known),
        }
    }

    /// As [`Self::add_with_terms`], and one path of the last frame once more for each square of `side` pixels a side. Only the megakernel does that.
    pub fn add_with_retraced(self, frame: &mut FrameBuilder, side: u32) -> Result<(terms::Terms, Retraced), GpuError> {
        if let Self::Wavefront(_) = self {
            tracing::warn!("paths.kernel=wavefront retraces no paths, which hpsf.time=hybrid is about: the megakernel is used");
        }
        megakernel::add_with_retraced(frame, side)
    }
}

/// Tiles of 8x4 pixels that the picture has, threads of a workgroup each.
pub fn tiles([width, height]: [u32; 2]) -> u32 {
    width.div_ceil(8) * height.div_ceil(4)
}
