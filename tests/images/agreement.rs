//! What changes the noise or the time must not change the picture: every switch is held against the plain setting by a Z-test over
//! blocks of 4x4 pixels, corrected for their number, at a significance of 10^-4: fixed seeds, so it either always or never fails.

use crate::common::render::{Rendered, builtin, mean, render, render_frames, set, settings, wall};
use crate::common::{self, TestGpu};
use glam::{DMat4, DVec3};
use pathspace::metrics::z_test::{Estimate, z_test};
use pathspace::scene::{CameraView, Instance, Light, LightKind, Local, Material, Mesh, Node, Scene};
use pathspace::technique::{Settings, ViewChoice};

const SIGNIFICANCE: f64 = 1e-4;
const FRAMES: u32 = 96;

fn assert_same_picture(what: &str, a: &Rendered, b: &Rendered, frames: u32) {
    let batches = Some(u64::from(frames));
    let a = Estimate { mean: &a.mean, variance: &a.variance, batches };
    let b = Estimate { mean: &b.mean, variance: &b.variance, batches };
    let result = z_test(a, b, 4, SIGNIFICANCE).unwrap();
    assert!(result.passed(), "{what}: {result:?}");
}

/// Renders with `plain` and with each of `changes`, with other seeds, and compares.
fn assert_switches_agree(gpu: &TestGpu, scene: &Scene, plain: &Settings, changes: &[&[(&str, &str)]]) {
    let expected = render(gpu, scene, plain, FRAMES);
    for (seed, change) in (100..).zip(changes) {
        let mut changed = Settings { seed, ..plain.clone() };
        set(&mut changed, change);
        let picture = render(gpu, scene, &changed, FRAMES);
        assert_same_picture(&format!("{change:?}"), &expected, &picture, FRAMES);
    }
}

#[test]
fn light_sampling_bsdf_sampling_and_both_agree() {
    let gpu = common::gpu();
    let changes: [&[(&str, &str)]; 2] = [&[("paths.direct", "nee")], &[("paths.direct", "bsdf")]];
    assert_switches_agree(&gpu, &builtin("cornell"), &settings(48, 32), &changes);
}

fn place(at: DVec3) -> Node {
    Node { name: String::new(), parent: None, local: Local::Matrix(DMat4::from_translation(at)) }
}

/// 40 small triangles in rows before a wall, shining on it from as near as 10 cm, among 10 point lights further off.
fn many_lights() -> Scene {
    let lamp = Mesh {
        positions: vec![[-0.02, -0.02, 0.0], [0.0, 0.03, 0.0], [0.02, -0.02, 0.0]],
        normals: vec![[0.0, 0.0, -1.0]; 3],
        triangles: vec![[0, 1, 2]],
        triangle_materials: vec![1],
        ..Mesh::default()
    };
    let lambert = Material { metallic: 0.0, specular: 0.0, base_color: [0.6, 0.5, 0.4, 1.0], ..Material::default() };
    let mut scene = Scene {
        meshes: vec![wall(), lamp],
        materials: vec![lambert.clone(), Material { base_color: [0.0; 4], emission: [60.0, 50.0, 40.0], ..lambert }],
        nodes: vec![place(DVec3::ZERO)],
        instances: vec![Instance { mesh: 0, node: 0 }],
        ..Scene::default()
    };
    for i in 0..50u32 {
        let [column, row] = [i % 10, i / 10].map(|cell| 0.2 * f64::from(cell) - 0.9);
        let node = scene.nodes.len() as u32;
        if i < 40 {
            scene.nodes.push(place(DVec3::new(column, row + 0.5, 0.1 + 0.02 * f64::from(i % 7))));
            scene.instances.push(Instance { mesh: 1, node });
        } else {
            scene.nodes.push(place(DVec3::new(column, 0.8 * column, 0.6)));
            scene.lights.push(Light { name: String::new(), node, color: [0.02; 3], kind: LightKind::Point, range: None });
        }
    }
    scene
}

/// Also that they are worth their time: with 8 the variance of this scene is less than half of that with 1.
#[test]
fn candidate_lights_take_noise_from_the_picture_and_nothing_else() {
    let gpu = common::gpu();
    let scene = many_lights();
    let view = ViewChoice::Fixed(CameraView::look_at(DVec3::new(0.3, 0.2, 4.0), DVec3::ZERO, 0.4));
    let mut single = Settings { view, spp: 4, ..settings(32, 32) };
    set(&mut single, &[("lights.candidates", "1")]);
    let changes: [&[(&str, &str)]; 3] =
        [&[("lights.candidates", "8")], &[("lights.candidates", "5"), ("paths.direct", "nee")], &[("rays.first_shadow_rays", "2")]];
    assert_switches_agree(&gpu, &scene, &single, &changes);
    let mut several = single.clone();
    set(&mut several, &[("lights.candidates", "8")]);
    let [one, eight] = [&single, &several].map(|settings| mean(&render(&gpu, &scene, settings, FRAMES).variance));
    assert!(eight < 0.5 * one, "{eight} instead of {one}");
}

/// The wall's triangles are 40 m wide: the offset of rays that leave them is not small beside a ten thousandth of the way to the lamps.
#[test]
fn lamps_close_to_a_large_surface_are_not_in_their_own_shadow() {
    let gpu = common::gpu();
    let view = ViewChoice::Fixed(CameraView::look_at(DVec3::new(0.3, 0.2, 4.0), DVec3::ZERO, 0.4));
    let mut sampled = Settings { view, spp: 4, ..settings(32, 32) };
    set(&mut sampled, &[("paths.direct", "nee"), ("paths.max_bounces", "0")]);
    let picture = mean(&render(&gpu, &many_lights(), &sampled, FRAMES).mean);
    let mut found = sampled.clone();
    set(&mut found, &[("paths.direct", "bsdf")]);
    let found = render(&gpu, &many_lights(), &found, FRAMES);
    let error = (mean(&found.variance) / (3.0 * 32.0 * 32.0)).sqrt() * 3f64.sqrt();
    let found = mean(&found.mean);
    assert!((picture - found).abs() < 4.0 * error, "{picture} instead of {found} +- {error}");
}

