//! Made-up results of a suite: two scenes, two devices, four techniques, switches, faults; with pictures.

use pathspace::bench::record::*;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

pub const SIZE: [u32; 2] = [160, 90];
const SPP: [u32; 3] = [1, 4, 16];

/// (name, ms at 1 spp, FLIP at 1 spp, ms of its filter).
const TECHNIQUES: [(&str, f64, f64, f64); 4] =
    [("reference", 4.0, 0.42, 0.0), ("unfiltered", 4.4, 0.421, 0.0), ("atrous", 4.4, 0.17, 2.6), ("path-space", 4.4, 0.169, 3.9)];

/// (parameter, base value, value, factor on ms, factor on errors).
const SWITCHES: [(&str, &str, &str, f64, f64); 5] = [
    ("mis", "1", "0", 0.8, 1.4),
    ("light-tree", "0", "1", 1.3, 0.7),
    ("texture-lod", "1", "0", 1.15, 1.0001),
    ("ray-offset", "exact", "fast", 1.0001, 1.0001),
    ("effects", "auto", "all", 1.25, 1.2),
];

/// Writes results.jsonl and its pictures.
pub fn write(folder: &Path) -> Vec<Record> {
    std::fs::create_dir_all(folder.join("pictures")).unwrap();
    let records = records();
    let lines = records.iter().fold(String::new(), |mut lines, record| {
        writeln!(lines, "{}", serde_json::to_string(record).unwrap()).unwrap();
        lines
    });
    std::fs::write(folder.join("results.jsonl"), lines).unwrap();
    for record in &records {
        let flip = record.figures["flip"].value;
        picture(&folder.join(&record.pictures.picture), |x, y| shade(x, y).map(|value| value + flip * noise(x, y)));
        picture(&folder.join(&record.pictures.reference), shade);
        picture(&folder.join(&record.pictures.heatmap), |x, y| [flip * noise(x, y).abs() * 2.0, 0.1, 0.3]);
    }
    records
}

fn records() -> Vec<Record> {
    let mut records = Vec::new();
    for (scene, moves, slower) in [("cornell", Moves::Nothing, 1.0), ("hall", Moves::Camera, 2.3)] {
        for device in ["Example GPU 4090", "Software device"] {
            let slower = if device.starts_with("Soft") { 40.0 * slower } else { slower };
            records.extend(of_scene(scene, moves, device, slower));
        }
    }
    records
}

fn of_scene(scene: &str, moves: Moves, device: &str, slower: f64) -> Vec<Record> {
    let mut records = Vec::new();
    for (technique, ms, flip, filter_ms) in TECHNIQUES {
        for spp in SPP {
            let n = f64::from(spp);
            records.push(record((scene, moves), device, (technique, spp), [slower * ms * n, slower * filter_ms, flip * n.powf(-0.45)]));
        }
    }
    let base = records[0].clone();
    let switched = SWITCHES.map(|(key, base_value, value, time, error)| {
        let [ms, flip] = ["frame_ms", "flip"].map(|key| base.figures[key].value);
        let mut record = record((scene, moves), device, ("reference", 1), [ms * time, 0.0, flip * error]);
        record.point.switch =
            Some(Switch { key: key.to_owned(), value: value.to_owned(), base_value: base_value.to_owned(), base: base.key.clone() });
        record.key += key;
        record
    });
    records.extend(switched);
    if scene == "hall" {
        make_faulty(&mut records[0]);
    }
    records
}

/// Faults, a poor reference, and text that must stay text.
fn make_faulty(record: &mut Record) {
    record.figures.insert("nan".to_owned(), figure(7.0, 0.0));
    record.reference.ratio = 4.2;
    record.point.settings.insert("name".to_owned(), "<b>bold</b>".to_owned());
}

fn figure(value: f64, relative: f64) -> Figure {
    let half = value.abs() * relative;
    Figure { value, low: value - half, high: value + half, unit: String::new(), samples: Vec::new() }
}

