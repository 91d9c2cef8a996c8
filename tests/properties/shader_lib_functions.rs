//! The small functions of shaders_glsl/lib against double precision: packing, frames, maps of the unit square, Fresnel, GGX.

use crate::common;
use bytemuck::Pod;
use glam::{DVec2, DVec3};
use pathspace::scene::packing::{pack_normal, pack_tangent};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use std::f64::consts::PI;

/// `body` computes `Out r` from `In v`; both are the floats of the Rust types.
fn map<I: Pod, O: Pod>(includes: &[&str], fields: [&str; 2], body: &str, inputs: &[I]) -> Vec<O> {
    let includes: String = includes.iter().map(|file| format!("#include \"lib/{file}.glsl\"\n")).collect();
    let source = format!(
        "{includes}struct In {{ {} }};\nstruct Out {{ {} }};\nvoid kernel(uint i) {{ In v = inputs[i]; Out r; {body} outputs[i] = r; }}",
        fields[0], fields[1]
    );
    common::run_kernel(&common::gpu(), &source, inputs)
}

fn unit(v: DVec3) -> [f32; 3] {
    v.normalize().as_vec3().to_array()
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

/// Random directions, all axes, and what is nearly one.
fn directions(seed: u64) -> Vec<[f32; 3]> {
    let mut rng = Pcg32::seed_from_u64(seed);
    let mut all: Vec<[f32; 3]> = (0..20_000).map(|_| unit(DVec3::from_array([0; 3].map(|_| rng.random_range(-1.0..1.0))))).collect();
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        for sign in [1.0, -1.0] {
            for tilt in [0.0, 1e-7, -1e-7, 1e-3] {
                all.push(unit(sign * axis + tilt * DVec3::new(1.0, -2.0, 0.5)));
            }
        }
    }
    all
}

/// Points of the unit square: random, and all its corners as near as a sampler gets.
fn squares(seed: u64) -> Vec<[f32; 2]> {
    let mut rng = Pcg32::seed_from_u64(seed);
    let mut all: Vec<[f32; 2]> = (0..20_000).map(|_| [rng.random(), rng.random()]).collect();
    let ends = [0.0, 0.5, 1.0f32.next_down()];
    all.extend(ends.into_iter().flat_map(|x| ends.map(|y| [x, y])));
    all
}

#[test]
fn packed_vectors_of_the_host_come_back_on_the_device() {
    let inputs: Vec<([u32; 2], [f32; 3])> =
        directions(1).into_iter().map(|v| ([pack_normal(v), pack_tangent([v[0], v[1], v[2], -1.0])], v)).collect();
    let words: Vec<[u32; 2]> = inputs.iter().map(|input| input.0).collect();
    let body = "r.normal = unpack_normal(v.normal); r.tangent = unpack_tangent(v.tangent); r.again = unpack_normal(pack_normal(r.normal));";
    let outputs: Vec<[f32; 10]> = map(&["packing"], ["uint normal; uint tangent;", "vec3 normal; vec4 tangent; vec3 again;"], body, &words);
    for ((_, v), out) in inputs.iter().zip(outputs) {
        let degrees = |at: usize| wide([out[at], out[at + 1], out[at + 2]]).angle_between(wide(*v)).to_degrees();
        assert!(degrees(0) < 0.004 && degrees(3) < 0.008 && degrees(7) < 0.008, "{v:?}: {out:?}");
        assert_eq!(out[6], -1.0);
    }
    let positive: Vec<[f32; 4]> =
        map(&["packing"], ["uint t;", "vec4 t;"], "r.t = unpack_tangent(v.t);", &[pack_tangent([0.0, 0.0, 1.0, 1.0])]);
    assert_eq!(positive[0], [0.0, 0.0, 1.0, 1.0]);
}

#[test]
fn bases_are_orthonormal_and_right_handed_around_every_normal() {
    let body =
        "Basis b = basis_around(v.n); r.t = b.tangent; r.b = b.bitangent; r.back = to_world(b, to_local(b, vec3(0.6, -0.48, 0.64)));";
    let normals = directions(2);
    let outputs: Vec<[[f32; 3]; 3]> = map(&["frame"], ["vec3 n;", "vec3 t; vec3 b; vec3 back;"], body, &normals);
    for (n, [t, b, back]) in normals.iter().zip(outputs) {
        let (n, t, b) = (wide(*n), wide(t), wide(b));
        assert!((t.cross(b) - n).length() < 1e-6 && (t.length() - 1.0).abs() < 1e-6, "{n}: {t} {b}");
        assert!((wide(back) - DVec3::new(0.6, -0.48, 0.64)).length() < 1e-6, "{n}");
    }
}

