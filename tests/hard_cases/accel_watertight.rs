//! Rays at the very edges and corners of a closed mesh do not get out.

use crate::common;
use crate::common::rays::{Ray, Traced, bumpy_sphere, scene_of};
use glam::{DMat4, DQuat, DVec3, Vec3};
use pathspace::scene::Mesh;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Specialization constant `rays.intersection`.
const INTERSECTION: u32 = 100;

/// From inside the mesh towards its vertices and points of its edges, after `transform`.
fn rays_at_seams(mesh: &Mesh, transform: DMat4, count: usize) -> Vec<Ray> {
    let mut rng = Pcg32::seed_from_u64(21);
    let to_world = |p: DVec3| transform.transform_point3(p).as_vec3();
    let mut ray = |index: usize| {
        let triangle = mesh.triangles[rng.random_range(0..mesh.triangles.len())];
        let [a, b] = [triangle[0], triangle[1]].map(|vertex| DVec3::from_array(mesh.positions[vertex as usize].map(f64::from)));
        let along = if index.is_multiple_of(3) { 0.0 } else { rng.random_range(0.0..1.0) };
        let inside = DVec3::new(rng.random_range(-0.3..0.3), rng.random_range(-0.3..0.3), rng.random_range(-0.3..0.3));
        let (from, to): (Vec3, Vec3) = (to_world(inside), to_world(a.lerp(b, along)));
        Ray { origin: from.to_array(), t_min: 0.0, direction: (to - from).normalize().to_array(), t_max: f32::INFINITY, alpha_seed: 0 }
    };
    (0..count).map(&mut ray).collect()
}

/// Rays that leave the sphere through a gap.
fn escapes(test: u32, transform: DMat4) -> usize {
    let gpu = common::gpu();
    let mesh = bumpy_sphere(5);
    let rays = rays_at_seams(&mesh, transform, 1 << 18);
    let traced = Traced::new(&gpu, scene_of(vec![(mesh, vec![transform])]));
    let mut constants = traced.alpha_constants();
    constants.push((INTERSECTION, test));
    traced.trace("bvh", &rays, false, &constants).iter().filter(|hit| hit.found == 0).count()
}

#[test]
fn no_ray_escapes_from_a_closed_mesh_between_its_triangles() {
    let turned =
        DMat4::from_scale_rotation_translation(DVec3::new(-3.0, 0.5, 2.0), DQuat::from_rotation_y(0.8), DVec3::new(9.0, -4.0, 70.0));
    for transform in [DMat4::IDENTITY, turned, DMat4::from_scale(DVec3::splat(1e6)), DMat4::from_scale(DVec3::splat(1e-3))] {
        assert_eq!(escapes(0, transform), 0, "{transform}");
    }
}

#[test]
fn rays_do_escape_between_triangles_tested_by_moeller_and_trumbore() {
    assert!(escapes(1, DMat4::IDENTITY) > 0);
}
