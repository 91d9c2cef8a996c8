//! The white furnace: under a sky of radiance 1 a white surface shows 1, whatever its roughness, metalness and index of refraction.

use crate::common;
use crate::surface::{CASE, Case, options};
use bytemuck::{Pod, Zeroable};
use pathspace::metrics::statistics::BatchMeans;

const ROUGHNESSES: [f32; 9] = [0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 1.0];
const COSINES: [f32; 6] = [1.0, 0.9, 0.7, 0.4, 0.15, 0.06];

/// Mean weight of 4096 samples of a shifted low-discrepancy sequence (Roberts' R3, in integers). Radiance that is refracted counts
/// eta^2 times, so that it is energy.
const BY_SAMPLES: &str = "
#include \"lib/rng.glsl\"
struct In { Case c; uint seed; };
struct Out { float albedo; };
void kernel(uint i) {
    Surface s = surface_of(inputs[i].c);
    uvec3 shift = pcg3d(uvec3(inputs[i].seed, 1u, 2u));
    float sum = 0.0;
    for (uint k = 0u; k < 4096u; k++) {
        uvec3 bits = shift + k * uvec3(3518319155u, 2882110345u, 2360945575u);
        BsdfSample result;
        if (bsdf_sample(s, inputs[i].c.wo, vec3(unit_float(bits.xy), unit_float(bits.z)), result)) {
            sum += (diffuse_albedo(s).g * result.diffuse_weight + result.specular_weight.g) * result.eta * result.eta;
        }
    }
    outputs[i].albedo = sum / 4096.0;
}
";

/// Independent estimates of each albedo.
const BATCHES: u32 = 16;

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Input {
    case: Case,
    seed: u32,
}

fn albedos(cases: &[Case], compensated: bool) -> Vec<BatchMeans> {
    let gpu = common::gpu();
    let (options, _tables) = options(&gpu, compensated);
    let inputs: Vec<Input> = cases.iter().flat_map(|&case| (0..BATCHES).map(move |seed| Input { case, seed })).collect();
    let estimates: Vec<f32> = common::run_kernel_with(&gpu, &format!("{CASE}{BY_SAMPLES}"), &inputs, &options);
    estimates.chunks(BATCHES as usize).map(|batches| batches.iter().copied().map(f64::from).collect()).collect()
}

fn grid(surfaces: impl Fn(f32) -> Vec<Case>) -> Vec<Case> {
    let seen = |case: Case| COSINES.map(|cosine| case.seen_at(cosine));
    ROUGHNESSES.iter().flat_map(|&roughness| surfaces(roughness)).flat_map(seen).collect()
}

fn described(case: &Case) -> String {
    let Case { roughness, metallic, ior, transmission, thin, inside, .. } = case;
    format!(
        "roughness {roughness} metallic {metallic} ior {ior} transmission {transmission} thin {thin} inside {inside} cos {}",
        case.wo[2]
    )
}

/// Within `tolerance`, and 4 standard errors of the estimate: where the truth is just within the tolerance, each albedo fails by chance
/// once in 1000 seeds (16 batches: Student's t).
fn assert_white(cases: &[Case], tolerance: f64) {
    let is_wrong = |albedo: &BatchMeans| (albedo.mean - 1.0).abs() > tolerance + 4.0 * albedo.variance_of_mean().sqrt();
    let albedos = albedos(cases, true);
    let wrong = cases.iter().zip(&albedos).filter(|(_, albedo)| is_wrong(albedo));
    let wrong: Vec<String> = wrong.map(|(case, albedo)| format!("{} at {}", albedo.mean, described(case))).collect();
    assert!(wrong.is_empty(), "{} of {} are not white:\n{}", wrong.len(), cases.len(), wrong.join("\n"));
    let worst = albedos.iter().map(|albedo| albedo.variance_of_mean().sqrt()).fold(0.0, f64::max);
    assert!(worst < 0.004, "the test is blunt: a standard error is {worst}");
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
fn refracting_glass_is_white_within_half_a_percent() {
    let iors = [1.1, 1.33, 1.5, 2.0];
    let both_sides = |ior, roughness| [Case::glass(roughness, ior, false), Case::glass(roughness, ior, true)];
    assert_white(&grid(|roughness| iors.iter().flat_map(|&ior| both_sides(ior, roughness)).collect()), 0.005);
}

#[test]
fn a_clearcoat_leaves_white_surfaces_white_within_half_a_percent() {
    let coated = |roughness| {
        let coat = |clearcoat_roughness| Case { clearcoat: 0.7, clearcoat_roughness, ..Case::metal(roughness) };
        let dielectric = |clearcoat_roughness| Case { clearcoat: 1.0, clearcoat_roughness, ..Case::dielectric(roughness, 1.5) };
        [coat(0.0), coat(0.4), dielectric(0.0), dielectric(0.7)].to_vec()
    };
    assert_white(&grid(coated), 0.005);
}

/// What the compensation is for: the plain model's losses that lib/energy.glsl states, straight on and at 80 degrees.
#[test]
fn the_plain_model_loses_what_the_shader_says() {
    let stated = [(0.25, 0.005, 0.067), (0.5, 0.084, 0.163), (0.75, 0.373, 0.280), (1.0, 0.693, 0.477)];
    for (roughness, straight, grazing) in stated {
        let cases = [Case::metal(roughness).seen_at(1.0), Case::metal(roughness).seen_at(80f32.to_radians().cos())];
        for (albedo, loss) in albedos(&cases, false).iter().zip([straight, grazing]) {
            assert!((1.0 - albedo.mean - loss).abs() < 0.002, "roughness {roughness}: {} for {loss}", 1.0 - albedo.mean);
        }
    }
}