#[test]
fn a_visible_normal_is_visible_unit_and_changed_no_more_than_needed() {
    let mut rng = Pcg32::seed_from_u64(3);
    let views = directions(3);
    let mut inputs: Vec<[[f32; 3]; 2]> = directions(4).into_iter().map(|n| [n, views[rng.random_range(0..views.len())]]).collect();
    inputs.push([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]);
    let outputs: Vec<[f32; 3]> = map(&["frame"], ["vec3 n; vec3 wo;", "vec3 n;"], "r.n = visible_normal(v.n, v.wo);", &inputs);
    for ([n, wo], out) in inputs.iter().zip(outputs) {
        let (n, wo, out) = (wide(*n), wide(*wo), wide(out));
        assert!(out.dot(wo) > 0.0099 && (out.length() - 1.0).abs() < 1e-5, "{n} {wo}: {out}");
        if n.dot(wo) >= 0.011 {
            assert_eq!(out, n);
        } else if n.dot(wo) > -0.999 {
            assert!(out.dot(n.cross(wo)).abs() < 1e-4, "{n} {wo}: {out} left their plane");
        }
    }
}

/// Each map's area element is constant, or has the stated density: checked by the oracle that the square's centre and edges go where
/// the paper says, and, for all points, by a twin in double precision.
#[test]
fn maps_of_the_unit_square_are_their_twins() {
    let points = squares(5);
    let body = "r.disk = sample_disk(v.u); r.hemisphere = sample_cosine_hemisphere(v.u); r.sphere = sample_sphere(v.u);
        r.cone = sample_cone(v.u, 1e-6); r.triangle = sample_triangle(v.u);";
    let fields = ["vec2 u;", "vec2 disk; vec3 hemisphere; vec3 sphere; vec3 cone; vec2 triangle;"];
    let outputs: Vec<[f32; 13]> = map(&["sampling"], fields, body, &points);
    for (u, out) in points.iter().zip(outputs) {
        let [x, y] = u.map(f64::from);
        let place = DVec2::new(2.0 * x - 1.0, 2.0 * y - 1.0);
        let (radius, angle) = match place.x.abs() > place.y.abs() {
            true => (place.x, PI / 4.0 * place.y / place.x),
            false if place.y == 0.0 => (0.0, 0.0),
            false => (place.y, PI / 2.0 - PI / 4.0 * place.x / place.y),
        };
        let disk = radius * DVec2::from_angle(angle);
        let close = |at: usize, expected: &[f64], tolerance: f64| {
            for (k, expected) in expected.iter().enumerate() {
                assert!((f64::from(out[at + k]) - expected).abs() <= tolerance, "{u:?}: {out:?}, {expected} at {}", at + k);
            }
        };
        close(0, &disk.to_array(), 1e-6);
        close(2, &[disk.x, disk.y], 1e-6);
        // Near the rim the height is the square root of a difference.
        close(4, &[(1.0 - disk.length_squared()).max(0.0).sqrt()], 1e-3);
        let azimuth = |sine: f64| [sine * (2.0 * PI * y).cos(), sine * (2.0 * PI * y).sin()];
        let z = 1.0 - 2.0 * x;
        close(5, &azimuth((1.0 - z * z).sqrt()), 1e-3);
        close(7, &[z], 1e-6);
        // A cone of 0.08 degrees keeps its digits.
        let drop = x * 1e-6;
        close(8, &azimuth((drop * (2.0 - drop)).sqrt()), 1e-8);
        let triangle = if y > x { [x / 2.0, y - x / 2.0] } else { [x - y / 2.0, y / 2.0] };
        close(11, &triangle, 1e-6);
        assert!(out[11] >= 0.0 && out[12] >= 0.0 && out[11] + out[12] <= 1.0, "{out:?}");
    }
}

/// Vulkan lets atan err by 4096 units in the last place, 5e-4; drivers use polynomials that err by some 1e-6 radians.
#[test]
fn latitude_and_longitude_go_there_and_back() {
    let all = directions(6);
    let body = "r.uv = direction_to_latlong(v.d); r.back = latlong_to_direction(r.uv);";
    let outputs: Vec<[f32; 5]> = map(&["sampling"], ["vec3 d;", "vec2 uv; vec3 back;"], body, &all);
    for (d, out) in all.iter().zip(outputs) {
        let [x, y, z] = d.map(f64::from);
        assert!((0.0..=1.0).contains(&out[0]) && (0.0..=1.0).contains(&out[1]), "{d:?}: {out:?}");
        assert!((f64::from(out[1]) - x.hypot(z).atan2(y) / PI).abs() < 1e-5, "{d:?}: {out:?}");
        assert!((wide([out[2], out[3], out[4]]) - wide(*d)).length() < 3e-5, "{d:?}: {out:?}");
    }
    // The centre is +z, a quarter along is +x, the top is +y.
    let centre: Vec<[f32; 3]> =
        map(&["sampling"], ["vec2 uv;", "vec3 d;"], "r.d = latlong_to_direction(v.uv);", &[[0.5f32, 0.5], [0.25, 0.5], [0.3, 0.0]]);
    for (d, expected) in centre.iter().zip([DVec3::Z, DVec3::X, DVec3::Y]) {
        assert!((wide(*d) - expected).length() < 1e-6, "{d:?} for {expected}");
    }
}

