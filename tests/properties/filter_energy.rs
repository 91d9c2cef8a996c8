//! What must hold for every filter: nothing is lost, nothing is made.

use crate::common;
use crate::common::floor::{floor, from_above};
use crate::common::render::{builtin, filtered, filters, mean, output, render_frames, set, settings};
use pathspace::scene::{Environment, Scene};
use pathspace::technique::Settings;

const SKY: [f32; 3] = [0.25, 0.5, 2.0];

/// Every path that leaves the floor brings exactly the sky's radiance.
fn under_a_constant_sky(base_color: [f32; 4]) -> (Scene, Settings) {
    let mut scene = floor(5.0);
    scene.materials[0].base_color = base_color;
    scene.environment = Environment::Constant(SKY);
    let mut settings = settings(40, 24);
    settings.view = from_above(0.5);
    set(&mut settings, &[("paths.direct", "bsdf")]);
    (scene, settings)
}

/// Every switch of a filter that changes what it adds up.
const SWITCHES: [&[(&str, &str)]; 16] = [
    &[],
    &[("hpsf.sums", "float"), ("hpsf.jitter_by", "sampler")],
    &[("hpsf.table", "swapped"), ("hpsf.levels", "3")],
    &[("hpsf.time", "average"), ("hpsf.lookups", "4")],
    &[("hpsf.time", "frame"), ("hpsf.lookups", "0"), ("hpsf.levels", "1")],
    &[("hpsf.time", "hybrid"), ("hpsf.sums", "float"), ("hpsf.shrink", "0.5"), ("hpsf.adaptive", "1")],
    &[("hpsf.neighbours", "on"), ("hpsf.few", "1000"), ("hpsf.width", "4")],
    &[("hpsf.normals", "fingerprint"), ("hpsf.normal_bits", "8"), ("hpsf.normal_jitter", "1")],
    &[("hpsf.keys", "exact"), ("hpsf.normal_bits", "8")],
    &[("hpsf.normals", "similar"), ("hpsf.normal_bits", "6"), ("hpsf.few", "1000")],
    &[("hpsf.eviction", "priority"), ("hpsf.cells", "0.01"), ("hpsf.width", "4")],
    &[("hpsf.blend", "on"), ("hpsf.limit", "1"), ("hpsf.few", "1")],
    &[("hpsf.iterations", "3"), ("hpsf.split", "on"), ("hpsf.table", "swapped"), ("hpsf.adaptive", "1"), ("hpsf.limit", "1")],
    &[("sspsf.window", "3"), ("anhpsf.choice", "importance")],
    &[("hpsf.split", "on"), ("hpsf.smooth", "3"), ("hpsf.smooth_specular", "2")],
    &[("hpsf.smooth", "5"), ("hpsf.smooth_noise", "1000"), ("paths.scramble", "tile"), ("frame.jitter", "on")],
];

#[test]
fn constant_radiance_comes_out_as_it_went_in() {
    let gpu = common::gpu();
    let (scene, plain) = under_a_constant_sky([0.5, 0.5, 0.5, 1.0]);
    for filter in filters() {
        for switches in SWITCHES {
            let mut settings = plain.clone();
            set(&mut settings, switches);
            for pixel in filtered(&render_frames(&gpu, &scene, &settings, filter, 3)).pixels {
                let near = (0..3).all(|c| (pixel[c] / SKY[c] - 1.0).abs() < 1e-5);
                assert!(near, "{filter} {switches:?}: {pixel:?}");
            }
        }
    }
}

#[test]
fn an_albedo_without_green_loses_no_green() {
    let gpu = common::gpu();
    let (scene, settings) = under_a_constant_sky([0.5, 0.0, 0.5, 1.0]);
    for filter in filters() {
        let renderer = render_frames(&gpu, &scene, &settings, filter, 1);
        assert!(filtered(&renderer).pixels.iter().all(|pixel| (pixel[1] / SKY[1] - 1.0).abs() < 1e-5), "{filter}");
        assert!(renderer.picture().unwrap().pixels.iter().all(|pixel| pixel[1] < 0.05 * pixel[2]), "{filter}");
    }
}

/// The same samples with and without a filter, 12 seeds. Cells and windows that reach over edges move light between surfaces of other
/// albedo, which may cost 1 %; beyond that, four standard errors, which chance exceeds in 6 of 10^5.
#[test]
fn filters_keep_the_mean_radiance() {
    let gpu = common::gpu();
    let scene = builtin("cornell");
    for filter in filters() {
        let mut renderers = [filter, "unfiltered"].map(|name| render_frames(&gpu, &scene, &settings(48, 32), name, 0));
        let mut ratio = |seed| {
            let [filtered, unfiltered] = renderers.each_mut().map(|renderer| {
                renderer.restart(seed, 0).unwrap();
                renderer.render_frame().unwrap();
                mean(&renderer.picture().unwrap())
            });
            filtered / unfiltered
        };
        let ratios: Vec<f64> = (1..=12).map(&mut ratio).collect();
        let average = ratios.iter().sum::<f64>() / 12.0;
        let error = (ratios.iter().map(|r| (r - average).powi(2)).sum::<f64>() / (11.0 * 12.0)).sqrt();
        assert!((average - 1.0).abs() < 0.01 + 4.0 * error, "{filter}: {average} +- {error}");
    }
}

/// Some paths find infinite radiance. They count as none, and no other pixel knows of them.
#[test]
fn a_sample_that_is_not_finite_stays_out() {
    let gpu = common::gpu();
    let (mut scene, settings) = under_a_constant_sky([0.5, 0.5, 0.5, 1.0]);
    let mut lamp = floor(0.7);
    lamp.materials[0].emission = [f32::INFINITY; 3];
    lamp.materials[0].double_sided = true;
    scene.materials.append(&mut lamp.materials);
    let mut mesh = lamp.meshes.remove(0);
    mesh.triangle_materials = vec![1, 1];
    scene.meshes.push(mesh);
    scene.nodes.push(common::floor::node(glam::DVec3::new(1.0, 1.5, 0.0)));
    scene.instances.push(pathspace::scene::Instance { mesh: 1, node: 1 });
    for filter in filters() {
        let renderer = render_frames(&gpu, &scene, &settings, filter, 2);
        let lost = output(&renderer, "diffuse_direct").pixels.iter().filter(|pixel| **pixel == [0.0; 3]).count();
        assert!(lost > 50, "{lost} paths meet the lamp");
        for pixel in filtered(&renderer).pixels {
            assert!((0..3).all(|c| (pixel[c] / SKY[c] - 1.0).abs() < 1e-5), "{filter}: {pixel:?}");
        }
    }
}
