//! Measures the front of one scene on one device, small and fast, and keeps it on disk: what `--budget-ms` and `--target-flip` choose from.

use super::accuracy;
use super::front::{Candidate, Front, VERSION};
use super::record::{Moves, Point};
use super::reference::{ReferenceCache, Subject};
use super::runner::BenchError;
use super::shots::Shots;
use super::suite::Values;
use crate::gpu::Gpu;
use crate::scene::Scene;
use crate::technique::{MOST_SHADOW_RAYS, REGISTRY, Renderer, Settings, Technique, Work};
use std::path::PathBuf;

/// Pixels that a calibration renders: as many as the reference takes so long for with one sample, so that all is done in a minute or a few,
/// within bounds: with fewer than these a filter's footprint is as large as the things in the picture.
const FRAME_MS: f64 = 40.0;
const FEWEST_PIXELS: f64 = 80.0 * 45.0;
/// And those that the time is taken with.
const PROBE_PIXELS: f64 = 160.0 * 90.0;
/// Samples per pixel that are measured; the last of those that go in rounds.
const SAMPLES: [u32; 2] = [1, 4];
const ROUNDS: [u32; 2] = [1, 3];
/// And one round with so many times the shadow rays at the first vertex.
const TIMES_THE_RAYS: u32 = 16;
/// Of techniques that remember: what a picture looks like once they have.
const FRAMES: u32 = 8;
const SEEDS: [u32; 2] = [1, 2];
/// Of the reference: as many as so much time allows, within bounds.
const REFERENCE_MS: f64 = 15_000.0;
const REFERENCE_SAMPLES: [f64; 2] = [64.0, 512.0];

/// What is calibrated.
pub struct Calibration<'a> {
    pub gpu: &'a Gpu,
    pub scene: &'a Scene,
    /// As the user wants to render; technique, samples and size are the calibration's own.
    pub settings: &'a Settings,
}

