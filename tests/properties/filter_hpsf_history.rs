//! What hpsf's cells remember: all of what went in, nothing of what is gone, wherever the camera and the frame's origin go.

use crate::common::floor::{floor, node};
use crate::common::render::{output, render_frames, set, settings};
use crate::common::{self, render};
use glam::{DQuat, DVec3};
use pathspace::scene::animation::{Animation, Channel, Interpolation, Keys};
use pathspace::scene::{Camera, Environment, Instance, Local, Material, Node, Projection, Scene};
use pathspace::technique::{Renderer, Settings};
use std::f64::consts::FRAC_PI_2;

const FPS: f64 = 30.0;

fn translated(node: u32, interpolation: Interpolation, keys: &[(f64, DVec3)]) -> Channel {
    let (times, places) = keys.iter().copied().unzip();
    Channel { node, times, interpolation, keys: Keys::Translation(places) }
}

/// Looks straight down from `place`.
fn camera_at(scene: &mut Scene, place: DVec3) -> u32 {
    let local = Local::Trs { translation: place, rotation: DQuat::from_rotation_x(-FRAC_PI_2), scale: DVec3::ONE };
    scene.nodes.push(Node { name: String::new(), parent: None, local });
    let node = scene.nodes.len() as u32 - 1;
    scene.cameras.push(Camera { name: String::new(), node, projection: Projection::Perspective { yfov: 0.8 } });
    node
}

const STALLS: &str = r#"
#include "lib/rng.glsl"
#include "lib/rounding.glsl"
struct In { float mean; float weight; vec2 news; };
struct Out { float rounded; float nearest; };
void kernel(uint i) {
    float rounded = inputs[i].mean;
    float nearest = inputs[i].mean;
    for (uint n = 0u; n < 1000000u; n++) {
        float number = unit_float(pcg2d(uvec2(i, n))).x;
        float now = inputs[i].news[n & 1u];
        rounded = add_rounding_at_random(rounded, inputs[i].weight * (now - rounded), number);
        nearest += inputs[i].weight * (now - nearest);
    }
    outputs[i] = Out(rounded, nearest);
}
"#;

/// 10^6 frames of 1000 samples each, of which 2^24 count: a step is 2^-14 of the difference, and far less than the last digit of a mean that is
/// nearly there. Rounded at random each leaves a last digit's error or less, weighted as the steps are: a standard deviation of
/// sqrt(2^14 / 2) / 2 last digits, 45, and 8 of the mean over 32 cells; 40 is 5 of these.
#[test]
fn a_thousand_million_samples_stall_no_mean() {
    let weight = 1000.0f32 / (16_777_216.0 + 1000.0);
    let ulp = f32::EPSILON / 2.0;
    for (start, news) in [(1.0, [0.999, 0.999]), (0.5, [0.0, 1.998]), (0.75, [0.9989, 0.9991])] {
        let outputs: Vec<[f32; 2]> = common::run_kernel(&common::gpu(), STALLS, &[[start, weight, news[0], news[1]]; 32]);
        let exact = (0..1_000_000).fold(f64::from(start), |mean, n| mean + f64::from(weight) * (f64::from(news[n & 1]) - mean));
        let error = |column: usize| {
            let sum: f64 = outputs.iter().map(|output| f64::from(output[column]) - exact).sum();
            (sum / outputs.len() as f64 / f64::from(ulp)).abs()
        };
        assert!(error(0) < 40.0, "{start} -> {news:?}: {} last digits", error(0));
        assert!(news[0] == 0.0 || error(1) > 1000.0, "the case would stall: {} last digits", error(1));
    }
}

/// Frames in which the camera rises over x = `from` by 2 cm each, over a floor of 40 m.
fn flight(from: f64, table: &str) -> Renderer {
    let mut scene = floor(20.0);
    scene.environment = Environment::Constant([1.0; 3]);
    let camera = camera_at(&mut scene, DVec3::new(from, 2.0, 0.0));
    let ends = [(0.0, DVec3::new(from, 2.0, 0.0)), (1.0, DVec3::new(from + 0.02 * FPS, 2.0, 0.0))];
    scene.animation = Animation::new(vec![translated(camera, Interpolation::Linear, &ends)]);
    let mut settings = settings(48, 32);
    set(&mut settings, &[("hpsf.table", table), ("hpsf.lookups", "0")]);
    render_frames(&common::gpu(), &scene, &settings, "hpsf", 8)
}

