//! What a preset promises about rays, and what a scene may take of memory.

use crate::common;
use crate::common::render::{builtin, set, settings};
use pathspace::technique::{Renderer, Settings};

#[test]
fn the_q2rtx_budget_is_three_scattered_and_four_shadow_rays_after_the_primary_one() {
    let gpu = common::gpu();
    let mut settings = settings(48, 48);
    set(&mut settings, &[("rays.budget", "q2rtx"), ("paths.roulette", "off")]);
    let mut renderer = Renderer::new(&gpu, builtin("cornell"), settings).unwrap();
    renderer.render_frame().unwrap();
    let counts = renderer.output("ray_count").unwrap().unwrap();
    let counts: Vec<[u32; 2]> = counts.pixels.iter().map(|pixel| [pixel[0] as u32 & 0xffff, pixel[0] as u32 >> 16]).collect();
    assert_eq!(counts.iter().map(|count| count[0]).max(), Some(1 + 3));
    assert_eq!(counts.iter().map(|count| count[1]).max(), Some(4));
}

/// Without textures. The smallest hall: a third of its triangles shine, and what does not grow with the scene weighs most.
#[test]
fn scene_and_structure_take_at_most_160_bytes_per_triangle() {
    let gpu = common::gpu();
    for structure in pathspace::accel::REGISTRY.iter().filter(|entry| (entry.available)(gpu.capabilities()).is_ok()) {
        let settings = Settings { trace: structure.name.to_owned(), ..settings(16, 9) };
        let mut renderer = Renderer::new(&gpu, builtin("hall:10000"), settings).unwrap();
        renderer.render_frame().unwrap();
        let per_triangle = renderer.timings().unwrap().memory_bytes.per_triangle;
        assert!((1.0..160.0).contains(&per_triangle), "{}: {per_triangle}", structure.name);
    }
}
