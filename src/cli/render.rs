//! `pathspace render`: a scene in, pictures out.

use super::Outcome;
use super::arguments::{self, Size};
use crate::display::{ToneCurve, ToneMapping};
use std::path::{Path, PathBuf};

/// Render a glTF scene, or a built-in one, to EXR and PNG files
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A .gltf or .glb file, or a built-in scene's name
    #[arg(default_value = "cornell")]
    pub scene: String,
    /// Picture to write: .exr holds linear radiance, .png is tonemapped; repeat for several
    #[arg(short, long, value_name = "OUT.exr|OUT.png", value_parser = arguments::picture, required_unless_present_any = ["aov", "timings"])]
    pub output: Vec<PathBuf>,
    #[arg(long, value_name = "WxH", default_value = "640x360")]
    pub size: Size,
    /// Samples per pixel and frame
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,
    /// Frames; without a filter they accumulate. With neither --spp nor --frames the reference takes 64 samples in all
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub frames: Option<u32>,
    /// How the noise of few samples becomes a picture
    #[arg(long, value_name = "NAME", default_value = "reference")]
    pub technique: String,
    /// Acceleration structure: auto, ray-query or bvh
    #[arg(long, value_name = "NAME", default_value = "auto")]
    pub trace: String,
    /// A camera of the scene [default: its first; without one, a view of the whole scene]
    #[arg(long, value_name = "NAME", conflicts_with_all = ["eye", "target", "vfov"])]
    pub camera: Option<String>,
    /// Place of the camera, metres
    #[arg(long, value_name = "x,y,z", value_parser = arguments::vector, allow_hyphen_values = true, requires = "target")]
    pub eye: Option<[f32; 3]>,
    /// What the camera looks at, metres
    #[arg(long, value_name = "x,y,z", value_parser = arguments::vector, allow_hyphen_values = true, requires = "eye")]
    pub target: Option<[f32; 3]>,
    /// Vertical field of view, degrees [default: 45]
    #[arg(long, value_name = "DEG", value_parser = arguments::field_of_view, requires = "eye")]
    pub vfov: Option<f32>,
    /// Scattering events after the primary hit; short for --set paths.max_bounces=N
    #[arg(long, value_name = "N")]
    pub max_bounces: Option<u32>,
    /// Same seed, same picture
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u32,
    /// Change a parameter; an unknown key lists them all
    #[arg(long, value_name = "key=value", value_parser = arguments::assignment)]
    pub set: Vec<(String, String)>,
    /// Latitude-longitude map seen by rays that leave the scene
    #[arg(long, value_name = "F.exr|F.hdr", value_parser = arguments::environment, conflicts_with = "background")]
    pub environment: Option<PathBuf>,
    /// Constant radiance seen by rays that leave the scene, W/(sr m^2)
    #[arg(long, value_name = "r,g,b", value_parser = arguments::radiance)]
    pub background: Option<[f32; 3]>,
    /// Also write what a pass put out, such as normal=normal.exr; an unknown name lists them all
    #[arg(long, value_name = "NAME=OUT.exr", value_parser = arguments::named_exr)]
    pub aov: Vec<(String, PathBuf)>,
    /// Write GPU milliseconds per pass, rays and memory as JSON
    #[arg(long, value_name = "F.json")]
    pub timings: Option<PathBuf>,
    /// Vulkan device, as 'pathspace devices' lists them [default: the best]
    #[arg(long, value_name = "NAME|INDEX")]
    pub device: Option<String>,
    /// Exposure of PNG files: radiance is multiplied by 2^EV
    #[arg(long, value_name = "EV", value_parser = arguments::finite, allow_hyphen_values = true, default_value = "0")]
    pub exposure: f32,
    /// Tone curve of PNG files
    #[arg(long, value_enum, default_value = "aces")]
    pub tonemap: ToneCurve,
    /// Effects to compile in: what the scene calls for, or all of them; the picture is the same
    #[arg(long, value_enum, default_value = "auto")]
    pub effects: EffectChoice,
    /// Animation: frame i shows the scene at i / FPS seconds
    #[arg(long, value_name = "N", value_parser = arguments::positive, default_value = "30")]
    pub fps: f32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum EffectChoice {
    Auto,
    All,
}

impl Args {
    /// For PNG outputs.
    pub fn tone_mapping(&self) -> ToneMapping {
        ToneMapping { exposure: self.exposure, curve: self.tonemap }
    }

    /// Every file that the command writes.
    fn outputs(&self) -> impl Iterator<Item = &Path> {
        self.output.iter().chain(self.aov.iter().map(|(_, path)| path)).chain(&self.timings).map(PathBuf::as_path)
    }
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    super::output::check_writable(args.outputs())?;
    anyhow::bail!("'pathspace render' is not part of this build")
}
