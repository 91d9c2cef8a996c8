//! A driver without ray query, as older ones are: asking for it is refused, leaving the choice to the program works.

use crate::common::{gpu_with, render};
use pathspace::technique::Renderer;

#[test]
fn without_ray_query_asking_for_it_is_refused_and_auto_renders() {
    let gpu = gpu_with(false);
    let scene = render::builtin("cornell");
    let mut settings = render::settings(16, 9);
    settings.trace = "ray-query".to_owned();
    let message = Renderer::new(&gpu, scene.clone(), settings.clone()).err().expect("it must be refused").to_string();
    for part in [&*gpu.capabilities().name, "ray-query", "lacks ray query", "--trace auto"] {
        assert!(message.contains(part), "'{part}' is not in: {message}");
    }
    settings.trace = "auto".to_owned();
    assert!(render::mean(&render::render(&gpu, &scene, &settings, 4).mean) > 0.0);
}
