//! Frames that add up: antialiasing without a trail.

use crate::common;
use crate::common::render::{builtin, mean, output, render_frames, set, settings};
use glam::DVec3;
use pathspace::display::Image;
use pathspace::gpu::Gpu;
use pathspace::scene::animation::{Animation, Channel, Interpolation, Keys};
use pathspace::scene::{Instance, Material, Scene};
use pathspace::technique::{Renderer, Settings};

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

/// What the picture's history will average is smoothed the less: as if it were so many samples. What has come into view has no history.
#[test]
fn smoothing_of_other_lobes_knows_how_long_a_point_has_been_seen() {
    let gpu = common::gpu();
    let mut settings = settings(64, 36);
    settings.outputs = vec!["specular_samples".to_owned(), "filter_position".to_owned()];
    let shares = |scene: &str, frames: u32| {
        let renderer = render_frames(&gpu, &builtin(scene), &settings, "hpsf+", frames);
        let [samples, vertices] = ["specular_samples", "filter_position"].map(|name| output(&renderer, name));
        let seen = samples.pixels.iter().zip(&vertices.pixels).filter(|(_, vertex)| **vertex != [0.0; 3]);
        let seen: Vec<f32> = seen.map(|(samples, _)| samples[0]).collect();
        let share = |long: f32| seen.iter().filter(|&&samples| samples >= long).count() as f64 / seen.len() as f64;
        [1.0 - share(2.0), share(0.7 * frames as f32)]
    };
    assert_eq!(shares("material", 1), [1.0; 2]);
    let [_, still] = shares("material", 6);
    let [new, _] = shares("hall-flight", 6);
    assert!(still > 0.9, "{still}");
    assert!(new > 0.01 && new < 0.2, "{new}");
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

/// Where retraced paths tell of no change, history is as long and as whole as if nothing could move: a lamp's too, and that of metals, some of whose
/// paths meet nothing but lamps. Which keys get slots is not left to chance, and smoothing hardly spreads the few pixels that nobody speaks for.
/// Without what lamps and metals say, 97 % of cornell and 79 % of the metal are the same.
#[test]
fn what_stands_still_keeps_its_history_where_something_may_move() {
    let gpu = common::gpu();
    let found = |scene: &str, values: &[(&str, &str)]| {
        let mut settings = Settings { all_effects: true, ..settings(64, 36) };
        set(&mut settings, &[("hpsf.insertion", "ordered"), ("hpsf.smooth_specular", "1")]);
        set(&mut settings, values);
        render_frames(&gpu, &builtin(scene), &settings, "hpsf+", 12).picture().unwrap()
    };
    for scene in ["cornell", "material-glossy"] {
        let [found, whole] = [&[][..], &[("temporal.clamp", "100"), ("temporal.moving", "64")]].map(|values| found(scene, values));
        let seen = |pixel: &[f32; 3]| pixel.iter().sum::<f32>() > 0.0;
        let pairs = || found.pixels.iter().zip(&whole.pixels).filter(|(a, _)| seen(a));
        let (same, all) = (pairs().filter(|(a, b)| a == b).count(), pairs().count());
        assert!(all > 1000 && 1000 * same > 995 * all, "{scene}: {same} of {all}");
    }
}

/// Frames that the sphere moves for, and its way: three times its radius.
const MOVES: u32 = 16;
const WAY: f64 = 0.2;

/// Cornell's box with a glowing sphere that comes from one side and stays in the middle; or has stayed there.
fn box_with_sphere(comes: bool) -> Scene {
    let mut scene = builtin("cornell-object");
    let end = DVec3::new(0.278, 0.4, 0.14);
    let start = if comes { end - DVec3::X * WAY } else { end };
    let Instance { node, mesh } = *scene.instances.last().expect("the sphere");
    scene.materials.push(Material { emission: [2.0; 3], specular: 0.0, metallic: 0.0, ..Default::default() });
    let glowing = scene.materials.len() as u32 - 1;
    scene.meshes[mesh as usize].triangle_materials.fill(glowing);
    let times = [0, MOVES, 1000].map(|frame| f64::from(frame) / 30.0).to_vec();
    let keys = Keys::Translation(vec![start, end, end]);
    scene.animation = Animation::new(vec![Channel { node, times, interpolation: Interpolation::Linear, keys }]);
    scene
}

/// Mean radiance of the pixels that `counts` after so many frames, over seeds.
fn mean_after(renderer: &mut Renderer, frames: u32, counts: &[bool]) -> f64 {
    const SEEDS: u32 = 8;
    let mut run = |seed| {
        renderer.restart(seed, 0).unwrap();
        (0..frames).for_each(|_| renderer.render_frame().unwrap());
        let picture = renderer.picture().unwrap().pixels;
        picture.iter().zip(counts).filter(|(_, counts)| **counts).map(|(pixel, _)| f64::from(pixel.iter().sum::<f32>())).sum::<f64>()
    };
    (1..=SEEDS).map(&mut run).sum::<f64>() / f64::from(3 * SEEDS) / counts.iter().filter(|&&counts| counts).count() as f64
}

/// Pixels where the sphere has been and is no longer.
fn uncovered(renderer: &mut Renderer) -> Vec<bool> {
    let mut covered = |_| {
        renderer.render_frame().unwrap();
        // What never moves is merged, and comes behind it.
        output(renderer, "identity").pixels.iter().map(|pixel| pixel[0] == 0.0).collect()
    };
    let frames: Vec<Vec<bool>> = (0..=MOVES).map(&mut covered).collect();
    let (last, earlier) = frames.split_last().unwrap();
    (0..last.len()).map(|i| !last[i] && earlier.iter().any(|frame| frame[i])).collect()
}

/// How much brighter it is where the sphere has been, so many frames after it has stopped, than where it has never been: part of the radiance.
fn trail(gpu: &Gpu, technique: &str, values: &[(&str, &str)], frames: u32) -> f64 {
    let mut settings = settings(64, 36);
    settings.outputs = vec!["identity".to_owned()];
    set(&mut settings, values);
    let [mut comes, mut stays] = [true, false].map(|comes| render_frames(gpu, &box_with_sphere(comes), &settings, technique, 0));
    let counts = uncovered(&mut comes);
    assert!(counts.iter().filter(|&&counts| counts).count() > 50);
    let frames = MOVES + 1 + frames;
    mean_after(&mut comes, frames, &counts) / mean_after(&mut stays, frames, &counts) - 1.0
}

/// Four frames are temporal.moving of hpsf+. Chance is 0.007; cells that do not forget have 0.048 and 0.040.
#[test]
fn an_object_that_stops_leaves_no_trail() {
    let gpu = common::gpu();
    let cells: &[_] = &[("hpsf.time", "hybrid"), ("hpsf.width", "4")];
    for (technique, values, frames) in [("hpsf+", &[][..], 4), ("hpsf", cells, 0)] {
        let found = trail(&gpu, technique, values, frames);
        assert!(found.abs() < 0.033, "{technique}: {found}");
    }
}
