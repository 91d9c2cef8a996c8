//! Node trees, cameras and lights as the loader places them.

use glam::{DMat4, DQuat, DVec3};
use pathspace::scene::{self, Environment, LightKind, Projection, Scene, transform};
use serde_json::json;

use crate::glb::Glb;

fn world(scene: &Scene, time: f64) -> Vec<DMat4> {
    transform::world_transforms(&scene.nodes, &scene.animation.sample(&scene.nodes, time))
}

#[test]
fn a_world_a_million_metres_away_keeps_its_micrometres() {
    let mut glb = Glb::triangle();
    // Each of these is off by up to 3 cm in single precision.
    let places = [1_000_000.001_001, -7_654_321.012_345, 0.000_001];
    glb.json["nodes"] = json!([{ "translation": places, "children": [1] }, { "translation": [0.000_002, 0.0, 0.0], "mesh": 0 }]);
    let scene = glb.load().unwrap();
    let origin = world(&scene, 0.0)[1].w_axis.truncate();
    assert!(origin.abs_diff_eq(DVec3::from(places) + DVec3::X * 0.000_002, 1e-8), "{origin}");
    let (low, high) = scene.bounds(&world(&scene, 0.0)).unwrap();
    assert!((high - low).abs_diff_eq(DVec3::new(1.0, 1.0, 0.0), 1e-8));
}

#[test]
fn transforms_compose_from_the_root_down_and_matrices_are_column_major() {
    let mut glb = Glb::triangle();
    let matrix = DMat4::from_scale_rotation_translation(DVec3::new(1.0, 2.0, 3.0), DQuat::from_rotation_y(0.5), DVec3::new(4.0, 5.0, 6.0));
    // Unnormalised, as exporters round.
    let turn = DQuat::from_rotation_x(1.0) * 1.5;
    glb.json["nodes"] = json!([
        { "name": "leaf", "mesh": 0, "rotation": turn.to_array(), "scale": [2.0, 2.0, 2.0] },
        { "name": "top", "matrix": matrix.to_cols_array(), "children": [0] },
    ]);
    glb.json["scenes"][0]["nodes"] = json!([1]);
    let scene = glb.load().unwrap();
    assert_eq!((scene.nodes[0].name.as_str(), scene.nodes[1].name.as_str()), ("top", "leaf"));
    assert_eq!((scene.nodes[1].parent, scene.instances[0].node), (Some(0), 1));
    let expected = matrix * DMat4::from_scale_rotation_translation(DVec3::splat(2.0), DQuat::from_rotation_x(1.0), DVec3::ZERO);
    assert!(world(&scene, 0.0)[1].abs_diff_eq(expected, 1e-12));
}

#[test]
fn a_mirrored_node_keeps_its_mesh_and_tells_that_its_winding_flips() {
    let mut glb = Glb::triangle();
    glb.json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "scale": [-1.0, 1.0, 1.0] }, { "mesh": 0, "scale": [-1.0, -2.0, 1.0] }]);
    glb.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let scene = glb.load().unwrap();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 3));
    let flips: Vec<bool> = world(&scene, 0.0).iter().map(transform::flips_winding).collect();
    assert_eq!(flips, [false, true, false]);
}

#[test]
fn only_the_default_scene_is_loaded_and_all_trees_where_there_is_none() {
    let mut glb = Glb::triangle();
    glb.json["nodes"] = json!([{ "mesh": 0, "name": "a" }, { "mesh": 0, "name": "b" }]);
    glb.json["scenes"] = json!([{ "nodes": [0] }, { "nodes": [1] }]);
    glb.json["scene"] = json!(1);
    let names = |glb: &Glb| glb.load().unwrap().nodes.iter().map(|node| node.name.clone()).collect::<String>();
    assert_eq!(names(&glb), "b");
    glb.json.as_object_mut().unwrap().remove("scene");
    assert_eq!(names(&glb), "a");
    glb.json.as_object_mut().unwrap().remove("scenes");
    assert_eq!(names(&glb), "ab");
}

