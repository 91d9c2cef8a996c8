//! What the accuracy switches cost: paths.albedo, accumulate.sum, frame.precision. Each is held against what the accurate setting gives.

use crate::common::render::{Rendered, builtin, mean, render, set, settings, wall};
use crate::common::{self, TestGpu};
use glam::{DMat4, DVec3};
use pathspace::display::Image;
use pathspace::scene::{Animation, CameraView, Environment, Instance, Local, Material, Node, Scene};
use pathspace::technique::{self, Renderer, Settings, ViewChoice};

/// One unit in the last place of a half, relative: drivers may round to either neighbour.
const HALF_ULP: f32 = 1.0 / 1024.0;
/// Between halves next to zero.
const LEAST_HALF: f32 = 6e-8;

/// A Lambert wall that fills the picture, or, from behind the camera, lets it see only a constant environment.
fn wall_scene(albedo: [f32; 3], radiance: f32) -> Scene {
    let [r, g, b] = albedo;
    let node = Node { name: "wall".to_owned(), parent: None, local: Local::Matrix(DMat4::IDENTITY) };
    Scene {
        meshes: vec![wall()],
        materials: vec![Material { base_color: [r, g, b, 1.0], metallic: 0.0, specular: 0.0, ..Material::default() }],
        nodes: vec![node],
        instances: vec![Instance { mesh: 0, node: 0 }],
        environment: Environment::Constant([radiance; 3]),
        ..Scene::default()
    }
}

/// From 4 m before the wall, towards it or away from it.
fn look(settings: Settings, towards_wall: bool) -> Settings {
    let target = DVec3::Z * if towards_wall { 0.0 } else { 8.0 };
    Settings { view: ViewChoice::Fixed(CameraView::look_at(DVec3::Z * 4.0, target, 0.5)), ..settings }
}

fn unfiltered(width: u32, height: u32) -> Settings {
    Settings { technique: technique::find("unfiltered").unwrap(), ..settings(width, height) }
}

/// A renderer after `frames` frames with `changes` to the settings.
fn rendered(gpu: &TestGpu, scene: Scene, mut settings: Settings, changes: &[(&str, &str)], frames: u32) -> Renderer {
    set(&mut settings, changes);
    let mut renderer = Renderer::new(gpu, scene, settings).unwrap();
    (0..frames).for_each(|_| renderer.render_frame().unwrap());
    renderer
}

fn output(renderer: &Renderer, name: &str) -> Vec<[f32; 3]> {
    renderer.output(name).unwrap().unwrap().pixels
}

fn assert_within(what: &str, found: &Image, expected: &Image, relative: f32) {
    let pairs = found.pixels.iter().flatten().zip(expected.pixels.iter().flatten());
    for (found, expected) in pairs {
        assert!((found - expected).abs() <= relative * expected.abs() + LEAST_HALF, "{what}: {found} instead of {expected}");
    }
}

#[test]
fn dividing_the_albedo_out_again_changes_no_picture_in_single_precision() {
    let gpu = common::gpu();
    let picture = |albedo| rendered(&gpu, builtin("cornell"), unfiltered(32, 24), &[("paths.albedo", albedo)], 1).picture().unwrap();
    assert_within("divided", &picture("divided"), &picture("apart"), 1e-5);
}

#[test]
fn only_an_albedo_kept_apart_lets_filters_see_what_a_channel_of_no_albedo_receives() {
    let gpu = common::gpu();
    // All channels receive the same.
    let received = |albedo| {
        let scene = wall_scene([0.8, 0.0, 0.3], 1.0);
        output(&rendered(&gpu, scene, look(unfiltered(16, 16), true), &[("paths.albedo", albedo)], 1), "diffuse_direct")
    };
    let apart = received("apart");
    assert!(apart.iter().any(|pixel| pixel[0] > 0.5));
    assert!(apart.iter().all(|[r, g, b]| r == g && r == b));
    let divided = received("divided");
    assert!(divided.iter().zip(&apart).all(|(found, expected)| (found[0] - expected[0]).abs() <= 1e-5 * expected[0]));
    assert!(divided.iter().all(|pixel| pixel[1] == 0.0));
}

#[test]
fn a_small_albedo_in_half_precision_costs_digits_only_where_it_is_divided_out() {
    let gpu = common::gpu();
    // Reflected: about 2e-6, where halves are 6e-8 apart.
    let worst_error = |albedo| {
        let scene = wall_scene([0.8, 0.002, 0.3], 1e-3);
        let changes = [("paths.albedo", albedo), ("frame.precision", "fp16")];
        let received = output(&rendered(&gpu, scene.clone(), look(unfiltered(16, 16), true), &changes, 1), "diffuse_direct");
        let exact = output(&rendered(&gpu, scene, look(unfiltered(16, 16), true), &[], 1), "diffuse_direct");
        received.iter().zip(&exact).filter(|(_, exact)| exact[1] > 5e-4).map(|(a, b)| (a[1] / b[1] - 1.0).abs()).fold(0.0, f32::max)
    };
    let (apart, divided) = (worst_error("apart"), worst_error("divided"));
    assert!(apart <= HALF_ULP, "{apart}");
    assert!(divided > 5.0 * HALF_ULP, "{divided}");
}

