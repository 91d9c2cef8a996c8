//! An edge-avoiding a-trous filter over the screen, guided by variance: shaders_glsl/filter/smooth/, Dammertz et al. 2010, Schied et al. 2017.
//!
//! Takes part of the light and the filter vertices; returns it smoothed, after passes whose taps are 1, 2, 4, ... pixels apart. No history.
//! A pass reads 40 bytes per pixel (its other taps come from caches) and writes 16, 32 and 8 at fp16.

use crate::display::temporal::Known;
use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::{GpuError, vk};
use crate::paths::gbuffer::GBuffer;
use crate::paths::terms::{FilterVertex, Terms};

/// Specialization constants: pixels between taps, and whether few samples are taken to be noisier than they seem.
const STEP: u32 = 224;
const BLIND: u32 = 233;

/// How often, and how many of these are blind. Direct light has edges soon; what fewer samples find takes more of them to be known by.
#[derive(Debug, Clone, Copy)]
pub struct Passes {
    pub count: usize,
    pub blind: usize,
}

/// The mean over samples, w being its variance, and how many samples it is over.
#[derive(Debug, Clone, Copy)]
pub struct Noisy {
    pub mean: ImageHandle,
    pub samples: ImageHandle,
}

/// What is smoothed.
pub struct Layer {
    passes: [&'static str; 5],
    smoothed: &'static str,
    halfway: &'static str,
}

pub const DIFFUSE: Layer =
    Layer { passes: ["smooth 1", "smooth 2", "smooth 3", "smooth 4", "smooth 5"], smoothed: "smoothed", halfway: "smoothed_halfway" };

pub const DIRECT: Layer = Layer {
    passes: ["smooth direct 1", "smooth direct 2", "smooth direct 3", "smooth direct 4", "smooth direct 5"],
    smoothed: "smoothed_direct",
    halfway: "smoothed_direct_halfway",
};

pub const INDIRECT: Layer = Layer {
    passes: ["smooth indirect 1", "smooth indirect 2", "smooth indirect 3", "smooth indirect 4", "smooth indirect 5"],
    smoothed: "smoothed_indirect",
    halfway: "smoothed_indirect_halfway",
};

pub const SPECULAR: Layer = Layer {
    passes: ["smooth specular 1", "smooth specular 2", "smooth specular 3", "smooth specular 4", "smooth specular 5"],
    smoothed: "smoothed_specular",
    halfway: "smoothed_specular_halfway",
};

pub fn add(frame: &mut FrameBuilder, vertex: &FilterVertex, noisy: Noisy, layer: &Layer, passes: Passes) -> Result<ImageHandle, GpuError> {
    if passes.count == 0 {
        return Ok(noisy.mean);
    }
    let smoothed = frame.color_image(layer.smoothed)?;
    let between = if passes.count > 1 { frame.color_image(layer.halfway)? } else { smoothed };
    let mut source = noisy.mean;
    for (i, name) in layer.passes.into_iter().enumerate().take(passes.count) {
        // They take turns, and the last one writes `smoothed`.
        let target = if (passes.count - i) % 2 == 1 { smoothed } else { between };
        let pass = frame.pass(name, "filter/smooth/step").constant(STEP, 1 << i).constant(BLIND, (i < passes.blind).into());
        let pass = pass.reads("noisy", source).reads("samples", noisy.samples).writes("smoothed", target);
        pass.reads("filter_position", vertex.position).reads("filter_normal", vertex.normal).add()?;
        source = target;
    }
    Ok(smoothed)
}

/// Both specular terms in one image, as noisy as they will be in a mean over frames where there is `history`.
pub fn add_specular(frame: &mut FrameBuilder, terms: &Terms, history: Option<&(GBuffer, Known)>) -> Result<Noisy, GpuError> {
    let noisy = Noisy { mean: frame.color_image("specular")?, samples: frame.image("specular_samples", vk::Format::R32_UINT)? };
    let pass = match history {
        Some((gbuffer, known)) => known.looks_up(frame.pass("smooth specular", "filter/smooth/specular_history"), gbuffer),
        None => frame.pass("smooth specular", "filter/smooth/specular"),
    };
    let pass = pass.writes("specular", noisy.mean).writes("samples", noisy.samples);
    pass.reads("specular_direct", terms.specular_direct).reads("specular_indirect", terms.specular_indirect).add()?;
    Ok(noisy)
}