#[test]
fn lights_have_their_units_angles_and_radii() {
    let mut glb = Glb::triangle();
    glb.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "point", "color": [1.0, 0.5, 0.25], "intensity": 8.0, "range": 3.0, "name": "bulb" },
        { "type": "point", "extras": { "radius": 0.125 } },
        { "type": "spot", "intensity": 2.0, "spot": { "innerConeAngle": 0.25, "outerConeAngle": 0.5 } },
        { "type": "spot", "spot": { "innerConeAngle": 3.0, "outerConeAngle": 2.0 } },
        { "type": "directional", "intensity": 10.0 },
        { "type": "directional", "intensity": -1.0 },
    ] } });
    let node = |light: usize| json!({ "extensions": { "KHR_lights_punctual": { "light": light } } });
    let lights: Vec<_> = (0..6).map(node).collect();
    glb.json["nodes"].as_array_mut().unwrap().extend(lights);
    glb.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3, 4, 5, 6]);
    let scene = glb.load().unwrap();
    let [bulb, sphere, spot, wide, sun, dark] = scene.lights.as_slice() else { panic!("six lights") };
    assert_eq!((bulb.color, bulb.range, bulb.kind, bulb.name.as_str()), ([8.0, 4.0, 2.0], Some(3.0), LightKind::Point, "bulb"));
    assert_eq!((sphere.kind, sphere.color, sphere.node), (LightKind::Sphere { radius: 0.125 }, [1.0; 3], 2));
    assert_eq!(spot.kind, LightKind::Spot { inner_cone_angle: 0.25, outer_cone_angle: 0.5 });
    assert!(matches!(wide.kind, LightKind::Spot { inner_cone_angle, outer_cone_angle } if inner_cone_angle < outer_cone_angle));
    assert_eq!((sun.kind, sun.color, sun.range), (LightKind::Directional, [10.0; 3], None));
    assert_eq!(dark.color, [0.0; 3]);
    assert_eq!(scene.warnings.len(), 2);
}

#[test]
fn a_camera_is_found_by_name_and_looks_along_its_node() {
    let mut glb = Glb::triangle();
    glb.json["cameras"] = json!([
        { "type": "perspective", "name": "wide", "perspective": { "yfov": 1.0, "znear": 0.1 } },
        { "type": "orthographic", "orthographic": { "xmag": 2.0, "ymag": 1.5, "zfar": 9.0, "znear": 0.1 } },
        { "type": "perspective", "perspective": { "yfov": 7.0, "znear": 0.1 } },
    ]);
    let turn = DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2);
    glb.json["nodes"] = json!([
        { "mesh": 0 },
        { "camera": 1, "name": "plan", "translation": [1.0, 2.0, 3.0], "rotation": turn.to_array(), "scale": [5.0, 0.1, 5.0] },
        { "camera": 0 }, { "camera": 2 },
    ]);
    glb.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let scene = glb.load().unwrap();
    assert_eq!(scene.cameras.len(), 2);
    let world = world(&scene, 0.0);
    let first = scene.default_camera_view(None, &world).unwrap();
    assert_eq!((first.position, first.projection), (DVec3::new(1.0, 2.0, 3.0), Projection::Orthographic { ymag: 1.5 }));
    assert!(first.forward.abs_diff_eq(DVec3::NEG_X, 1e-12) && first.up.abs_diff_eq(DVec3::Y, 1e-12));
    let wide = scene.default_camera_view(Some("wide"), &world).unwrap();
    assert_eq!((wide.forward, wide.up, wide.projection), (DVec3::NEG_Z, DVec3::Y, Projection::Perspective { yfov: 1.0 }));
    let error = scene.default_camera_view(Some("tele"), &world).unwrap_err().to_string();
    assert!(error.contains("'tele'") && error.contains("'plan', 'wide'"), "{error}");
}

#[test]
fn the_environment_of_a_scene_is_read_from_its_extras() {
    let mut glb = Glb::triangle();
    assert_eq!(glb.load().unwrap().environment, Environment::Constant([0.0; 3]));
    glb.json["scenes"][0]["extras"] = json!({ "environment": [1.0, 2.0, 3.0] });
    assert_eq!(glb.load().unwrap().environment, Environment::Constant([1.0, 2.0, 3.0]));
    glb.json["scenes"][0]["extras"] = json!({ "environment": [1.0, -2.0, 3.0] });
    assert_eq!(glb.load().unwrap().environment, Environment::Constant([0.0; 3]));
}

/// The independent renderer's pictures state where they were taken from.
#[test]
fn default_views_are_those_of_the_reference_pictures() {
    let shared = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared");
    let Ok(entries) = std::fs::read_dir(format!("{shared}/references")) else {
        println!("skipped: {shared}/references is missing");
        return;
    };
    for path in entries.flatten().map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|extension| extension == "json")) {
        let reference: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        let vector =
            |key: &str| reference[key].as_array().map(|values| DVec3::from_array(std::array::from_fn(|i| values[i].as_f64().unwrap())));
        let (Some(eye), Some(forward), Some(file)) = (vector("eye"), vector("forward"), reference["scene"].as_str()) else { continue };
        let scene = scene::gltf::load(format!("{shared}/scenes/{file}").as_ref()).unwrap();
        let view = scene.default_camera_view(None, &world(&scene, 0.0)).unwrap();
        println!("{file}: at {}, {} from the reference", view.position, view.position.distance(eye));
        assert!(view.position.distance(eye) < 1e-4 * eye.length().max(1.0) && view.forward.distance(forward) < 1e-5, "{file}: {view:?}");
        let Projection::Perspective { yfov } = view.projection else { panic!("{file}") };
        assert!((f64::from(yfov) - reference["yfov_rad"].as_f64().unwrap()).abs() < 1e-6);
    }
}
