//! The wavefront makes the megakernel's picture: the same paths by the same steps, value by value. So does either in several submissions.

use crate::common::render::{builtin, output, render, set, settings, wall};
use crate::common::{self, TestGpu};
use glam::{DMat4, DVec3};
use pathspace::scene::{AlphaMode, CameraView, Environment, Instance, Light, LightKind, Local, Material, Node, Scene};
use pathspace::technique::{self, Renderer, Settings, ViewChoice, Work};

/// Where a technique's paths make lists of vertices.
const OF_LISTS: [&str; 2] = ["path_vertices", "specular_attenuation"];

/// Everything that a technique puts out after some frames, and the picture. Of lists, after so many that cells of theirs are known.
fn outputs(gpu: &TestGpu, scene: &Scene, settings: &Settings, kernel: &str, samples: f64) -> Vec<(String, Vec<[f32; 3]>)> {
    let mut settings = settings.clone();
    set(&mut settings, &[("paths.kernel", kernel)]);
    let mut renderer = Renderer::new(gpu, scene.clone(), settings.clone()).unwrap();
    renderer.set_work(Work { samples, first_shadow_rays: settings.parameters.number("rays.first_shadow_rays") as u32 });
    let makes_lists = settings.technique.name == "nhpsf" || settings.parameters.number("hpsf.second") == 1.0;
    (0..if makes_lists { 4 } else { 2 }).for_each(|_| renderer.render_frame().unwrap());
    renderer.finish().unwrap();
    let names: &[&str] = match settings.technique.name {
        "reference" => &["radiance", "variance", "ray_count"],
        _ => &[
            "before",
            "attenuation",
            "diffuse_direct",
            "diffuse_indirect",
            "specular_direct",
            "specular_indirect",
            "filter_position",
            "filter_normal",
            "filter_incident",
            "ray_count",
        ],
    };
    let picture = ("the picture".to_owned(), renderer.picture().unwrap().pixels);
    let of_lists: &[&str] = if makes_lists { &OF_LISTS } else { &[] };
    names.iter().chain(of_lists).map(|&name| (name.to_owned(), output(&renderer, name).pixels)).chain([picture]).collect()
}

/// Rounding of a sum may differ on devices that fuse operations otherwise in other kernels; on lavapipe nothing differs.
fn assert_same(gpu: &TestGpu, what: &str, scene: &Scene, settings: &Settings, samples: f64) {
    let [expected, found] = ["megakernel", "wavefront"].map(|kernel| outputs(gpu, scene, settings, kernel, samples));
    for ((name, expected), (_, found)) in expected.iter().zip(&found) {
        let differs = |(a, b): &(&[f32; 3], &[f32; 3])| (0..3).any(|c| (a[c] - b[c]).abs() > 1e-5 * a[c].abs());
        let differing = expected.iter().zip(found).filter(differs).count();
        assert_eq!(differing, 0, "{what}, {}: pixels of {name} differ", settings.technique.name);
        assert!(name != "the picture" || expected.iter().any(|pixel| pixel[0] > 0.0), "{what}: nothing to be seen");
    }
}

/// What a wavefront must not lose on the way from kernel to kernel: glass, mirrors and clearcoat, a hole of alpha in front of them, and light
/// from a sphere, a point, an emissive surface and the sky.
fn everything() -> Scene {
    let mut scene = builtin("material");
    let mut add = |at: DVec3, size: f64| {
        let local = Local::Matrix(DMat4::from_translation(at) * DMat4::from_scale(DVec3::splat(size)));
        scene.nodes.push(Node { name: String::new(), parent: None, local });
        scene.nodes.len() as u32 - 1
    };
    let (sphere, point, veil) =
        (add(DVec3::new(0.5, 1.2, 1.0), 1.0), add(DVec3::new(-1.0, 2.0, 1.0), 1.0), add(DVec3::new(0.0, 0.0, 2.0), 0.03));
    let light = |node, kind| Light { name: String::new(), node, color: [3.0, 2.0, 1.0], kind, range: None };
    scene.lights.extend([light(sphere, LightKind::Sphere { radius: 0.2 }), light(point, LightKind::Point)]);
    let mut mesh = wall();
    let material = scene.materials.len() as u32;
    mesh.triangle_materials = vec![material, material + 1];
    scene.meshes.push(mesh);
    scene.instances.push(Instance { mesh: scene.meshes.len() as u32 - 1, node: veil });
    let blend = Material { alpha_mode: AlphaMode::Blend, base_color: [0.8, 0.6, 0.4, 0.5], ..Material::default() };
    scene.materials.extend([blend.clone(), Material { alpha_mode: AlphaMode::Opaque, emission: [0.5, 0.2, 0.1], ..blend }]);
    scene.environment = Environment::Constant([0.2, 0.3, 0.4]);
    scene
}

