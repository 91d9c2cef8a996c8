//! Rays that leave a surface do not meet it again, and do not skip a plate close behind it: from 10^-3 m to 10^6 m, far from the mesh's
//! own origin, far from the world's, through turned, mirrored and squashed instances, and from slivers.

use crate::common::rays::{Traced, mesh_of, scene_of};
use crate::common::{self, TestGpu};
use glam::{DMat4, DQuat, DVec3, EulerRot};
use pathspace::scene::Mesh;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use std::f64::consts::TAU;

/// Specialization constant `rays.offset`.
const RAY_OFFSET: u32 = 101;

const KERNEL: &str = r#"
#include "accel/trace.glsl"
#include "lib/ray_offset.glsl"
struct In { vec3 direction; vec2 barycentrics; uint primitive; };
struct Out { uint found; uint primitive; float t; float cosine; };
void kernel(uint i) {
    Instance instance = InstanceBuffer(frame.instances).at[0];
    Mesh mesh = MeshBuffer(frame.meshes).at[0];
    uvec3 c = Uvec3Buffer(mesh.triangles).at[inputs[i].primitive];
    Vec3Buffer p = Vec3Buffer(mesh.positions);
    vec3 edge1 = affine_linear(instance.object_to_world, p.at[c.y] - p.at[c.x]);
    vec3 edge2 = affine_linear(instance.object_to_world, p.at[c.z] - p.at[c.x]);
    vec3 normal = normalize(cross(edge1, edge2));
    RayOrigin origin = ray_origin_of_hit(instance, mesh, c, inputs[i].barycentrics, normal);
    Ray ray = Ray(leave_surface(origin, inputs[i].direction), 0.0, inputs[i].direction, 3.4e38);
    Hit hit;
    bool found = accel_trace(ray, false, 0, hit);
    outputs[i] = found ? Out(1, hit.primitive, hit.t, dot(normal, ray.direction)) : Out(0, 0, 0.0, dot(normal, ray.direction));
}
"#;

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Departure {
    direction: [f32; 3],
    barycentrics: [f32; 2],
    primitive: u32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Arrival {
    found: u32,
    primitive: u32,
    t: f32,
    cosine: f32,
}

/// Of a plate, in units of the triangle's size.
const THICKNESS: f64 = 1e-4;
/// Plates stand this far apart, in the same units, in a row whose middle is `offset` from the mesh's origin.
const SPACING: f64 = 2.0;
const PLATES: usize = 6;

/// Pairs of parallel triangles of every orientation: the first of each pair in front, the second behind it. The first plate is in the
/// plane z = `offset.z`: without offset a coordinate is exactly 0 and has no rounding error of its own.
fn plates(rng: &mut Pcg32, size: f64, offset: DVec3) -> Mesh {
    let mut positions = Vec::new();
    for plate in 0..PLATES {
        let turn = match plate {
            0 => DQuat::IDENTITY,
            _ => DQuat::from_euler(EulerRot::XYZ, rng.random_range(-3.0..3.0), rng.random_range(-3.0..3.0), rng.random_range(-3.0..3.0)),
        };
        let place = offset + DVec3::X * (plate as f64 - 0.5 * PLATES as f64) * SPACING;
        for depth in [0.0, THICKNESS] {
            let corners = [DVec3::new(0.2, 0.0, depth), DVec3::new(0.0, 0.2, depth), DVec3::new(-0.1, -0.1, depth)];
            positions.extend(corners.map(|corner| ((turn * corner * 5.0 + place) * size).as_vec3().to_array()));
        }
    }
    let triangles = (0..2 * PLATES as u32).map(|triangle| [0, 1, 2].map(|corner| 3 * triangle + corner)).collect();
    mesh_of(positions, triangles)
}

/// From inside every triangle, in all directions, a quarter of them nearly in its plane.
fn departures(rng: &mut Pcg32, traced: &Traced, count: usize) -> Vec<Departure> {
    let mut departure = |index: usize| {
        let direction = DVec3::new(rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0)).normalize();
        let barycentrics = [rng.random_range(0.1..0.45), rng.random_range(0.1..0.45)];
        let primitive = (index % traced.scene.meshes[0].triangles.len()) as u32;
        Departure { direction: direction.as_vec3().to_array(), barycentrics, primitive }
    };
    (0..count).map(&mut departure).collect()
}

