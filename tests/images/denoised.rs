//! What `hpsf+` is for: one frame at one sample per pixel.

use crate::common;
use crate::common::render::{builtin, render, render_frames, set, settings};
use pathspace::display::ToneMapping;
use pathspace::metrics::accuracy::{Reference, Shot, accuracy};

/// Error over that of the same samples without a filter, against 256 samples. Measured: FLIP 0.70, relMSE 0.05; at 256x144,
/// where less of the error is aliasing, 0.54 and 0.02.
#[test]
fn one_frame_of_hpsf_plus_has_little_of_the_noise() {
    let gpu = common::gpu();
    let scene = builtin("cornell");
    let settings = settings(128, 72);
    let mut many = settings.clone();
    set(&mut many, &[("textures.level", "zero")]);
    many.spp = 64;
    let truth = render(&gpu, &scene, &many, 4).mean;
    let [noisy, filtered] = ["unfiltered", "hpsf+"].map(|technique| {
        let picture = render_frames(&gpu, &scene, &settings, technique, 1).picture().unwrap();
        let reference = Reference { mean: &truth, variance: None, before: None };
        let figures = accuracy(&[Shot { last: &picture, before: None }], &reference, &ToneMapping::default()).unwrap();
        ["flip", "relmse"].map(|key| figures[key].value)
    });
    let [flip, relmse] = [filtered[0] / noisy[0], filtered[1] / noisy[1]];
    assert!(flip < 0.75 && relmse < 0.1, "FLIP {flip}, relMSE {relmse}");
}