/// Sums are carried on in the order of the samples, and their sequence goes on: no bit differs. 40 samples are the 40 frames of one each.
#[test]
fn a_frame_in_several_submissions_is_the_frame_in_one() {
    let gpu = common::gpu();
    let scene = builtin("cornell");
    for kernel in ["megakernel", "wavefront"] {
        for (samples, most) in [(40.0, 16), (2.5, 1), (3.25, 2)] {
            let [whole, shared] = [1 << 20, 27 * 18 * most].map(|paths: u32| {
                let mut settings = settings(27, 18);
                set(&mut settings, &[("paths.per_submission", &paths.to_string())]);
                outputs(&gpu, &scene, &settings, kernel, samples)
            });
            assert_eq!(whole, shared, "{kernel}, {samples} samples, {most} at once");
        }
        let mut shared = settings(27, 18);
        set(&mut shared, &[("paths.kernel", kernel), ("paths.per_submission", "1")]);
        let frames = render(&gpu, &scene, &shared, 40).mean;
        let frame = render(&gpu, &scene, &Settings { spp: 40, ..shared }, 1).mean;
        let differs = |(a, b): (&f32, &f32)| (a - b).abs() > 40.0 * f32::EPSILON * a.abs();
        let differing = frame.pixels.iter().flatten().zip(frames.pixels.iter().flatten()).filter(|&pair| differs(pair)).count();
        assert_eq!(differing, 0, "{kernel}: more than rounding");
    }
}

fn view() -> ViewChoice {
    ViewChoice::Fixed(CameraView::look_at(DVec3::new(0.0, 1.5, 4.0), DVec3::new(0.0, 0.2, 0.0), 0.6))
}

#[test]
fn the_wavefront_makes_the_megakernels_picture_with_everything_in_it() {
    let gpu = common::gpu();
    let scene = everything();
    let reference = Settings { view: view(), ..settings(40, 28) };
    assert_same(&gpu, "everything", &scene, &reference, 1.0);
    let mut apart = Settings { technique: technique::find("unfiltered").unwrap(), ..reference };
    assert_same(&gpu, "everything", &scene, &apart, 1.0);
    for rays in ["1", "3"] {
        set(&mut apart, &[("lights.sole", "apart"), ("rays.first_shadow_rays", rays)]);
        assert_same(&gpu, "sole light apart", &scene, &apart, 1.0);
    }
}

/// Vertices whose light comes from emission found, from shadow rays and through glass; lists that end early, where cells are known, and late.
#[test]
fn the_wavefront_makes_the_megakernels_lists_of_vertices() {
    let gpu = common::gpu();
    let everything = (everything(), Settings { view: view(), ..settings(40, 28) });
    let cornell = (builtin("cornell"), settings(40, 28));
    for ((scene, settings), technique, changes) in [
        (&everything, "hpsf", &[("hpsf.second", "cells"), ("lights.sole", "apart"), ("rays.first_shadow_rays", "3")][..]),
        (&everything, "nhpsf", &[("nhpsf.vertices", "3")]),
        (&cornell, "hpsf", &[("hpsf.second", "cells"), ("nhpsf.vertices", "3"), ("nhpsf.wider", "1")]),
        (&cornell, "nhpsf", &[("nhpsf.unknown", "dark"), ("rays.first_shadow_rays", "3")]),
        (&cornell, "nhpsf", &[("nhpsf.form", "paper"), ("hpsf.vertex", "second")]),
    ] {
        let mut settings = Settings { technique: technique::find(technique).unwrap(), ..settings.clone() };
        set(&mut settings, changes);
        assert_same(&gpu, &format!("{changes:?}"), scene, &settings, 1.0);
    }
}

/// Several shadow rays at the first vertex are several visits; further samples are all passes once more, for some of the pixels.
#[test]
fn the_wavefront_takes_further_samples_and_shadow_rays() {
    let gpu = common::gpu();
    let scene = builtin("cornell");
    for changes in [
        &[("rays.first_shadow_rays", "3"), ("paths.max_bounces", "2")][..],
        &[("paths.max_bounces", "0")],
        &[("paths.roulette_start", "0"), ("paths.scramble", "tile"), ("paths.direct", "bsdf")],
    ] {
        let mut plain = settings(27, 18);
        set(&mut plain, changes);
        assert_same(&gpu, &format!("{changes:?}"), &scene, &plain, 2.5);
        let apart = Settings { technique: technique::find("unfiltered").unwrap(), ..plain };
        assert_same(&gpu, &format!("{changes:?}"), &scene, &apart, 1.0);
    }
}
