//! Frames that add up: antialiasing without a trail.

use crate::common;
use crate::common::render::{builtin, mean, output, render_frames, settings};
use pathspace::display::Image;

/// The lamp is most of the light that the camera gets, and three pixels high: a row of pixels more or less is a third of it.
#[test]
fn offsets_within_the_pixel_make_the_mean_over_frames_that_of_the_whole_pixel() {
    let gpu = common::gpu();
    let scene = builtin("cornell");
    let settings = settings(128, 72);
    let energy = |technique: &str| mean(&render_frames(&gpu, &scene, &settings, technique, 64).picture().unwrap());
    let truth = energy("reference");
    let antialiased = energy("hpsf+") / truth;
    assert!((antialiased - 1.0).abs() < 0.02, "{antialiased}");
    let centres = energy("hpsf") / truth;
    assert!((centres - 1.0).abs() > 0.05, "the view shows aliasing: {centres}");
}

/// Both kernels see the same point of the pixel in every frame.
#[test]
fn g_buffer_and_terms_share_the_offset() {
    let gpu = common::gpu();
    let mut settings = settings(48, 32);
    settings.outputs = vec!["position".to_owned()];
    let renderer = render_frames(&gpu, &builtin("cornell"), &settings, "hpsf+", 3);
    let [position, vertex] = ["position", "filter_position"].map(|name| output(&renderer, name));
    let agree = |image: &Image| image.pixels.iter().zip(&vertex.pixels).filter(|(a, b)| (0..3).all(|c| (a[c] - b[c]).abs() < 1e-5)).count();
    let seen = vertex.pixels.iter().filter(|pixel| **pixel != [0.0; 3]).count();
    assert!(seen > 500 && agree(&position) >= seen, "{} of {seen}", agree(&position));
    let centres = render_frames(&gpu, &builtin("cornell"), &settings, "hpsf", 3);
    assert!(agree(&output(&centres, "position")) < seen / 2, "the third frame's offset is not zero");
}

/// Of all that a picture of several frames can remember, the lamp is the brightest.
#[test]
fn a_moving_lamp_leaves_no_trail() {
    let gpu = common::gpu();
    let scene = builtin("cornell-light");
    let bright = |technique: &str| {
        let renderer = render_frames(&gpu, &scene, &settings(96, 54), technique, 16);
        renderer.picture().unwrap().pixels.iter().filter(|pixel| pixel[0] > 1.0).count()
    };
    let [lamp, remembered] = ["unfiltered", "hpsf+"].map(bright);
    assert!(lamp > 10 && 2 * remembered < 3 * lamp, "{remembered} of {lamp}");
}
