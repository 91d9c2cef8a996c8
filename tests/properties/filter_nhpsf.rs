//! nhpsf: light that travels from cell to cell arrives, once, from any depth.

use crate::common;
use crate::common::floor::node;
use crate::common::render::{builtin, mean, output, render_frames, set, settings};
use glam::{DVec3, Vec3};
use pathspace::display::Image;
use pathspace::metrics::statistics::BatchMeans;
use pathspace::scene::{CameraView, Instance, Material, Mesh, Scene};
use pathspace::technique::{Settings, ViewChoice};

pub const EMITTED: [f32; 3] = [1.0, 0.5, 2.0];
const ALBEDO: [f32; 3] = [0.5, 0.2, 0.7];

/// A cube of 2 m around the camera whose walls all emit the same: what arrives anywhere from anywhere is e / (1 - albedo), and no sample of it
/// differs from another where nothing but emission is looked for.
pub fn closed_box(wall: impl Fn(&mut Material, usize)) -> (Scene, Settings) {
    let mut scene = Scene { nodes: vec![node(DVec3::ZERO)], ..Default::default() };
    for side in 0..6 {
        let mut material = Material { metallic: 0.0, specular: 0.0, double_sided: true, ..Default::default() };
        material.base_color = [ALBEDO[0], ALBEDO[1], ALBEDO[2], 1.0];
        material.emission = EMITTED;
        wall(&mut material, side);
        scene.materials.push(material);
        let normal = Vec3::AXES[side / 2] * if side % 2 == 0 { 1.0 } else { -1.0 };
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let corner = |x: f32, y: f32| (x * tangent + y * bitangent - normal).to_array();
        scene.meshes.push(Mesh {
            positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
            normals: vec![normal.to_array(); 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            triangle_materials: vec![0, 0],
            ..Default::default()
        });
        scene.instances.push(Instance { mesh: side as u32, node: 0 });
        scene.meshes[side].triangle_materials = vec![side as u32; 2];
    }
    let mut settings = settings(40, 24);
    settings.view = ViewChoice::Fixed(CameraView::look_at(DVec3::new(0.3, 0.2, 0.5), DVec3::new(0.0, 0.0, -1.0), 1.0));
    set(&mut settings, &[("paths.direct", "bsdf"), ("paths.roulette", "off")]);
    // The last frame's mean alone, no cell forgotten, and none that only a rare jitter finds.
    set(&mut settings, &[("hpsf.time", "average"), ("hpsf.alpha", "0"), ("hpsf.age", "254"), ("hpsf.seed", "off"), ("hpsf.jitter", "0")]);
    (scene, settings)
}

fn filtered(scene: &Scene, settings: &Settings, values: &[(&str, &str)], frames: u32) -> Image {
    let mut settings = settings.clone();
    set(&mut settings, values);
    output(&render_frames(&common::gpu(), scene, &settings, "nhpsf", frames), "diffuse")
}

/// e times the sum of so many powers of the albedo.
pub fn series(channel: usize, bounces: u32) -> f32 {
    EMITTED[channel] * (0..bounces).map(|i| ALBEDO[channel].powi(i as i32)).sum::<f32>()
}

/// Most of [`relative_error`]: in a frame, as many paths as 2 of the 960 may come to a cell that nothing is known of yet.
const FEW: f32 = 2e-3;

/// Mean over pixels and channels.
pub fn relative_error(image: &Image, expected: impl Fn(usize) -> f32) -> f32 {
    let error = |value: f32, c: usize| (value / expected(c) - 1.0).abs();
    image.pixels.iter().flat_map(|pixel| (0..3).map(|c| error(pixel[c], c))).sum::<f32>() / (3 * image.pixels.len()) as f32
}

/// What walls receive, at any depth.
pub fn received(channel: usize) -> f32 {
    EMITTED[channel] / (1.0 - ALBEDO[channel])
}

/// 0.7^40 of the light is from deeper than the frames reach. Paths of three bounces alone would miss a quarter of the blue.
#[test]
fn short_paths_find_the_light_of_all_bounces() {
    let switches: [&[(&str, &str)]; 5] = [
        &[],
        &[("nhpsf.vertices", "4"), ("nhpsf.distance", "path")],
        &[("hpsf.table", "swapped"), ("nhpsf.wider", "0"), ("hpsf.sums", "float")],
        &[("nhpsf.unknown", "dark")],
        &[("hpsf.time", "integrate"), ("hpsf.recency", "16")],
    ];
    let (scene, settings) = closed_box(|_, _| ());
    for values in switches {
        let values = [values, &[("paths.max_bounces", "3")]].concat();
        let error = relative_error(&filtered(&scene, &settings, &values, 40), received);
        assert!(error < FEW, "{values:?}: {error}");
    }
}

/// Mirrors in front of filter vertices and between them: the ceiling and a wall in the picture.
#[test]
fn light_comes_through_mirrors_between_filter_vertices() {
    let (scene, settings) = closed_box(|material, side| {
        if side == 3 || side == 4 {
            *material = Material { metallic: 1.0, roughness: 0.0, base_color: [1.0; 4], double_sided: true, ..Default::default() };
        }
    });
    let error = relative_error(&filtered(&scene, &settings, &[("paths.max_bounces", "60")], 40), received);
    assert!(error < FEW, "{error}");
}

/// Nothing but what cells know goes on: n frames see n bounces, one more where the paths of the first frame were as long as that, and fewer in
/// the 2 % of the cells that were found later.
#[test]
fn each_frame_adds_a_bounce() {
    let (scene, settings) = closed_box(|_, _| ());
    for frames in 1..=5 {
        let image = filtered(&scene, &settings, &[("nhpsf.unknown", "dark")], frames);
        for c in 0..3 {
            let [least, most] = [frames, frames + 1].map(|bounces| series(c, bounces));
            let values = || image.pixels.iter().map(|pixel| pixel[c]);
            let average = values().sum::<f32>() / image.pixels.len() as f32;
            assert!(values().all(|value| value < 1.0001 * most) && average > 0.98 * least, "{frames} frames: {average}, {least} to {most}");
        }
    }
}

/// Walls behind the camera are in nobody's picture: only vertices behind the first one fill their cells.
#[test]
fn cells_outside_of_the_picture_are_filled() {
    let (scene, settings) = closed_box(|_, _| ());
    let values = |vertices| [("nhpsf.unknown", "dark"), ("nhpsf.vertices", vertices)];
    let [filled, dark] = ["2", "1"].map(|vertices| relative_error(&filtered(&scene, &settings, &values(vertices), 40), received));
    assert!(filled < FEW && dark > 0.1, "{filled}; {dark} where cells out of sight are dark");
}

/// With cells of their own, vertices behind the first one know of direct light alone: the thesis' form gives e + 2 albedo e where two vertices of a
/// path find e + albedo e.
#[test]
fn the_thesis_form_counts_the_second_vertex_twice() {
    let (scene, settings) = closed_box(|_, _| ());
    let values = [("nhpsf.form", "paper"), ("nhpsf.wider", "6"), ("hpsf.levels", "1")];
    let error = relative_error(&filtered(&scene, &settings, &values, 8), |c| EMITTED[c] * (1.0 + 2.0 * ALBEDO[c]));
    assert!(error < FEW, "{error}");
}

/// The mean of the last half of the frames of some runs, and the variance of that mean.
pub fn mean_of_runs(scene: &Scene, settings: &Settings, technique: &str, frames: u32) -> (f64, f64) {
    const RUNS: u32 = 6;
    let mut renderer = render_frames(&common::gpu(), scene, settings, technique, 0);
    let mut run = |seed| {
        renderer.restart(seed, 0).unwrap();
        let mut sum = 0.0;
        for frame in 0..frames {
            renderer.render_frame().unwrap();
            sum += if frame < frames / 2 { 0.0 } else { mean(&renderer.picture().unwrap()) };
        }
        sum / f64::from(frames - frames / 2)
    };
    let means: Vec<f64> = (1..=RUNS).map(&mut run).collect();
    let average = means.iter().sum::<f64>() / f64::from(RUNS);
    let variance = means.iter().map(|m| (m - average).powi(2)).sum::<f64>() / f64::from(RUNS * (RUNS - 1));
    (average, variance)
}

/// Against path tracing through the same points, to 32 bounces: 1 %, beyond chance (4 standard errors of both, once in 10^4). Cells are as large
/// as by default at 192x128.
#[test]
fn closed_scenes_are_as_bright_as_the_path_tracer_finds_them() {
    for name in ["cornell", "furnace"] {
        let scene = builtin(name);
        let mut settings = settings(48, 32);
        set(&mut settings, &[("hpsf.width", "4"), ("hpsf.cells", "4")]);
        let (found, of_found) = mean_of_runs(&scene, &settings, "nhpsf", 32);
        set(&mut settings, &[("paths.max_bounces", "32")]);
        let (truth, of_truth) = mean_of_runs(&scene, &settings, "unfiltered", 128);
        let error = (of_truth + of_found).sqrt() / truth;
        assert!((found / truth - 1.0).abs() < 0.01 + 4.0 * error, "{name}: {} +- {error}", found / truth);
    }
}

/// Of what a filter vertex receives indirectly, after so many frames: variance over seeds, the mean over pixels.
fn variance_of_indirect_light(settings: &Settings, frames: u32) -> f64 {
    let mut renderer = render_frames(&common::gpu(), &builtin("cornell"), settings, "hpsf", 0);
    let mut pixels = vec![BatchMeans::default(); (settings.extent[0] * settings.extent[1]) as usize];
    for seed in 1..=8 {
        renderer.restart(seed, 0).unwrap();
        (0..frames).for_each(|_| renderer.render_frame().unwrap());
        renderer.finish().unwrap();
        let received = output(&renderer, "diffuse_indirect");
        pixels.iter_mut().zip(received.pixels).for_each(|(pixel, value)| pixel.add(f64::from(value[0])));
    }
    pixels.iter().map(BatchMeans::variance_of_mean).sum::<f64>() / pixels.len() as f64
}

/// Where second vertices are read from cells: as bright as path tracing to 32 bounces, as above; fewer rays, and less noise.
#[test]
fn second_vertices_that_are_read_bring_the_same_light_by_fewer_rays_and_with_less_noise() {
    let mut settings = settings(48, 32);
    set(&mut settings, &[("hpsf.width", "4"), ("hpsf.cells", "4"), ("hpsf.recency", "1"), ("paths.max_bounces", "32")]);
    let (truth, of_truth) = mean_of_runs(&builtin("cornell"), &settings, "unfiltered", 128);
    set(&mut settings, &[("paths.max_bounces", "8")]);
    let [traced, read] = ["trace", "cells"].map(|second| {
        set(&mut settings, &[("hpsf.second", second)]);
        let mut renderer = render_frames(&common::gpu(), &builtin("cornell"), &settings, "hpsf", 8);
        (renderer.timings().unwrap().rays.per_pixel, [1, 8].map(|frames| variance_of_indirect_light(&settings, frames)))
    });
    // In the first frame cells know what its own paths have found; all of these were traced to their end.
    assert!(read.0 < 0.8 * traced.0 && read.1[0] < 0.8 * traced.1[0] && read.1[1] < 0.6 * traced.1[1], "{read:?} {traced:?}");
    let (found, of_found) = mean_of_runs(&builtin("cornell"), &settings, "hpsf", 32);
    let error = (of_truth + of_found).sqrt() / truth;
    assert!((found / truth - 1.0).abs() < 0.01 + 4.0 * error, "{} +- {error}", found / truth);
}

/// hpsf's cells at a later diffuse vertex: what lies in front of it is the path's own, and the sum is the same.
#[test]
fn light_is_as_bright_where_a_later_vertex_is_filtered() {
    let (scene, mut settings) = closed_box(|_, _| ());
    for (vertex, in_front) in [("first", 0), ("second", 1), ("third", 2)] {
        set(&mut settings, &[("hpsf.vertex", vertex), ("paths.max_bounces", "40")]);
        let renderer = render_frames(&common::gpu(), &scene, &settings, "hpsf", 2);
        let error = relative_error(&output(&renderer, "diffuse"), received);
        assert!(error < 1e-4, "{vertex}: {error}");
        assert!(relative_error(&output(&renderer, "before"), |c| series(c, in_front + 1)) < 1e-4, "{vertex}");
        assert!(relative_error(&renderer.picture().unwrap(), received) < 1e-4, "{vertex}");
    }
}

/// Mean of the indirect light of so many frames, each pixel's red: pictures of all bounces, less those without any by the same numbers.
fn indirect_light(settings: &Settings, technique: &str, seed: u32, frames: u32) -> Vec<f64> {
    let scene = builtin("cornell");
    let mut sum = vec![0.0; (settings.extent[0] * settings.extent[1]) as usize];
    for (bounces, sign) in [("8", 1.0), ("0", -1.0)] {
        let mut settings = settings.clone();
        set(&mut settings, &[("paths.max_bounces", bounces), ("paths.roulette", "off")]);
        let mut renderer = render_frames(&common::gpu(), &scene, &Settings { seed, ..settings }, technique, 0);
        for _ in 0..frames {
            renderer.render_frame().unwrap();
            let picture = renderer.picture().unwrap();
            sum.iter_mut().zip(&picture.pixels).for_each(|(sum, pixel)| *sum += sign * f64::from(pixel[0]) / f64::from(frames));
        }
    }
    sum
}

/// Binder, figure 10: 16 paths per pixel, filtered at their second diffuse vertex alone, have less of an error in their indirect light than
/// without a filter.
#[test]
fn filtering_at_the_second_vertex_takes_away_variance_of_indirect_light() {
    let mut settings = settings(48, 32);
    set(&mut settings, &[("hpsf.width", "4"), ("hpsf.normal_bits", "6")]);
    let truth = indirect_light(&settings, "unfiltered", 1, 400);
    let error = |found: Vec<f64>| found.iter().zip(&truth).map(|(f, t)| (f - t).powi(2)).sum::<f64>();
    let plain = error(indirect_light(&settings, "unfiltered", 2, 16));
    set(&mut settings, &[("hpsf.vertex", "second")]);
    let second = error(indirect_light(&settings, "hpsf", 2, 16));
    assert!(plain > 1.4 * second, "{plain} without, {second} with");
}
