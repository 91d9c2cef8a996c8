//! Techniques: how few samples become a picture. Each is an ordered list of passes and a line in [`REGISTRY`], from which the command line,
//! tests and measurements take them.

pub mod parameters;
mod governor;
mod anhpsf;
mod prepared;
mod reference;
mod hpsf;
mod hpsf_plus;
mod nhpsf;
mod renderer;
mod settings;
mod sspsf;
mod timings;
mod unfiltered;
mod work;

pub use governor::Governor;
pub use parameters::{ParameterError, Parameters};
pub use renderer::Renderer;
pub use settings::{RenderError, Settings, ViewChoice};
pub use timings::{BuildTimes, MemoryUse, PassTime, RayCounts, Timings};
pub use work::{MOST_SHADOW_RAYS, Scale, Work};

use crate::display::rounds;
use crate::frame::{FrameBuilder, ImageHandle};
use crate::gpu::GpuError;
use crate::paths::{Kernel, WavefrontOptions};
use crate::scene::effects::{Effect, EffectSet};

/// One way from samples to a picture.
pub struct Technique {
    pub name: &'static str,
    /// One line for the user.
    pub help: &'static str,
    /// Its picture is the mean of all frames so far; else each frame stands alone.
    pub accumulates: bool,
    /// A further sample per pixel of a frame is all of its passes once more, at the same time, and their mean is the picture; else path tracing
    /// takes as many as there are.
    pub rounds: bool,
    /// Outputs that are made only where asked for, beside the g-buffer's.
    pub(crate) extra_outputs: &'static [&'static str],
    /// Parameters whose default differs here.
    pub defaults: &'static [(&'static str, &'static str)],
    /// Parameters that it takes no other value of.
    pub fixed: &'static [(&'static str, &'static str)],
    /// Declares the passes; returns the picture.
    pub(crate) passes: fn(&mut FrameBuilder, PassOptions) -> Result<ImageHandle, GpuError>,
}

impl Technique {
    /// Puts right what it takes no other value of, with a warning.
    fn fix(&self, parameters: &mut Parameters) {
        for (key, value) in self.fixed {
            let asked = parameters.number(key);
            parameters.set(key, value).expect("a technique's fixed values are parameters'");
            if parameters.number(key) != asked {
                tracing::warn!("{} takes {key}={value} alone", self.name);
            }
        }
    }

    /// Every parameter at its default here.
    pub fn parameters(&self) -> Parameters {
        let mut parameters = Parameters::default();
        for (key, value) in self.defaults {
            parameters.set(key, value).expect("a technique's defaults are parameters");
        }
        parameters
    }
}

/// What a technique's passes depend on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PassOptions<'a> {
    /// Outputs that were asked for, beside the picture.
    pub outputs: &'a [String],
    /// Those that the host needs itself: sizes, and which passes there are.
    pub parameters: &'a Parameters,
    /// Samples per pixel of a frame.
    pub samples: u32,
    /// What the scene calls for.
    pub effects: &'a EffectSet,
}

impl PassOptions<'_> {
    /// The mean of a frame's rounds, where there is more than one.
    fn mean_of_rounds(&self, frame: &mut FrameBuilder, picture: ImageHandle) -> Result<ImageHandle, GpuError> {
        if self.samples > 1 { rounds::add(frame, picture) } else { Ok(picture) }
    }

    /// Whether one of these outputs was asked for, which the technique itself may not need.
    fn wants(&self, outputs: &[&str]) -> bool {
        self.outputs.iter().any(|name| outputs.contains(&name.as_str()))
    }

    /// What traces paths.
    fn kernel(&self) -> Kernel {
        let number = |key| self.parameters.number(key) as u32;
        if number("paths.kernel") == 0 {
            return Kernel::Megakernel;
        }
        let has_sole_ray = number("lights.sole") == 1 && self.effects.contains(Effect::SoleLight);
        Kernel::Wavefront(WavefrontOptions {
            max_bounces: number("paths.max_bounces"),
            first_visits: number("rays.first_shadow_rays") + u32::from(has_sole_ray),
        })
    }
}

pub static REGISTRY: [Technique; 7] = [
    reference::TECHNIQUE,
    unfiltered::TECHNIQUE,
    sspsf::TECHNIQUE,
    hpsf::TECHNIQUE,
    nhpsf::TECHNIQUE,
    anhpsf::TECHNIQUE,
    hpsf_plus::TECHNIQUE,
];

/// The technique of this name.
pub fn find(name: &str) -> Option<&'static Technique> {
    REGISTRY.iter().find(|technique| technique.name == name)
}
