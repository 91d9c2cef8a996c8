//! Records of runs that never took place, with the noise that real ones have.

use pathspace::bench::record::{Figure, Moves, Pictures, Point, Provenance, Record, ReferenceQuality, VERSION};
use rand::Rng;
use rand_pcg::Pcg32;
use std::collections::BTreeMap;

/// Without figures.
pub fn record(key: &str, technique: &str) -> Record {
    let point = Point {
        scene: key.to_owned(),
        source: "cornell".to_owned(),
        moves: Moves::Nothing,
        size: [64, 36],
        technique: technique.to_owned(),
        spp: 1,
        frames: 1,
        trace: "bvh".to_owned(),
        settings: BTreeMap::new(),
        all_effects: false,
        switch: None,
    };
    Record {
        version: VERSION,
        key: key.to_owned(),
        suite: "synthetic".to_owned(),
        point,
        provenance: Provenance {
            commit: "0123abc".to_owned(),
            program: "0.1.0".to_owned(),
            device: "device".to_owned(),
            driver: "driver".to_owned(),
            machine: "machine".to_owned(),
            cpu: "cpu".to_owned(),
            cores: 2,
            os: "os".to_owned(),
            time: "2026-01-01T00:00:00Z".to_owned(),
            seeds: (1..=8).collect(),
        },
        reference: ReferenceQuality { key: "reference".to_owned(), samples_per_pixel: 1024, standard_error: 0.01, ratio: 10.0 },
        figures: BTreeMap::new(),
        passes: Vec::new(),
        pictures: Pictures::default(),
        command: "pathspace render".to_owned(),
    }
}

pub fn figure(samples: Vec<f64>) -> Figure {
    let value = samples.iter().sum::<f64>() / samples.len() as f64;
    Figure { value, low: value, high: value, unit: String::new(), samples }
}

/// Standard normal (Box and Muller 1958).
pub fn normal(rng: &mut Pcg32) -> f64 {
    let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * rng.random::<f64>()).cos()
}
