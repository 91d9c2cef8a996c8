//! Measures one point after the other: renders every seed, times the frames, holds the pictures against the reference, and writes a record.

use super::log::{Log, LogError};
use super::plan::Planned;
use super::record::{Figure, Moves, PassFigure, Pictures, Point, Provenance, Record, ReferenceQuality, VERSION};
use super::reference::{Reference, ReferenceCache, Subject};
use super::shots::Shots;
use super::stage::Stage;
use super::suite::{Suite, SuiteError};
use super::{accuracy, roofline, table};
use crate::display::image::write_png_bytes;
use crate::display::{Image, ImageError, ToneMapping};
use crate::gpu::{Gpu, GpuError};
use crate::metrics::series::quantile_of_series;
use crate::metrics::statistics::quantile;
use crate::metrics::{self, Estimate, MetricError};
use crate::scene::LoadError;
use crate::scene::source::SourceError;
use crate::technique::{PassTime, RenderError, Settings, Timings};
use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Why a point could not be measured.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    #[error(transparent)]
    Suite(#[from] SuiteError),
    #[error(transparent)]
    Source(#[from] SourceError),
    #[error(transparent)]
    Environment(#[from] LoadError),
    #[error(transparent)]
    Render(#[from] RenderError),
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(transparent)]
    Log(#[from] LogError),
    #[error(transparent)]
    Metric(#[from] MetricError),
    #[error("cannot write '{}': {source}", path.display())]
    Picture { path: PathBuf, source: ImageError },
}

/// More than these are not kept in a record.
const KEPT_SAMPLES: usize = 256;
/// Error and reference influence each other: the reference is improved at most so often.
const IMPROVEMENTS: usize = 3;

/// A suite on a device.
pub struct Runner<'a> {
    gpu: &'a Gpu,
    suite: &'a Suite,
    folder: &'a Path,
    log: Log,
    references: ReferenceCache,
    provenance: Provenance,
    stage: Option<Stage>,
}

impl<'a> Runner<'a> {
    /// Results go to `folder`.
    ///
    /// # Errors
    /// It cannot be written, or another run writes it.
    pub fn new(gpu: &'a Gpu, suite: &'a Suite, folder: &'a Path) -> Result<Self, BenchError> {
        let log = Log::open(folder)?;
        let provenance = Provenance::here(gpu.capabilities());
        Ok(Self { gpu, suite, folder, log, references: ReferenceCache::open(), provenance, stage: None })
    }

    /// Whether an earlier run into the same folder has measured it.
    pub fn has(&self, planned: &Planned) -> bool {
        self.log.finished().contains(&planned.key)
    }

    /// Measures a point; its record is on disk when this returns.
    ///
    /// # Errors
    /// The scene cannot be loaded or rendered; the record or its pictures cannot be written.
    pub fn measure(&mut self, planned: &Planned) -> Result<Record, BenchError> {
        let row = &self.suite.scenes[planned.scene];
        let stage = match self.stage.take().filter(|stage| stage.index == planned.scene) {
            Some(stage) => stage,
            None => Stage::load(self.suite, planned.scene)?,
        };
        let settings = stage.settings(row, &planned.point, self.suite)?;
        let seeds: Vec<u32> = (1..=self.suite.seeds).collect();
        let shots = Shots::take(self.gpu, &stage.scene, &settings, &planned.point, row.frames, &seeds)?;
        let truth = self.truth(&stage, planned, &shots)?;
        let mut figures = time_figures(&shots.timings, stage.load_ms, frames_of_picture(&settings, &planned.point));
        figures.extend(roofline::figures(&shots.timings, planned.point.size));
        figures.extend(truth.figures);
        figures.extend(table::figures(self.gpu, &stage.scene, &settings, &planned.point)?);
        let record = Record {
            version: VERSION,
            key: planned.key.clone(),
            suite: self.suite.name.clone(),
            provenance: self.provenance.now(seeds),
            reference: truth.quality,
            figures,
            passes: shots.timings.passes.iter().map(pass_figure).collect(),
            pictures: self.write_pictures(planned, &shots.last[0], &truth.reference.mean)?,
            command: stage.command(row, &planned.point, self.suite),
            point: planned.point.clone(),
        };
        self.stage = Some(stage);
        self.log.append(&record)?;
        Ok(record)
    }

    /// Errors, against a reference that is good enough to tell them.
    fn truth(&self, stage: &Stage, planned: &Planned, shots: &Shots) -> Result<Truth, BenchError> {
        let row = &self.suite.scenes[planned.scene];
        let settings = stage.reference_settings(row, &planned.point, self.suite)?;
        let frame = planned.point.frame_shown(row.frames);
        let subject = |frame| Subject { gpu: self.gpu, scene: &stage.scene, settings: &settings, frame };
        let most = self.suite.reference.most_samples;
        let mut samples = (4 * u64::from(planned.point.spp)).clamp(64, most);
        for turn in 0.. {
            let reference = self.references.reference(&subject(frame), samples)?;
            let error = accuracy::relative_error(&shots.last, &reference)?;
            let (standard_error, wanted) = (reference.standard_error(), self.suite.reference.ratio);
            let ratio = error / standard_error.max(f64::MIN_POSITIVE);
            if ratio >= wanted || reference.samples >= most || turn == IMPROVEMENTS {
                let before = match planned.point.moves {
                    Moves::Nothing => None,
                    _ => Some(self.references.reference(&subject(frame.saturating_sub(1)), reference.samples)?),
                };
                let figures = accuracy::figures(shots, &reference, before.as_ref())?;
                let quality = ReferenceQuality { key: subject(frame).key()?, samples_per_pixel: reference.samples, standard_error, ratio };
                return Ok(Truth { reference, quality, figures });
            }
            // The variance falls as 1 / samples.
            let missing = (wanted / ratio).powi(2) * 1.1;
            samples = ((reference.samples as f64 * missing).ceil() as u64).clamp(reference.samples + 1, most);
        }
        unreachable!("the loop ends by returning")
    }

    fn write_pictures(&self, planned: &Planned, picture: &Image, reference: &Image) -> Result<Pictures, BenchError> {
        let mapping = ToneMapping::default();
        let errors = metrics::flip::heatmap(&accuracy::flip_map(picture, reference)?);
        let heatmap = |file: &mut File| write_png_bytes(picture.width, picture.height, &errors, file);
        let key = &planned.key;
        Ok(Pictures {
            picture: self.write_picture(format!("{key}.png"), |file| picture.with_zeros().write_png(&mapping, file))?,
            reference: self.write_picture(format!("{key}-reference.png"), |file| reference.write_png(&mapping, file))?,
            heatmap: self.write_picture(format!("{key}-error.png"), heatmap)?,
        })
    }

    /// Its path as records hold it.
    fn write_picture(&self, name: String, write: impl FnOnce(&mut File) -> Result<(), ImageError>) -> Result<String, BenchError> {
        let path = self.folder.join(PICTURES).join(&name);
        let create = || write(&mut File::create(&path)?);
        std::fs::create_dir_all(self.folder.join(PICTURES))
            .map_err(ImageError::from)
            .and_then(|()| create())
            .map_err(|source| BenchError::Picture { path: path.clone(), source })?;
        Ok(format!("{PICTURES}/{name}"))
    }
}

/// Folder of the pictures, beside results.jsonl.
const PICTURES: &str = "pictures";

struct Truth {
    reference: Reference,
    quality: ReferenceQuality,
    figures: BTreeMap<String, Figure>,
}

/// Frames that become one picture.
fn frames_of_picture(settings: &Settings, point: &Point) -> f64 {
    if settings.technique.accumulates { f64::from(point.frames) } else { 1.0 }
}

fn time_figures(timings: &Timings, load_ms: f64, frames: f64) -> BTreeMap<String, Figure> {
    let build = timings.build_ms;
    let (read, written) = timings.passes.iter().fold((0, 0), |(r, w), pass| (r + pass.bytes_read, w + pass.bytes_written));
    let frame = timings.frame_ms_median;
    let single = [
        ("cpu_ms", timings.cpu_ms_median),
        ("first_frame_ms", timings.first_frame_ms),
        ("load_ms", load_ms),
        ("build_ms", build.order + build.upload + build.structure + build.pipelines),
        ("rays_per_pixel", timings.rays.per_pixel),
        ("mrays_per_second", timings.rays.mrays_per_second),
        ("memory_bytes", timings.memory_bytes.peak as f64),
        ("bytes_read", read as f64),
        ("bytes_written", written as f64),
        ("bandwidth", (read + written) as f64 / frame * 1e-6),
    ];
    let kept: Vec<f64> = timings.frame_ms.iter().take(KEPT_SAMPLES).map(|ms| ms * frames).collect();
    let series = [("frame_ms", 0.5), ("frame_ms_p95", 0.95)].map(|(key, at)| (key, quantile_of_series(&kept, at).ok()));
    let mut figures: Vec<(&str, Estimate)> = single.map(|(key, value)| (key, Estimate::exact(value))).into();
    figures.extend(series.into_iter().filter_map(|(key, estimate)| Some((key, estimate?))));
    let finite = |estimate: &Estimate| [estimate.value, estimate.low, estimate.high].iter().all(|value| value.is_finite());
    figures.into_iter().filter(|(_, estimate)| finite(estimate)).map(|(key, estimate)| accuracy::named(key, estimate)).collect()
}

fn pass_figure(pass: &PassTime) -> PassFigure {
    let quartile = |at| quantile(pass.samples_ms.clone(), at);
    PassFigure {
        name: pass.name.to_owned(),
        median_ms: pass.median_ms,
        p95_ms: pass.p95_ms,
        spread_ms: quartile(0.75) - quartile(0.25),
        bytes_read: pass.bytes_read,
        bytes_written: pass.bytes_written,
    }
}
