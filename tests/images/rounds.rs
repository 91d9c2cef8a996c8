//! Several samples per pixel of a frame, for techniques that take one at a time.

use crate::common;
use crate::common::render::{builtin, render_frames, settings};
use pathspace::display::Image;
use pathspace::technique::{self, Renderer, Settings, Work};

fn picture(scene: &str, technique: &str, spp: u32, frames: u32) -> Image {
    let settings = Settings { spp, ..settings(48, 27) };
    render_frames(&common::gpu(), &builtin(scene), &settings, technique, frames).picture().unwrap()
}

/// To 1e-5 of the larger one: sums in another order.
fn agree(a: &Image, b: &Image) -> bool {
    let values = |image: &Image| image.pixels.iter().flatten().copied().collect::<Vec<f32>>();
    values(a).iter().zip(values(b)).all(|(&a, b)| (a - b).abs() <= 1e-5 * a.abs().max(b.abs()))
}

#[test]
fn a_frame_of_several_samples_is_the_mean_of_as_many_frames() {
    for technique in ["unfiltered", "sspsf", "hpsf"] {
        let frames = [1, 2, 3].map(|frames| picture("cornell", technique, 1, frames));
        let mut mean = frames[0].clone();
        for (at, pixel) in mean.pixels.iter_mut().enumerate() {
            *pixel = [0, 1, 2].map(|channel| frames.iter().map(|frame| frame.pixels[at][channel]).sum::<f32>() / 3.0);
        }
        assert!(agree(&picture("cornell", technique, 3, 1), &mean), "{technique}");
        assert!(!agree(&frames[2], &mean), "{technique}");
    }
}

/// Where the technique itself averages over frames, a still scene takes rounds for frames.
#[test]
fn rounds_join_what_earlier_frames_know() {
    assert!(agree(&picture("cornell", "hpsf+", 2, 2), &picture("cornell", "hpsf+", 1, 4)));
}

/// A budget changes them from frame to frame, up to as many as the frame was made for.
#[test]
fn a_frame_takes_as_many_rounds_as_it_is_asked_for() {
    let settings = Settings { spp: 2, technique: technique::find("hpsf").unwrap(), ..settings(48, 27) };
    let mut renderer = Renderer::new(&common::gpu(), builtin("cornell"), settings).unwrap();
    let mut picture_of = |samples| {
        renderer.set_work(Work { samples, first_shadow_rays: 1 });
        renderer.render_frame().unwrap();
        renderer.picture().unwrap()
    };
    let [one, two, again] = [1.0, 9.0, 1.9].map(&mut picture_of);
    let frames = [1, 2, 3, 4].map(|frames| picture("cornell", "hpsf", 1, frames));
    let mut mean = frames[1].clone();
    for (pixel, other) in mean.pixels.iter_mut().zip(&frames[2].pixels) {
        *pixel = [0, 1, 2].map(|channel| 0.5 * (pixel[channel] + other[channel]));
    }
    assert!(agree(&one, &frames[0]) && agree(&two, &mean) && agree(&again, &frames[3]));
}

/// The second round shows the time of the first: what moves by a frame stands still in between.
#[test]
fn the_rounds_of_a_frame_show_one_time() {
    let seen = |spp| {
        let settings = Settings { spp, ..settings(48, 27) };
        let renderer = render_frames(&common::gpu(), &builtin("cornell-object"), &settings, "unfiltered", 3);
        ["motion", "position"].map(|name| renderer.output(name).unwrap().expect("it is put out"))
    };
    let moves = |motion: &Image| motion.pixels.iter().any(|pixel| pixel[0].abs() > 0.01 || pixel[1].abs() > 0.01);
    let ([motion, position], [motion_of_round, position_of_round]) = (seen(1), seen(2));
    assert!(moves(&motion) && !moves(&motion_of_round));
    assert!(agree(&position, &position_of_round));
}
