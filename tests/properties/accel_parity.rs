//! Every acceleration structure gives the same hits as every other, and as an oracle that tests all triangles in double precision.

use crate::common::rays::{ExactHit, Hit, Oracle, Ray, Traced, bumpy_sphere, mesh_of, placed, random_rays, scene_of};
use crate::common::{self, TestGpu};
use glam::{DMat4, DQuat, DVec3};
use pathspace::scene::{AlphaMode, Material, Scene, builtin};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use rayon::prelude::*;

fn built_in(spec: &str) -> Scene {
    builtin::find(spec).unwrap().unwrap().load().unwrap()
}

/// Spheres turned, mirrored, squashed and overlapping, each instance in its own way.
fn instanced() -> Scene {
    let mut rng = Pcg32::seed_from_u64(5);
    let mut transform = |_| {
        let mut number = || rng.random_range(-1.0..1.0);
        let scale = DVec3::new(number(), number(), number()) * 2.0 + 0.05;
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, 3.0 * number(), 3.0 * number(), 3.0 * number());
        DMat4::from_scale_rotation_translation(scale, turn, DVec3::new(number(), number(), number()) * 10.0)
    };
    let transforms = (0..60).map(&mut transform).collect();
    scene_of(vec![(bumpy_sphere(2), transforms), (bumpy_sphere(1), vec![DMat4::from_scale(DVec3::splat(12.0))])])
}

/// How far apart two distances to the same place may be: the rounding of coordinates as large as the scene's, seen at a slant.
fn tie(scale: f64, cosine: f64) -> f64 {
    64.0 * f64::from(f32::EPSILON) * scale / cosine.max(1e-4)
}

/// The GPU's hit is the oracle's; or that is so near to the ray's start that rounding decides on which side of it the hit lies, and the GPU's is
/// the oracle's without it.
fn agrees(oracle: &Oracle, scale: f64, ray: &Ray, exact: Option<ExactHit>, hit: &Hit) -> bool {
    let starts_there = |exact: &ExactHit| exact.t - f64::from(ray.t_min) <= tie(scale, exact.cosine);
    let agrees_behind = |exact: ExactHit| {
        let behind = Ray { t_min: (exact.t as f32).next_up(), ..*ray };
        same_place(oracle, scale, &behind, oracle.closest(&behind), hit)
    };
    same_place(oracle, scale, ray, exact, hit) || exact.filter(starts_there).is_some_and(agrees_behind)
}

/// The same triangle, or another one as near, or the ray passes that close by an edge.
fn same_place(oracle: &Oracle, scale: f64, ray: &Ray, exact: Option<ExactHit>, hit: &Hit) -> bool {
    let near_edge = |hit: &ExactHit| hit.barycentrics.iter().any(|b| b.abs() < 1e-4) || hit.cosine < 1e-4;
    match (exact, hit.found == 1) {
        (None, false) => true,
        (Some(exact), false) => near_edge(&exact),
        (exact, true) => {
            let own = oracle.plane_hit(ray, hit.instance, hit.primitive).expect("a triangle of the scene");
            let is_there = (own.t - f64::from(hit.t)).abs() <= tie(scale, own.cosine) && own.barycentrics.iter().all(|&b| b > -1e-4);
            is_there && exact.map_or(near_edge(&own), |exact| exact.t >= own.t - tie(scale, own.cosine) || near_edge(&exact))
        }
    }
}

fn check_against_oracle(gpu: &TestGpu, name: &str, scene: Scene, count: usize) {
    let traced = Traced::new(gpu, scene);
    let oracle = Oracle::new(&traced);
    let bounds = oracle.bounds();
    let scale = bounds.0.abs().max(bounds.1.abs()).max_element();
    let rays = random_rays(&mut Pcg32::seed_from_u64(11), bounds, count);
    let exact: Vec<Option<ExactHit>> = rays.par_iter().map(|ray| oracle.closest(ray)).collect();
    assert!(exact.iter().filter(|hit| hit.is_some()).count() > count / 4, "{name}: too few rays hit anything");
    for (stem, _) in &traced.structures {
        let hits = traced.closest(stem, &rays);
        for ((ray, exact), hit) in rays.iter().zip(&exact).zip(&hits) {
            assert!(agrees(&oracle, scale, ray, *exact, hit), "{name}, {stem}: {ray:?} gives {hit:?} instead of {exact:?}");
        }
    }
}

