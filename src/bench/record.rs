//! What one measurement leaves: a line of results.jsonl, complete in itself.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Of [`Record`]; readers refuse others.
pub const VERSION: u32 = 1;

/// One point of a suite, measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    pub version: u32,
    /// Hash of `point`: equal points of two runs, on whatever machine, have one key.
    pub key: String,
    pub suite: String,
    pub point: Point,
    pub provenance: Provenance,
    pub reference: ReferenceQuality,
    /// By the keys of [`super::figure::FIGURES`]; what could not be measured is missing.
    pub figures: BTreeMap<String, Figure>,
    /// In the order of the frame.
    pub passes: Vec<PassFigure>,
    pub pictures: Pictures,
    /// Shell command that renders the same picture.
    pub command: String,
}

/// What was measured: everything that the result should depend on, and nothing else.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Its name in the suite.
    pub scene: String,
    /// File or built-in scene.
    pub source: String,
    pub moves: Moves,
    /// Pixels.
    pub size: [u32; 2],
    pub technique: String,
    /// Samples per pixel and frame.
    pub spp: u32,
    /// Frames of the sequence; the last one is measured.
    pub frames: u32,
    /// Acceleration structure.
    pub trace: String,
    /// Parameters that were set, beside the technique's own defaults.
    pub settings: BTreeMap<String, String>,
    /// Every effect compiled in, called for or not.
    pub all_effects: bool,
    /// The accuracy switch that this point prices against the same point without it; none for points of a technique.
    pub switch: Option<Switch>,
}

impl Point {
    /// The frame of the animation that its picture shows; `sequence`: frames of the scene's sequence.
    pub fn frame_shown(&self, sequence: u32) -> u32 {
        if self.moves == Moves::Nothing { 0 } else { sequence.max(1) - 1 }
    }
}

/// What moves in a sequence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Moves {
    Nothing,
    Camera,
    Light,
    Object,
}

/// One setting that differs from the base point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Switch {
    /// Parameter, or `effects`.
    pub key: String,
    pub value: String,
    /// Its value at the base point.
    pub base_value: String,
    /// Key of the base point's record.
    pub base: String,
}

/// Where and when a point was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Of the program; `unknown` outside a repository.
    pub commit: String,
    pub program: String,
    pub device: String,
    pub driver: String,
    pub machine: String,
    pub cpu: String,
    pub cores: u32,
    pub os: String,
    /// UTC, RFC 3339.
    pub time: String,
    pub seeds: Vec<u32>,
}

/// How good the picture is that errors are measured against.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferenceQuality {
    /// Content hash of scene, camera, size and code of the integrator.
    pub key: String,
    pub samples_per_pixel: u64,
    /// Root mean square over pixels of the standard error, relative as relMSE is.
    pub standard_error: f64,
    /// Root of the relative squared error that was measured, over `standard_error`: 10 is asked for.
    pub ratio: f64,
}

/// One number with its 95 % confidence interval over seeds (over frames for times).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    pub value: f64,
    pub low: f64,
    pub high: f64,
    pub unit: String,
    /// One value per seed, or per frame for times; empty where there is only one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub samples: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PassFigure {
    pub name: String,
    pub median_ms: f64,
    pub p95_ms: f64,
    /// Difference of the quartiles over frames.
    pub spread_ms: f64,
    pub bytes_read: u64,
    pub bytes_written: u64,
}

/// Files beside results.jsonl, as paths relative to it, with forward slashes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Pictures {
    /// Tonemapped PNG of the first seed.
    pub picture: String,
    pub reference: String,
    /// LDR-FLIP of `picture` in the magma colour map.
    pub heatmap: String,
}

impl Figure {
    /// No number of it is NaN or infinite, which JSON cannot hold.
    pub fn is_finite(&self) -> bool {
        [self.value, self.low, self.high].iter().chain(&self.samples).all(|number| number.is_finite())
    }

    /// The intervals of the two have a value in common: no difference is to be shown.
    pub fn overlaps(&self, other: &Figure) -> bool {
        self.low <= other.high && other.low <= self.high
    }
}
