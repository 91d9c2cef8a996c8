//! The subcommand: what it makes, and what it refuses.

use super::results;
use assert_cmd::Command;
use std::path::Path;

pub fn report(folder: &Path, arguments: &[&str]) -> std::process::Output {
    Command::cargo_bin("pathspace").unwrap().current_dir(folder).arg("report").args(arguments).output().unwrap()
}

fn assert_refused(folder: &Path, arguments: &[&str], hints: &[&str]) {
    let output = report(folder, arguments);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    for hint in hints {
        assert!(stderr.contains(hint), "{arguments:?} should mention '{hint}': {stderr}");
    }
    assert!(!folder.join("a/report").exists() && !folder.join("out").exists(), "{arguments:?} left files behind");
}

#[test]
fn results_of_two_folders_become_one_report_without_the_original_files() {
    let directory = tempfile::tempdir().unwrap();
    let records = results::write(&directory.path().join("a"));
    results::write(&directory.path().join("b"));
    let output = report(directory.path(), &["a", "b", "-o", "out"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(String::from_utf8(output.stdout).unwrap().trim(), "out/index.html");
    let data = std::fs::read_to_string(directory.path().join("out/data.js")).unwrap();
    let json = data.trim().strip_prefix("window.report = { data: ").and_then(|rest| rest.strip_suffix(" };")).unwrap();
    let data: serde_json::Value = serde_json::from_str(json).unwrap();
    assert_eq!(data["points"].as_array().unwrap().len(), records.len());
    assert_eq!(data["runs"].as_array().unwrap().len(), 2);
    assert_eq!(data["views"].as_array().unwrap().len(), 4);
}

#[test]
fn bad_results_are_refused_with_their_place() {
    let directory = tempfile::tempdir().unwrap();
    let log = directory.path().join("a/results.jsonl");
    assert_refused(directory.path(), &["a"], &["a/results.jsonl"]);
    results::write(&directory.path().join("a"));
    let good = std::fs::read_to_string(&log).unwrap();
    for (bad, hints) in [
        (good.replacen("\"version\":1", "\"version\":99", 1), vec!["line 1", "99"]),
        (format!("{good}{{\"version\":1}}\n"), vec!["results.jsonl", "line"]),
        (good.replacen("pictures/cornell.png", "../cornell.png", 1), vec!["../cornell.png", "leads out"]),
        (good.replacen("pictures/cornell.png", "pictures/missing.png", 1), vec!["missing.png", "cornell"]),
        (good.replacen("pictures/cornell.png", "results.jsonl", 1), vec!["no PNG"]),
        (String::new(), vec!["no records"]),
    ] {
        std::fs::write(&log, bad).unwrap();
        assert_refused(directory.path(), &["a", "-o", "out"], &hints);
    }
}
