//! Whole pictures for tests: small, few samples, fixed seeds.

use pathspace::display::Image;
use pathspace::gpu::Gpu;
use pathspace::scene::{Mesh, Scene, builtin};
use pathspace::technique::{self, Parameters, Renderer, Settings, ViewChoice};

/// A picture and the variance of each of its values.
pub struct Rendered {
    pub mean: Image,
    pub variance: Image,
}

/// The reference technique at one sample per pixel and frame; change what a test is about.
pub fn settings(width: u32, height: u32) -> Settings {
    let mut settings = Settings {
        extent: [width, height],
        spp: 1,
        technique: technique::find("reference").expect("it is registered"),
        trace: "auto".to_owned(),
        parameters: Parameters::default(),
        all_effects: false,
        merge_static: true,
        seed: 1,
        fps: 30.0,
        view: ViewChoice::Scene(None),
        outputs: Vec::new(),
    };
    set(&mut settings, &[("textures.level", "zero")]);
    settings
}

pub fn set(settings: &mut Settings, values: &[(&str, &str)]) {
    for (key, value) in values {
        settings.parameters.set(key, value).unwrap();
    }
}

pub fn builtin(name: &str) -> Scene {
    builtin::find(name).unwrap().expect("a built-in scene").load().unwrap()
}

/// A square of 40 m that faces +z.
pub fn wall() -> Mesh {
    let size = 20.0;
    Mesh {
        positions: vec![[-size, -size, 0.0], [size, -size, 0.0], [size, size, 0.0], [-size, size, 0.0]],
        normals: vec![[0.0, 0.0, 1.0]; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        triangle_materials: vec![0, 0],
        ..Default::default()
    }
}

pub fn render(gpu: &Gpu, scene: &Scene, settings: &Settings, frames: u32) -> Rendered {
    let mut renderer = Renderer::new(gpu, scene.clone(), settings.clone()).unwrap();
    for _ in 0..frames {
        renderer.render_frame().unwrap();
    }
    renderer.finish().unwrap();
    Rendered { mean: renderer.picture().unwrap(), variance: renderer.output("variance").unwrap().expect("the reference keeps it") }
}

/// Mean over all pixels and channels.
pub fn mean(image: &Image) -> f64 {
    let values = image.pixels.iter().flatten().map(|&v| f64::from(v));
    values.sum::<f64>() / (3 * image.pixels.len()) as f64
}

/// Filters: techniques that make a picture of one frame's samples by more than adding their terms up.
pub fn filters() -> impl Iterator<Item = &'static str> {
    technique::REGISTRY.iter().filter(|technique| !technique.accumulates && technique.name != "unfiltered").map(|technique| technique.name)
}

/// A technique after some frames; what `settings` leaves at its default has the technique's.
pub fn render_frames(gpu: &Gpu, scene: &Scene, settings: &Settings, technique: &str, frames: u32) -> Renderer {
    let technique = technique::find(technique).expect("it is registered");
    let parameters = settings.parameters.changed_from(&Parameters::default(), technique.parameters());
    let mut renderer = Renderer::new(gpu, scene.clone(), Settings { technique, parameters, ..settings.clone() }).unwrap();
    (0..frames).for_each(|_| renderer.render_frame().unwrap());
    renderer.finish().unwrap();
    renderer
}

/// What the last pass of a filter makes of the radiance behind the filter vertices, all of it.
pub fn filtered(renderer: &Renderer) -> Image {
    let last = |smoothed: &str, noisy: &str| renderer.output(smoothed).unwrap().or_else(|| renderer.output(noisy).unwrap());
    let Some(mut sum) = last("smoothed_direct", "direct") else { return last("smoothed", "diffuse").expect("the technique filters") };
    let indirect = last("smoothed_indirect", "indirect").expect("it follows direct light");
    sum.pixels.iter_mut().zip(&indirect.pixels).for_each(|(sum, pixel)| (0..3).for_each(|c| sum[c] += pixel[c]));
    sum
}

pub fn output(renderer: &Renderer, name: &str) -> Image {
    renderer.output(name).unwrap().expect("the technique has it")
}