#[test]
fn hits_are_those_of_an_oracle_in_double_precision() {
    let gpu = common::gpu();
    for (spec, count) in [("cornell", 4096), ("material", 1024), ("hall:10000", 2048)] {
        check_against_oracle(&gpu, spec, built_in(spec), count);
    }
    check_against_oracle(&gpu, "instanced", instanced(), 2048);
}

/// Share of rays for which two structures may differ at all: those that meet an edge or a tie, of which random rays have few.
const MOST_DIFFERENT: f64 = 2e-4;

fn check_against_each_other(gpu: &TestGpu, name: &str, scene: Scene, count: usize) {
    let traced = Traced::new(gpu, scene);
    let oracle = Oracle::new(&traced);
    let bounds = oracle.bounds();
    let scale = bounds.0.abs().max(bounds.1.abs()).max_element();
    let rays = random_rays(&mut Pcg32::seed_from_u64(12), bounds, count);
    let all: Vec<Vec<Hit>> = traced.structures.iter().map(|(stem, _)| traced.closest(stem, &rays)).collect();
    for (hits, (stem, _)) in all.iter().zip(&traced.structures) {
        let same = |(a, b): &(&Hit, &Hit)| (a.found, a.instance, a.primitive) == (b.found, b.instance, b.primitive);
        let different: Vec<usize> = all[0].iter().zip(hits).enumerate().filter(|(_, pair)| !same(pair)).map(|(i, _)| i).collect();
        let share = different.len() as f64 / count as f64;
        assert!(share <= MOST_DIFFERENT, "{name}, {stem}: {} of {count} rays differ", different.len());
        for (index, ray) in different.into_iter().map(|index| (index, &rays[index])) {
            assert!(
                agrees(&oracle, scale, ray, oracle.closest(ray), &hits[index]),
                "{name}, {stem}: {ray:?} gives {:?} instead of {:?}",
                hits[index],
                oracle.closest(ray)
            );
        }
    }
}

#[test]
fn structures_give_the_same_hits_on_a_million_rays() {
    let gpu = common::gpu();
    for spec in ["cornell", "furnace", "material", "hall:80000"] {
        check_against_each_other(&gpu, spec, built_in(spec), 1 << 20);
    }
    check_against_each_other(&gpu, "instanced", instanced(), 1 << 20);
}

/// Devices with few texels, such as SwiftShader, read nodes and triangles by address.
#[test]
fn a_tree_read_by_address_gives_the_hits_of_one_read_as_texels() {
    const BVH_AS_TEXELS: u32 = 210;
    let gpu = common::gpu();
    let traced = Traced::new(&gpu, instanced());
    let rays = random_rays(&mut Pcg32::seed_from_u64(13), Oracle::new(&traced).bounds(), 4096);
    let by_address = [traced.alpha_constants(), vec![(BVH_AS_TEXELS, 0)]].concat();
    assert_eq!(traced.trace("bvh", &rays, false, &by_address), traced.closest("bvh", &rays));
}

#[test]
fn any_hit_says_what_closest_hit_says() {
    let gpu = common::gpu();
    let traced = Traced::new(&gpu, instanced());
    let rays: Vec<Ray> = random_rays(&mut Pcg32::seed_from_u64(13), Oracle::new(&traced).bounds(), 1 << 16);
    for (stem, _) in &traced.structures {
        let closest = traced.closest(stem, &rays);
        let any = traced.trace(stem, &rays, true, &traced.alpha_constants());
        assert!(closest.iter().zip(&any).all(|(closest, any)| closest.found == any.found), "{stem}");
        assert!(closest.iter().any(|hit| hit.found == 0) && closest.iter().any(|hit| hit.found == 1));
    }
}

#[test]
fn hits_follow_instances_that_move_from_frame_to_frame() {
    let gpu = common::gpu();
    let mut traced = Traced::new(&gpu, instanced());
    let mut rng = Pcg32::seed_from_u64(14);
    for frame in 1..=6 {
        for (index, instance) in traced.instances.iter_mut().enumerate() {
            let angle = 0.3 * frame as f64 + index as f64;
            let place = DVec3::new(angle.sin(), (1.7 * angle).cos(), angle.cos()) * 9.0;
            *instance = placed(instance.mesh, &(DMat4::from_translation(place) * DMat4::from_rotation_y(angle)), false);
        }
        traced.update(frame % 2);
        let oracle = Oracle::new(&traced);
        let rays = random_rays(&mut rng, oracle.bounds(), 256);
        let exact: Vec<Option<ExactHit>> = rays.par_iter().map(|ray| oracle.closest(ray)).collect();
        for (stem, _) in &traced.structures {
            for ((ray, exact), hit) in rays.iter().zip(&exact).zip(traced.closest(stem, &rays)) {
                assert!(agrees(&oracle, 11.0, ray, *exact, &hit), "frame {frame}, {stem}: {ray:?} gives {hit:?} instead of {exact:?}");
            }
        }
    }
}