/// (rays that meet their own triangle, rays that miss the plate behind them).
fn failures(gpu: &TestGpu, size: f64, offset: DVec3, transform: DMat4, ray_offset: u32) -> Vec<(&'static str, usize, usize)> {
    let mut rng = Pcg32::seed_from_u64(31);
    let traced = Traced::new(gpu, scene_of(vec![(plates(&mut rng, size, offset), vec![transform])]));
    let departures = departures(&mut rng, &traced, 1 << 15);
    let partner = partners(&traced.scene.meshes[0]);
    let mut constants = traced.alpha_constants();
    constants.push((RAY_OFFSET, ray_offset));
    let count = |stem: &'static str| {
        let arrivals: Vec<Arrival> = traced.run(stem, KERNEL, &departures, &constants);
        let pairs = || departures.iter().zip(&arrivals);
        let own = pairs().filter(|(from, to)| to.found == 1 && to.primitive == from.primitive).count();
        // The first of a pair has its partner along the normal, the second against it; mirrors turn the normal.
        let mirrored = if transform.determinant() < 0.0 { -1.0 } else { 1.0 };
        let towards = |from: &Departure, to: &Arrival| {
            let (partner, sign) = partner[from.primitive as usize];
            (mirrored * sign * to.cosine > 0.3).then_some(partner)
        };
        let missed = pairs().filter(|(from, to)| towards(from, to).is_some_and(|partner| to.found == 0 || to.primitive != partner)).count();
        (stem, own, missed)
    };
    traced.structures.iter().map(|(stem, _)| count(stem)).collect()
}

/// For each triangle in spatial order the other one of its plate, and the side of its normal on which that lies.
fn partners(mesh: &Mesh) -> Vec<(u32, f32)> {
    let of = |corner: u32| mesh.triangles.iter().position(|triangle| triangle[0] == corner).expect("every triangle is kept") as u32;
    let partner =
        |triangle: &[u32; 3]| if triangle[0].is_multiple_of(6) { (of(triangle[0] + 3), 1.0) } else { (of(triangle[0] - 3), -1.0) };
    mesh.triangles.iter().map(partner).collect()
}

/// A bar of `sides` slivers around, each 9 m long and some 5 cm wide, its caps left open: convex, so that nothing that leaves it outwards meets it.
fn bar(sides: u32) -> Mesh {
    let corner = |side: u32, end: f64| {
        let angle = f64::from(side) / f64::from(sides) * TAU;
        DVec3::new(end, 0.8 * angle.cos(), 0.8 * angle.sin()).as_vec3().to_array()
    };
    let positions = (0..sides).flat_map(|side| [corner(side, -4.5), corner(side, 4.5)]).collect();
    let quad = |side: u32| {
        let (a, b) = (2 * side, 2 * ((side + 1) % sides));
        [[a, b, b + 1], [a, b + 1, a + 1]]
    };
    mesh_of(positions, (0..sides).flat_map(quad).collect())
}

/// The watertight test's rounding grows with a triangle's aspect ratio, beyond what the origin's offset allows for.
#[test]
fn rays_that_leave_a_convex_bar_of_slivers_do_not_meet_it() {
    let gpu = common::gpu();
    let mut rng = Pcg32::seed_from_u64(32);
    for transform in [DMat4::IDENTITY, squashed(1.0), DMat4::from_scale(DVec3::splat(1e-3))] {
        let traced = Traced::new(&gpu, scene_of(vec![(bar(100), vec![transform])]));
        let departures = departures(&mut rng, &traced, 1 << 16);
        let outwards = if transform.determinant() < 0.0 { -1.0 } else { 1.0 };
        for (stem, _) in &traced.structures {
            let arrivals: Vec<Arrival> = traced.run(stem, KERNEL, &departures, &traced.alpha_constants());
            let met = arrivals.iter().filter(|arrival| outwards * arrival.cosine > 0.0 && arrival.found == 1).count();
            assert_eq!(met, 0, "{stem}: {transform}");
        }
    }
}

fn squashed(scale: f64) -> DMat4 {
    let turn = DQuat::from_euler(EulerRot::XYZ, 0.4, 1.1, -2.0);
    DMat4::from_scale_rotation_translation(DVec3::new(-1.5, 1.0, 0.8), turn, DVec3::new(3.0, -5.0, 1.0) * scale)
}

#[test]
fn rays_neither_meet_their_own_triangle_nor_leak_through_a_thin_plate() {
    let gpu = common::gpu();
    for size in [1e-3, 1.0, 1e3, 1e6] {
        for offset in [DVec3::ZERO, DVec3::new(10.0, -6.0, 3.0)] {
            for transform in [DMat4::IDENTITY, squashed(size)] {
                for (stem, own, missed) in failures(&gpu, size, offset, transform, 0) {
                    assert_eq!((own, missed), (0, 0), "{stem}: size {size} m at {offset}, {transform}");
                }
            }
        }
    }
}

#[test]
fn a_fixed_offset_leaks_in_small_scenes_and_hits_itself_in_large_ones() {
    let gpu = common::gpu();
    let leaks = failures(&gpu, 1e-3, DVec3::ZERO, DMat4::IDENTITY, 1);
    let hits_itself = failures(&gpu, 1e6, DVec3::ZERO, squashed(1e6), 1);
    assert!(leaks.iter().all(|(_, _, missed)| *missed > 0), "{leaks:?}");
    assert!(hits_itself.iter().all(|(_, own, _)| *own > 0), "{hits_itself:?}");
}
