//! `pathspace diff`: measures, limits, refusals.

use super::{Run, assert_refused, files, pathspace, run};
use pathspace::display::{ExrContents, Image, ToneCurve, ToneMapping};
use std::fs::File;
use std::path::Path;
use tempfile::TempDir;

/// a.exr is 10 % brighter than b.exr; a.png and b.png show the same; small.exr has another size; broken.exr has a NaN.
fn pictures() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    let ramp = |scale: f32| Image::new(16, 12, (0..192u16).map(|i| [scale * f32::from(i) / 192.0, scale * 0.5, scale * 0.25]).collect());
    let mut broken = ramp(1.0);
    broken.pixels[17] = [f32::NAN; 3];
    let mapping = ToneMapping { exposure: 0.0, curve: ToneCurve::None };
    for (name, image) in [("a", ramp(1.1)), ("b", ramp(1.0)), ("small", Image::new(1, 1, vec![[1.0; 3]])), ("broken", broken)] {
        let file = |extension| File::create(directory.path().join(name).with_extension(extension)).unwrap();
        ExrContents { image: &image, beside: &[], attributes: &[] }.write(file("exr")).unwrap();
        image.write_png(&mapping, file("png")).unwrap();
    }
    directory
}

fn json(directory: &Path, arguments: &[&str]) -> serde_json::Value {
    let Run { code, stdout, stderr } = run(directory, arguments);
    assert_eq!((code, stderr.as_str()), (Some(0), ""), "{arguments:?}");
    serde_json::from_str(&stdout).expect("stdout is JSON alone")
}

#[test]
fn json_has_a_version_and_every_metric() {
    let directory = pictures();
    let result = json(directory.path(), &["diff", "a.exr", "b.exr", "--json"]);
    assert_eq!(result["version"], 1);
    for name in ["mse", "relmse", "relmse_trimmed", "rmse_tonemapped", "psnr", "ssim", "mean_ratio"] {
        assert!(result["metrics"][name].is_f64(), "{name}: {result}");
    }
    for name in ["flip", "flip_p99", "flip_worst_tile", "hdr_flip", "hdr_flip_p99", "hdr_flip_worst_tile"] {
        assert!(result["metrics"][name].is_f64(), "{name}: {result}");
    }
    assert!((result["metrics"]["mean_ratio"].as_f64().unwrap() - 1.1).abs() < 1e-6);
}

#[test]
fn one_metric_alone_is_measured_when_asked() {
    let directory = pictures();
    let result = json(directory.path(), &["diff", "a.png", "b.png", "--json", "--metric", "psnr"]);
    assert_eq!(result["metrics"].as_object().unwrap().keys().collect::<Vec<_>>(), ["psnr"]);
    let equal = json(directory.path(), &["diff", "a.png", "a.png", "--json", "--metric", "psnr"]);
    assert!(equal["metrics"]["psnr"].is_null(), "infinite");
}

/// Each limit lies on one side of the value, then on the other.
#[test]
fn limits_decide_the_exit_code() {
    let directory = pictures();
    let with = |limit: &str| run(directory.path(), &["diff", "a.exr", "b.exr", "--metric", "mse", "--fail-above", limit]).code;
    for (holds, fails) in [
        ("mse=1", "mse=1e-9"),
        ("relmse=1", "relmse=1e-9"),
        ("flip=1", "flip=0"),
        ("hdr-flip=1", "hdr-flip=0"),
        ("rmse-tonemapped=1", "rmse-tonemapped=1e-9"),
        ("psnr=5", "psnr=99"),
        ("ssim=0.1", "ssim=1"),
        ("mean-ratio=0.11", "mean-ratio=0.09"),
    ] {
        assert_eq!((with(holds), with(fails)), (Some(0), Some(1)), "{holds} {fails}");
    }
    let failed = run(directory.path(), &["diff", "a.exr", "b.exr", "--fail-above", "mse=1e-9", "--fail-above", "psnr=5"]);
    assert_eq!((failed.code, failed.stderr.as_str()), (Some(1), ""));
    assert!(
        failed.stdout.contains("FAILED: --fail-above mse=") && failed.stdout.contains("holds: --fail-above psnr=5"),
        "{}",
        failed.stdout
    );
}

