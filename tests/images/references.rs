//! The `reference` technique against every image of assets/references, which Mitsuba 3 rendered (ci/references/README.md):
//! - relMSE is at most 1.5 times what the variances of both pictures explain (a bias would come on top), and at 1024 samples below 10^-3
//!   for diffuse scenes and 5 * 10^-3 for others;
//! - mean radiance is within 0.5 %, and four standard errors of both pictures together (false alarms: 6 * 10^-5);
//! - a Z-test over blocks of 8x8 pixels, corrected for their number, does not reject at a significance of 10^-4.
//!
//! Seeds are fixed: what passes once always passes.

use crate::common;
use crate::common::render::{Rendered, builtin, render, set, settings};
use exr::prelude::{ReadChannels, ReadLayers, read};
use pathspace::display::Image;
use pathspace::gpu::Gpu;
use pathspace::metrics::z_test::{Estimate, ZTest, z_test};
use pathspace::metrics::{Pair, mean_ratio, relmse};
use pathspace::scene::effects::EffectSet;
use pathspace::scene::{Scene, builtin, gltf};
use pathspace::technique::Settings;
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};

const SIGNIFICANCE: f64 = 1e-4;
const BLOCK: u32 = 8;
/// Rounding to half precision, relative.
const HALF_ROUNDING: f32 = 1.0 / 2048.0;
/// relMSE over the one that both variances explain.
const MOST_UNEXPLAINED: f64 = 1.5;
/// Samples per pixel at which relMSE's criterion is stated.
const FULL: u32 = 1024;

#[test]
fn the_reference_technique_converges_to_the_pictures_of_an_independent_renderer() {
    compare_all(48, 16);
}

#[test]
#[ignore = "takes minutes: ci/accuracy runs it"]
fn every_picture_holds_the_full_criterion_at_1024_samples() {
    compare_all(FULL, 64);
}

fn compare_all(spp: u32, frames: u32) {
    let gpu = common::gpu();
    println!("{:<16} {:>5} {:>9} {:>9} {:>9} {:>17} {:>8}", "scene", "spp", "relMSE", "criterion", "noise's", "mean ratio", "least p");
    let mut failed = Vec::new();
    for reference in references() {
        let comparison = Comparison::new(&gpu, &reference, spp, frames);
        println!("{comparison}");
        if !comparison.holds() {
            failed.push(reference.name);
        }
    }
    assert!(failed.is_empty(), "{failed:?} fail");
}

/// An image of assets/references with its variance, and what it shows.
struct Reference {
    name: String,
    scene: Scene,
    picture: Rendered,
    samples: u64,
    batches: u64,
    bounces: u64,
    /// Without energy compensation.
    plain_gltf: bool,
}

fn references() -> Vec<Reference> {
    let mut paths: Vec<PathBuf> = std::fs::read_dir(assets("references")).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "json"));
    paths.sort();
    assert!(!paths.is_empty());
    paths.iter().map(|path| Reference::read(path)).collect()
}

fn assets(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(folder)
}

impl Reference {
    fn read(description: &Path) -> Self {
        let about: serde_json::Value = serde_json::from_slice(&std::fs::read(description).unwrap()).unwrap();
        let file = Path::new(about["scene"].as_str().unwrap());
        let stem = file.file_stem().unwrap().to_str().unwrap();
        let is_builtin = builtin::REGISTRY.iter().any(|scene| scene.name == stem);
        Self {
            name: description.file_stem().unwrap().to_str().unwrap().to_owned(),
            scene: if is_builtin { builtin(stem) } else { gltf::load(&assets("scenes").join(file)).unwrap() },
            picture: read_picture(&description.with_extension("exr")),
            samples: about["samples_per_pixel"].as_u64().unwrap(),
            batches: about["batches"].as_u64().unwrap(),
            bounces: about["max_bounces"].as_u64().unwrap(),
            plain_gltf: about["bsdf"].as_str().unwrap().contains("glTF 2.0 appendix B"),
        }
    }

    fn settings(&self, spp: u32) -> Settings {
        let mean = &self.picture.mean;
        let mut settings = Settings { spp, ..settings(mean.width, mean.height) };
        set(&mut settings, &[("paths.max_bounces", &self.bounces.to_string())]);
        if self.plain_gltf {
            set(&mut settings, &[("material.energy_compensation", "off")]);
        }
        settings
    }
}

