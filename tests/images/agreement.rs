//! What changes the noise or the time must not change the picture: every switch is held against the plain setting by a Z-test over
//! blocks of 4x4 pixels, corrected for their number, at a significance of 10^-4: fixed seeds, so it either always or never fails.

use crate::common::render::{Rendered, builtin, render, set, settings};
use crate::common::{self, TestGpu};
use pathspace::metrics::z_test::{Estimate, z_test};
use pathspace::scene::Scene;
use pathspace::technique::Settings;

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

#[test]
fn samplers_roulette_and_extra_shadow_rays_do_not_change_the_picture() {
    let gpu = common::gpu();
    let changes: [&[(&str, &str)]; 4] =
        [&[("paths.sampler", "independent")], &[("paths.sampler", "r2")], &[("paths.roulette", "off")], &[("rays.first_shadow_rays", "3")]];
    assert_switches_agree(&gpu, &builtin("cornell"), &settings(32, 32), &changes);
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
