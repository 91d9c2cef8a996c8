//! hpsf.glossy: the lobes other than the diffuse one in cells of their own.

use crate::common;
use crate::common::floor::{floor, from_above, node};
use crate::common::render::{builtin, mean, output, render_frames, set, settings};
use glam::DVec3;
use pathspace::display::Image;
use pathspace::scene::{CameraView, Environment, Instance, Material, Mesh, Scene, Texture, TextureRef};
use pathspace::technique::{Renderer, ViewChoice};

fn rendered(scene: &Scene, values: &[(&str, &str)], frames: u32) -> Renderer {
    let mut settings = settings(96, 54);
    if scene.cameras.is_empty() {
        settings.view = from_above(0.5);
    }
    set(&mut settings, values);
    render_frames(&common::gpu(), scene, &settings, "hpsf", frames)
}

fn bits(image: &Image) -> Vec<[u32; 3]> {
    image.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

/// A floor that also reflects, under a sky: some paths leave through the one lobe, some through the other.
fn shiny_floor(roughness: f32) -> Scene {
    let mut scene = floor(5.0);
    scene.materials[0].specular = 1.0;
    scene.materials[0].roughness = roughness;
    scene.environment = Environment::Constant([0.25, 0.5, 2.0]);
    scene
}

/// 12 seeds, with and without. Cells reach over the edges of what is seen, which may cost 1 %; beyond that, four standard errors, which chance
/// exceeds in 6 of 10^5.
#[test]
fn glossy_cells_keep_the_mean_radiance() {
    let gpu = common::gpu();
    let scene = builtin("material-glossy");
    let mut renderers = ["on", "off"].map(|glossy| {
        let mut settings = settings(96, 54);
        set(&mut settings, &[("hpsf.glossy", glossy)]);
        render_frames(&gpu, &scene, &settings, "hpsf", 0)
    });
    let mut ratio = |seed| {
        let [on, off] = renderers.each_mut().map(|renderer| {
            renderer.restart(seed, 0).unwrap();
            renderer.render_frame().unwrap();
            mean(&renderer.picture().unwrap())
        });
        on / off
    };
    let ratios: Vec<f64> = (1..=12).map(&mut ratio).collect();
    let average = ratios.iter().sum::<f64>() / 12.0;
    let error = (ratios.iter().map(|r| (r - average).powi(2)).sum::<f64>() / (11.0 * 12.0)).sqrt();
    assert!((average - 1.0).abs() < 0.01 + 4.0 * error, "{average} +- {error}");
}

#[test]
fn diffuse_cells_know_nothing_of_glossy_ones() {
    let [on, off] = ["on", "off"].map(|glossy| rendered(&shiny_floor(0.3), &[("hpsf.glossy", glossy)], 2));
    assert!(bits(&output(&on, "diffuse")) == bits(&output(&off, "diffuse")));
    assert!(bits(&on.picture().unwrap()) != bits(&off.picture().unwrap()));
}

/// By both kernels of paths. No metals: rough ones no longer bring what they show to the diffuse cells behind.
#[test]
fn what_has_no_glossy_layer_stays_bit_for_bit() {
    let mut scene = builtin("material-glossy");
    scene.materials.iter_mut().for_each(|material| material.metallic = material.metallic.min(0.9));
    for kernel in ["megakernel", "wavefront"] {
        let [on, off] = ["on", "off"].map(|glossy| rendered(&scene, &[("hpsf.glossy", glossy), ("paths.kernel", kernel)], 2));
        let layers = output(&on, "filter_layer");
        let (before, after) = (bits(&off.picture().unwrap()), bits(&on.picture().unwrap()));
        let changed = |glossy: bool| {
            let pixels = layers.pixels.iter().zip(before.iter().zip(&after)).filter(|(layer, _)| (layer[0] > 0.0) == glossy);
            pixels.filter(|(_, (before, after))| before != after).count()
        };
        assert_eq!(changed(false), 0, "{kernel}");
        assert!(changed(true) > 100, "{kernel}: {}", changed(true));
    }
}

#[test]
fn mirrors_are_never_filtered_and_rough_floors_are() {
    for (roughness, filtered) in [(0.0, false), (0.3, true)] {
        let [on, off] = ["on", "off"].map(|glossy| rendered(&shiny_floor(roughness), &[("hpsf.glossy", glossy)], 1));
        assert!(mean(&output(&on, "specular_indirect")) + mean(&output(&on, "specular_direct")) > 0.0);
        assert_eq!(bits(&on.picture().unwrap()) != bits(&off.picture().unwrap()), filtered, "roughness {roughness}");
    }
}

/// A metal has nothing to tell the cells of the diffuse layer.
#[test]
fn rough_metals_are_filtered_and_leave_diffuse_cells_alone() {
    let mut scene = shiny_floor(0.5);
    scene.materials[0].metallic = 1.0;
    for filter in ["hpsf", "nhpsf"] {
        let mut settings = settings(96, 54);
        settings.view = from_above(0.5);
        let [on, off] = ["on", "off"].map(|glossy| {
            set(&mut settings, &[("hpsf.glossy", glossy)]);
            render_frames(&common::gpu(), &scene, &settings, filter, 1)
        });
        assert!(output(&on, "filter_layer").pixels.iter().all(|layer| layer[0] > 0.0), "{filter}");
        assert!(bits(&on.picture().unwrap()) != bits(&off.picture().unwrap()), "{filter}");
        assert!(output(&on, "hpsf_samples").pixels.iter().all(|samples| samples[0] == 0.0), "{filter}: no diffuse sample");
    }
}

/// A metal that goes from bright to dark along the picture's rows: cells hold samples of one colour, or each row of them would have steps as wide as
/// a cell, a third of the picture. A column's noise is 3 % of its mean.
#[test]
fn a_metal_whose_colour_is_a_texture_is_filtered_and_keeps_it() {
    let mut scene = shiny_floor(0.3);
    let texture = Texture::new("stripes".to_owned(), [2, 2], [[255; 4], [40, 40, 40, 255]].concat().repeat(2), true, Default::default());
    scene.meshes[0].uv0 = vec![[0.0, 0.0], [0.0, 8.0], [8.0, 8.0], [8.0, 0.0]];
    scene.textures = vec![texture];
    let slot = TextureRef { texture: 0, uv_set: 0, transform: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] };
    scene.materials[0].base_color_texture = Some(slot);
    scene.materials[0].metallic = 1.0;
    let [on, off] =
        ["on", "off"].map(|glossy| rendered(&scene, &[("hpsf.glossy", glossy), ("hpsf.width", "32"), ("hpsf.glossy_finer", "0")], 4));
    assert!(output(&on, "specular_samples").pixels.iter().filter(|samples| samples[0] > 1.0).count() > 5000);
    let columns = [on, off].map(|renderer| {
        let picture = renderer.picture().unwrap();
        (0..96).map(|x| (0..54).map(|y| f64::from(picture.pixels[96 * y + x][0])).sum()).collect::<Vec<f64>>()
    });
    for (x, (filtered, noisy)) in columns[0].iter().zip(&columns[1]).enumerate() {
        assert!((filtered / noisy - 1.0).abs() < 0.12, "column {x}: {filtered} {noisy}");
    }
}