/// Parallel squares at z = 0, 1, 2, ...: each layer's material is the layer's index.
fn layers(materials: Vec<Material>) -> Scene {
    let mut mesh = mesh_of(Vec::new(), Vec::new());
    for layer in 0..materials.len() as u32 {
        let z = layer as f32;
        mesh.positions.extend([[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]]);
        // Vertex alpha goes from 0 on the left to 1 on the right.
        mesh.colors.extend([0.0, 1.0, 1.0, 0.0].map(|alpha| [1.0, 1.0, 1.0, alpha]));
        mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|corners| corners.map(|corner| 4 * layer + corner)));
        mesh.triangle_materials.extend([layer; 2]);
    }
    mesh.normals = vec![[0.0, 0.0, 1.0]; mesh.positions.len()];
    Scene { materials, ..scene_of(vec![(mesh, vec![DMat4::IDENTITY])]) }
}

fn through_layers(rng: &mut Pcg32, count: u32) -> Vec<Ray> {
    let mut ray = |alpha_seed| {
        let origin = [rng.random_range(-0.99..0.99), rng.random_range(-0.99..0.99), -1.0];
        Ray { origin, t_min: 0.0, direction: [0.0, 0.0, 1.0], t_max: 1e30, alpha_seed }
    };
    (0..count).map(&mut ray).collect()
}

#[test]
fn a_mask_lets_rays_through_exactly_where_alpha_is_below_the_cutoff() {
    let gpu = common::gpu();
    let masked = |cutoff| Material { alpha_mode: AlphaMode::Mask { cutoff }, ..Material::default() };
    let traced = Traced::new(&gpu, layers(vec![masked(0.75), masked(0.25), Material::default()]));
    let rays = through_layers(&mut Pcg32::seed_from_u64(15), 4096);
    for (stem, _) in &traced.structures {
        for (ray, hit) in rays.iter().zip(traced.closest(stem, &rays)) {
            let alpha = 0.5 * (ray.origin[0] + 1.0);
            let layer = if alpha > 0.75 {
                0.0
            } else if alpha > 0.25 {
                1.0
            } else {
                2.0
            };
            let undecided = (alpha - 0.75).abs() < 1e-4 || (alpha - 0.25).abs() < 1e-4;
            assert!(undecided || hit.t.round() == layer + 1.0, "{stem}: alpha {alpha} gives {hit:?}");
        }
    }
}

#[test]
fn blending_stops_the_share_of_rays_that_alpha_says_and_the_same_rays_in_every_structure() {
    let gpu = common::gpu();
    let blended = |alpha| Material { alpha_mode: AlphaMode::Blend, base_color: [1.0, 1.0, 1.0, alpha], ..Material::default() };
    let traced = Traced::new(&gpu, layers(vec![blended(0.6), blended(1.0)]));
    let count = 1 << 16;
    let rays = through_layers(&mut Pcg32::seed_from_u64(16), count);
    // The first layer stops 0.6 x alpha, alpha being 1/2 on average; the second stops alpha of what is left. E[alpha^2] = 1/3.
    let expected = [0.3, 0.5 - 0.6 / 3.0];
    let all: Vec<Vec<Hit>> = traced.structures.iter().map(|(stem, _)| traced.closest(stem, &rays)).collect();
    for (layer, share) in expected.into_iter().enumerate() {
        let stopped = all[0].iter().filter(|hit| hit.found == 1 && hit.t.round() == layer as f32 + 1.0).count() as f64;
        // Rays keep 1 % off both sides, which changes E[alpha^2] by 0.002. Beyond that, 5 standard deviations: one false alarm in 10^6.
        let deviation = (f64::from(count) * share * (1.0 - share)).sqrt();
        assert!((stopped - share * f64::from(count)).abs() < 5.0 * deviation + 0.0015 * f64::from(count), "layer {layer}: {stopped}");
    }
    for hits in &all[1..] {
        let differ = all[0].iter().zip(hits).filter(|(a, b)| (a.found, a.primitive) != (b.found, b.primitive)).count();
        assert!(differ <= 4, "{differ} rays differ");
    }
}
