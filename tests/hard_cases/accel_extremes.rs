//! Scenes and rays at the ends of what floats hold.

use crate::common;
use crate::common::rays::{Ray, Traced, bumpy_sphere, mesh_of, scene_of};
use glam::{DMat4, DVec3};
use pathspace::scene::Scene;

fn ray(origin: [f32; 3], direction: [f32; 3]) -> Ray {
    Ray { origin, t_min: 0.0, direction, t_max: f32::INFINITY, alpha_seed: 0 }
}

fn square(z: f32) -> Scene {
    let corners = vec![[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
    scene_of(vec![(mesh_of(corners, vec![[0, 1, 2], [0, 2, 3]]), vec![DMat4::IDENTITY])])
}

#[test]
fn nothing_is_hit_where_there_is_nothing() {
    let gpu = common::gpu();
    let traced = Traced::new(&gpu, scene_of(vec![(mesh_of(Vec::new(), Vec::new()), vec![DMat4::IDENTITY])]));
    for (stem, _) in &traced.structures {
        assert_eq!(traced.closest(stem, &[ray([0.0; 3], [0.0, 0.0, 1.0])])[0].found, 0, "{stem}");
    }
}

#[test]
fn rays_along_axes_hit_flat_boxes_and_those_in_their_plane_do_no_harm() {
    let gpu = common::gpu();
    let traced = Traced::new(&gpu, square(0.0));
    let hits = [([0.25, 0.5, -2.0], [0.0, 0.0, 1.0]), ([0.25, 0.5, 3.0], [-0.0, 0.0, -1.0]), ([0.25, 0.5, 3.0], [1e-38, -1e-44, -1.0])];
    let misses = [([-1.0, 0.5, 0.0], [1.0, 0.0, 0.0]), ([0.5, 0.5, 0.0], [0.0, 1.0, 0.0]), ([0.5, 2.0, -1.0], [0.0, 0.0, 1.0])];
    let rays: Vec<Ray> = hits.iter().chain(&misses).map(|&(origin, direction)| ray(origin, direction)).collect();
    for (stem, _) in &traced.structures {
        let found: Vec<u32> = traced.closest(stem, &rays).iter().map(|hit| hit.found).collect();
        assert_eq!(found, [1, 1, 1, 0, 0, 0], "{stem}");
    }
}

#[test]
fn rays_along_axes_through_box_sides_hit_whatever_the_scale() {
    let gpu = common::gpu();
    for scale in [1e-3, 1.0, 1e6] {
        let sphere = (bumpy_sphere(2), vec![DMat4::from_scale(DVec3::splat(scale))]);
        let traced = Traced::new(&gpu, scene_of(vec![sphere]));
        // From the centre, where splitting planes and box sides are most likely to lie.
        let rays: Vec<Ray> =
            DVec3::AXES.iter().flat_map(|&axis| [axis, -axis]).map(|axis| ray([0.0; 3], axis.as_vec3().to_array())).collect();
        for (stem, _) in &traced.structures {
            assert!(traced.closest(stem, &rays).iter().all(|hit| hit.found == 1), "{stem} at scale {scale}");
        }
    }
}
