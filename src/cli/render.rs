//! `pathspace render`: a scene in, pictures out.

use super::Outcome;
use super::arguments::{self, Size};
use super::budget::Budget;
use super::output::{print_result, write_atomically, write_picture};
use super::progress::Progress;
use crate::bench::front::Wish;
use crate::display::{ExrContents, ToneCurve, ToneMapping};
use crate::gpu::{DeviceOptions, Gpu};
use crate::scene::{CameraView, Environment, Scene, source};
use crate::technique::{self, Parameters, Renderer, Settings, Technique, ViewChoice};
use anyhow::{Context, anyhow, bail};
use glam::DVec3;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Samples per pixel of a technique that accumulates, where nothing is said.
const DEFAULT_SAMPLES: u32 = 64;

/// Render a glTF scene, or a built-in one, to EXR and PNG files
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("wish").multiple(true))]
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
    #[arg(long, value_name = "NAME", default_value = "reference", conflicts_with_all = ["budget_ms", "target_flip"])]
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
    #[arg(long, value_name = "r,g,b", value_parser = arguments::radiance, allow_hyphen_values = true)]
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
    /// Milliseconds that a frame may take: technique and samples are chosen from what was measured on this device, and adapted while rendering
    #[arg(long, value_name = "MS", value_parser = arguments::positive, conflicts_with = "spp", group = "wish")]
    pub budget_ms: Option<f32>,
    /// Mean FLIP that a frame should reach, as cheaply as possible; with --budget-ms within it
    #[arg(long, value_name = "FLIP", value_parser = arguments::positive, conflicts_with = "spp", group = "wish")]
    pub target_flip: Option<f32>,
    /// Measure this device and scene anew for --budget-ms and --target-flip; otherwise it is done once
    #[arg(long, requires = "wish")]
    pub calibrate: bool,
    /// Exposure of PNG files: radiance is multiplied by 2^EV
    #[arg(long, value_name = "EV", value_parser = arguments::finite, allow_hyphen_values = true, default_value = "0")]
    pub exposure: f32,
    /// Tone curve of PNG files
    #[arg(long, value_enum, default_value = "aces")]
    pub tonemap: ToneCurve,
    /// Effects to compile in: what the scene calls for, or all of them; the picture is the same
    #[arg(long, value_enum, default_value = "auto")]
    pub effects: EffectChoice,
    /// Frame of the animation that the first frame shows
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub first_frame: u32,
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
    let technique = technique::find(&args.technique).ok_or_else(|| unknown_technique(&args.technique))?;
    let parameters = args.parameters(technique)?;
    let view = args.view()?;
    super::output::check_writable(args.outputs())?;
    let scene = args.load_scene()?;
    let gpu = Gpu::open(&DeviceOptions { device: args.device.clone(), ..Default::default() })?;
    let (spp, frames) = args.samples(technique);
    let settings = Settings {
        extent: [args.size.width, args.size.height],
        spp,
        technique,
        trace: args.trace.clone(),
        parameters,
        all_effects: args.effects == EffectChoice::All,
        merge_static: true,
        seed: args.seed,
        fps: args.fps,
        view,
        outputs: args.aov.iter().map(|(name, _)| name.clone()).collect(),
    };
    let (mut budget, settings) = match args.wish() {
        Some(wish) => {
            let (budget, settings) = Budget::plan(&gpu, &scene, settings, wish, args.calibrate)?;
            print_result(&budget.explain())?;
            (Some(budget), settings)
        }
        None => (None, settings),
    };
    let mut renderer = Renderer::new(&gpu, scene, settings)?;
    if args.first_frame > 0 {
        renderer.restart(args.seed, args.first_frame)?;
    }
    render_frames(&mut renderer, frames, args.size, spp, budget.as_mut())?;
    args.write(&mut renderer, frames)?;
    if let Some(outcome) = budget.map(|budget| renderer.timings().map(|timings| budget.outcome(&timings))).transpose()?.flatten() {
        print_result(&outcome)?;
    }
    Ok(Outcome::Done)
}

/// How often the error is estimated; it costs a wait for the device.
const ESTIMATE_EVERY: Duration = Duration::from_secs(2);

