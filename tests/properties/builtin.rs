//! Built-in scenes hold what their names promise, after the one loader has read them.

use pathspace::scene::effects::{Effect, EffectSet};
use pathspace::scene::{Environment, LightKind, Scene, builtin, transform::world_transforms};

fn load(spec: &str) -> Scene {
    builtin::find(spec).unwrap().unwrap().load().unwrap_or_else(|error| panic!("{error}"))
}

fn triangles_met_by_rays(scene: &Scene) -> usize {
    scene.instances.iter().map(|instance| scene.meshes[instance.mesh as usize].triangles.len()).sum()
}

#[test]
fn every_built_in_scene_loads_without_a_warning_and_has_light_and_a_camera() {
    for name in builtin::names() {
        let scene = load(name);
        assert_eq!(scene.warnings, [], "{name}");
        assert!(!scene.cameras.is_empty(), "{name}");
        let is_lit =
            scene.environment != Environment::default() || !scene.lights.is_empty() || scene.materials.iter().any(|m| m.is_emissive());
        assert!(is_lit, "{name}");
    }
}

#[test]
fn hall_has_as_many_triangles_as_asked_for_within_two_percent() {
    for wanted in [10_000, 25_000, 80_000, 300_000] {
        for name in ["hall", "hall-flight"] {
            let found = triangles_met_by_rays(&load(&format!("{name}:{wanted}")));
            assert!(found.abs_diff(wanted) * 50 <= wanted, "{found} instead of {wanted}");
        }
    }
}

#[test]
fn hall_has_every_kind_of_small_light_and_something_that_moves() {
    let scene = load("hall:10000");
    let has = |is_kind: fn(LightKind) -> bool| scene.lights.iter().any(|light| is_kind(light.kind));
    assert!(has(|kind| kind == LightKind::Point) && has(|kind| matches!(kind, LightKind::Sphere { .. })));
    assert!(has(|kind| matches!(kind, LightKind::Spot { .. })));
    let flames = scene.instances.iter().filter(|instance| scene.meshes[instance.mesh as usize].name == "candle").count();
    assert!(flames >= 50);
    assert!(!scene.animation.is_empty());
}

#[test]
fn animated_nodes_stand_at_time_zero_where_the_document_puts_them() {
    for name in ["cornell-light", "cornell-object", "hall:10000", "hall-flight:10000"] {
        let scene = load(name);
        let still: Vec<_> = scene.nodes.iter().map(|node| node.local).collect();
        let [at_rest, at_zero] = [still, scene.animation.sample(&scene.nodes, 0.0)].map(|locals| world_transforms(&scene.nodes, &locals));
        assert!(at_rest.iter().zip(&at_zero).all(|(a, b)| a.abs_diff_eq(*b, 1e-6)), "{name}");
    }
}

#[test]
fn moving_scenes_call_for_the_motion_of_what_moves_and_say_what_does() {
    let cases = [
        ("cornell", None, None),
        ("cornell-light", None, Some("node 'lamp back' moves")),
        ("cornell-object", None, Some("node 'sphere' moves")),
        ("hall-flight:10000", Some("node 'camera' moves"), Some("node 'knot' moves")),
    ];
    for (name, camera, object) in cases {
        let effects = EffectSet::derive(&load(name));
        let reason = |wanted: Effect| effects.iter().find(|(effect, _)| *effect == wanted).map(|(_, reason)| reason.to_owned());
        assert_eq!(reason(Effect::CameraAnimation).as_deref(), camera, "{name}");
        assert_eq!(reason(Effect::ObjectAnimation).as_deref(), object, "{name}");
    }
}

#[test]
fn swings_through_the_box_end_where_they_begin() {
    for name in ["cornell-light", "cornell-object"] {
        let scene = load(name);
        // Just before the period of 1.2 s is over.
        let [first, last] = [0.0, 1.2 - 1e-7].map(|time| world_transforms(&scene.nodes, &scene.animation.sample(&scene.nodes, time)));
        assert!(first.iter().zip(&last).all(|(a, b)| a.abs_diff_eq(*b, 1e-6)), "{name}");
    }
}

#[test]
fn sizes_outside_the_range_are_refused() {
    for spec in ["hall:9999", "hall:5000001", "hall:many", "hall:", "hall:-1", "furnace:10"] {
        assert!(builtin::find(spec).is_err(), "{spec}");
    }
}