fn figures(ms: f64, flip: f64) -> BTreeMap<String, Figure> {
    let all = [
        ("frame_ms", ms),
        ("frame_ms_p95", ms * 1.1),
        ("cpu_ms", 0.3),
        ("rays_per_pixel", 9.5),
        ("bytes_read", 2.5e8),
        ("bytes_written", 6e7),
        ("bandwidth", 310.0 / ms),
        ("memory_bytes", 4.1e8),
        ("flip", flip),
        ("relmse", flip * flip),
        ("psnr", 20.0 - 20.0 * flip.log10()),
        ("energy", 1.0 - flip * 0.05),
        ("bias2", flip * flip * 0.1 - 0.002),
        ("variance", flip * flip * 0.9),
        ("temporal", flip * 0.2),
        ("occupancy", 0.2),
        ("nan", 0.0),
        ("predicted_ms:Example GPU 2070", ms * 3.0),
    ];
    all.map(|(key, value)| (key.to_owned(), figure(value, 0.03))).into()
}

/// `costs`: ms of paths, ms of filters, FLIP.
fn record(scene: (&str, Moves), device: &str, (technique, spp): (&str, u32), costs: [f64; 3]) -> Record {
    let text = str::to_owned;
    let [paths_ms, filter_ms, flip] = costs;
    let pass = |name: &str, median_ms: f64| PassFigure {
        name: text(name),
        median_ms,
        p95_ms: median_ms * 1.1,
        spread_ms: median_ms * 0.05,
        bytes_read: 120_000_000,
        bytes_written: 30_000_000,
    };
    let passes = [("gbuffer", paths_ms * 0.2), ("megakernel", paths_ms * 0.75), (technique, filter_ms), ("tonemap", paths_ms * 0.05)];
    let stem = format!("pictures/{}-{technique}-{spp}", scene.0);
    Record {
        version: VERSION,
        key: format!("{}-{technique}-{spp}", scene.0),
        suite: text("made-up"),
        point: Point {
            scene: text(scene.0),
            source: text(scene.0),
            moves: scene.1,
            size: SIZE,
            technique: text(technique),
            spp,
            frames: 16,
            trace: text("bvh"),
            settings: BTreeMap::new(),
            all_effects: false,
            switch: None,
        },
        provenance: Provenance {
            commit: text("0123456789abcdef"),
            program: text("0.1.0"),
            device: text(device),
            driver: text("driver 1.2.3"),
            machine: text("machine"),
            cpu: text("Example CPU"),
            cores: 16,
            os: text("Linux"),
            time: text("2026-01-01T00:00:00Z"),
            seeds: vec![0, 1, 2, 3, 4],
        },
        reference: ReferenceQuality { key: text(scene.0), samples_per_pixel: 65536, standard_error: 0.002, ratio: 31.0 },
        figures: figures(paths_ms + filter_ms, flip),
        passes: passes.into_iter().filter(|(_, ms)| *ms > 0.0).map(|(name, ms)| pass(name, ms)).collect(),
        pictures: Pictures {
            picture: format!("{stem}.png"),
            reference: format!("pictures/{}.png", scene.0),
            heatmap: format!("{stem}-flip.png"),
        },
        command: format!("pathspace render {} --technique {technique} --spp {spp} -o picture.png", scene.0),
    }
}

/// A lit ball before a gradient.
fn shade(x: u32, y: u32) -> [f64; 3] {
    let (u, v) = (f64::from(x) / 90.0 - 0.89, f64::from(y) / 90.0 - 0.5);
    let height = 0.16 - u * u - v * v;
    match height > 0.0 {
        true => [0.9, 0.55, 0.3].map(|albedo| albedo * (0.2 + (height.sqrt() * 0.6 - u * 0.6 - v * 0.8).max(0.0) * 1.6)),
        false => [0.55 + v * 0.3, 0.6 + v * 0.3, 0.7 + v * 0.2],
    }
}

/// In [-1, 1].
fn noise(x: u32, y: u32) -> f64 {
    let hash = (x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35);
    f64::from(hash >> 8) / f64::from(1 << 23) - 1.0
}

fn picture(path: &Path, color: impl Fn(u32, u32) -> [f64; 3]) {
    let pixel = |x, y| image::Rgb(color(x, y).map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8));
    image::RgbImage::from_fn(SIZE[0], SIZE[1], pixel).save(path).unwrap();
}
