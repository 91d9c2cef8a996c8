//! Records for tests.

use super::Measured;
use crate::bench::record::*;
use std::collections::BTreeMap;
use std::path::PathBuf;

pub fn figure(value: f64, low: f64, high: f64) -> Figure {
    Figure { value, low, high, unit: String::new(), samples: Vec::new() }
}

/// Within 1 %.
fn figures(ms: f64, flip: f64) -> BTreeMap<String, Figure> {
    [("frame_ms", ms), ("flip", flip)].map(|(key, value)| (key.to_owned(), figure(value, value * 0.99, value * 1.01))).into()
}

/// A still cornell of 64x32 pixels.
pub fn measured(key: &str, technique: &str, spp: u32, ms: f64, flip: f64) -> Measured {
    let text = str::to_owned;
    let record = Record {
        version: VERSION,
        key: text(key),
        suite: text("test"),
        point: Point {
            scene: text("cornell"),
            source: text("cornell"),
            moves: Moves::Nothing,
            size: [64, 32],
            technique: text(technique),
            spp,
            frames: 1,
            trace: text("bvh"),
            settings: BTreeMap::new(),
            all_effects: false,
            switch: None,
        },
        provenance: Provenance {
            commit: text("0123456"),
            program: text("0.1.0"),
            device: text("device"),
            driver: text("driver"),
            machine: text("machine"),
            cpu: text("cpu"),
            cores: 2,
            os: text("os"),
            time: text("2026-01-01T00:00:00Z"),
            seeds: vec![0, 1, 2],
        },
        reference: ReferenceQuality { key: text("r"), samples_per_pixel: 4096, standard_error: 0.001, ratio: 20.0 },
        figures: figures(ms, flip),
        passes: Vec::new(),
        pictures: Pictures::default(),
        command: text("pathspace render"),
    };
    Measured { record, folder: PathBuf::new() }
}

/// `base` with one switch set.
pub fn switched(key: &str, base: &Measured, switch: &str, value: &str, ms: f64, flip: f64) -> Measured {
    let mut switched = base.clone();
    switched.record.point.switch =
        Some(Switch { key: switch.to_owned(), value: value.to_owned(), base_value: "1".to_owned(), base: base.record.key.clone() });
    switched.record.key = key.to_owned();
    switched.record.figures = figures(ms, flip);
    switched
}