/// Mean, and variance of the mean without the file's rounding.
fn read_picture(path: &Path) -> Rendered {
    let file =
        read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes().from_file(path).unwrap();
    let layer = file.layer_data;
    let channels = |prefix: &str| {
        let find = |name: String| layer.channel_data.list.iter().find(|channel| channel.name.eq_case_insensitive(&name)).unwrap();
        let [r, g, b] = ["R", "G", "B"].map(|color| find(format!("{prefix}{color}")).sample_data.values_as_f32().collect::<Vec<_>>());
        let pixels = (0..r.len()).map(|i| [r[i], g[i], b[i]]).collect();
        Image::new(layer.size.width() as u32, layer.size.height() as u32, pixels)
    };
    let (mean, mut variance) = (channels(""), channels("error."));
    variance.pixels.iter_mut().flatten().for_each(|error| *error *= *error);
    Rendered { mean, variance }
}

/// `f(value, other)` for each channel of each pixel.
fn combined(image: &Image, other: &Image, f: impl Fn(f32, f32) -> f32) -> Image {
    let pixels = image.pixels.iter().zip(&other.pixels).map(|(a, b)| [0, 1, 2].map(|c| f(a[c], b[c])));
    Image::new(image.width, image.height, pixels.collect())
}

impl Reference {
    /// With the rounding to half precision. Neighbours of one colour are rounded alike, so that of a block counts as that of one value.
    fn variance(&self) -> Image {
        let rounding = |value: f32| (value * HALF_ROUNDING * BLOCK as f32).powi(2) / 3.0;
        combined(&self.picture.variance, &self.picture.mean, |variance, mean| variance + rounding(mean))
    }

    /// Of a picture of ours: few samples may have missed what is rare, and then underestimate it, where the reference has met it.
    fn variance_of(&self, ours: &Rendered, spp: u32) -> Image {
        let scale = self.samples as f32 / spp as f32;
        combined(&ours.variance, &self.picture.variance, |own, theirs| own.max(scale * theirs))
    }
}

struct Comparison {
    name: String,
    spp: u32,
    relmse: f64,
    /// At [`FULL`] samples.
    criterion: f64,
    /// What the variances of both pictures explain of relMSE.
    explained: f64,
    mean_ratio: f64,
    mean_error: f64,
    z: ZTest,
}

impl Comparison {
    /// Renders `spp` samples in `frames` batches.
    fn new(gpu: &Gpu, reference: &Reference, spp: u32, frames: u32) -> Self {
        let ours = render(gpu, &reference.scene, &reference.settings(spp / frames), frames);
        let theirs = &reference.picture.mean;
        let pair = Pair::new(&ours.mean, theirs).unwrap();
        let (our_variance, their_variance) = (reference.variance_of(&ours, spp), reference.variance());
        let a = Estimate { mean: &ours.mean, variance: &our_variance, batches: Some(frames.into()) };
        let b = Estimate { mean: theirs, variance: &their_variance, batches: Some(reference.batches) };
        let variance = combined(&our_variance, &reference.picture.variance, |a, b| a + b);
        let relative = combined(&variance, theirs, |variance, mean| variance / (mean * mean + 0.01));
        Self {
            name: reference.name.clone(),
            spp,
            relmse: relmse(&pair, 0.0),
            criterion: if EffectSet::derive(&reference.scene).is_diffuse_only() { 1e-3 } else { 5e-3 },
            explained: sum(&relative) / (3 * theirs.pixels.len()) as f64,
            mean_ratio: mean_ratio(&pair),
            mean_error: sum(&variance).sqrt() / sum(theirs),
            z: z_test(a, b, BLOCK, SIGNIFICANCE).unwrap(),
        }
    }

    fn holds(&self) -> bool {
        self.relmse < MOST_UNEXPLAINED * self.explained
            && (self.spp < FULL || self.relmse < self.criterion)
            && (self.mean_ratio - 1.0).abs() < 5e-3 + 4.0 * self.mean_error
            && self.z.passed()
    }
}

fn sum(image: &Image) -> f64 {
    image.pixels.iter().flatten().map(|&value| f64::from(value)).sum()
}

impl Display for Comparison {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let Self { name, spp, relmse, criterion, explained, mean_ratio, mean_error, z } = self;
        write!(
            f,
            "{name:<16} {spp:>5} {relmse:>9.1e} {criterion:>9.0e} {explained:>9.1e} {mean_ratio:>8.4} +-{mean_error:.4} {:>8.0e}",
            z.smallest_p
        )?;
        write!(f, " {}", if self.holds() { "holds" } else { "FAILS" })?;
        if z.passed() { Ok(()) } else { write!(f, " ({} of {} blocks differ, most at {:?})", z.rejected, z.tests, z.worst) }
    }
}