#[test]
fn samplers_roulette_and_extra_shadow_rays_do_not_change_the_picture() {
    let gpu = common::gpu();
    let changes: [&[(&str, &str)]; 4] =
        [&[("paths.sampler", "independent")], &[("paths.sampler", "r2")], &[("paths.roulette", "off")], &[("rays.first_shadow_rays", "3")]];
    assert_switches_agree(&gpu, &builtin("cornell"), &settings(32, 32), &changes);
}

/// A point light among spheres under a sky: the same picture, by the megakernel and by the wavefront, and without the noise of
/// choosing between them.
#[test]
fn a_sole_light_apart_takes_noise_from_the_picture_and_nothing_else() {
    let gpu = common::gpu();
    let mut scene = builtin("furnace");
    let node = scene.nodes.len() as u32;
    scene.nodes.push(place(DVec3::new(0.5, 2.0, 3.0)));
    scene.lights.push(Light { name: String::new(), node, color: [9.0, 8.0, 7.0], kind: LightKind::Point, range: None });
    let plain = settings(32, 32);
    let changes: [&[(&str, &str)]; 4] = [
        &[("lights.sole", "apart")],
        &[("lights.sole", "apart"), ("paths.direct", "nee"), ("rays.first_shadow_rays", "2")],
        &[("lights.sole", "apart"), ("paths.direct", "bsdf")],
        &[("lights.sole", "apart"), ("paths.kernel", "wavefront")],
    ];
    assert_switches_agree(&gpu, &scene, &plain, &changes);
    let mut apart = plain.clone();
    set(&mut apart, &[("lights.sole", "apart")]);
    let [sampled, apart] = [&plain, &apart].map(|settings| mean(&render(&gpu, &scene, settings, FRAMES).variance));
    assert!(apart < 0.95 * sampled, "{apart} instead of {sampled}");
}

/// Nothing but a point light above a floor: its light is the same, apart or chosen with certainty. And nhpsf, whose cells are of all vertices,
/// takes no part of the light apart.
#[test]
fn a_light_that_is_all_there_is_may_be_apart() {
    let gpu = common::gpu();
    let scene = Scene {
        meshes: vec![wall()],
        materials: vec![Material { roughness: 0.035, metallic: 0.5, ..Material::default() }],
        nodes: vec![place(DVec3::ZERO), place(DVec3::new(0.5, 0.3, 1.0))],
        instances: vec![Instance { mesh: 0, node: 0 }],
        lights: vec![Light { name: String::new(), node: 1, color: [2.0; 3], kind: LightKind::Point, range: None }],
        ..Default::default()
    };
    let view = ViewChoice::Fixed(CameraView::look_at(DVec3::new(0.3, 0.2, 4.0), DVec3::ZERO, 0.4));
    let mut apart = Settings { view, ..settings(32, 32) };
    let sampled = apart.clone();
    set(&mut apart, &[("lights.sole", "apart")]);
    let picture = |settings: &Settings, technique| render_frames(&gpu, &scene, settings, technique, 2).picture().unwrap().pixels;
    let [a, b] = [&sampled, &apart].map(|settings| picture(settings, "unfiltered"));
    let close = |(a, b): (&f32, &f32)| (a - b).abs() <= 1e-5 * a.abs().max(1e-3);
    assert!(a.iter().flatten().any(|&value| value > 0.0) && a.iter().flatten().zip(b.iter().flatten()).all(close));
    let [a, b] = [&sampled, &apart].map(|settings| picture(settings, "nhpsf"));
    assert_eq!(a, b);
}

#[test]
fn every_structure_and_both_triangle_tests_see_the_same_scene() {
    let gpu = common::gpu();
    let scene = builtin("material");
    let bvh = Settings { trace: "bvh".to_owned(), ..settings(48, 32) };
    let expected = render(&gpu, &scene, &bvh, FRAMES);
    for (seed, entry) in (7..).zip(pathspace::accel::REGISTRY).filter(|(_, entry)| (entry.available)(gpu.capabilities()).is_ok()) {
        let other = Settings { trace: entry.name.to_owned(), seed, ..bvh.clone() };
        assert_same_picture(entry.name, &expected, &render(&gpu, &scene, &other, FRAMES), FRAMES);
    }
    let mut fast = Settings { seed: 50, ..bvh };
    set(&mut fast, &[("rays.intersection", "moller-trumbore")]);
    assert_same_picture("Moeller-Trumbore", &expected, &render(&gpu, &scene, &fast, FRAMES), FRAMES);
}

#[test]
fn effects_that_are_not_called_for_change_nothing() {
    let gpu = common::gpu();
    let scene = builtin("cornell");
    let plain = settings(32, 32);
    let all = Settings { all_effects: true, ..plain.clone() };
    let [some, every] = [&plain, &all].map(|settings| render(&gpu, &scene, settings, 8).mean);
    for (a, b) in some.pixels.iter().flatten().zip(every.pixels.iter().flatten()) {
        assert!((a - b).abs() <= 1e-4 * a.abs().max(1e-3), "{a} {b}");
    }
}
