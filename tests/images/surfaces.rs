//! What a surface shows by itself, exactly: unlit colour, emission of its sides, the colour of what lies below it.

use crate::common;
use crate::common::floor::{floor, node};
use crate::common::render::{render, settings};
use glam::{DMat4, DQuat, DVec3};
use pathspace::scene::{CameraView, Environment, Instance, Light, LightKind, Local, Node, Scene};
use pathspace::technique::ViewChoice;

/// The floor's middle, from 1 m above or below; the same in every pixel up to rounding.
fn seen_from(height: f64, scene: &Scene) -> [f32; 3] {
    let gpu = common::gpu();
    let mut settings = settings(4, 4);
    settings.view = ViewChoice::Fixed(CameraView::look_at(DVec3::new(0.0, height, 1e-7), DVec3::ZERO, 0.01));
    let pixels = render(&gpu, scene, &settings, 1).mean.pixels;
    assert!(pixels.iter().flatten().zip(pixels[0].iter().cycle()).all(|(a, b)| (a - b).abs() <= 1e-4 * b), "{pixels:?}");
    pixels[0]
}

fn assert_close(what: &str, found: [f32; 3], expected: [f32; 3]) {
    assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() <= 1e-3 * expected), "{what}: {found:?}");
}

#[test]
fn an_unlit_surface_shows_its_colour_whatever_shines_on_it() {
    let mut scene = floor(5.0);
    (scene.materials[0].unlit, scene.materials[0].base_color) = (true, [0.25, 0.5, 0.75, 1.0]);
    scene.nodes.push(node(DVec3::new(0.0, 2.0, 0.0)));
    scene.lights.push(Light { name: String::new(), node: 1, color: [100.0; 3], kind: LightKind::Point, range: None });
    assert_close("unlit", seen_from(1.0, &scene), [0.25, 0.5, 0.75]);
}

#[test]
fn only_the_front_emits_unless_the_material_is_double_sided_and_a_mirrored_instance_keeps_its_front() {
    let emission = [1.0, 2.0, 3.0];
    for (double_sided, mirrored) in [(false, false), (true, false), (false, true)] {
        let mut scene = floor(5.0);
        let material = &mut scene.materials[0];
        (material.emission, material.base_color, material.double_sided) = (emission, [0.0, 0.0, 0.0, 1.0], double_sided);
        if mirrored {
            scene.nodes[0].local = Local::Matrix(DMat4::from_scale(DVec3::new(-1.0, 1.0, 2.0)));
        }
        let what = format!("double-sided {double_sided}, mirrored {mirrored}");
        assert_close(&what, seen_from(1.0, &scene), emission);
        assert_close(&what, seen_from(-1.0, &scene), if double_sided { emission } else { [0.0; 3] });
    }
}

/// Beer-Lambert through a slab 1 m thick that neither bends nor reflects light, before a white sky: KHR_materials_volume gives the colour
/// that is left after `attenuation_distance`.
#[test]
fn a_slab_takes_from_the_light_what_its_attenuation_says() {
    let mut scene = floor(5.0);
    let material = &mut scene.materials[0];
    (material.base_color, material.roughness, material.ior) = ([1.0; 4], 0.0, 1.0);
    (material.transmission, material.thickness) = (1.0, 1.0);
    (material.attenuation_color, material.attenuation_distance) = ([0.25, 0.5, 0.9], 0.5);
    let below = Local::Trs { translation: -DVec3::Y, rotation: DQuat::from_rotation_x(std::f64::consts::PI), scale: DVec3::ONE };
    scene.nodes.push(Node { name: String::new(), parent: None, local: below });
    scene.instances.push(Instance { mesh: 0, node: 1 });
    scene.environment = Environment::Constant([1.0; 3]);
    assert_close("slab", seen_from(1.0, &scene), [0.0625, 0.25, 0.81]);
}
