//! The white furnace: under a sky of radiance 1 a white surface shows 1, whatever its roughness, metalness and index of refraction.

use crate::common;
use crate::surface::{CASE, Case, options};

const ROUGHNESSES: [f32; 9] = [0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 1.0];
const COSINES: [f32; 6] = [1.0, 0.9, 0.7, 0.4, 0.15, 0.06];

/// Mean weight of many samples of a low-discrepancy sequence: radiance that is refracted counts eta^2 times, so that it is energy.
const BY_SAMPLES: &str = "
struct In { Case c; };
struct Out { vec3 albedo; float largest; };
void kernel(uint i) {
    Surface s = surface_of(inputs[i].c);
    vec3 sum = vec3(0.0);
    float largest = 0.0;
    const uint COUNT = 8192u;
    for (uint k = 0u; k < COUNT; k++) {
        vec3 u = unit_float_3(k);
        BsdfSample result;
        if (bsdf_sample(s, inputs[i].c.wo, u, result)) {
            vec3 weight = diffuse_albedo(s) * result.diffuse_weight + result.specular_weight;
            sum += weight * result.eta * result.eta;
            largest = max(largest, max_component(weight));
        }
    }
    outputs[i] = Out(sum / float(COUNT), largest);
}
";

/// Roberts' R3 sequence in integers.
const SEQUENCE: &str = "
#include \"lib/rng.glsl\"
vec3 unit_float_3(uint k) {
    uvec3 bits = (k + 1u) * uvec3(3518319155u, 2882110345u, 2360945575u);
    return vec3(unit_float(bits.xy), unit_float(bits.z));
}
";

fn albedos(cases: &[Case], compensated: bool) -> Vec<[f32; 4]> {
    let gpu = common::gpu();
    let (options, _tables) = options(&gpu, compensated);
    common::run_kernel_with(&gpu, &format!("{CASE}{SEQUENCE}{BY_SAMPLES}"), cases, &options)
}

fn grid(surfaces: impl Fn(f32) -> Vec<Case>) -> Vec<Case> {
    let seen = |case: Case| COSINES.map(|cosine| case.seen_at(cosine));
    ROUGHNESSES.iter().flat_map(|&roughness| surfaces(roughness)).flat_map(seen).collect()
}

fn assert_white(cases: &[Case], tolerance: f32) {
    let mut wrong = Vec::new();
    for (case, [r, g, b, _]) in cases.iter().zip(albedos(cases, true)) {
        if !((r - 1.0).abs() <= tolerance && g == r && b == r) {
            wrong.push(format!(
                "{r} at roughness {} metallic {} ior {} transmission {} thin {} inside {} cos {}",
                case.roughness, case.metallic, case.ior, case.transmission, case.thin, case.inside, case.wo[2]
            ));
        }
    }
    assert!(wrong.is_empty(), "{} of {} are not white:\n{}", wrong.len(), cases.len(), wrong.join("\n"));
}

#[test]
fn metals_and_dielectrics_are_white_within_half_a_percent() {
    let iors = [0.0, 1.0, 1.1, 1.33, 1.5, 2.0, 2.5];
    assert_white(&grid(|roughness| iors.iter().map(|&ior| Case::dielectric(roughness, ior)).collect()), 0.005);
    let mixed = |roughness| [0.25, 0.5, 1.0].map(|metallic| Case { metallic, roughness, ..Case::default() }).to_vec();
    assert_white(&grid(mixed), 0.005);
}

#[test]
fn thin_walled_glass_is_white_within_half_a_percent() {
    let iors = [1.1, 1.33, 1.5, 2.0];
    assert_white(&grid(|roughness| iors.iter().map(|&ior| Case::thin_glass(roughness, ior)).collect()), 0.005);
}

#[test]
fn refracting_glass_is_white_within_two_percent() {
    let iors = [1.1, 1.33, 1.5, 2.0];
    let both_sides = |ior, roughness| [Case::glass(roughness, ior, false), Case::glass(roughness, ior, true)];
    assert_white(&grid(|roughness| iors.iter().flat_map(|&ior| both_sides(ior, roughness)).collect()), 0.02);
}