/// A rough metal as a mirror shows it: 4 seeds of one frame each, whose means chance moves by 0.004.
#[test]
fn rough_metals_are_filtered_in_mirrors() {
    let mut scene = shiny_floor(0.5);
    scene.materials[0].metallic = 1.0;
    let mirror = Material { metallic: 1.0, roughness: 0.0, base_color: [0.9, 0.8, 0.7, 1.0], double_sided: true, ..Default::default() };
    scene.materials.push(mirror);
    scene.meshes.push(Mesh { triangle_materials: vec![1, 1], ..scene.meshes[0].clone() });
    scene.nodes.push(node(DVec3::Y * 2.0));
    scene.instances.push(Instance { mesh: 1, node: scene.nodes.len() as u32 - 1 });
    let gpu = common::gpu();
    let [on, off] = ["on", "off"].map(|glossy| {
        let mut settings = settings(96, 54);
        settings.view = ViewChoice::Fixed(CameraView::look_at(DVec3::Y, DVec3::new(0.5, 2.0, 0.0), 0.5));
        set(&mut settings, &[("hpsf.glossy", glossy)]);
        let mut renderer = render_frames(&gpu, &scene, &settings, "hpsf", 0);
        let mut frame = |seed| {
            renderer.restart(seed, 0).unwrap();
            renderer.render_frame().unwrap();
            mean(&renderer.picture().unwrap())
        };
        let average = (1..=4).map(&mut frame).sum::<f64>() / 4.0;
        if glossy == "on" {
            let filtered = output(&renderer, "specular_samples").pixels.iter().filter(|samples| samples[0] > 1.0).count();
            assert!(filtered > 5000, "{filtered} pixels");
        }
        average
    });
    assert!((on / off - 1.0).abs() < 0.02, "{on} {off}");
}

const KEYS: &str = r#"
#include "filter/hpsf/cell.glsl"
struct In { float roughness; uint material; vec3 incident; };
struct Out { ivec3 cell; int level; uint normal; uint layer; };
void kernel(uint i) {
    In v = inputs[i];
    uint layer = v.roughness == 0.0 ? 0u : glossy_layer(v.material, v.roughness, true);
    FilterPoint point = FilterPoint(vec3(0.3, 0.2, 0.1), vec3(0.0, 1.0, 0.0), normalize(v.incident), 4.0, vec3(0.0), layer);
    CellKey key = key_of(point, vec4(0.5), 0);
    outputs[i] = Out(key.cell, key.level, key.normal, key.layer);
}
"#;

#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Glossy {
    roughness: f32,
    material: u32,
    incident: [f32; 3],
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
struct Key {
    cell: [i32; 3],
    level: i32,
    normal: u32,
    layer: u32,
}

#[test]
fn keys_of_glossy_layers_depend_on_view_material_and_roughness_and_diffuse_ones_do_not() {
    let mut options = common::kernel::KernelOptions::default();
    options.frame.extent = [32, 32];
    options.frame.camera.up = [0.0, 1.0, 0.0];
    options.frame.camera.projection = 1;
    options.parameters.hpsf_width = 16.0;
    options.parameters.hpsf_incident_bits = 6;
    options.parameters.hpsf_glossy_finer = 1.0;
    let down = [0.1, -1.0, 0.2];
    let aside = [1.0, -0.2, 0.0];
    let of = |roughness, material, incident| Glossy { roughness, material, incident };
    let inputs = [of(0.0, 1, down), of(0.0, 2, aside), of(1.0, 1, down), of(1.0, 1, aside), of(1.0, 2, down), of(0.3, 1, down)];
    let keys: Vec<Key> = common::run_kernel_with(&common::gpu(), KEYS, &inputs, &options);
    assert_eq!(keys[0], keys[1], "the diffuse layer is one for all");
    assert_eq!(keys[0].layer, 0);
    for (i, glossy) in keys.iter().enumerate().skip(2) {
        assert!(keys.iter().enumerate().all(|(j, key)| i == j || key.layer != glossy.layer), "{i}: {keys:?}");
    }
    assert_eq!([keys[2].level, keys[5].level], [keys[0].level, keys[0].level - 2], "a third of the roughness, a quarter of the width");
}
