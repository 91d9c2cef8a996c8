//! Texture level of detail by ray cones: less noise at the same mean.

use crate::common;
use crate::common::render::{Rendered, mean, render, set, settings};
use glam::DVec3;
use pathspace::scene::texture::Sampler;
use pathspace::scene::transform::{Local, Node};
use pathspace::scene::{CameraView, Environment, Instance, Material, Mesh, Scene, Texture, TextureRef};
use pathspace::technique::ViewChoice;

/// A floor of 80 m whose 8x8 chequers repeat every 20 cm, under an even sky.
fn chequered_floor() -> Scene {
    let texel = |i: u32| if (i % 8 + i / 8).is_multiple_of(2) { [255, 255, 255, 255] } else { [0, 0, 0, 255] };
    let pixels: Vec<u8> = (0..64).flat_map(texel).collect();
    let (half, repeats) = (40.0, 400.0);
    let floor = Mesh {
        positions: vec![[-half, 0.0, -half], [-half, 0.0, half], [half, 0.0, half], [half, 0.0, -half]],
        normals: vec![[0.0, 1.0, 0.0]; 4],
        uv0: vec![[0.0, 0.0], [0.0, repeats], [repeats, repeats], [repeats, 0.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        triangle_materials: vec![0, 0],
        ..Default::default()
    };
    let reference = TextureRef { texture: 0, uv_set: 0, transform: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] };
    let material = Material { metallic: 0.0, specular: 0.0, base_color_texture: Some(reference), ..Default::default() };
    Scene {
        meshes: vec![floor],
        materials: vec![material],
        textures: vec![Texture::new("chequers".to_owned(), [8, 8], pixels, true, Sampler::default())],
        nodes: vec![Node { name: String::new(), parent: None, local: Local::Matrix(glam::DMat4::IDENTITY) }],
        instances: vec![Instance { mesh: 0, node: 0 }],
        environment: Environment::Constant([1.0; 3]),
        ..Default::default()
    }
}

#[test]
fn ray_cones_take_the_noise_from_distant_textures_and_keep_their_mean() {
    let gpu = common::gpu();
    let mut settings = settings(32, 24);
    let view = CameraView::look_at(DVec3::new(0.0, 2.0, 0.0), DVec3::new(0.0, 0.0, -10.0), 0.3);
    settings.view = ViewChoice::Fixed(view);
    let [finest, cone]: [Rendered; 2] = ["zero", "cone"].map(|level| {
        let mut settings = settings.clone();
        // Under an even sky, scattering by the cosine has no noise of its own.
        set(&mut settings, &[("textures.level", level), ("paths.direct", "bsdf"), ("paths.roulette", "off")]);
        render(&gpu, &chequered_floor(), &settings, 48)
    });
    let (wanted, found) = (mean(&finest.mean), mean(&cone.mean));
    assert!((found / wanted - 1.0).abs() < 0.02, "{found} {wanted}");
    let (noise, left) = (mean(&finest.variance), mean(&cone.variance));
    assert!(left < 0.1 * noise, "{left} of {noise}");
}
