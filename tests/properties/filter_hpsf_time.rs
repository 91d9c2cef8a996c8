//! hpsf over time: what stands still is integrated, what changes is followed (Binder, section 3.4.1 and figure 9).

use crate::common;
use crate::common::floor::{floor, from_above, node};
use crate::common::render::{builtin, mean, output, render_frames, set, settings};
use glam::DVec3;
use pathspace::display::Image;
use pathspace::gpu::Gpu;
use pathspace::metrics::statistics::BatchMeans;
use pathspace::metrics::{Pair, relmse};
use pathspace::scene::animation::{Animation, Channel, Interpolation, Keys};
use pathspace::scene::{Instance, Light, LightKind, Material, Mesh, Scene};
use pathspace::technique::{Renderer, Settings, Work};

fn with(values: &[(&str, &str)]) -> Settings {
    let mut settings = settings(64, 36);
    set(&mut settings, values);
    settings
}

fn bits(image: &Image) -> Vec<[u32; 3]> {
    image.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

/// A path with the numbers of the last frame finds the very same radiance, so that nothing is forgotten.
#[test]
fn a_still_scene_is_integrated_to_the_bit() {
    let gpu = common::gpu();
    for (technique, name) in [("hpsf", "material"), ("hpsf+", "cornell")] {
        let scene = builtin(name);
        let [integrate, hybrid] = ["integrate", "hybrid"].map(|time| {
            let mut settings = with(&[("hpsf.time", time), ("hpsf.cells", "4"), ("hpsf.retrace", "2"), ("hpsf.glossy", "on")]);
            // Or no path would be retraced, because nothing moves.
            settings.all_effects = true;
            render_frames(&gpu, &scene, &settings, technique, 4)
        });
        assert_eq!(bits(&integrate.picture().unwrap()), bits(&hybrid.picture().unwrap()), "{technique}, {name}");
    }
}

/// What the camera does changes no light: paths are retraced from where it was.
#[test]
fn a_moving_camera_makes_nothing_forget() {
    let gpu = common::gpu();
    let mut scene = builtin("cornell");
    let camera = scene.cameras[0].node;
    scene.animation = moving(camera, vec![DVec3::new(0.278, 0.273, -0.8), DVec3::new(0.378, 0.273, -0.7)], Interpolation::Linear);
    let mut settings = with(&[("hpsf.time", "hybrid"), ("hpsf.retrace", "2")]);
    // Or no path would be retraced, because no object moves.
    settings.all_effects = true;
    let renderer = render_frames(&gpu, &scene, &settings, "hpsf", 4);
    assert!(output(&renderer, "retraced_ray_count").pixels.iter().any(|pixel| pixel[0] > 0.0));
    assert!(output(&renderer, "hpsf_change").pixels.iter().all(|pixel| pixel[0] == 0.0));
}

/// Nor what a budget asks of a frame: a path of the last frame is retraced with the shadow rays that it had.
#[test]
fn more_shadow_rays_than_in_the_last_frame_make_nothing_forget() {
    let gpu = common::gpu();
    let mut settings = with(&[("hpsf.time", "hybrid"), ("hpsf.retrace", "2")]);
    settings.all_effects = true;
    settings.technique = pathspace::technique::find("hpsf").unwrap();
    settings.spp = 2;
    let mut renderer = Renderer::new(&gpu, builtin("cornell"), settings).unwrap();
    for (samples, first_shadow_rays) in [(1.0, 1), (1.0, 3), (2.0, 2), (1.0, 20)] {
        renderer.set_work(Work { samples, first_shadow_rays });
        renderer.render_frame().unwrap();
        let change = renderer.output("hpsf_change").unwrap().unwrap();
        assert!(change.pixels.iter().all(|pixel| pixel[0] == 0.0), "{samples} {first_shadow_rays}");
    }
    assert!(output(&renderer, "retraced_ray_count").pixels.iter().any(|pixel| pixel[0] > 0.0));
}

const FRAMES_PER_SECOND: f64 = 30.0;

/// Keys are a second apart where motion is linear, 8 frames where it is in steps.
fn moving(node: u32, keys: Vec<DVec3>, interpolation: Interpolation) -> Animation {
    let apart = if interpolation == Interpolation::Step { f64::from(STEP) / FRAMES_PER_SECOND } else { 1.0 };
    let times = (0..keys.len()).map(|i| i as f64 * apart).chain([100.0]).take(keys.len() + 1).collect();
    let last = *keys.last().unwrap();
    let keys = Keys::Translation(keys.into_iter().chain([last]).collect());
    Animation::new(vec![Channel { node, times, interpolation, keys }])
}

/// A floor seen from 1 m above, lit by a small sphere at the node that is added last.
fn lit_floor(light: DVec3) -> (Scene, u32) {
    let mut scene = floor(4.0);
    scene.nodes.push(node(light));
    let node = scene.nodes.len() as u32 - 1;
    let kind = LightKind::Sphere { radius: 0.01 };
    scene.lights.push(Light { name: String::new(), node, color: [20.0; 3], kind, range: None });
    (scene, node)
}

/// The light's height changes in this frame.
const STEP: u32 = 8;

/// How much of a step of the light one of the renderer's outputs has taken by the end of each of the first frames with it.
fn response(gpu: &Gpu, values: &[(&str, &str)], material: &Material, shown: &str) -> Vec<f64> {
    let high = DVec3::new(0.0, 4.0, 0.0);
    let (mut scene, light) = lit_floor(high);
    scene.materials[0] = material.clone();
    scene.animation = moving(light, vec![high, DVec3::new(0.0, 3.0, 0.0)], Interpolation::Step);
    let mut settings = with(values);
    settings.view = from_above(0.5);
    let shown = |renderer: &Renderer| mean(&output(renderer, shown));
    let mut renderer = render_frames(gpu, &scene, &settings, "hpsf", STEP);
    let before = shown(&renderer);
    let frames: Vec<f64> = (0..5)
        .map(|_| {
            renderer.render_frame().unwrap();
            renderer.finish().unwrap();
            shown(&renderer)
        })
        .collect();
    renderer.restart(1, STEP + 1).unwrap();
    renderer.render_frame().unwrap();
    renderer.finish().unwrap();
    let after = shown(&renderer);
    assert!(after > 1.5 * before, "{before} {after}");
    frames.into_iter().map(|frame| (frame - before) / (after - before)).collect()
}

#[test]
fn the_hybrid_has_nine_tenths_of_a_step_of_the_light_within_four_frames() {
    let gpu = common::gpu();
    let of_time = |time| response(&gpu, &[("hpsf.time", time)], &floor(4.0).materials[0], "diffuse");
    let [hybrid, detect, average, integrate] = ["hybrid", "detect", "average", "integrate"].map(of_time);
    let narrow = response(&gpu, &[("hpsf.time", "hybrid"), ("frame.precision", "fp16")], &floor(4.0).materials[0], "diffuse");
    for (time, frames) in [("hybrid", hybrid), ("detect", detect), ("hybrid in half precision", narrow)] {
        assert!(frames[..3].iter().any(|&part| part > 0.9), "{time}: {frames:?}");
    }
    assert!(average.iter().chain(&integrate).all(|&part| part < 0.9), "{average:?} {integrate:?}");
}

/// What glossy lobes show of the light, over a diffuse base and on a metal, smooth and rough: cells of a few pixels' width, told apart by direction.
#[test]
fn the_hybrid_has_nine_tenths_of_a_step_of_a_highlight_within_four_frames() {
    let gpu = common::gpu();
    for (metallic, roughness) in [(0.0, 0.3), (0.0, 0.8), (1.0, 0.3)] {
        let material = Material { specular: 1.0, metallic, roughness, ..floor(4.0).materials[0].clone() };
        let of_time = |time| response(&gpu, &[("hpsf.time", time), ("hpsf.glossy", "on")], &material, "specular");
        let [hybrid, integrate] = ["hybrid", "integrate"].map(of_time);
        assert!(hybrid[..3].iter().any(|&part| part > 0.9), "metallic {metallic}, roughness {roughness}: {hybrid:?}");
        assert!(integrate.iter().all(|&part| part < 0.9), "metallic {metallic}, roughness {roughness}: {integrate:?}");
    }
}

/// Also where the light is the only one without a size, whose light goes past the cells and only the antialiasing of hpsf+ remembers it; and
/// on a metal, of which the table of diffuse light has no samples.
#[test]
fn the_picture_of_hpsf_plus_has_nine_tenths_of_a_step_of_the_light_within_four_frames() {
    let gpu = common::gpu();
    let high = DVec3::new(0.0, 4.0, 0.0);
    for (kind, metallic) in [(LightKind::Sphere { radius: 0.01 }, 0.0), (LightKind::Point, 0.0), (LightKind::Point, 1.0)] {
        let (mut scene, light) = lit_floor(high);
        scene.lights[0].kind = kind;
        scene.materials[0] = Material { metallic, roughness: 0.8, ..scene.materials[0].clone() };
        scene.animation = moving(light, vec![high, DVec3::new(0.0, 3.0, 0.0)], Interpolation::Step);
        let mut settings = with(&[("hpsf.glossy", "on")]);
        settings.view = from_above(0.5);
        let mut renderer = render_frames(&gpu, &scene, &settings, "hpsf+", STEP);
        let before = mean(&renderer.picture().unwrap());
        (0..4).for_each(|_| renderer.render_frame().unwrap());
        let fourth = mean(&renderer.picture().unwrap());
        renderer.restart(1, STEP + 1).unwrap();
        renderer.render_frame().unwrap();
        let after = mean(&renderer.picture().unwrap());
        assert!(after > 1.5 * before, "{kind:?}, metallic {metallic}: {before} {after}");
        assert!((fourth - before) / (after - before) > 0.9, "{kind:?}, metallic {metallic}: from {before} to {fourth}, not {after}");
    }
}

/// A card that lies flat at `place`, from one x to the other, and as far along z either way; returns its node.
fn add_card(scene: &mut Scene, [left, right]: [f32; 2], z: f32, place: DVec3) -> u32 {
    scene.meshes.push(Mesh {
        positions: vec![[left, 0.0, -z], [left, 0.0, z], [right, 0.0, z], [right, 0.0, -z]],
        normals: vec![[0.0, 1.0, 0.0]; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        triangle_materials: vec![0, 0],
        ..Default::default()
    });
    let (mesh, node_of_card) = (scene.meshes.len() as u32 - 1, scene.nodes.len() as u32);
    scene.nodes.push(node(place));
    scene.instances.push(Instance { mesh, node: node_of_card });
    node_of_card
}

/// Frames that a card hides a part of the floor for: fewer than hpsf.age.
const HIDDEN: u32 = 4;

/// A card of 0.2 m, 0.3 m above the floor, under a light from the left. It comes from far away to hide the middle of the floor, whose cells
/// remember it lit, and goes on to the left, from where its shadow falls there.
fn passing_card() -> Scene {
    let (mut scene, _) = lit_floor(DVec3::new(-4.0, 4.0, 0.0));
    let places = [20.0, 0.0, -0.3, -0.3].map(|x| DVec3::new(x, 0.3, 0.0));
    let card = add_card(&mut scene, [-0.1, 0.1], 0.1, places[0]);
    // A last key far away, since animations begin anew after it.
    let times = [0, STEP, STEP + HIDDEN, 1000].map(|frame| f64::from(frame) / FRAMES_PER_SECOND).to_vec();
    let channel = Channel { node: card, times, interpolation: Interpolation::Step, keys: Keys::Translation(places.to_vec()) };
    scene.animation = Animation::new(vec![channel]);
    scene
}

/// Mean over the middle of the picture.
fn middle(image: &Image) -> f64 {
    let inside = |i: usize| (28..36).contains(&(i % 64)) && (14..22).contains(&(i / 64));
    let values = image.pixels.iter().enumerate().filter(|(i, _)| inside(*i)).map(|(_, pixel)| f64::from(pixel[0]));
    values.sum::<f64>() / 64.0
}

/// What has been hidden for a while may look different from what its cells remember.
#[test]
fn the_hybrid_has_nine_tenths_of_a_shadow_that_fell_while_its_place_was_hidden_within_four_frames() {
    let gpu = common::gpu();
    for technique in ["hpsf", "hpsf+"] {
        let mut settings = with(&[("hpsf.time", "hybrid")]);
        settings.view = from_above(0.5);
        let mut renderer = render_frames(&gpu, &passing_card(), &settings, technique, STEP);
        let lit = middle(&renderer.picture().unwrap());
        (0..HIDDEN).for_each(|_| renderer.render_frame().unwrap());
        let mut step = |_| {
            renderer.render_frame().unwrap();
            renderer.finish().unwrap();
            middle(&renderer.picture().unwrap())
        };
        let frames: Vec<f64> = (0..8).map(&mut step).collect();
        let dark = frames[7];
        assert!(dark < 0.5 * lit, "{technique}: {lit} {dark}");
        assert!(frames[..3].iter().any(|frame| frame - dark < 0.1 * (lit - dark)), "{technique}: from {lit}, {frames:?}");
    }
}

/// The light moves above a card with an edge at x = 0 in the middle between it and the floor: the shadow's edge moves the other way, as fast.
fn moving_shadow() -> Scene {
    let (mut scene, light) = lit_floor(DVec3::new(0.0, 4.0, 0.0));
    add_card(&mut scene, [-4.0, 0.0], 4.0, DVec3::new(0.0, 2.0, 0.0));
    let start = DVec3::new(-0.15, 4.0, 0.0);
    // Two pixels a frame.
    scene.animation = moving(light, vec![start, start + DVec3::X * FRAMES_PER_SECOND * 2.0 * 0.5 / 36.0], Interpolation::Linear);
    scene
}

/// Pixels over which the shadow's edge goes from a tenth to nine tenths of the light, in the mean over rows and seeds.
fn edge_width(gpu: &Gpu, time: &str) -> f64 {
    const FRAMES: u32 = 10;
    let mut settings = with(&[("hpsf.time", time), ("hpsf.width", "4"), ("hpsf.lookups", "4")]);
    settings.view = from_above(0.5);
    let mut renderer = render_frames(gpu, &moving_shadow(), &settings, "hpsf", 0);
    let mut profile = [0.0; 64];
    for seed in 0..8 {
        renderer.restart(seed, 0).unwrap();
        (0..FRAMES).for_each(|_| renderer.render_frame().unwrap());
        renderer.finish().unwrap();
        for (i, pixel) in output(&renderer, "diffuse").pixels.iter().enumerate() {
            profile[i % 64] += f64::from(pixel[0]) / (8.0 * 36.0);
        }
    }
    let most = profile.iter().copied().fold(0.0, f64::max);
    // The light falls off by little: what lies between is the edge.
    profile.iter().map(|&value| value / most).filter(|part| (0.1..0.9).contains(part)).count() as f64
}

#[test]
fn the_hybrid_keeps_a_moving_shadow_as_sharp_as_one_frame() {
    let gpu = common::gpu();
    let [frame, hybrid, average, integrate] = ["frame", "hybrid", "average", "integrate"].map(|time| edge_width(&gpu, time));
    assert!(hybrid <= 1.25 * frame, "{hybrid} {frame}");
    assert!(average > 2.0 * frame && integrate > 2.0 * frame, "{average} {integrate} {frame}");
}

/// Of a still camera: squared errors relative to the truth, the mean over pixels, of each seed after so many frames each.
fn relmse_of_seeds(gpu: &Gpu, values: &[(&str, &str)], truth: &Image, seeds: u32, frames: &[u32]) -> Vec<Vec<f64>> {
    let mut settings = settings(32, 18);
    set(&mut settings, &[("hpsf.cells", "8")]);
    set(&mut settings, values);
    let mut renderer = render_frames(gpu, &builtin("cornell"), &settings, "hpsf", 0);
    let mut run = |seed| {
        renderer.restart(seed, 0).unwrap();
        let mut error = |&frame: &u32| {
            (renderer.frame()..frame).for_each(|_| renderer.render_frame().unwrap());
            renderer.finish().unwrap();
            relmse(&Pair::new(&renderer.picture().unwrap(), truth).unwrap(), 0.0)
        };
        frames.iter().map(&mut error).collect()
    };
    (1..=seeds).map(&mut run).collect()
}

/// The mean over seeds.
fn relmse_after(gpu: &Gpu, values: &[(&str, &str)], truth: &Image, seeds: u32, frames: &[u32]) -> Vec<f64> {
    let of_seeds = relmse_of_seeds(gpu, values, truth, seeds, frames);
    (0..frames.len()).map(|i| of_seeds.iter().map(|errors| errors[i]).sum::<f64>() / f64::from(seeds)).collect()
}

/// What paths through the pixels' centres find on average.
fn truth_at_centres(gpu: &Gpu) -> Image {
    const FRAMES: u32 = 2048;
    let mut renderer = render_frames(gpu, &builtin("cornell"), &settings(32, 18), "unfiltered", 0);
    renderer.restart(12345, 0).unwrap();
    let mut mean = vec![[0.0; 3]; 32 * 18];
    for _ in 0..FRAMES {
        renderer.render_frame().unwrap();
        renderer.finish().unwrap();
        for (mean, pixel) in mean.iter_mut().zip(renderer.picture().unwrap().pixels) {
            (0..3).for_each(|c| mean[c] += pixel[c] / FRAMES as f32);
        }
    }
    Image::new(32, 18, mean)
}

/// Cells that stay what they are leave their bias and the jitter's own noise, and the variance of all samples in them, which falls at least as
/// 1 / N: what the first and the last error say of the floor and of the way there is what those between are at most, but for chance, three
/// standard errors of the mean over seeds. An error that fell as N^(-3/4) would be ten of them above that after eight frames without jitter, and
/// three with it. Floors here, with one level: 0.003 for cells of 4 pixels, 0.013 for 8, without jitter; 0.019 with it, 0.015 with it and 4
/// lookups, which leave less of its noise.
#[test]
fn a_still_camera_s_error_falls_as_one_over_frames_to_its_floor() {
    const SEEDS: u32 = 32;
    let gpu = common::gpu();
    let truth = truth_at_centres(&gpu);
    let frames = [1, 2, 4, 8, 16, 32, 128];
    for (jitter, width) in [("0", "4"), ("0.6", "8")] {
        let values = [("hpsf.jitter", jitter), ("hpsf.levels", "1"), ("hpsf.width", width)];
        let of_seeds = relmse_of_seeds(&gpu, &values, &truth, SEEDS, &frames);
        for (i, n) in frames.into_iter().enumerate().take(6).skip(1) {
            let excess = |errors: &Vec<f64>| {
                let floor = (128.0 * errors[6] - errors[0]) / 127.0;
                errors[i] - floor - (errors[0] - floor) / f64::from(n)
            };
            let found: BatchMeans = of_seeds.iter().map(excess).collect();
            let chance = found.variance_of_mean().sqrt();
            assert!(found.mean <= 3.0 * chance, "jitter {jitter}, width {width}, {n} frames: {} +- {chance}", found.mean);
        }
    }
}

/// Coarse cells that split at shadows have no more noise in the first frame than those that do not, and much less blur as samples add up.
#[test]
fn cells_that_split_where_light_differs_lose_the_blur_of_coarse_ones_and_not_their_quiet() {
    let gpu = common::gpu();
    let truth = truth_at_centres(&gpu);
    let after = |adaptive, width, levels| {
        let values =
            [("hpsf.adaptive", adaptive), ("hpsf.width", width), ("hpsf.levels", levels), ("hpsf.lookups", "4"), ("hpsf.few", "4")];
        relmse_after(&gpu, &values, &truth, 4, &[1, 8])
    };
    let (split, coarse) = (after("1", "4", "3"), after("0", "16", "1"));
    assert!(split[0] < 1.05 * coarse[0] && split[1] < 0.7 * coarse[1], "{split:?} {coarse:?}");
}

/// Consistency: no bias stays.
#[test]
fn a_still_camera_s_picture_goes_to_the_truth_where_cells_shrink() {
    let gpu = common::gpu();
    let truth = truth_at_centres(&gpu);
    let after = |shrink| relmse_after(&gpu, &[("hpsf.shrink", shrink), ("hpsf.lookups", "4")], &truth, 1, &[32, 512]);
    let [kept, shrunk] = ["0", "0.4"].map(after);
    assert!(kept[1] > 0.9 * kept[0], "cells that do not shrink have reached their floor: {kept:?}");
    assert!(shrunk[1] < 0.1 * kept[1] && shrunk[1] < 0.25 * shrunk[0], "{shrunk:?} {kept:?}");
}
