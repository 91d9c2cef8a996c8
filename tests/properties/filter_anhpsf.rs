//! anhpsf: paths that grow by a bounce with every frame, and fill cells that no short path comes to.

use crate::common;
use crate::common::render::{builtin, mean, output, render_frames, set, settings};
use crate::filter_nhpsf::{closed_box, mean_of_runs, received, relative_error, series};
use pathspace::display::Image;
use pathspace::scene::Scene;
use pathspace::technique::{Renderer, Settings};

fn rendered(scene: &Scene, settings: &Settings, values: &[(&str, &str)], frames: u32) -> Renderer {
    let mut settings = settings.clone();
    set(&mut settings, values);
    render_frames(&common::gpu(), scene, &settings, "anhpsf", frames)
}

fn filtered(scene: &Scene, settings: &Settings, values: &[(&str, &str)], frames: u32) -> Image {
    output(&rendered(scene, settings, values, frames), "diffuse")
}

/// Between which cells light travels, and which path goes on.
const FORMS: [[(&str, &str); 2]; 3] = [
    [("anhpsf.transport", "last"), ("anhpsf.choice", "deepest")],
    [("anhpsf.transport", "all"), ("anhpsf.choice", "deepest")],
    [("anhpsf.transport", "last"), ("anhpsf.choice", "importance")],
];

/// Short paths end at the first vertex behind the picture's, whose cells are filled by those that are continued, or not at all: nhpsf leaves walls
/// behind the camera dark that way.
#[test]
fn continued_paths_fill_cells_outside_of_the_picture() {
    let (scene, settings) = closed_box(|_, _| ());
    for form in FORMS {
        let values = [&form[..], &[("nhpsf.unknown", "dark")]].concat();
        let error = relative_error(&filtered(&scene, &settings, &values, 40), received);
        assert!(error < 1e-3, "{form:?}: {error}");
    }
}

/// What a frame's cells know goes one bounce further in the next; cells out of sight come to know it one frame later than those of the picture.
#[test]
fn frames_bring_light_from_as_many_bounces() {
    let (scene, settings) = closed_box(|_, _| ());
    for frames in [1, 2, 4] {
        let image = filtered(&scene, &settings, &[("nhpsf.unknown", "dark")], frames);
        for c in 0..3 {
            let [least, most] = [frames - 1, frames].map(|bounces| series(c, bounces));
            let average = image.pixels.iter().map(|pixel| pixel[c]).sum::<f32>() / image.pixels.len() as f32;
            assert!((0.98 * least..1.0001 * most).contains(&average), "{frames} frames: {average}, {least} to {most}");
        }
    }
}

/// In a closed box without roulette no path ends before it is as deep as paths.max_bounces.
#[test]
fn paths_grow_by_a_vertex_with_every_frame_and_begin_anew_when_they_are_deep_enough() {
    let (scene, settings) = closed_box(|_, _| ());
    let values = [("nhpsf.unknown", "dark"), ("anhpsf.transport", "all"), ("paths.max_bounces", "5")];
    let mut renderer = rendered(&scene, &settings, &values, 0);
    for vertices in [1, 2, 3, 4, 5, 6, 1, 2] {
        renderer.render_frame().unwrap();
        let chains = output(&renderer, "chain_vertices").pixels;
        let as_long = chains.iter().filter(|pixel| pixel[0] == vertices as f32).count();
        assert!(as_long as f64 > 0.98 * chains.len() as f64, "{as_long} of {} have {vertices} vertices", chains.len());
    }
}

/// No light is looked for, and no path ends before it is two bounces deep: the two rays of this frame's path, and the one of the path that goes on. The
/// deepest one is at its end in every third frame, and the next begins without a ray; by choice, where no cell knows its end.
#[test]
fn chosen_paths_have_a_scattered_ray_in_every_frame_but_the_first() {
    let (scene, settings) = closed_box(|_, _| ());
    for (choice, expected) in [("deepest", [2.0, 3.0, 3.0, 2.0, 3.0, 3.0]), ("importance", [2.0, 3.0, 3.0, 3.0, 3.0, 3.0])] {
        let values = [("nhpsf.unknown", "dark"), ("anhpsf.choice", choice), ("paths.max_bounces", "2")];
        let mut renderer = rendered(&scene, &settings, &values, 0);
        for rays in expected {
            renderer.render_frame().unwrap();
            let found = mean(&output(&renderer, "ray_count"));
            assert!((found - rays).abs() < 0.01, "{choice}, frame {}: {found} rays", renderer.frame());
        }
    }
}

