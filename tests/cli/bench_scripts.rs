//! ci/bench_slurm and ci/bench_parallel spread a suite over shards. A stand-in for the program notes how it was called.

use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

/// Runs a script with a stand-in that appends its arguments to `calls`, and fails for the shard `failing`.
fn spread(directory: &Path, script: &str, arguments: &[&str], environment: &[(&str, &str)], failing: &str) -> (Output, Vec<String>) {
    let program = directory.join("program");
    let calls = directory.join("calls");
    let text = format!(
        "#!/bin/bash\necho \"$*\" >>'{}'\n[[ $1 == bench ]] && mkdir -p \"$(sed -E 's/.* -o ([^ ]+) .*/\\1/' <<<\"$*\")\"\n[[ $* != *'--shard {failing} '* ]]\n",
        calls.display()
    );
    std::fs::write(&program, text).unwrap();
    std::fs::set_permissions(&program, PermissionsExt::from_mode(0o755)).unwrap();
    let output = Command::new(Path::new(env!("CARGO_MANIFEST_DIR")).join("ci").join(script))
        .args(arguments)
        .envs(environment.iter().copied())
        .env("PATHSPACE", &program)
        .current_dir(directory)
        .output()
        .unwrap();
    let mut lines: Vec<_> = std::fs::read_to_string(calls).unwrap_or_default().lines().map(str::to_owned).collect();
    lines.sort();
    (output, lines)
}

#[test]
fn a_slurm_task_measures_its_shard() {
    let directory = tempfile::tempdir().unwrap();
    let task = [("SLURM_ARRAY_TASK_ID", "7"), ("SLURM_ARRAY_TASK_MIN", "5"), ("SLURM_ARRAY_TASK_COUNT", "8")];
    let (output, calls) = spread(directory.path(), "bench_slurm", &["out", "my suite.toml", "--quick"], &task, "none");
    assert!(output.status.success(), "{output:?}");
    assert_eq!(calls, ["bench my suite.toml --quick -o out/shard-7 --shard 3/8 --resume"]);
    let (output, calls) = spread(directory.path(), "bench_slurm", &["out"], &[], "none");
    assert!(!output.status.success() && calls.len() == 1, "outside of Slurm: {output:?}");
}

#[test]
fn gnu_parallel_measures_every_shard_and_reports_them_together() {
    if Command::new("parallel").arg("--version").output().is_err() {
        println!("skipped: GNU parallel is not installed");
        return;
    }
    let shards = |failing| {
        let directory = tempfile::tempdir().unwrap();
        let (output, calls) = spread(directory.path(), "bench_parallel", &["3", "out", "my suite.toml"], &[("JOBS", "2")], failing);
        let expected = [1, 2, 3].map(|k| format!("bench my suite.toml -o out/shard-{k} --shard {k}/3 --resume"));
        assert_eq!(calls[..3], expected, "{output:?}");
        assert_eq!(calls[3..], ["report out/shard-1 out/shard-2 out/shard-3 -o out/report"], "{output:?}");
        output.status.code()
    };
    assert_eq!(shards("none"), Some(0));
    assert_eq!(shards("2/3"), Some(1), "a shard that failed");
}

#[test]
fn a_number_of_shards_is_asked_for() {
    let directory = tempfile::tempdir().unwrap();
    for arguments in [&[][..], &["3"], &["0", "out"], &["three", "out"]] {
        let (output, calls) = spread(directory.path(), "bench_parallel", arguments, &[], "none");
        assert!(!output.status.success() && calls.is_empty(), "{arguments:?}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("usage: ci/bench_parallel N DIR"), "{output:?}");
    }
}
