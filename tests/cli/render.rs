//! `pathspace render` and `devices`, on the best Vulkan device of this machine: outputs, refusals.

use super::{Run, assert_refused, files, pathspace, run};
use pathspace::display::Image;
use std::path::Path;
use tempfile::TempDir;

const SMALL: [&str; 6] = ["render", "cornell", "--size", "16x9", "--frames", "3"];

fn render(directory: &Path, arguments: &[&str]) -> Run {
    run(directory, &[&SMALL, arguments].concat())
}

fn refused(arguments: &[&str], hints: &[&str]) {
    let directory = tempfile::tempdir().unwrap();
    assert_refused(directory.path(), &[&["render", "-o", "a.exr", "-o", "a.png", "--timings", "t.json"], arguments].concat(), hints);
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).expect("JSON alone")
}

#[test]
fn render_writes_what_was_asked_for_and_nothing_else() {
    let directory = tempfile::tempdir().unwrap();
    let Run { code, stdout, stderr } =
        render(directory.path(), &["-o", "a.exr", "-o", "a.png", "--aov", "normal=n.exr", "--timings", "t.json"]);
    assert_eq!((code, stderr.as_str()), (Some(0), ""));
    assert!(stdout.contains("ms"), "the table of passes: {stdout}");
    assert_eq!(files(directory.path()), ["a.exr", "a.png", "n.exr", "t.json"]);
    for name in ["a.exr", "a.png", "n.exr"] {
        let image = Image::read(&directory.path().join(name)).unwrap();
        assert_eq!((image.width, image.height), (16, 9), "{name}");
        assert!(image.non_finite().is_none() && image.pixels.iter().any(|pixel| *pixel != [0.0; 3]), "{name} is black or not finite");
    }
    let timings = json(&std::fs::read_to_string(directory.path().join("t.json")).unwrap());
    assert_eq!(timings["version"], 1);
    for key in ["device", "driver", "frame_ms_median", "cpu_ms_median", "rays", "memory_bytes"] {
        assert!(!timings[key].is_null(), "{key}: {timings}");
    }
    assert!(timings["passes"].as_array().unwrap().iter().all(|pass| pass["name"].is_string() && pass["p95_ms"].is_f64()), "{timings}");
}

fn picture(directory: &TempDir, arguments: &[&str]) -> Image {
    let result = render(directory.path(), &[arguments, &["-o", "picture.exr"]].concat());
    assert_eq!(result.code, Some(0), "{arguments:?}: {}", result.stderr);
    Image::read(&directory.path().join("picture.exr")).unwrap()
}

#[test]
fn the_seed_alone_decides_the_noise() {
    let directory = tempfile::tempdir().unwrap();
    let first = picture(&directory, &["--seed", "1"]);
    assert_eq!(first, picture(&directory, &["--seed", "1"]));
    assert_ne!(first, picture(&directory, &["--seed", "2"]));
}

#[test]
fn the_camera_and_the_background_are_what_was_asked_for() {
    let directory = tempfile::tempdir().unwrap();
    let away = ["--eye", "0,0,-9", "--target", "0,0,-10", "--vfov", "40", "--background", "0.25,0.5,0.75"];
    assert_eq!(picture(&directory, &away).pixels, [[0.25, 0.5, 0.75]; 16 * 9]);
}

#[test]
fn names_that_nobody_knows_are_refused_with_those_that_there_are() {
    refused(&["--technique", "magic"], &["'magic'", "reference"]);
    refused(&["--trace", "magic"], &["'magic'", "ray-query", "bvh"]);
    refused(&["--camera", "magic"], &["'magic'", "camera"]);
    refused(&["--aov", "magic=b.exr"], &["'magic'", "normal"]);
    refused(&["--device", "magic"], &["'magic'"]);
    refused(&["--device", "99"], &["99"]);
    refused(&["--set", "paths.magic=1"], &["paths.magic", "paths.max_bounces"]);
    refused(&["palace"], &["'palace'", "cornell"]);
}

#[test]
fn values_out_of_range_are_refused_with_the_range() {
    refused(&["--set", "paths.max_bounces=99"], &["paths.max_bounces", "64"]);
    refused(&["--set", "paths.max_bounces=nan"], &["paths.max_bounces"]);
    refused(&["--max-bounces", "99"], &["paths.max_bounces", "64"]);
    refused(&["--set", "paths.sampler=magic"], &["paths.sampler", "sobol"]);
}

#[test]
fn files_that_cannot_be_read_are_refused() {
    refused(&["missing.glb"], &["missing.glb"]);
    refused(&["--environment", "missing.hdr"], &["missing.hdr"]);
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("garbage.exr"), b"garbage").unwrap();
    assert_refused(directory.path(), &["render", "-o", "a.png", "--environment", "garbage.exr"], &["garbage.exr"]);
}

/// The loader finds no driver where these variables lead nowhere.
#[test]
fn a_machine_without_a_vulkan_device_is_told_so() {
    let directory = tempfile::tempdir().unwrap();
    for arguments in [&["render", "-o", "a.png"][..], &["devices"]] {
        let mut command = pathspace(directory.path());
        command.env("VK_DRIVER_FILES", "/nowhere.json").env("VK_ICD_FILENAMES", "/nowhere.json");
        let output = command.args(arguments).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr).to_lowercase();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.starts_with("error: ") && message.contains("install a driver"), "{arguments:?}: {message}");
        assert!(files(directory.path()).is_empty());
    }
}

#[test]
fn devices_are_listed_as_text_and_as_json() {
    let directory = tempfile::tempdir().unwrap();
    let Run { code, stdout, stderr } = run(directory.path(), &["devices", "--json"]);
    assert_eq!((code, stderr.as_str()), (Some(0), ""));
    let report = json(&stdout);
    assert_eq!(report["version"], 1);
    let name = report["devices"][0]["name"].as_str().expect("a device has a name");
    assert!(run(directory.path(), &["devices"]).stdout.contains(name));
}
