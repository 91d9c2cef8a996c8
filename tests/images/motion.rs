//! Motion vectors of the g-buffer: from where a point is to where it was, in pixels, whatever moved and wherever the world is.

use crate::common;
use crate::common::render::{builtin, set, settings, wall};
use glam::{DQuat, DVec3};
use pathspace::scene::animation::{Animation, Channel, Interpolation, Keys};
use pathspace::scene::{Camera, Environment, Instance, Local, Material, Node, Projection, Scene};
use pathspace::technique::{self, Renderer, Settings};

const DEPTH: f64 = 4.0;
/// Metres per frame.
const STEP: f64 = 0.05;
const FRAMES_PER_SECOND: f64 = 30.0;
const YFOV: f64 = 0.8;
const EXTENT: [u32; 2] = [48, 32];

fn at(translation: DVec3, parent: Option<u32>) -> Node {
    let local = Local::Trs { translation, rotation: DQuat::IDENTITY, scale: DVec3::ONE };
    Node { name: String::new(), parent, local }
}

/// A wall that fills the picture, 4 m in front of a camera; node `moving` goes `STEP` metres per frame along `direction`.
fn wall_and_camera(place: DVec3, moving: u32, direction: DVec3) -> Scene {
    let nodes = vec![at(place, None), at(DVec3::new(0.0, 0.0, -DEPTH), Some(0)), at(DVec3::ZERO, Some(0))];
    let Local::Trs { translation: start, .. } = nodes[moving as usize].local else { unreachable!() };
    let keys = Keys::Translation(vec![start, start + direction * STEP * FRAMES_PER_SECOND]);
    let channel = Channel { node: moving, times: vec![0.0, 1.0], interpolation: Interpolation::Linear, keys };
    Scene {
        meshes: vec![wall()],
        materials: vec![Material::default()],
        nodes,
        instances: vec![Instance { mesh: 0, node: 1 }],
        cameras: vec![Camera { name: String::new(), node: 2, projection: Projection::Perspective { yfov: YFOV as f32 } }],
        animation: Animation::new(vec![channel]),
        environment: Environment::Constant([1.0; 3]),
        ..Default::default()
    }
}

/// Motion of all pixels in frame `frame`.
fn motion(scene: Scene, frame: u32) -> Vec<[f32; 3]> {
    motion_in(EXTENT, scene, frame)
}

fn motion_in([width, height]: [u32; 2], scene: Scene, frame: u32) -> Vec<[f32; 3]> {
    let gpu = common::gpu();
    let mut unfiltered = Settings { technique: technique::find("unfiltered").unwrap(), ..settings(width, height) };
    // Motion is that of points, and knows nothing of where in the pixel they were seen.
    set(&mut unfiltered, &[("frame.jitter", "on")]);
    let mut renderer = Renderer::new(&gpu, scene, unfiltered).unwrap();
    (0..=frame).for_each(|_| renderer.render_frame().unwrap());
    renderer.output("motion").unwrap().unwrap().pixels
}

fn assert_motion(what: &str, found: &[[f32; 3]], expected: [f64; 3]) {
    for pixel in found {
        let error = (0..3).map(|i| (f64::from(pixel[i]) - expected[i]).abs()).fold(0.0, f64::max);
        assert!(error < 0.01, "{what}: {pixel:?} instead of {expected:?}");
    }
}

/// Pixels that `STEP` metres span on the wall.
fn step_in_pixels() -> f64 {
    STEP / (2.0 * (YFOV / 2.0).tan() * DEPTH) * f64::from(EXTENT[1])
}

#[test]
fn a_wall_that_moves_right_was_on_the_left_near_and_far_from_zero() {
    for place in [DVec3::ZERO, DVec3::new(1e6, -2e6, 3e6)] {
        let found = motion(wall_and_camera(place, 1, DVec3::X), 3);
        assert_motion("moving wall", &found, [-step_in_pixels(), 0.0, 0.0]);
    }
}

#[test]
fn for_a_camera_that_rises_the_wall_was_further_up_in_the_picture_even_when_the_origin_moves() {
    // The origin of a scene this large moves in steps of 32 m: a camera that rises past 16 m crosses into the next.
    for place in [DVec3::ZERO, DVec3::new(0.0, 15.9, 0.0)] {
        let found = motion(wall_and_camera(place, 2, DVec3::Y), 5);
        assert_motion("rising camera", &found, [0.0, -step_in_pixels(), 0.0]);
    }
}

#[test]
fn what_stands_still_has_no_motion() {
    let found = motion(wall_and_camera(DVec3::ZERO, 1, DVec3::ZERO), 2);
    assert_motion("standing wall", &found, [0.0; 3]);
}

/// Pixels that have moved, in pixels of a picture of 256x144, ascending; and the part of the picture that they are.
fn speeds_at_256x144(name: &str) -> (Vec<f32>, f32) {
    let motion = motion_in([128, 72], builtin(name), 2);
    let mut speeds: Vec<f32> = motion.iter().map(|[x, y, _]| 2.0 * x.hypot(*y)).filter(|&speed| speed > 0.01).collect();
    speeds.sort_by(f32::total_cmp);
    let part = speeds.len() as f32 / motion.len() as f32;
    (speeds, part)
}

#[test]
fn moving_scenes_move_by_a_few_pixels_per_frame_and_only_what_should() {
    // The lamp is a thin strip; the sphere has 0.14 of the picture's height; all that a flying camera sees moves, except for some pixel
    // near the point that it flies to.
    for (name, least, most) in [("cornell-light", 0.002, 0.02), ("cornell-object", 0.01, 0.05), ("hall-flight:10000", 0.98, 1.0)] {
        let (speeds, part) = speeds_at_256x144(name);
        assert!((least..=most).contains(&part), "{name}: {part} of the picture moves");
        let typical = speeds[speeds.len() / 2];
        assert!((1.0..6.0).contains(&typical), "{name}: {typical} pixels per frame");
    }
}