#[test]
fn png_files_are_taken_as_they_are_and_exr_files_are_tonemapped() {
    let directory = pictures();
    let psnr = |arguments: &[&str]| {
        json(directory.path(), &[&["diff", "--json", "--metric", "psnr"], arguments].concat())["metrics"]["psnr"].as_f64()
    };
    assert_eq!(psnr(&["a.png", "b.png"]), psnr(&["a.png", "b.png", "--exposure", "3"]));
    assert_ne!(psnr(&["a.exr", "b.exr"]), psnr(&["a.exr", "b.exr", "--exposure=-3"]));
    assert_ne!(psnr(&["a.exr", "b.exr"]), psnr(&["a.exr", "b.exr", "--tonemap", "none"]));
}

#[test]
fn the_heatmap_is_a_picture_of_the_same_size() {
    let directory = pictures();
    assert_eq!(run(directory.path(), &["diff", "a.exr", "b.exr", "--heatmap", "h.png"]).code, Some(0));
    let heatmap = Image::read(&directory.path().join("h.png")).unwrap();
    assert_eq!((heatmap.width, heatmap.height), (16, 12));
    assert_eq!(files(directory.path()).len(), 9, "nothing beside the heatmap is left");
}

#[test]
fn pictures_that_cannot_be_compared_are_refused() {
    let directory = pictures();
    std::fs::write(directory.path().join("garbage.exr"), b"garbage").unwrap();
    let whole = std::fs::read(directory.path().join("a.exr")).unwrap();
    std::fs::write(directory.path().join("truncated.exr"), &whole[..whole.len() / 2]).unwrap();
    let refused = |arguments: &[&str], hints: &[&str]| {
        assert_refused(directory.path(), &[&["diff", "--heatmap", "h.png"], arguments].concat(), hints)
    };
    refused(&["a.exr", "small.exr"], &["16x12", "1x1"]);
    refused(&["a.exr", "broken.exr"], &["reference", "NaN or infinity", "(1, 1)"]);
    refused(&["missing.exr", "b.exr"], &["missing.exr"]);
    refused(&["garbage.exr", "b.exr"], &["garbage.exr"]);
    refused(&["a.exr", "truncated.exr"], &["truncated.exr"]);
    refused(&["small.exr", "small.exr", "--metric", "ssim"], &["11x11"]);
    refused(&["a.exr", "b.exr", "--fail-above", "beauty=1"], &["one of mse"]);
    refused(&["a.exr", "b.exr", "--fail-above", "mse=nan"], &["finite"]);
    refused(&["a.exr", "b.exr", "--metric", "beauty"], &["possible values"]);
    assert_refused(directory.path(), &["diff", "a.exr", "b.exr", "--heatmap", "missing/h.png"], &["missing/h.png"]);
}

#[test]
fn pictures_too_small_for_ssim_have_the_other_metrics() {
    let directory = pictures();
    let result = run(directory.path(), &["diff", "small.exr", "small.exr"]);
    assert_eq!(result.code, Some(0));
    assert!(!result.stdout.contains("ssim") && result.stdout.contains("flip") && result.stderr.contains("11x11"));
    assert!(!result.stderr.contains('\u{1b}'), "no colours where stderr is no terminal");
    assert_eq!(run(directory.path(), &["-q", "diff", "small.exr", "small.exr"]).stderr, "");
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_error() {
    use std::process::Stdio;
    let directory = pictures();
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let mut command = std::process::Command::new(pathspace(directory.path()).get_program());
    let output = command.current_dir(directory.path()).args(["diff", "a.exr", "b.exr"]).stdout(Stdio::from(writer)).output().unwrap();
    assert_eq!((output.status.code(), String::from_utf8_lossy(&output.stderr).as_ref()), (Some(0), ""));
}