fn render_frames(renderer: &mut Renderer, frames: u32, size: Size, spp: u32, mut budget: Option<&mut Budget>) -> anyhow::Result<()> {
    let samples = u64::from(size.width) * u64::from(size.height) * u64::from(spp);
    let progress = Progress::new("rendering", samples * u64::from(frames), "samples");
    let mut estimated = Instant::now();
    for frame in 0..frames {
        if let Some(budget) = budget.as_deref_mut() {
            budget.steer(renderer);
        }
        renderer.render_frame_telling(|part| progress.reach(((f64::from(frame) + part) * samples as f64) as u64))?;
        if estimated.elapsed() > ESTIMATE_EVERY {
            if let Some(error) = renderer.relative_error()? {
                progress.error_estimate(error);
            }
            estimated = Instant::now();
        }
    }
    Ok(renderer.finish()?)
}

fn unknown_technique(name: &str) -> anyhow::Error {
    let known: Vec<String> = technique::REGISTRY.iter().map(|t| format!("\n  {}: {}", t.name, t.help)).collect();
    anyhow!("there is no technique '{name}'; there are:{}", known.concat())
}

impl Args {
    fn parameters(&self, technique: &Technique) -> anyhow::Result<Parameters> {
        let mut parameters = technique.parameters();
        for (key, value) in &self.set {
            parameters.set(key, value)?;
        }
        if let Some(bounces) = self.max_bounces {
            parameters.set("paths.max_bounces", &bounces.to_string())?;
        }
        Ok(parameters)
    }

    fn wish(&self) -> Option<Wish> {
        let wish = Wish { budget_ms: self.budget_ms.map(f64::from), target_flip: self.target_flip.map(f64::from) };
        (wish.budget_ms.is_some() || wish.target_flip.is_some()).then_some(wish)
    }

    /// Samples per pixel and frame, and frames.
    fn samples(&self, technique: &Technique) -> (u32, u32) {
        let frames = if technique.accumulates && self.spp.is_none() { DEFAULT_SAMPLES } else { 1 };
        (self.spp.unwrap_or(1), self.frames.unwrap_or(frames))
    }

    fn load_scene(&self) -> anyhow::Result<Scene> {
        let mut scene = source::load(&self.scene)?;
        if let Some(path) = &self.environment {
            let (environment, warnings) = Environment::load(path)?;
            scene.environment = environment;
            scene.warnings.extend(warnings);
        }
        if let Some(radiance) = self.background {
            scene.environment = Environment::Constant(radiance);
        }
        for warning in &scene.warnings {
            tracing::warn!("{} ({})", warning.message, warning.count);
        }
        Ok(scene)
    }

    fn view(&self) -> anyhow::Result<ViewChoice> {
        let (Some(eye), Some(target)) = (self.eye, self.target) else { return Ok(ViewChoice::Scene(self.camera.clone())) };
        if eye == target {
            bail!("--eye and --target are the same point: there is no direction to look in");
        }
        let place = |point: [f32; 3]| DVec3::from_array(point.map(f64::from));
        Ok(ViewChoice::Fixed(CameraView::look_at(place(eye), place(target), self.vfov.unwrap_or(45.0).to_radians())))
    }

    fn write(&self, renderer: &mut Renderer, frames: u32) -> anyhow::Result<()> {
        let attributes = [
            ("scene", self.scene.clone()),
            ("technique", renderer.settings().technique.name.to_owned()),
            ("spp", renderer.samples().to_string()),
            ("frames", frames.to_string()),
            ("seed", self.seed.to_string()),
        ];
        let picture = renderer.picture()?;
        for path in &self.output {
            let contents = ExrContents { image: &picture, beside: &[], attributes: &attributes };
            write_picture(path, &contents, &self.tone_mapping())?;
        }
        for (name, path) in &self.aov {
            let image = renderer.output(name)?.with_context(|| format!("there is no output '{name}'"))?;
            write_picture(path, &ExrContents { image: &image, beside: &[], attributes: &attributes }, &self.tone_mapping())?;
        }
        let timings = renderer.timings()?;
        if let Some(path) = &self.timings {
            write_atomically(path, |file| serde_json::to_writer_pretty(file, &timings))?;
        }
        print_result(&timings.to_string())
    }
}
