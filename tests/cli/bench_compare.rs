//! `pathspace bench-compare`: verdicts, limits, what it refuses.

use super::records::{figure, normal, record};
use super::{Run, assert_refused, run};
use pathspace::bench::record::Figure;
use pathspace::bench::{Log, Record};
use rand::SeedableRng;
use rand_pcg::Pcg32;
use std::path::Path;
use tempfile::TempDir;

fn write(folder: &Path, records: &[Record]) {
    let mut log = Log::open(folder).unwrap();
    records.iter().for_each(|record| log.append(record).unwrap());
}

/// Six points of frames of `ms` with 3 % of noise, and memory of `memory_bytes`.
fn points(ms: f64, memory_bytes: f64, seed: u64) -> Vec<Record> {
    let mut rng = Pcg32::seed_from_u64(seed);
    let mut point = |i: usize| {
        let mut record = record(&format!("point-{i}"), "reference");
        let frames = (0..32).map(|_| ms * (0.03 * normal(&mut rng)).exp()).collect();
        record.figures.insert("frame_ms".to_owned(), figure(frames));
        record.figures.insert("memory_bytes".to_owned(), figure(vec![memory_bytes]));
        record
    };
    (0..6).map(&mut point).collect()
}

/// Runs `a`, `same`, `slow` (by 30 %) and `large` (by 10 % of memory); `other` shares no point with them.
fn runs() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    for (name, ms, memory, seed) in [("a", 10.0, 1e6, 1), ("same", 10.0, 1e6, 2), ("slow", 13.0, 1e6, 3), ("large", 10.0, 1.1e6, 4)] {
        write(&directory.path().join(name), &points(ms, memory, seed));
    }
    write(&directory.path().join("other"), &[record("elsewhere", "reference")]);
    directory
}

#[test]
fn what_became_worse_decides_the_exit_code() {
    let directory = runs();
    let with = |arguments: &[&str]| run(directory.path(), &[&["bench-compare", "a"], arguments].concat());
    assert_eq!(with(&["same"]).code, Some(0));
    let Run { code, stdout, stderr } = with(&["slow"]);
    assert_eq!((code, stderr.as_str()), (Some(1), ""));
    assert!(stdout.contains("all 6 points") && stdout.contains("7 REGRESSED"), "six points and their summary: {stdout}");
    assert_eq!(with(&["large"]).code, Some(1));
    assert_eq!(with(&["slow", "--metric", "memory_bytes"]).code, Some(0), "its times are not looked at");
    assert_eq!(with(&["slow", "--fail-above", "frame_ms=60"]).code, Some(0), "within the limit");
    assert_eq!(with(&["a", "--fail-above", "frame_ms=0"]).code, Some(0), "itself");
    assert_eq!(run(directory.path(), &["bench-compare", "slow", "a"]).code, Some(0), "better");
    assert_eq!(with(&["slow/results.jsonl"]).code, Some(1), "a file in place of its folder");
}

/// The reference that the integrator makes is darker, and what is measured against it is as right as before.
#[test]
fn light_that_the_integrator_loses_is_a_regression() {
    let directory = runs();
    let mut dark = points(10.0, 1e6, 5);
    let mut before = points(10.0, 1e6, 1);
    for (records, mean) in [(&mut before, 1.0), (&mut dark, 0.99)] {
        let radiance = Figure { value: mean, low: mean - 1e-3, high: mean + 1e-3, unit: String::new(), samples: vec![] };
        records[0].figures.insert("reference_radiance".to_owned(), radiance);
    }
    for (name, records) in [("before", before), ("dark", dark)] {
        write(&directory.path().join(name), &records);
    }
    let Run { code, stdout, .. } = run(directory.path(), &["bench-compare", "before", "dark"]);
    assert!(code == Some(1) && stdout.contains("1 REGRESSED"), "{stdout}");
    assert_eq!(run(directory.path(), &["bench-compare", "before", "before"]).code, Some(0));
}

#[test]
fn json_tells_each_change_with_its_interval() {
    let directory = runs();
    let Run { code, stdout, stderr } = run(directory.path(), &["bench-compare", "a", "slow", "--json", "--metric", "frame_ms"]);
    assert_eq!((code, stderr.as_str()), (Some(1), ""));
    let result: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&result["version"], &result["regressed"]), (&1.into(), &true.into()));
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let summary = &result["summaries"][0];
    assert!((number(&summary["change"]) - 1.3).abs() < 0.03, "{summary}");
    for point in result["points"].as_array().unwrap() {
        let [low, high] = [0, 1].map(|end| number(&point["interval"][end]));
        assert!(low < number(&point["change"]) && number(&point["change"]) < high && point["verdict"] == "regressed", "{point}");
    }
    assert_eq!(result["points"].as_array().unwrap().len(), 6);
}

#[test]
fn the_newest_record_counts_and_other_circumstances_are_warned_of() {
    let directory = runs();
    let mut again = points(10.0, 1e6, 5);
    for record in &mut again {
        record.provenance.time = "2026-02-01T00:00:00Z".to_owned();
        record.provenance.device = "another".to_owned();
        record.reference.key = "another".to_owned();
    }
    again.push(record("new", "reference"));
    write(&directory.path().join("slow"), &again);
    let Run { code, stdout, stderr } = run(directory.path(), &["bench-compare", "a", "slow"]);
    assert_eq!(code, Some(0), "{stdout}");
    assert!(stdout.contains("only in B: new"), "{stdout}");
    assert!(stderr.contains("another device") && stderr.contains("another reference"), "{stderr}");
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let directory = runs();
    std::fs::create_dir(directory.path().join("empty")).unwrap();
    std::fs::write(directory.path().join("damaged.jsonl"), "{}\n{}\n").unwrap();
    let refused =
        |arguments: &[&str], hints: &[&str]| assert_refused(directory.path(), &[&["bench-compare", "a"], arguments].concat(), hints);
    refused(&["missing"], &["missing", "cannot be read"]);
    refused(&["empty"], &["empty", "results.jsonl"]);
    refused(&["damaged.jsonl"], &["damaged.jsonl", "line 1"]);
    refused(&["other"], &["share no figure"]);
    refused(&["same", "--metric", "beauty"], &["frame_ms", "energy"]);
    refused(&["same", "--fail-above", "frame_ms=-1"], &["at least 0"]);
    refused(&["same", "--fail-above", "frame_ms"], &["key=value"]);
}
