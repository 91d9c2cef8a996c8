//! What is rendered, and how.

use super::{Parameters, Technique};
use crate::gpu::GpuError;
use crate::scene::{CameraView, Scene, UnknownCamera};
use glam::DMat4;

#[derive(Clone)]
pub struct Settings {
    /// Pixels.
    pub extent: [u32; 2],
    /// Samples per pixel and frame.
    pub spp: u32,
    pub technique: &'static Technique,
    /// Acceleration structure: a name of [`crate::accel::REGISTRY`], or `auto`.
    pub trace: String,
    pub parameters: Parameters,
    /// Compile in every effect, also those that the scene does not call for.
    pub all_effects: bool,
    /// Meshes that are placed once and never move become one (scene::merge): the same picture, sooner.
    pub merge_static: bool,
    pub seed: u32,
    /// Frame i shows the scene at i / fps seconds.
    pub fps: f32,
    pub view: ViewChoice,
    /// Outputs that will be asked for, beside the picture.
    pub outputs: Vec<String>,
}

/// Where the picture is taken from.
#[derive(Debug, Clone)]
pub enum ViewChoice {
    /// A camera of the scene's, which may move; its first, or a view of everything, where none is named.
    Scene(Option<String>),
    Fixed(CameraView),
}

impl ViewChoice {
    /// `world`: world matrix of each node.
    pub fn at(&self, scene: &Scene, world: &[DMat4]) -> Result<CameraView, UnknownCamera> {
        match self {
            ViewChoice::Scene(name) => scene.default_camera_view(name.as_deref(), world),
            ViewChoice::Fixed(view) => Ok(*view),
        }
    }
}

/// Why a scene cannot be rendered as asked.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(transparent)]
    Camera(#[from] UnknownCamera),
    #[error(transparent)]
    Trace(#[from] crate::accel::TraceError),
    #[error("technique '{technique}' has no output '{name}'; it has {known}")]
    UnknownOutput { technique: &'static str, name: String, known: String },
}
