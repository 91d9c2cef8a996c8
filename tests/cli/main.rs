//! The program as its user meets it: exit codes, messages, files, what goes to stdout.

#[path = "../common/glb.rs"]
mod glb;
#[path = "../common/records.rs"]
mod records;

mod bad_scenes;
mod bench;
mod bench_compare;
mod bench_scripts;
mod budget;
mod diff;
mod inspect;
mod readme;
mod render;
mod render_arguments;
mod setup;

use assert_cmd::Command;
use std::path::Path;

/// The program, to be run in `directory`.
fn pathspace(directory: &Path) -> Command {
    let mut command = Command::cargo_bin("pathspace").expect("cargo builds the binary for this test");
    command.current_dir(directory).env_remove("PATHSPACE_LOG");
    command
}

/// What one run left behind.
struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

fn run(directory: &Path, arguments: &[&str]) -> Run {
    let output = pathspace(directory).args(arguments).output().expect("the program starts");
    let text = |bytes| String::from_utf8(bytes).expect("messages are UTF-8");
    Run { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

/// Bad input: exit code 2, a message that holds each of `hints`, nothing on stdout, no file made.
fn assert_refused(directory: &Path, arguments: &[&str], hints: &[&str]) {
    let files_before = files(directory);
    let Run { code, stdout, stderr } = run(directory, arguments);
    assert_eq!(code, Some(2), "{arguments:?}: {stderr}");
    assert!(stderr.starts_with("error: ") && !stderr.contains("panicked"), "{arguments:?}: {stderr}");
    for hint in hints {
        assert!(stderr.contains(hint), "{arguments:?} should mention '{hint}': {stderr}");
    }
    assert_eq!(stdout, "", "{arguments:?}");
    assert_eq!(files(directory), files_before, "{arguments:?} left files behind");
}

fn files(directory: &Path) -> Vec<std::ffi::OsString> {
    let mut names: Vec<_> = std::fs::read_dir(directory).expect("readable").map(|entry| entry.expect("readable").file_name()).collect();
    names.sort();
    names
}

#[test]
fn no_subcommand_or_an_unknown_one_is_bad_input() {
    let directory = tempfile::tempdir().unwrap();
    assert_eq!(run(directory.path(), &[]).code, Some(2));
    assert_refused(directory.path(), &["paint"], &["unrecognized subcommand 'paint'"]);
}

#[test]
fn help_and_version_are_results() {
    let directory = tempfile::tempdir().unwrap();
    for arguments in [&["--help"][..], &["--version"], &["render", "--help"], &["diff", "--help"]] {
        let Run { code, stdout, stderr } = run(directory.path(), arguments);
        assert_eq!((code, stderr.as_str()), (Some(0), ""), "{arguments:?}");
        assert!(stdout.contains("pathspace"), "{arguments:?}");
    }
}

#[test]
fn a_log_filter_that_cannot_be_read_is_bad_input() {
    let directory = tempfile::tempdir().unwrap();
    let output = pathspace(directory.path()).args(["diff", "a.png", "b.png"]).env("PATHSPACE_LOG", "pathspace=loud").output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("PATHSPACE_LOG='pathspace=loud'"));
}
