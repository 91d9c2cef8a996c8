//! Where a scene is and how large it is does not change its picture.

use crate::common;
use crate::common::render::{builtin, filters, render, render_frames, settings};
use glam::{DMat4, DVec3};
use pathspace::display::Image;
use pathspace::scene::{Local, Node, Scene};

/// The scene below a new root.
fn placed(mut scene: Scene, root: DMat4) -> Scene {
    for node in &mut scene.nodes {
        node.parent = Some(node.parent.map_or(0, |parent| parent + 1));
    }
    scene.nodes.insert(0, Node { name: "root".to_owned(), parent: None, local: Local::Matrix(root) });
    scene.instances.iter_mut().for_each(|instance| instance.node += 1);
    scene.lights.iter_mut().for_each(|light| light.node += 1);
    scene.cameras.iter_mut().for_each(|camera| camera.node += 1);
    scene
}

/// Paths are chaotic: rounding may send a few another way. The rest is equal, pixel by pixel, with the same seed.
fn assert_nearly_equal(what: &str, a: &Image, b: &Image, share: f64) {
    let differs = |(a, b): &(&[f32; 3], &[f32; 3])| (0..3).any(|c| (a[c] - b[c]).abs() > 0.02 * a[c].abs().max(0.01));
    let differing = a.pixels.iter().zip(&b.pixels).filter(differs).count();
    assert!(differing as f64 <= share * a.pixels.len() as f64, "{what}: {differing} of {} pixels differ", a.pixels.len());
}

#[test]
fn a_scene_looks_the_same_wherever_and_however_large_it_is() {
    let gpu = common::gpu();
    let scene = builtin("cornell");
    let settings = settings(32, 32);
    let expected = render(&gpu, &scene, &settings, 4).mean;
    let far = DVec3::new(1.0e6, -2.0e6, 3.0e6);
    let cases = [
        ("10^6 m away", DMat4::from_translation(far), 0.05),
        ("a thousandth", DMat4::from_scale(DVec3::splat(1e-3)), 0.05),
        ("10^6 times as large", DMat4::from_scale(DVec3::splat(1e6)), 0.05),
    ];
    for (what, root, share) in cases {
        assert_nearly_equal(what, &expected, &render(&gpu, &placed(scene.clone(), root), &settings, 4).mean, share);
    }
}

/// Mean difference over mean value.
fn difference(a: &Image, b: &Image) -> f64 {
    let pairs = || a.pixels.iter().flatten().zip(b.pixels.iter().flatten()).map(|(&a, &b)| (f64::from(a), f64::from(b)));
    pairs().map(|(a, b)| (a - b).abs()).sum::<f64>() / pairs().map(|(a, _)| a).sum::<f64>()
}

/// A path that rounding sends another way changes its cell or window a little, not the pixel alone. Powers of two keep the grid of cells
/// where it is in the scene; other scales move it, so that the cells are others, of up to twice the width.
#[test]
fn a_filter_works_the_same_wherever_and_however_large_the_scene_is() {
    let gpu = common::gpu();
    let scene = builtin("cornell");
    let settings = settings(48, 32);
    let far = DVec3::new(1.0e6, -2.0e6, 3.0e6);
    let cases = [
        ("10^6 m away", DMat4::from_translation(far), 0.02),
        ("2^-10 as large", DMat4::from_scale(DVec3::splat(0.5f64.powi(10))), 0.02),
        ("2^20 times as large", DMat4::from_scale(DVec3::splat(2f64.powi(20))), 0.02),
        ("a thousandth", DMat4::from_scale(DVec3::splat(1e-3)), 0.15),
        ("10^6 times as large", DMat4::from_scale(DVec3::splat(1e6)), 0.15),
    ];
    for filter in filters() {
        let expected = render_frames(&gpu, &scene, &settings, filter, 4).picture().unwrap();
        for (what, root, most) in &cases {
            let found = render_frames(&gpu, &placed(scene.clone(), *root), &settings, filter, 4).picture().unwrap();
            let difference = difference(&expected, &found);
            assert!(difference < *most, "{filter}, {what}: {difference}");
        }
    }
}
