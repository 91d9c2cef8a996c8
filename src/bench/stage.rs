//! A scene of a suite, loaded, and the settings of its points.

use super::record::Point;
use super::runner::BenchError;
use super::suite::{SceneRow, Suite, SuiteError, Values};
use crate::scene::{CameraView, Environment, Scene, source};
use crate::technique::{self, Parameters, Settings, Technique, ViewChoice};
use glam::DVec3;
use std::path::Path;
use std::time::Instant;

/// The scene on the stage.
pub struct Stage {
    /// Among the suite's scenes.
    pub index: usize,
    pub scene: Scene,
    pub load_ms: f64,
}

const FRAMES_PER_SECOND: f32 = 30.0;

impl Stage {
    /// # Errors
    /// The scene or its environment cannot be loaded.
    pub fn load(suite: &Suite, index: usize) -> Result<Self, BenchError> {
        let row = &suite.scenes[index];
        let start = Instant::now();
        let mut scene = source::load(&suite.path_of(&row.source))?;
        if let Some(file) = &row.environment {
            scene.environment = Environment::load(Path::new(&suite.path_of(file)))?.0;
        }
        if let Some(radiance) = row.background {
            scene.environment = Environment::Constant(radiance);
        }
        Ok(Self { index, scene, load_ms: start.elapsed().as_secs_f64() * 1e3 })
    }

    /// # Errors
    /// A technique or parameter that there is not; plans hold none.
    pub fn settings(&self, row: &SceneRow, point: &Point, suite: &Suite) -> Result<Settings, BenchError> {
        let wrong = |reason: String| SuiteError::Wrong { suite: suite.name.clone(), place: row.name.clone(), reason };
        let technique = technique::find(&point.technique).ok_or_else(|| wrong(format!("there is no technique '{}'", point.technique)))?;
        let parameters = with_values(technique, &point.settings).map_err(|error| wrong(error.to_string()))?;
        Ok(Settings {
            extent: point.size,
            spp: point.spp,
            technique,
            trace: point.trace.clone(),
            parameters,
            all_effects: point.all_effects,
            merge_static: true,
            seed: 0,
            fps: FRAMES_PER_SECOND,
            view: view(row),
            outputs: Vec::new(),
        })
    }

    /// Of the picture that the point is measured against: parameters of the suite's, not of the point's.
    ///
    /// # Errors
    /// A parameter that there is not.
    pub fn reference_settings(&self, row: &SceneRow, point: &Point, suite: &Suite) -> Result<Settings, BenchError> {
        let settings = suite.reference.settings.clone();
        let truth = Point { technique: "reference".to_owned(), settings, all_effects: false, trace: suite.trace.clone(), ..point.clone() };
        self.settings(row, &truth, suite)
    }

    /// A shell command that renders the point's first picture.
    pub fn command(&self, row: &SceneRow, point: &Point, suite: &Suite) -> String {
        let Point { size: [width, height], technique, spp, frames, trace, settings, all_effects, .. } = point;
        let mut words = vec!["pathspace render".to_owned(), quoted(&suite.path_of(&row.source)), "-o picture.exr".to_owned()];
        words.push(format!("--size {width}x{height} --technique {technique} --spp {spp} --frames {frames} --trace {trace} --seed 1"));
        let accumulates = technique::find(technique).is_some_and(|technique| technique.accumulates);
        match point.frame_shown(row.frames) {
            shown if accumulates && shown > 0 => words.push(format!("--first-frame {shown}")),
            _ => {}
        }
        let triple = |numbers: [f64; 3]| numbers.map(|number| number.to_string()).join(",");
        words.extend(row.background.map(|radiance| format!("--background {}", triple(radiance.map(f64::from)))));
        words.extend(row.environment.as_ref().map(|file| format!("--environment {}", quoted(&suite.path_of(file)))));
        words.extend(row.camera.as_ref().map(|name| format!("--camera {}", quoted(name))));
        words.extend(row.eye.map(|eye| format!("--eye {}", triple(eye))));
        words.extend(row.target.map(|target| format!("--target {}", triple(target))));
        words.extend(row.vfov.map(|degrees| format!("--vfov {degrees}")));
        words.extend(settings.iter().map(|(key, value)| format!("--set {}", quoted(&format!("{key}={value}")))));
        words.extend(all_effects.then(|| "--effects all".to_owned()));
        words.join(" ")
    }
}

fn with_values(technique: &Technique, values: &Values) -> Result<Parameters, technique::ParameterError> {
    values.iter().try_fold(technique.parameters(), |mut parameters, (key, value)| parameters.set(key, value).map(|()| parameters))
}

fn view(row: &SceneRow) -> ViewChoice {
    let (Some(eye), Some(target)) = (row.eye, row.target) else { return ViewChoice::Scene(row.camera.clone()) };
    let place = DVec3::from_array;
    ViewChoice::Fixed(CameraView::look_at(place(eye), place(target), row.vfov.unwrap_or(45.0).to_radians()))
}

/// For a POSIX shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+".contains(c);
    if !word.is_empty() && word.chars().all(plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}
