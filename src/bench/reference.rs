//! Pictures that errors are measured against: accumulated until they are good enough, and kept on disk under a hash of all that they
//! depend on, so that no suite renders one twice.

use super::runner::BenchError;
use crate::display::exr_file::ExrFile;
use crate::display::{ExrContents, Image};
use crate::gpu::{Gpu, load_shader};
use crate::scene::Scene;
use crate::technique::{self, Renderer, Settings};
use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;

/// An estimate of the truth, and how sure it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    pub mean: Image,
    /// Of `mean`.
    pub variance: Image,
    /// Per pixel.
    pub samples: u64,
}

impl Reference {
    /// Root mean square over pixels and channels of the standard error, relative as relMSE is.
    pub fn standard_error(&self) -> f64 {
        let pairs = self.mean.pixels.iter().flatten().zip(self.variance.pixels.iter().flatten());
        let sum: f64 = pairs.map(|(&mean, &variance)| f64::from(variance) / (f64::from(mean).powi(2) + 0.01)).sum();
        (sum / (3 * self.mean.pixels.len()) as f64).sqrt()
    }

    /// The mean of two independent estimates, each sample counting alike.
    fn merged(self, other: Self) -> Self {
        let total = (self.samples + other.samples) as f64;
        let shares = [self.samples as f64 / total, other.samples as f64 / total];
        let blend = |a: &Image, b: &Image, weights: [f64; 2]| {
            let pixel =
                |(a, b): (&[f32; 3], &[f32; 3])| [0, 1, 2].map(|c| (weights[0] * f64::from(a[c]) + weights[1] * f64::from(b[c])) as f32);
            Image::new(a.width, a.height, a.pixels.iter().zip(&b.pixels).map(pixel).collect())
        };
        Self {
            mean: blend(&self.mean, &other.mean, shares),
            variance: blend(&self.variance, &other.variance, shares.map(|share| share * share)),
            samples: self.samples + other.samples,
        }
    }
}

/// What a reference shows.
pub struct Subject<'a> {
    pub gpu: &'a Gpu,
    pub scene: &'a Scene,
    /// Of the reference technique; samples and seed are this module's.
    pub settings: &'a Settings,
    /// Of the animation.
    pub frame: u32,
}

/// References in a folder.
pub struct ReferenceCache {
    /// Nothing is kept where there is none.
    folder: Option<PathBuf>,
}

/// Samples of one frame: few enough that no device's watchdog bites.
const SAMPLES_PER_FRAME: u64 = 16;
/// Frames, at least: variances are estimated from them.
const FRAMES: u64 = 32;

impl ReferenceCache {
    /// In the user's cache folder.
    pub fn open() -> Self {
        Self { folder: dirs::cache_dir().map(|folder| folder.join("pathspace/references")) }
    }

    /// At least `samples` per pixel; what is there already is added to.
    ///
    /// # Errors
    /// The device cannot render it.
    pub fn reference(&self, subject: &Subject, samples: u64) -> Result<Reference, BenchError> {
        let key = subject.key()?;
        let kept = self.read(&key).filter(|reference| subject.fits(reference));
        let missing = samples.saturating_sub(kept.as_ref().map_or(0, |reference| reference.samples));
        if missing == 0
            && let Some(reference) = kept
        {
            return Ok(reference);
        }
        let done = kept.as_ref().map_or(0, |reference| reference.samples);
        let more = subject.render(missing, done as u32)?;
        let reference = match kept {
            Some(kept) => kept.merged(more),
            None => more,
        };
        self.write(&key, &reference);
        Ok(reference)
    }

    fn path(&self, key: &str) -> Option<PathBuf> {
        self.folder.as_ref().map(|folder| folder.join(format!("{key}.exr")))
    }

    fn read(&self, key: &str) -> Option<Reference> {
        let file = ExrFile::read(BufReader::new(File::open(self.path(key)?).ok()?)).ok()?;
        let samples = file.attribute("samples")?.parse().ok()?;
        let variance = file.beside("variance")?;
        Some(Reference { variance, mean: file.image, samples })
    }

