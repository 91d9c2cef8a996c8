//! An edge-avoiding a-trous filter over the screen: shaders_glsl/filter/smooth.comp, Dammertz et al. 2010.
//!
//! Takes a filter's result and the vertices; returns `smoothed`, after passes whose taps are 1, 2, 4, ... pixels apart. No history. A pass
//! reads 40 bytes per pixel (its other taps come from caches) and writes 16.

use crate::filter::hpsf::Filtered;
use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;
use crate::paths::terms::FilterVertex;

/// Specialization constant: pixels between taps.
const STEP: u32 = 224;
const NAMES: [&str; 4] = ["smooth 1", "smooth 2", "smooth 3", "smooth 4"];

pub fn add(frame: &mut FrameBuilder, vertex: &FilterVertex, filtered: Filtered, passes: usize) -> Result<ImageHandle, GpuError> {
    if passes == 0 {
        return Ok(filtered.diffuse);
    }
    let smoothed = frame.color_image("smoothed")?;
    let between = if passes > 1 { frame.color_image("smoothed_halfway")? } else { smoothed };
    let mut source = filtered.diffuse;
    for (i, name) in NAMES.into_iter().enumerate().take(passes) {
        // They take turns, and the last one writes `smoothed`.
        let target = if (passes - i) % 2 == 1 { smoothed } else { between };
        let pass = frame.pass(name, "filter/smooth").constant(STEP, 1 << i).reads("noisy", source).writes("smoothed", target);
        pass.reads("samples", filtered.samples).reads("filter_position", vertex.position).reads("filter_normal", vertex.normal).add()?;
        source = target;
    }
    Ok(smoothed)
}