/// The origin is at multiples of 32 m: one flight crosses 16 m and moves it, the other, whose cells are in the same places, does not.
#[test]
fn a_move_of_the_origin_leaves_no_seam_and_loses_no_history() {
    for table in ["persistent", "swapped"] {
        let [crossing, staying] = [15.92, 7.92].map(|from| flight(from, table));
        let x = |renderer: &Renderer| output(renderer, "filter_position").pixels[0][0];
        assert!(x(&crossing) < -10.0 && x(&staying) > 0.0, "{} {}", x(&crossing), x(&staying));
        let samples = [&crossing, &staying].map(|renderer| output(renderer, "hpsf_samples").pixels);
        let most = samples[1].iter().map(|pixel| pixel[0]).fold(0.0, f32::max);
        let differing = samples[0].iter().zip(&samples[1]).filter(|(a, b)| (a[0] - b[0]).abs() > 0.05 * most).count();
        assert!(most > 500.0 && differing < samples[0].len() / 50, "{table}: {differing} pixels know less, or more, than {most} samples");
        let [a, b] = [&crossing, &staying].map(|renderer| output(renderer, "diffuse").pixels);
        let difference = a.iter().zip(&b).map(|(a, b)| (a[0] - b[0]).abs()).sum::<f32>() / a.len() as f32;
        assert!(difference < 0.002, "{table}: a radiance of 1 differs by {difference}");
    }
}

/// A lamp over a floor; the camera is elsewhere, where there is nothing, from frame 4 for `frames`; meanwhile the lamp has gone.
fn after_an_absence(frames: u32, values: &[(&str, &str)]) -> f64 {
    let (mut scene, mut lamp) = (floor(5.0), floor(0.7));
    lamp.materials[0] = Material { emission: [10.0; 3], double_sided: true, ..lamp.materials[0].clone() };
    scene.materials.append(&mut lamp.materials);
    let mut mesh = lamp.meshes.remove(0);
    mesh.triangle_materials = vec![1, 1];
    scene.meshes.push(mesh);
    scene.nodes.push(node(DVec3::new(0.0, 3.0, 0.0)));
    scene.instances.push(Instance { mesh: 1, node: 1 });
    let camera = camera_at(&mut scene, DVec3::new(0.0, 1.0, 0.0));
    let [leaves, returns] = [4, 4 + frames].map(|frame| (f64::from(frame) - 0.5) / FPS);
    let (here, there) = (DVec3::new(0.0, 1.0, 0.0), DVec3::new(100.0, 1.0, 0.0));
    scene.animation = Animation::new(vec![
        translated(camera, Interpolation::Step, &[(0.0, here), (leaves, there), (returns, here), (100.0, here)]),
        translated(1, Interpolation::Step, &[(0.0, DVec3::new(0.0, 3.0, 0.0)), (leaves, DVec3::new(0.0, -50.0, 0.0))]),
    ]);
    let mut settings: Settings = settings(48, 32);
    set(&mut settings, values);
    let renderer = render_frames(&common::gpu(), &scene, &settings, "hpsf", 5 + frames);
    render::mean(&output(&renderer, "diffuse"))
}

/// Stale light is gone after hpsf.age + 1 frames in which no sample has met it, with swapped tables after one; before, it is not.
#[test]
fn a_camera_that_returns_sees_no_stale_light_after_the_stated_frames() {
    let age = ("hpsf.age", "3");
    for values in [&[age][..], &[age, ("hpsf.eviction", "priority")]] {
        assert!(after_an_absence(3, values) > 0.01, "{values:?}: the light would be seen");
        assert_eq!(after_an_absence(4, values), 0.0, "{values:?}");
    }
    assert_eq!(after_an_absence(1, &[("hpsf.table", "swapped")]), 0.0);
}

/// One sample in some hundreds is 10^4 times as bright as the others: once a cell knows its mean, such samples hardly raise it.
#[test]
fn limited_samples_raise_their_cell_by_no_more_than_the_limit() {
    let mut scene = floor(5.0);
    scene.environment = Environment::Constant([0.1; 3]);
    let (mut lamp, place) = (floor(0.05), DVec3::new(0.0, 1.2, 0.0));
    lamp.materials[0] = Material { emission: [1e3; 3], double_sided: true, ..lamp.materials[0].clone() };
    scene.materials.append(&mut lamp.materials);
    let mut mesh = lamp.meshes.remove(0);
    mesh.triangle_materials = vec![1, 1];
    scene.meshes.push(mesh);
    scene.nodes.push(node(DVec3::ZERO));
    scene.instances.push(Instance { mesh: 1, node: 1 });
    camera_at(&mut scene, DVec3::new(0.0, 1.0, 0.0));
    // It appears when all cells know what they are like without.
    let keys = [(0.0, DVec3::new(0.0, -50.0, 0.0)), (5.5 / FPS, place), (100.0, place)];
    scene.animation = Animation::new(vec![translated(1, Interpolation::Step, &keys)]);
    let brightest = |limit: &str| {
        let mut settings = settings(48, 32);
        set(&mut settings, &[("paths.direct", "bsdf"), ("hpsf.limit", limit), ("hpsf.width", "4"), ("hpsf.time", "average")]);
        let renderer = render_frames(&common::gpu(), &scene, &settings, "hpsf", 12);
        output(&renderer, "diffuse").pixels.iter().map(|pixel| pixel[0]).fold(0.0, f32::max)
    };
    let (free, limited) = (brightest("0"), brightest("2"));
    assert!(free > 5.0 && limited < 0.5 * free, "{free} without a limit, {limited} with one");
}
