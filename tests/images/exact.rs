//! Pictures whose right answer is known.

use crate::common;
use crate::common::floor::{floor, from_above, node};
use crate::common::render::{builtin, mean, render, set, settings};
use glam::DVec3;
use pathspace::scene::{CameraView, Environment, Instance, Light, LightKind, Local, Material, Node, Scene};
use pathspace::technique::ViewChoice;
use std::f32::consts::PI;

fn with_light(kind: LightKind, color: f32, height: f64) -> Scene {
    let mut scene = floor(5.0);
    let rotation = glam::DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    let local = Local::Trs { translation: DVec3::new(0.0, height, 0.0), rotation, scale: DVec3::ONE };
    scene.nodes.push(Node { name: String::new(), parent: None, local });
    scene.lights.push(Light { name: String::new(), node: 1, color: [color; 3], kind, range: None });
    scene
}

fn center_radiance(scene: &Scene, frames: u32) -> f64 {
    let gpu = common::gpu();
    let mut settings = settings(8, 8);
    settings.view = from_above(0.01);
    mean(&render(&gpu, scene, &settings, frames).mean)
}

/// A plane through zero has no rounding error along its normal, and still rays that graze it must not meet it again.
#[test]
fn a_floor_does_not_light_itself() {
    let gpu = common::gpu();
    let mut settings = settings(64, 64);
    settings.view = from_above(0.01);
    let image = render(&gpu, &with_light(LightKind::Directional, 10.0, 2.0), &settings, 16).mean;
    assert!(image.pixels.iter().all(|pixel| pixel[0] < 1.5916), "{:?}", image.pixels.iter().map(|p| p[0]).fold(0.0, f32::max));
}

#[test]
fn a_point_light_of_100_candela_at_2_metres() {
    let expected = f64::from(100.0 / 4.0 * 0.5 / PI);
    let radiance = center_radiance(&with_light(LightKind::Point, 100.0, 2.0), 1);
    assert!((radiance / expected - 1.0).abs() < 1e-4, "{radiance} {expected}");
}

#[test]
fn a_directional_light_of_10_lux() {
    let radiance = center_radiance(&with_light(LightKind::Directional, 10.0, 2.0), 1);
    assert!((radiance / f64::from(10.0 * 0.5 / PI) - 1.0).abs() < 1e-5, "{radiance}");
}

#[test]
fn the_axis_of_a_spot_light_is_as_bright_as_the_point_light() {
    let spot = LightKind::Spot { inner_cone_angle: 0.3, outer_cone_angle: 0.5 };
    let radiance = center_radiance(&with_light(spot, 100.0, 2.0), 1);
    assert!((radiance / f64::from(100.0 / 4.0 * 0.5 / PI) - 1.0).abs() < 1e-4, "{radiance}");
}

/// Irradiance below a sphere's centre is pi L sin^2 of its half angle, which is that of a point light.
#[test]
fn a_sphere_light_is_as_bright_as_the_point_light_in_its_centre() {
    let sphere = LightKind::Sphere { radius: 0.5 };
    let radiance = center_radiance(&with_light(sphere, 100.0, 2.0), 64);
    assert!((radiance / f64::from(100.0 / 4.0 * 0.5 / PI) - 1.0).abs() < 2e-3, "{radiance}");
}

/// Form factor from a differential area to a parallel, coaxial disc, here a square of four quadrants: Howell, catalogue of
/// configuration factors, B-4, each quadrant (a = b = half side over distance).
#[test]
fn a_square_lamp_has_the_form_factor_of_four_rectangles() {
    let mut scene = floor(5.0);
    let (half, height, radiance) = (0.5f32, 1.5f64, 7.0f32);
    scene.materials.push(Material { emission: [radiance; 3], base_color: [0.0, 0.0, 0.0, 1.0], specular: 0.0, ..Default::default() });
    let mut lamp = scene.meshes[0].clone();
    lamp.positions = vec![[-half, 0.0, -half], [half, 0.0, -half], [half, 0.0, half], [-half, 0.0, half]];
    lamp.normals = vec![[0.0, -1.0, 0.0]; 4];
    lamp.triangle_materials = vec![1, 1];
    scene.meshes.push(lamp);
    scene.nodes.push(node(DVec3::new(0.0, height, 0.0)));
    scene.instances.push(Instance { mesh: 1, node: 1 });
    let a = f64::from(half) / height;
    let side = (1.0 + a * a).sqrt();
    let quadrant = (a / side * (a / side).atan() * 2.0) / (2.0 * std::f64::consts::PI);
    let expected = 4.0 * quadrant * f64::from(radiance) * 0.5;
    let found = center_radiance(&scene, 256);
    assert!((found / expected - 1.0).abs() < 3e-3, "{found} {expected}");
}

/// White spheres in a white environment vanish. One pixel in 10^4 may stray by chance; the mean may not.
#[test]
fn the_furnace_is_white_everywhere() {
    let gpu = common::gpu();
    let scene = builtin("furnace");
    let mut settings = settings(64, 36);
    set(&mut settings, &[("paths.max_bounces", "32")]);
    let image = render(&gpu, &scene, &settings, 64).mean;
    assert!((mean(&image) - 1.0).abs() < 5e-3, "{}", mean(&image));
}

#[test]
fn an_empty_sky_shows_the_environment() {
    let gpu = common::gpu();
    let mut scene = floor(0.01);
    scene.environment = Environment::Constant([0.25, 0.5, 2.0]);
    let mut settings = settings(8, 8);
    settings.view = ViewChoice::Fixed(CameraView::look_at(DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.0, 2.0, 1.0), 0.5));
    assert!(render(&gpu, &scene, &settings, 1).mean.pixels.iter().all(|&pixel| pixel == [0.25, 0.5, 2.0]));
}
