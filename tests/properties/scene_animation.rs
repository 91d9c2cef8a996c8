//! Animation against closed forms.

use glam::{DQuat, DVec3};
use pathspace::scene::{Local, Scene};
use serde_json::json;

use crate::glb::Glb;

fn animate(glb: &mut Glb, node: usize, path: &str, interpolation: &str, times: &[f32], values: &[f32]) {
    let kind = if path == "rotation" { "VEC4" } else { "VEC3" };
    let (input, output) = (glb.floats("SCALAR", times), glb.floats(kind, values));
    let sampler = json!({ "input": input, "output": output, "interpolation": interpolation });
    glb.push("animations", json!({ "channels": [{ "sampler": 0, "target": { "node": node, "path": path } }], "samplers": [sampler] }));
}

fn animated(path: &str, interpolation: &str, times: &[f32], values: &[f32]) -> Scene {
    let mut glb = Glb::triangle();
    animate(&mut glb, 0, path, interpolation, times, values);
    glb.load().unwrap()
}

fn trs(scene: &Scene, time: f64) -> (DVec3, DQuat, DVec3) {
    let Local::Trs { translation, rotation, scale } = scene.animation.sample(&scene.nodes, time)[0] else { panic!("taken apart") };
    (translation, rotation, scale)
}

#[test]
fn steps_hold_and_lines_are_straight() {
    let values = [0.0, 0.0, 0.0, 2.0, 4.0, 8.0, 0.0, 0.0, 0.0];
    let (step, linear) =
        (animated("translation", "STEP", &[1.0, 2.0, 4.0], &values), animated("scale", "LINEAR", &[1.0, 2.0, 4.0], &values));
    for (time, held, straight) in [(0.5, 0.0, 0.0), (1.25, 0.0, 0.25), (2.0, 1.0, 1.0), (3.5, 1.0, 0.25), (4.0, 0.0, 0.0)] {
        assert_eq!(trs(&step, time).0, DVec3::new(2.0, 4.0, 8.0) * held, "at {time}");
        assert_eq!(trs(&linear, time).2, DVec3::new(2.0, 4.0, 8.0) * straight, "at {time}");
    }
}

#[test]
fn cubic_splines_reproduce_a_cubic() {
    let cubic = |t: f64| 1.0 + 2.0 * t - 3.0 * t * t + 0.5 * t.powi(3);
    let slope = |t: f64| 2.0 - 6.0 * t + 1.5 * t * t;
    let times = [0.0f32, 0.5, 2.0];
    let key = |&t: &f32| [slope(t.into()) as f32, 0.0, 0.0, cubic(t.into()) as f32, 0.0, 0.0, slope(t.into()) as f32, 0.0, 0.0];
    let scene = animated("translation", "CUBICSPLINE", &times, &times.iter().flat_map(key).collect::<Vec<_>>());
    for i in 0..=40 {
        let time = f64::from(i) * 0.05;
        assert!((trs(&scene, time).0.x - cubic(time)).abs() < 1e-5, "at {time}");
    }
}

#[test]
fn rotations_turn_evenly_along_the_shorter_way_and_stay_unit_length() {
    let (from, to) = (DQuat::from_rotation_z(0.2), -DQuat::from_rotation_z(1.4));
    let values: Vec<f32> = [from, to].iter().flat_map(|q| q.to_array().map(|component| component as f32)).collect();
    let scene = animated("rotation", "LINEAR", &[0.0, 2.0], &values);
    for i in 0..=20 {
        let time = f64::from(i) * 0.1;
        let expected = DQuat::from_rotation_z(0.2 + 0.6 * time);
        assert!(trs(&scene, time).1.dot(expected).abs() > 1.0 - 1e-12, "at {time}");
    }
    let spline: Vec<f32> = [[0.0; 4], [0.0, 0.0, 0.0, 1.0], [3.0, 0.0, 0.0, 0.0], [0.0; 4], [1.0, 0.0, 0.0, 0.0], [0.0; 4]].concat();
    let scene = animated("rotation", "CUBICSPLINE", &[0.0, 1.0], &spline);
    assert!((0..=10).all(|i| (trs(&scene, f64::from(i) * 0.1).1.length() - 1.0).abs() < 1e-12));
}

#[test]
fn time_beyond_the_end_starts_anew() {
    let scene = animated("translation", "LINEAR", &[0.0, 2.0], &[0.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    assert_eq!((scene.animation.duration(), scene.animation.is_empty()), (2.0, false));
    for (time, x) in [(2.0, 2.0), (2.5, 0.5), (7.0, 1.0), (-0.5, 1.5)] {
        assert_eq!(trs(&scene, time).0.x, x, "at {time}");
    }
    assert!(trs(&scene, f64::NAN).0.is_finite());
}

#[test]
fn what_is_below_an_animated_node_moves_and_nothing_else() {
    let mut glb = Glb::triangle();
    glb.json["nodes"] = json!([{ "mesh": 0 }, { "children": [2], "translation": [5.0, 0.0, 0.0] }, { "mesh": 0 }, { "mesh": 0 }]);
    glb.json["scenes"][0]["nodes"] = json!([0, 1, 3]);
    animate(&mut glb, 1, "scale", "STEP", &[0.0], &[2.0, 2.0, 2.0]);
    let scene = glb.load().unwrap();
    assert_eq!(scene.animation.animated_nodes(), [1]);
    assert_eq!(scene.animation.moving_nodes(&scene.nodes), [false, true, true, false]);
    // A channel leaves the other properties of its node as they are.
    let mut locals = vec![scene.nodes[0].local; 4];
    scene.animation.sample_into(&scene.nodes, 0.5, &mut locals);
    assert_eq!(locals[1], Local::Trs { translation: DVec3::X * 5.0, rotation: DQuat::IDENTITY, scale: DVec3::splat(2.0) });
}

#[test]
fn a_matrix_is_taken_apart_where_it_is_animated() {
    let mut glb = Glb::triangle();
    glb.json["nodes"][0]["matrix"] = json!([2.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 5.0, 6.0, 7.0, 1.0]);
    animate(&mut glb, 0, "translation", "STEP", &[0.0], &[1.0, 1.0, 1.0]);
    let (translation, _, scale) = trs(&glb.load().unwrap(), 0.0);
    assert_eq!((translation, scale), (DVec3::ONE, DVec3::new(2.0, 3.0, 4.0)));
}

#[test]
fn the_first_channel_of_a_property_wins_and_the_others_are_counted() {
    let mut glb = Glb::triangle();
    for x in [1.0, 2.0] {
        animate(&mut glb, 0, "translation", "STEP", &[0.0], &[x, 0.0, 0.0]);
    }
    let scene = glb.load().unwrap();
    assert_eq!(trs(&scene, 0.0).0.x, 1.0);
    assert_eq!(scene.warnings[0].count, 1);
}

#[test]
fn a_node_that_grows_from_nothing_is_kept() {
    let mut glb = Glb::triangle();
    glb.json["nodes"][0]["scale"] = json!([0.0, 0.0, 0.0]);
    animate(&mut glb, 0, "scale", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    assert_eq!(glb.load().unwrap().instances.len(), 1);
}