    /// A cache that cannot be written costs time, nothing else.
    fn write(&self, key: &str, reference: &Reference) {
        let Some(path) = self.path(key) else { return };
        let attributes = [("samples", reference.samples.to_string())];
        let contents = ExrContents { image: &reference.mean, beside: &[("variance", &reference.variance)], attributes: &attributes };
        let folder = path.parent().expect("a file in a folder");
        let written = std::fs::create_dir_all(folder).and_then(|()| tempfile::NamedTempFile::new_in(folder)).map(|file| {
            let complete = contents.write(file.as_file()).is_ok();
            complete && file.persist(&path).is_ok()
        });
        if !written.unwrap_or(false) {
            tracing::warn!("the reference could not be kept in '{}'", path.display());
        }
    }
}

impl Subject<'_> {
    /// Of scene, camera, time, size, parameters and the integrator's code, host and device.
    pub fn key(&self) -> Result<String, BenchError> {
        let Settings {
            extent,
            parameters,
            view,
            fps,
            all_effects: _,
            merge_static: _,
            technique: _,
            trace: _,
            spp: _,
            seed: _,
            outputs: _,
        } = self.settings;
        let mut hasher = blake3::Hasher::new();
        hasher.update(self.scene.fingerprint().as_bytes());
        hasher.update(format!("{extent:?} {parameters:?} {view:?} {fps} {}", self.frame).as_bytes());
        hasher.update(env!("PATHSPACE_HOST_CODE").as_bytes());
        for stem in ["paths/megakernel", "display/accumulate"] {
            hasher.update(bytemuck::cast_slice(&load_shader(stem, "bvh", parameters.precision())?));
        }
        Ok(hasher.finalize().to_hex()[..32].to_owned())
    }

    fn fits(&self, reference: &Reference) -> bool {
        let [width, height] = self.settings.extent;
        [&reference.mean, &reference.variance].iter().all(|image| [image.width, image.height] == [width, height])
    }

    /// `offset`: samples that were taken before: other random numbers than theirs.
    fn render(&self, samples: u64, offset: u32) -> Result<Reference, BenchError> {
        const SEEDS: u32 = 0x5eed_0000;
        let spp = samples.div_ceil(FRAMES).clamp(1, SAMPLES_PER_FRAME);
        let frames = samples.div_ceil(spp).max(FRAMES);
        let technique = technique::find("reference").expect("it is registered");
        let settings = Settings { technique, spp: spp as u32, outputs: Vec::new(), ..self.settings.clone() };
        let mut renderer = Renderer::new(self.gpu, self.scene.clone(), settings)?;
        renderer.restart(SEEDS.wrapping_add(offset), self.frame)?;
        for _ in 0..frames {
            renderer.render_frame()?;
        }
        let variance = renderer.output("variance")?.expect("the reference technique keeps it");
        let mean = renderer.picture()?;
        let [mean, variance] = [mean, variance].map(|image| image.made_finite("the reference").into_owned());
        Ok(Reference { mean, variance, samples: spp * frames })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn constant(mean: f32, variance: f32, samples: u64) -> Reference {
        let image = |value| Image::new(2, 1, vec![[value; 3]; 2]);
        Reference { mean: image(mean), variance: image(variance), samples }
    }

    #[test]
    fn merging_weighs_by_samples_and_reduces_the_variance() {
        let merged = constant(1.0, 0.3, 100).merged(constant(4.0, 0.1, 300));
        assert_eq!((merged.mean.pixels[0][0], merged.samples), (3.25, 400));
        assert!((merged.variance.pixels[0][0] - (0.3 / 16.0 + 0.1 * 9.0 / 16.0)).abs() < 1e-6);
    }

    #[test]
    fn the_standard_error_is_relative_as_relmse_is() {
        assert!((constant(0.3, 0.001, 1).standard_error() - 0.1).abs() < 1e-6);
    }

    #[test]
    fn a_cache_keeps_what_it_was_given() {
        let folder = tempfile::tempdir().unwrap();
        let cache = ReferenceCache { folder: Some(folder.path().join("references")) };
        assert_eq!(cache.read("key"), None);
        cache.write("key", &constant(0.1, 1e-9, 123));
        assert_eq!(cache.read("key"), Some(constant(0.1, 1e-9, 123)));
    }
}