const CHANCE: &str = r#"
#include "filter/anhpsf/choice.glsl"
struct In { vec3 own_mean; uint own_count; vec3 own_attenuation; vec3 mean; uint count; vec3 attenuation; };
struct Out { float chance; };
void kernel(uint i) {
    In v = inputs[i];
    Cell own = Cell(v.own_mean, v.own_count, 0u);
    outputs[i] = Out(chance_to_give_way(own, v.own_attenuation, Cell(v.mean, v.count, 0u), v.attenuation));
}
"#;

#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Candidate {
    mean: [f32; 3],
    count: u32,
    attenuation: [f32; 3],
}

/// In proportion to brightness and to what the vertex passes on, against the number of samples, within 1/20 and 19/20.
#[test]
fn chances_follow_what_another_sample_is_worth() {
    let of = |radiance: f32, count, attenuation: f32| Candidate { mean: [radiance; 3], count, attenuation: [attenuation; 3] };
    let (own, none) = (of(1.0, 9, 0.5), of(0.0, 0, 0.5));
    let cases = [
        (own, of(1.0, 9, 0.5), 0.5),
        (own, of(3.0, 9, 0.5), 0.75),
        (own, of(1.0, 29, 0.5), 0.25),
        (own, of(1.0, 9, 1.5), 0.75),
        (own, of(0.0, 9, 0.5), 0.05),
        (own, of(1e6, 9, 0.5), 0.95),
        (own, none, 1.0 - 1.0 / 11.0),
        (of(0.0, 9, 0.5), none, 0.5),
    ];
    let inputs: Vec<[Candidate; 2]> = cases.iter().map(|&(own, other, _)| [own, other]).collect();
    let chances: Vec<f32> = common::run_kernel(&common::gpu(), CHANCE, &inputs);
    for ((own, other, expected), found) in cases.into_iter().zip(chances) {
        assert!((found - expected).abs() < 1e-5, "{own:?} {other:?}: {found} instead of {expected}");
    }
}

/// Sums in fixed point, and states that only their own pixel touches.
#[test]
fn runs_are_the_same_bit_for_bit_and_a_restart_knows_nothing_of_the_frames_before() {
    let scene = builtin("cornell");
    let values: &[(&str, &str)] = &[("hpsf.cells", "4"), ("hpsf.insertion", "ordered")];
    let mut first = rendered(&scene, &settings(32, 20), values, 6);
    let picture = first.picture().unwrap().pixels;
    let again = rendered(&scene, &settings(32, 20), values, 6).picture().unwrap().pixels;
    assert!(picture == again, "another run");
    first.restart(1, 0).unwrap();
    (0..6).for_each(|_| first.render_frame().unwrap());
    assert!(picture == first.picture().unwrap().pixels, "a restart");
}

/// Against path tracing through the same points, to 32 bounces: 1 %, beyond chance (4 standard errors of both, once in 10^4).
#[test]
fn closed_scenes_are_as_bright_as_the_path_tracer_finds_them() {
    for name in ["cornell", "furnace"] {
        let scene = builtin(name);
        let mut settings = settings(48, 32);
        set(&mut settings, &[("hpsf.width", "4"), ("hpsf.cells", "4"), ("paths.max_bounces", "32")]);
        let (truth, of_truth) = mean_of_runs(&scene, &settings, "unfiltered", 128);
        set(&mut settings, &[("paths.max_bounces", "16")]);
        for form in FORMS {
            set(&mut settings, &form);
            let (found, of_found) = mean_of_runs(&scene, &settings, "anhpsf", 32);
            let error = (of_truth + of_found).sqrt() / truth;
            assert!((found / truth - 1.0).abs() < 0.01 + 4.0 * error, "{name}, {form:?}: {} +- {error}", found / truth);
        }
    }
}

/// A path whose surface moves has no place to go on from: where all of the box moves, each frame's paths begin anew.
#[test]
fn paths_end_where_their_surface_moves() {
    let mut scene = builtin("cornell-object");
    let longest = |scene: &Scene| {
        let chains = output(&rendered(scene, &settings(32, 20), &[], 3), "chain_vertices");
        chains.pixels.iter().map(|pixel| pixel[0]).fold(0.0, f32::max)
    };
    assert_eq!(longest(&scene), 2.0);
    let moving = scene.instances.last().expect("the sphere").node;
    scene.instances.iter_mut().for_each(|instance| instance.node = moving);
    assert_eq!(longest(&scene), 1.0);
}
