//! Filters smooth light, not what it falls on.

use crate::common;
use crate::common::floor::{floor, from_above, node};
use crate::common::render::{output, render_frames, set, settings};
use glam::DVec3;
use pathspace::display::Image;
use pathspace::scene::texture::Sampler;
use pathspace::scene::{Instance, Scene, Texture, TextureRef};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// A floor whose albedo is noise of 32x32 texels a metre, under a lamp of 2 m that is 3 m above it.
fn textured_floor() -> Scene {
    let mut random = Pcg32::seed_from_u64(1);
    let mut texel = || [random.random_range(80..=255), random.random_range(80..=255), random.random_range(80..=255), 255];
    let pixels = (0..32 * 32).flat_map(|_| texel()).collect();
    let mut scene = floor(4.0);
    scene.meshes[0].uv0 = vec![[0.0, 0.0], [0.0, 8.0], [8.0, 8.0], [8.0, 0.0]];
    let texture = TextureRef { texture: 0, uv_set: 0, transform: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] };
    scene.materials[0].base_color = [1.0; 4];
    scene.materials[0].base_color_texture = Some(texture);
    scene.textures = vec![Texture::new("noise".to_owned(), [32, 32], pixels, true, Sampler::default())];
    let mut lamp = floor(1.0);
    lamp.materials[0].emission = [5.0; 3];
    lamp.materials[0].double_sided = true;
    lamp.meshes[0].triangle_materials = vec![1, 1];
    scene.materials.append(&mut lamp.materials);
    scene.meshes.append(&mut lamp.meshes);
    scene.nodes.push(node(DVec3::new(0.0, 3.0, 0.0)));
    scene.instances.push(Instance { mesh: 1, node: 1 });
    scene
}

/// Differences between neighbours, to the right and downwards, of the green channel.
fn gradients(image: &Image) -> Vec<f64> {
    let (width, height) = (image.width as usize, image.height as usize);
    let at = |x: usize, y: usize| f64::from(image.pixels[y * width + x][1]);
    let inner = (0..height - 1).flat_map(|y| (0..width - 1).map(move |x| (x, y)));
    inner.flat_map(|(x, y)| [at(x + 1, y) - at(x, y), at(x, y + 1) - at(x, y)]).collect()
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (of_a, of_b) = (mean(a), mean(b));
    let product = |a: &[f64], of_a: f64, b: &[f64], of_b: f64| a.iter().zip(b).map(|(x, y)| (x - of_a) * (y - of_b)).sum::<f64>();
    product(a, of_a, b, of_b) / (product(a, of_a, a, of_a) * product(b, of_b, b, of_b)).sqrt()
}

/// Gradients of one frame against those of the albedo that it shows.
#[test]
fn texture_keeps_its_detail_in_one_frame() {
    let gpu = common::gpu();
    let scene = textured_floor();
    let mut settings = settings(96, 54);
    settings.view = from_above(1.0);
    settings.outputs = vec!["albedo".to_owned()];
    set(&mut settings, &[("textures.level", "cone")]);
    let kept = |technique: &str| {
        let renderer = render_frames(&gpu, &scene, &settings, technique, 1);
        correlation(&gradients(&renderer.picture().unwrap()), &gradients(&output(&renderer, "albedo")))
    };
    let noise = kept("unfiltered");
    let detail = kept("hpsf+");
    assert!(detail >= 0.98 && noise < 0.95, "hpsf+: {detail}; unfiltered: {noise}");
}
