//! What a preset promises about rays.

use crate::common;
use crate::common::render::{builtin, set, settings};
use pathspace::technique::Renderer;

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