/// Amplitudes by the complex transmitted cosine's real case, independent of the shader's form.
#[test]
fn fresnel_is_that_of_the_amplitudes_and_total_inside() {
    let mut rng = Pcg32::seed_from_u64(7);
    let mut inputs: Vec<[f32; 2]> = (0..20_000).map(|_| [rng.random(), rng.random_range(0.3..3.0)]).collect();
    inputs.extend([0.0, 1e-7, 1.0].into_iter().flat_map(|c| [0.3, 1.0, 1.5, 3.0, 1e3, 1e-3].map(|eta| [c, eta])));
    let body = "r.f = fresnel_dielectric(v.c, v.eta); r.rise = dielectric_rise(v.c, v.eta);";
    let outputs: Vec<[f32; 2]> = map(&["fresnel"], ["float c; float eta;", "float f; float rise;"], body, &inputs);
    for ([c, eta], [f, rise]) in inputs.iter().zip(outputs) {
        assert!(f.is_finite() && rise.is_finite() && (0.0..=1.0 + 1e-6).contains(&f), "{c} {eta}: {f} {rise}");
        let (c, eta) = (f64::from(*c), f64::from(*eta));
        let incident = c.acos();
        let sine = incident.sin() / eta;
        // Fresnel's sine and tangent laws; at normal incidence they are 0 / 0. Next to the critical angle 1e-7 in the cosine shows as 1e-3.
        if c < 0.9999 && c > 1e-3 && (sine - 1.0).abs() > 1e-4 && (eta - 1.0).abs() > 1e-3 {
            let expected = if sine >= 1.0 { 1.0 } else { laws(incident, sine.asin()) };
            assert!((f64::from(f) - expected).abs() < 2e-4, "{c} {eta}: {f} for {expected}");
        }
    }
}

fn laws(incident: f64, transmitted: f64) -> f64 {
    let (difference, sum) = (incident - transmitted, incident + transmitted);
    0.5 * ((difference.sin() / sum.sin()).powi(2) + (difference.tan() / sum.tan()).powi(2))
}

#[test]
fn ggx_is_walters_distribution_with_heitz_masking_down_to_mirrors() {
    let mut rng = Pcg32::seed_from_u64(8);
    // Half vectors within a few widths of the lobe, where it is not negligible.
    let inputs: Vec<([f32; 3], [f32; 3])> = (0..20_000)
        .map(|_| {
            let alpha: f64 = 10f64.powf(rng.random_range(-3.0..0.0));
            let theta = (alpha * rng.random_range(0.0..4.0f64)).atan();
            let phi = rng.random_range(0.0..2.0 * PI);
            let h = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
            ([alpha as f32, rng.random_range(1e-3..1.0), rng.random_range(1e-3..1.0)], h.as_vec3().to_array())
        })
        .collect();
    let words: Vec<[f32; 6]> = inputs.iter().map(|(a, h)| [a[0], a[1], a[2], h[0], h[1], h[2]]).collect();
    let body = "r.d = ggx_distribution(v.alpha, vec3(0.0, 0.0, 1.0), v.h); r.visibility = smith_visibility(v.alpha, v.o, v.i);";
    let outputs: Vec<[f32; 2]> =
        map(&["microfacet"], ["float alpha; float o; float i; vec3 h;", "float d; float visibility;"], body, &words);
    for (([alpha, o, i], h), [d, visibility]) in inputs.iter().zip(outputs) {
        let [alpha, o, i] = [alpha, o, i].map(|&v| f64::from(v));
        let h = wide(*h);
        let tan2 = (h.x * h.x + h.y * h.y) / (h.z * h.z);
        let expected = alpha * alpha / (PI * h.z.powi(4) * (alpha * alpha + tan2).powi(2));
        assert!((f64::from(d) / expected - 1.0).abs() < 1e-3, "{alpha} {h}: {d} for {expected}");
        let lambda = |c: f64| 0.5 * ((1.0 + alpha * alpha * (1.0 / (c * c) - 1.0)).sqrt() - 1.0);
        let expected = 1.0 / (1.0 + lambda(o) + lambda(i)) / (4.0 * o * i);
        assert!((f64::from(visibility) / expected - 1.0).abs() < 1e-4, "{alpha} {o} {i}: {visibility} for {expected}");
    }
}

/// A colour is told from NaN and infinity by its bits.
#[test]
fn finite_colours_are_told_from_the_others() {
    let inputs =
        [[0.0, 1.0, 2.0], [f32::NAN, 0.0, 0.0], [0.0, f32::INFINITY, 0.0], [0.0, 0.0, f32::NEG_INFINITY], [f32::MAX, -f32::MAX, 1e-45]];
    let outputs: Vec<u32> = map(&["colour"], ["vec3 c;", "uint finite;"], "r.finite = all_finite(v.c) ? 1u : 0u;", &inputs);
    assert_eq!(outputs, [1, 0, 0, 0, 1]);
}
