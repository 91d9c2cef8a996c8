//! `pathspace bench`: what it leaves, also when it is killed.

use super::{assert_refused, pathspace, run};
use rand::{Rng, SeedableRng};
use std::collections::HashSet;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// Ten points of a few milliseconds each.
const SUITE: &str = r#"
version = 1
name = "tiny"
sizes = ["12x12"]
seeds = 3
reference = { ratio = 2, most_samples = 64 }
scenes = [{ name = "box", source = "cornell" }]
techniques = [{ name = "*", spp = [1, 2, 4], frames = [1, 2] }]

[[switches]]
key = "paths.direct"
values = ["nee", "bsdf"]
technique = "reference"

[[switches]]
key = "effects"
values = ["all"]
technique = "reference"
"#;

fn with_suite(text: &str) -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("suite.toml"), text).unwrap();
    directory
}

fn records(path: &Path) -> Vec<serde_json::Value> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    text.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"))).collect()
}

fn keys(path: &Path) -> Vec<String> {
    records(path).iter().map(|record| record["key"].as_str().unwrap().to_owned()).collect()
}

/// Keys of the suite's points.
fn planned(directory: &Path, arguments: &[&str]) -> Vec<String> {
    let listed = run(directory, &[&["bench", "suite.toml", "--list"], arguments].concat());
    assert_eq!(listed.code, Some(0), "{}", listed.stderr);
    listed.stdout.lines().map(|line| line.split_once(' ').unwrap().0.to_owned()).collect()
}

#[test]
fn a_run_leaves_a_record_of_every_point_its_pictures_and_a_report() {
    let directory = with_suite(SUITE);
    let done = run(directory.path(), &["bench", "suite.toml", "-o", "results"]);
    assert_eq!((done.code, done.stdout.trim()), (Some(0), "results/report/index.html"), "{}", done.stderr);
    let results = directory.path().join("results");
    assert!(results.join("report/index.html").is_file());
    let records = records(&results.join("results.jsonl"));
    assert_eq!(keys(&results.join("results.jsonl")), planned(directory.path(), &[]));
    for record in &records {
        for key in
            ["frame_ms", "cpu_ms", "memory_bytes", "relmse", "flip", "hdr_flip", "ssim", "bias2", "variance", "temporal", "energy", "nan"]
        {
            let figure = &record["figures"][key];
            let [value, low, high] = ["value", "low", "high"].map(|part| figure[part].as_f64().unwrap_or(f64::NAN));
            assert!(low <= value && value <= high, "{key}: {figure} of {}", record["command"]);
        }
        for picture in ["picture", "reference", "heatmap"] {
            assert!(results.join(record["pictures"][picture].as_str().unwrap()).is_file(), "{picture}");
        }
        let of_table = ["occupancy", "probes", "probes_p99", "failed_insertions", "collisions"];
        let has_table = record["point"]["technique"].as_str().unwrap().contains("hpsf");
        assert!(of_table.iter().all(|key| record["figures"].get(key).is_some() == has_table), "{}", record["command"]);
        assert_eq!(record["provenance"]["seeds"].as_array().unwrap().len(), 3);
        assert!(record["passes"][0]["bytes_written"].as_u64().unwrap() > 0);
    }
    let refused = run(directory.path(), &["bench", "suite.toml", "-o", "results"]);
    assert!(refused.code == Some(2) && refused.stderr.contains("--resume"), "{}", refused.stderr);
}

#[test]
fn the_command_of_a_record_renders_its_picture() {
    let directory = with_suite(SUITE);
    assert_eq!(run(directory.path(), &["bench", "suite.toml", "-o", "results", "--shard", "1/8"]).code, Some(0));
    let record = &records(&directory.path().join("results/results.jsonl"))[0];
    let command = record["command"].as_str().unwrap().replace("picture.exr", "again.png");
    let arguments: Vec<&str> = command.split(' ').skip(1).collect();
    assert_eq!(run(directory.path(), &arguments).code, Some(0), "{command}");
    let read = |path: &str| std::fs::read(directory.path().join(path)).unwrap();
    assert!(read("again.png") == read(&format!("results/{}", record["pictures"]["picture"].as_str().unwrap())), "{command}");
}

/// Killed 20 times at random: what was finished stays, is not measured again, and the file is whole after each new beginning.
#[test]
fn a_run_that_is_killed_again_and_again_loses_nothing() {
    let directory = with_suite(&SUITE.replace("spp = [1, 2, 4]", "spp = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]"));
    let results = directory.path().join("results/results.jsonl");
    let mut rng = rand_pcg::Pcg32::seed_from_u64(11);
    let mut finished: Vec<String> = Vec::new();
    let mut killed = 0;
    while killed < 20 {
        let mut command = Command::new(pathspace(directory.path()).get_program());
        command.current_dir(directory.path()).args(["bench", "suite.toml", "-o", "results", "--resume"]);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(rng.random_range(50..900)));
        child.kill().unwrap();
        child.wait().unwrap();
        killed += 1;
        let text = std::fs::read_to_string(&results).unwrap_or_default();
        let whole: Vec<&str> = text.split_inclusive('\n').filter(|line| line.ends_with('\n')).collect();
        let now: Vec<String> =
            whole.iter().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap()["key"].as_str().unwrap().to_owned()).collect();
        assert!(now.starts_with(&finished), "a finished result is lost");
        finished = now;
    }
    let last = run(directory.path(), &["bench", "suite.toml", "-o", "results", "--resume"]);
    assert_eq!(last.code, Some(0), "{}", last.stderr);
    let keys = keys(&results);
    assert_eq!(keys.iter().collect::<HashSet<_>>().len(), keys.len(), "a point is measured once");
    assert_eq!(keys.len(), planned(directory.path(), &[]).len());
}

#[test]
fn shards_are_parts_of_the_whole() {
    let directory = with_suite(SUITE);
    let parts: Vec<String> = ["1/3", "2/3", "3/3"].iter().flat_map(|shard| planned(directory.path(), &["--shard", shard])).collect();
    assert_eq!(parts, planned(directory.path(), &[]));
}

#[test]
fn suites_that_are_wrong_are_refused_before_anything_is_measured() {
    let refused = |from: &str, to: &str, hint: &str| {
        assert!(SUITE.contains(from));
        let directory = with_suite(&SUITE.replace(from, to));
        assert_refused(directory.path(), &["bench", "suite.toml", "-o", "results"], &["suite", hint]);
    };
    refused("version = 1", "version = 9", "version 9");
    refused("12x12", "12", "'12' is no WIDTHxHEIGHT");
    refused("name = \"*\"", "name = \"magic\"", "no technique 'magic'");
    refused("\"nee\"", "\"never\"", "'never' is no value for 'paths.direct'");
    refused("paths.direct", "paths.indirect", "no parameter 'paths.indirect'");
    refused("seeds = 3", "seeds = \"three\"", "seeds");
    let directory = with_suite(SUITE);
    assert_refused(directory.path(), &["bench", "missing.toml"], &["missing.toml"]);
    assert_refused(directory.path(), &["bench", "suite.toml", "--shard", "4/3"], &["K/N"]);
}
