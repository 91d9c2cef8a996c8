//! Radiance terms kept apart at the filter vertex sum up to the plain path tracer's picture.

use crate::common;
use crate::common::render::{builtin, mean, render, settings};
use glam::DVec3;
use pathspace::scene::CameraView;
use pathspace::technique::{self, Renderer, Settings, ViewChoice};

const FRAMES: u32 = 64;

#[test]
fn separate_terms_recombine_to_the_same_picture() {
    let gpu = common::gpu();
    let views = [("cornell", [0.278, 0.4, -0.5], [0.278, 0.0, 0.28]), ("material", [0.0, 1.5, 4.0], [0.0, 0.2, 0.0])];
    for (name, eye, target) in views {
        let scene = builtin(name);
        let view = CameraView::look_at(DVec3::from_array(eye), DVec3::from_array(target), 0.5);
        let plain = Settings { view: ViewChoice::Fixed(view), ..settings(32, 24) };
        let expected = render(&gpu, &scene, &plain, FRAMES);
        let unfiltered = Settings { technique: technique::find("unfiltered").unwrap(), seed: 9, ..plain };
        let mut renderer = Renderer::new(&gpu, scene, unfiltered).unwrap();
        let mut sum = 0.0;
        for _ in 0..FRAMES {
            renderer.render_frame().unwrap();
            sum += mean(&renderer.picture().unwrap());
        }
        let (found, wanted) = (sum / f64::from(FRAMES), mean(&expected.mean));
        let deviation = (mean(&expected.variance) / (3.0 * 32.0 * 24.0)).sqrt();
        // The pixel's centre instead of its whole area shifts edges: allowed for by 1 %, with no lamp in view.
        assert!((found - wanted).abs() < 8.0 * deviation + 0.01 * wanted, "{name}: {found} {wanted} +- {deviation}");
    }
}

#[test]
fn the_composite_is_the_sum_of_its_terms() {
    let gpu = common::gpu();
    let terms = ["before", "attenuation", "diffuse_direct", "diffuse_indirect", "specular_direct", "specular_indirect"];
    let unfiltered = Settings { technique: technique::find("unfiltered").unwrap(), ..settings(24, 16) };
    let mut renderer = Renderer::new(&gpu, builtin("material"), unfiltered).unwrap();
    renderer.render_frame().unwrap();
    let [before, attenuation, dd, di, sd, si] = terms.map(|name| renderer.output(name).unwrap().unwrap().pixels);
    let picture = renderer.picture().unwrap().pixels;
    let mut separated = 0;
    for i in 0..picture.len() {
        for c in 0..3 {
            let sum = before[i][c] + attenuation[i][c] * (dd[i][c] + di[i][c]) + sd[i][c] + si[i][c];
            assert!((sum - picture[i][c]).abs() <= 1e-5 * sum.abs().max(1e-5), "{sum} {}", picture[i][c]);
        }
        separated += usize::from(attenuation[i][0] > 0.0);
    }
    assert!(separated > picture.len() / 2, "most pixels see a filter vertex: {separated}");
}