impl Calibration<'_> {
    /// The front that was kept, unless `anew`; else measures it. `progress` is told how many candidates are done, and of how many.
    ///
    /// # Errors
    /// The device cannot render the scene.
    pub fn front(&self, anew: bool, mut progress: impl FnMut(usize, usize)) -> Result<Front, BenchError> {
        let path = self.path()?;
        let kept = || serde_json::from_slice::<Front>(&std::fs::read(path.as_ref()?).ok()?).ok();
        if let Some(front) = kept().filter(|front| !anew && front.version == VERSION) {
            return Ok(front);
        }
        let front = self.measure(&mut progress)?;
        if let Some(path) = path
            && keep(&path, &front).is_err()
        {
            tracing::warn!("the calibration could not be kept in '{}'", path.display());
        }
        Ok(front)
    }

    fn measure(&self, progress: &mut dyn FnMut(usize, usize)) -> Result<Front, BenchError> {
        let parameters = self.with_user_values(reference());
        let probe = Settings { extent: self.size(PROBE_PIXELS), technique: reference(), parameters, ..self.settings.clone() };
        let ms_per_pixel = self.ms_per_pixel(&probe)?;
        let size = self.size((FRAME_MS / ms_per_pixel).max(FEWEST_PIXELS));
        let truth = Settings { extent: size, ..probe };
        let [least, most] = REFERENCE_SAMPLES;
        let samples = (REFERENCE_MS / (ms_per_pixel * f64::from(size[0] * size[1]))).clamp(least, most) as u64;
        let subject = Subject { gpu: self.gpu, scene: self.scene, settings: &truth, frame: 0 };
        let reference = ReferenceCache::open().reference(&subject, samples)?;
        let all: Vec<(&Technique, Work)> =
            REGISTRY.iter().flat_map(|technique| self.works(technique).into_iter().map(move |work| (technique, work))).collect();
        let mut candidates = Vec::new();
        for (done, &(technique, work)) in all.iter().enumerate() {
            progress(done, all.len());
            let spp = work.samples as u32;
            let point = self.point(technique, spp, size);
            let mut parameters = self.with_user_values(technique);
            parameters.set("rays.first_shadow_rays", &work.first_shadow_rays.to_string()).expect("it is within its range");
            let settings = Settings { technique, spp, parameters, ..truth.clone() };
            let shots = Shots::take(self.gpu, self.scene, &settings, &point, 1, &SEEDS)?;
            candidates.push(Candidate {
                technique: technique.name.to_owned(),
                rounds: technique.rounds,
                work,
                ns_per_pixel: shots.timings.frame_ms_median * 1e6 / f64::from(size[0] * size[1]),
                flip: accuracy::mean_flip(&shots.last, &reference)?,
            });
        }
        candidates.retain(|candidate| candidate.ns_per_pixel.is_finite() && candidate.flip.is_finite());
        Ok(Front { version: VERSION, candidates })
    }

    /// What is measured of a technique.
    fn works(&self, technique: &Technique) -> Vec<Work> {
        let parameters = self.with_user_values(technique);
        let rays = parameters.number("rays.first_shadow_rays") as u32;
        let with_samples = |&samples: &u32| Work { samples: f64::from(samples), first_shadow_rays: rays };
        if !technique.rounds {
            return SAMPLES.iter().map(with_samples).collect();
        }
        let more_rays = (rays * TIMES_THE_RAYS).min(MOST_SHADOW_RAYS);
        // The wavefront's passes are as many as the settings' shadow rays.
        let more_rays = (more_rays > rays && parameters.number("paths.kernel") == 0.0).then_some(more_rays);
        let more_rays = more_rays.map(|rays| Work { samples: 1.0, first_shadow_rays: rays });
        ROUNDS.iter().map(with_samples).chain(more_rays).collect()
    }

    /// What one sample takes; above 0.
    fn ms_per_pixel(&self, probe: &Settings) -> Result<f64, BenchError> {
        let mut renderer = Renderer::new(self.gpu, self.scene.clone(), Settings { spp: 1, ..probe.clone() })?;
        (0..3).try_for_each(|_| renderer.render_frame())?;
        let ms = renderer.timings()?.frame_ms_median;
        Ok(ms.max(1e-3) / f64::from(probe.extent[0] * probe.extent[1]))
    }

    /// The picture's shape with so many pixels, or the picture's own size where that is smaller.
    fn size(&self, pixels: f64) -> [u32; 2] {
        let [width, height] = self.settings.extent.map(f64::from);
        let scale = (pixels / (width * height)).sqrt().min(1.0);
        [width, height].map(|side| ((side * scale).round() as u32).max(11))
    }

    /// What the user has set, over a technique's own defaults.
    fn with_user_values(&self, technique: &Technique) -> crate::technique::Parameters {
        self.settings.parameters.changed_from(&self.settings.technique.parameters(), technique.parameters())
    }

    fn point(&self, technique: &Technique, spp: u32, size: [u32; 2]) -> Point {
        Point {
            scene: self.scene.name.clone(),
            source: String::new(),
            moves: Moves::Nothing,
            size,
            technique: technique.name.to_owned(),
            spp,
            frames: if technique.accumulates { 1 } else { FRAMES },
            trace: self.settings.trace.clone(),
            settings: Values::new(),
            all_effects: self.settings.all_effects,
            switch: None,
        }
    }

    /// Under a hash of scene, view, size, parameters, device, driver and program.
    fn path(&self) -> Result<Option<PathBuf>, BenchError> {
        let subject = Subject { gpu: self.gpu, scene: self.scene, settings: self.settings, frame: 0 };
        let device = self.gpu.capabilities();
        let text = format!("{} {} {} {} {}", subject.key()?, device.name, device.driver, self.settings.trace, env!("PATHSPACE_COMMIT"));
        let name = format!("{}.json", &blake3::hash(text.as_bytes()).to_hex()[..32]);
        Ok(dirs::cache_dir().map(|folder| folder.join("pathspace/calibrations").join(name)))
    }
}

fn reference() -> &'static Technique {
    crate::technique::find("reference").expect("it is registered")
}

fn keep(path: &std::path::Path, front: &Front) -> std::io::Result<()> {
    let folder = path.parent().expect("a file in a folder");
    std::fs::create_dir_all(folder)?;
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    serde_json::to_writer(&mut file, front)?;
    file.persist(path).map_err(|error| error.error)?;
    Ok(())
}
