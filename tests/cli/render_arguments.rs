//! What `pathspace render` refuses before it looks for a device or a scene.

use super::assert_refused;

fn refused(arguments: &[&str], hint: &str) {
    let directory = tempfile::tempdir().unwrap();
    assert_refused(directory.path(), &[&["render"], arguments].concat(), &[hint]);
}

#[test]
fn pictures_without_pixels_or_samples_are_refused() {
    refused(&["-o", "a.png", "--size", "0x0"], "WIDTHxHEIGHT");
    refused(&["-o", "a.png", "--size", "640"], "WIDTHxHEIGHT");
    refused(&["-o", "a.png", "--size", "99999999x99999999"], "1 to 16384");
    refused(&["-o", "a.png", "--spp", "0"], "--spp");
    refused(&["-o", "a.png", "--frames", "0"], "--frames");
    refused(&["-o", "a.png", "--spp", "many"], "--spp");
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    refused(&["-o", "a.png", "--eye", "0,nan,0", "--target", "0,0,0"], "three finite numbers");
    refused(&["-o", "a.png", "--eye", "0,0", "--target", "0,0,0"], "three finite numbers");
    refused(&["-o", "a.png", "--background", "1,inf,1"], "three finite numbers");
    refused(&["-o", "a.png", "--background", "-1,0,0"], "at least 0");
    refused(&["-o", "a.png", "--exposure", "nan"], "finite number");
    refused(&["-o", "a.png", "--fps", "0"], "above 0");
    refused(&["-o", "a.png", "--eye", "0,0,0", "--target", "0,0,1", "--vfov", "180"], "below 180");
}

#[test]
fn half_a_camera_or_two_are_refused() {
    refused(&["-o", "a.png", "--eye", "0,0,0"], "--target");
    refused(&["-o", "a.png", "--vfov", "30"], "--eye");
    refused(&["-o", "a.png", "--eye", "0,1,0", "--target", "0,1,0"], "--eye and --target are the same point");
    refused(&["-o", "a.png", "--camera", "x", "--eye", "0,0,0", "--target", "0,0,1"], "cannot be used with");
    refused(&["-o", "a.png", "--environment", "a.hdr", "--background", "1,1,1"], "cannot be used with");
}

#[test]
fn outputs_that_cannot_be_are_refused_before_the_work() {
    refused(&[], "--output");
    refused(&["-o", "a.jpg"], ".exr or .png");
    refused(&["--aov", "normal=a.png"], ".exr");
    refused(&["--aov", "a.exr"], "NAME=OUT.exr");
    refused(&["-o", "missing/a.png"], "'missing/a.png'");
    refused(&["-o", "a.png", "--timings", "missing/t.json"], "'missing/t.json'");
    refused(&["-o", "a.exr", "--aov", "normal=./a.exr"], "named twice");
    let directory = tempfile::tempdir().unwrap();
    std::fs::create_dir(directory.path().join("a.png")).unwrap();
    assert_refused(directory.path(), &["render", "-o", "a.png"], &["it is a directory"]);
}

#[test]
fn settings_without_a_value_are_refused() {
    refused(&["-o", "a.png", "--set", "paths.max_bounces"], "key=value");
    refused(&["-o", "a.png", "--set", "=4"], "key=value");
}