#[test]
fn half_precision_rounds_a_frame_and_leaves_coordinates_alone() {
    let gpu = common::gpu();
    let [single, half] = ["fp32", "fp16"].map(|precision| {
        let mut settings = settings(32, 24);
        settings.outputs.push("position".to_owned());
        rendered(&gpu, builtin("material"), settings, &[("frame.precision", precision)], 1)
    });
    let pictures = [&single, &half].map(|renderer| renderer.picture().unwrap());
    assert_ne!(pictures[0].pixels, pictures[1].pixels);
    assert_within("reference", &pictures[1], &pictures[0], HALF_ULP);
    for name in ["position", "motion", "identity", "ray_count"] {
        assert_eq!(output(&single, name), output(&half, name), "{name}");
    }
    // Attenuation, terms and their sum are rounded.
    let [single, half] = ["fp32", "fp16"]
        .map(|precision| rendered(&gpu, builtin("material"), unfiltered(32, 24), &[("frame.precision", precision)], 1).picture().unwrap());
    assert_within("unfiltered", &half, &single, 3.0 * HALF_ULP);
}

#[test]
fn half_precision_moves_half_the_bytes() {
    let gpu = common::gpu();
    let [single, half] = ["fp32", "fp16"].map(|precision| {
        let timings = rendered(&gpu, builtin("cornell"), unfiltered(8, 8), &[("frame.precision", precision)], 1).timings().unwrap();
        let composite = timings.passes.into_iter().find(|pass| pass.name == "composite").unwrap();
        [composite.bytes_read, composite.bytes_written]
    });
    assert_eq!(single, half.map(|bytes| 2 * bytes));
}

#[test]
fn radiance_beyond_the_largest_half_is_clamped_to_it() {
    let gpu = common::gpu();
    for plain in [settings(8, 8), unfiltered(8, 8)] {
        let renderer = rendered(&gpu, wall_scene([0.5; 3], 1e6), look(plain, false), &[("frame.precision", "fp16")], 3);
        assert!(renderer.picture().unwrap().pixels.iter().flatten().all(|&value| value == 65504.0 || value == 65504.0 / 3.0));
    }
}

/// Mean of `frames` frames of a constant.
fn mean_of_constant(gpu: &TestGpu, value: f32, changes: &[(&str, &str)], frames: u32) -> f32 {
    let renderer = rendered(gpu, wall_scene([0.5; 3], value), look(settings(8, 4), false), changes, frames);
    renderer.picture().unwrap().pixels[0][0]
}

#[test]
fn a_plain_sum_of_halves_stalls_and_one_that_keeps_what_rounding_lost_does_not() {
    let gpu = common::gpu();
    // 2048 + 1 is no half.
    let frames = 3000;
    let plain = [("accumulate.sum", "plain"), ("frame.precision", "fp16")];
    assert!(mean_of_constant(&gpu, 1.0, &plain, frames) < 0.7);
    assert!((mean_of_constant(&gpu, 1.0, &plain[1..], frames) - 1.0).abs() <= HALF_ULP);
    assert_eq!(mean_of_constant(&gpu, 1.0, &[], frames), 1.0);
}

#[test]
fn a_plain_sum_in_single_precision_drifts_and_a_compensated_one_does_not() {
    let gpu = common::gpu();
    let error = |sum| (f64::from(mean_of_constant(&gpu, 0.1, &[("accumulate.sum", sum)], 3000)) / f64::from(0.1f32) - 1.0).abs();
    let (plain, compensated) = (error("plain"), error("compensated"));
    assert!(plain > 1e-6, "{plain}");
    assert!(compensated <= f64::from(f32::EPSILON), "{compensated}");
}

/// Variance over the square of what is there, sum over pixels and channels: lamps' edges do not outweigh all others.
fn relative_variance(found: &Rendered, truth: &Rendered) -> f64 {
    let pairs = found.variance.pixels.iter().flatten().zip(truth.mean.pixels.iter().flatten());
    pairs.map(|(&variance, &mean)| f64::from(variance / (mean * mean + 1e-4))).sum()
}

/// Cornell's box with a polished sphere: what it throws onto the walls is found by few samples, which is what the switch is for: .66 of their noise.
#[test]
fn lobes_behind_a_diffuse_vertex_may_be_wider_and_the_picture_is_nearly_the_same_with_less_noise() {
    let gpu = common::gpu();
    let box_with = |material: Material, everywhere: bool| {
        let mut scene = builtin("cornell-object");
        scene.animation = Animation::default();
        let walls = scene.materials.len() as u32;
        if everywhere {
            scene.materials.iter_mut().for_each(|wall| *wall = Material { emission: wall.emission, ..material.clone() });
        }
        let sphere = scene.instances.last().expect("the sphere").mesh;
        scene.materials.push(material);
        scene.meshes[sphere as usize].triangle_materials.fill(walls);
        scene
    };
    let found = |scene: &Scene, roughness: &str, frames: u32| {
        let mut settings = settings(48, 27);
        set(&mut settings, &[("paths.regularize", roughness), ("paths.clamp", "0")]);
        render(&gpu, scene, &settings, frames)
    };
    let metal = |roughness: f32| Material { base_color: [0.9, 0.9, 0.9, 1.0], metallic: 1.0, roughness, ..Material::default() };
    let polished = box_with(metal(0.08), false);
    let [plain, wider] = ["0", "0.45"].map(|roughness| found(&polished, roughness, 512));
    let energy = mean(&wider.mean) / mean(&plain.mean);
    let noise = relative_variance(&wider, &plain) / relative_variance(&plain, &plain);
    assert!((energy - 1.0).abs() < 0.01, "{energy}");
    assert!(noise < 0.8, "{noise}");
    // What is as rough already, a mirror, and lobes that no diffuse vertex is in front of, stay as they are.
    for same in [box_with(metal(0.5), false), box_with(metal(0.0), false), box_with(metal(0.08), true)] {
        let [plain, wider] = ["0", "0.45"].map(|roughness| found(&same, roughness, 2).mean);
        assert_eq!(plain.pixels, wider.pixels);
    }
}
