//! An edge-avoiding a-trous filter over the screen, guided by variance: shaders_glsl/filter/smooth/, Dammertz et al. 2010, Schied et al. 2017.
//!
//! Takes up to three parts of the light and the filter vertices; smooths them, in passes whose taps are 1, 2, 4, ... pixels apart.
//! No history. A pass reads 20 bytes per pixel (its other taps come from caches), and for each part 20 more, and writes 16, 12 and 8 at fp16.

use crate::display::temporal::Known;
use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::{GpuError, vk};
use crate::paths::gbuffer::GBuffer;
use crate::paths::terms::{FilterVertex, Terms};

/// Specialization constants: pixels between taps, and for each layer the samples that are few, of which noise is not known well.
const STEP: u32 = 224;
const FEW: [u32; MOST_LAYERS] = [232, 233, 236];

/// Passes at most, each with taps twice as far apart as the one before.
const PASSES: [&str; 5] = ["smooth 1", "smooth 2", "smooth 3", "smooth 4", "smooth 5"];
/// One for each number of layers.
const STEMS: [&str; MOST_LAYERS] = ["filter/smooth/step_1", "filter/smooth/step_2", "filter/smooth/step_3"];
const MOST_LAYERS: usize = 3;
/// What a kernel calls the images of each of its layers.
const NOISY: [&str; MOST_LAYERS] = ["noisy_0", "noisy_1", "noisy_2"];
const SAMPLES: [&str; MOST_LAYERS] = ["samples_0", "samples_1", "samples_2"];
const SMOOTHED: [&str; MOST_LAYERS] = ["smoothed_0", "smoothed_1", "smoothed_2"];

/// How often, how many of these are blind, and how many samples they take for few. Direct light has edges soon; what fewer samples find takes
/// more of them to be known by.
#[derive(Debug, Clone, Copy)]
pub struct Passes {
    pub count: usize,
    pub blind: usize,
    pub few: f32,
}

/// The mean over samples, w being its variance, and how many samples it is over.
#[derive(Debug, Clone, Copy)]
pub struct Noisy {
    pub mean: ImageHandle,
    pub samples: ImageHandle,
}

/// Names of what becomes of a part of the light.
#[derive(Debug, Clone, Copy)]
pub struct Names {
    smoothed: &'static str,
    halfway: &'static str,
}

pub const DIFFUSE: Names = Names { smoothed: "smoothed", halfway: "smoothed_halfway" };
pub const DIRECT: Names = Names { smoothed: "smoothed_direct", halfway: "smoothed_direct_halfway" };
pub const INDIRECT: Names = Names { smoothed: "smoothed_indirect", halfway: "smoothed_indirect_halfway" };
pub const SPECULAR: Names = Names { smoothed: "smoothed_specular", halfway: "smoothed_specular_halfway" };

/// A part of the light that is smoothed apart from others.
#[derive(Debug, Clone, Copy)]
pub struct Layer {
    pub noisy: Noisy,
    pub names: Names,
    pub passes: Passes,
}

/// Smooths each layer as often as it wants, side by side, and puts what comes out in place of its mean.
pub fn add(frame: &mut FrameBuilder, vertex: &FilterVertex, mut layers: [Option<&mut Layer>; MOST_LAYERS]) -> Result<(), GpuError> {
    let mut targets = [None; MOST_LAYERS];
    for (targets, layer) in targets.iter_mut().zip(&layers) {
        *targets = layer.as_ref().map(|layer| layer.targets(frame)).transpose()?;
    }
    for (i, name) in PASSES.into_iter().enumerate() {
        let goes_on = |layer: &Layer| layer.passes.count > i;
        let count = layers.iter().flatten().filter(|layer| goes_on(layer)).count();
        if count == 0 {
            break;
        }
        let mut pass = frame.pass(name, STEMS[count - 1]).constant(STEP, 1 << i);
        let going_on = layers.iter_mut().flatten().zip(targets.into_iter().flatten()).filter(|(layer, _)| goes_on(layer));
        for (place, (layer, targets)) in going_on.enumerate() {
            // They take turns, and the last pass writes the first one.
            let target = targets[(layer.passes.count - i + 1) % 2];
            pass = pass.reads(NOISY[place], layer.noisy.mean).reads(SAMPLES[place], layer.noisy.samples).writes(SMOOTHED[place], target);
            let few = if i < layer.passes.blind { layer.passes.few } else { 0.0 };
            pass = pass.constant(FEW[place], few.to_bits());
            layer.noisy.mean = target;
        }
        pass.reads("filter_position", vertex.position).reads("filter_normal", vertex.normal).add()?;
    }
    Ok(())
}

impl Layer {
    /// Images that passes write by turns.
    fn targets(&self, frame: &mut FrameBuilder) -> Result<[ImageHandle; 2], GpuError> {
        let image = |frame: &mut FrameBuilder, passes, name| {
            if self.passes.count >= passes { frame.color_image(name) } else { Ok(self.noisy.mean) }
        };
        Ok([image(frame, 1, self.names.smoothed)?, image(frame, 2, self.names.halfway)?])
    }
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
