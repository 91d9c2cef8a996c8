//! Sampled directions of every lobe follow the density that bsdf_evaluate states.

use crate::common;
use crate::surface::{CASE, Case, options};
use bytemuck::{Pod, Zeroable};
use pathspace::metrics::statistics::{chi_square_test, sidak};

/// 24 rows of polar angle by 24 columns of azimuth.
const CELLS: u32 = 576;
/// Threads for each case, of 1024 samples each.
const THREADS: u32 = 40;

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Input {
    case: Case,
    seed: u32,
}

/// The cell of each of 1024 samples; 576 where there is none.
const SAMPLE: &str = "
struct In { Case c; uint seed; };
struct Out { uint cells[1024]; };
void kernel(uint i) {
    Surface s = surface_of(inputs[i].c);
    for (uint k = 0u; k < 1024u; k++) {
        uvec4 bits = pcg4d(uvec4(k, inputs[i].seed, i, 1u));
        BsdfSample r;
        uint cell = 576u;
        if (bsdf_sample(s, inputs[i].c.wo, vec3(unit_float(bits.xy), unit_float(bits.z)), r)) {
            vec2 place = vec2(acos(clamp(r.direction.z, -1.0, 1.0)) / PI, atan(r.direction.y, r.direction.x) / (2.0 * PI) + 0.5);
            uvec2 at = min(uvec2(place * 24.0), uvec2(23u));
            cell = at.x * 24u + at.y;
        }
        outputs[i].cells[k] = cell;
    }
}
";

/// The density over one cell: the midpoint rule with 48 x 48 points.
const EXPECT: &str = "
struct In { Case c; uint seed; };
struct Out { float probability; };
void kernel(uint i) {
    Surface s = surface_of(inputs[i].c);
    vec2 cell = vec2(inputs[i].seed / 24u, inputs[i].seed % 24u);
    float sum = 0.0;
    for (uint k = 0u; k < 2304u; k++) {
        vec2 place = (cell + (vec2(k / 48u, k % 48u) + 0.5) / 48.0) / 24.0;
        float theta = PI * place.x;
        float phi = 2.0 * PI * (place.y - 0.5);
        vec3 wi = vec3(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
        sum += bsdf_evaluate(s, inputs[i].c.wo, wi).pdf * sin(theta);
    }
    outputs[i].probability = sum / 2304.0 * 2.0 * PI * PI / 576.0;
}
";

fn cases() -> Vec<Case> {
    let families: [fn(f32) -> Case; 8] = [
        Case::metal,
        |roughness| Case::dielectric(roughness, 1.5),
        |roughness| Case::thin_glass(roughness, 1.5),
        |roughness| Case::glass(roughness, 1.5, false),
        |roughness| Case::glass(roughness, 1.33, true),
        |roughness| Case { transmission: 0.5, metallic: 0.3, ..Case::glass(roughness, 2.0, false) },
        |roughness| Case { clearcoat: 1.0, clearcoat_roughness: 0.4, base_color: [0.2; 3], ..Case::dielectric(roughness, 1.5) },
        // A normal map's normal: what falls below either horizon is no sample.
        |roughness| Case { normal: [0.48, 0.36, 0.8], ..Case::glass(roughness, 1.5, false) },
    ];
    let seen = |family: fn(f32) -> Case| {
        [0.3, 0.6, 1.0].into_iter().flat_map(move |roughness| [0.97, 0.6, 0.2].map(|cosine| family(roughness).seen_at(cosine)))
    };
    families.into_iter().flat_map(seen).collect()
}

/// 72 chi-square tests with and 72 without compensation; all of them together would fail by chance once in 1000 seeds.
#[test]
fn samples_of_every_lobe_follow_their_density() {
    let gpu = common::gpu();
    let cases = cases();
    let inputs = |count: u32| cases.iter().flat_map(move |&case| (0..count).map(move |seed| Input { case, seed })).collect::<Vec<_>>();
    let significance = sidak(1e-3, 2 * cases.len());
    let mut failures = Vec::new();
    for compensated in [true, false] {
        let (options, _tables) = options(&gpu, compensated);
        let densities: Vec<f32> = common::run_kernel_with(&gpu, &format!("{CASE}{EXPECT}"), &inputs(CELLS), &options);
        let samples: Vec<[u32; 1024]> =
            common::run_kernel_with(&gpu, &format!("{CASE}#include \"lib/rng.glsl\"\n{SAMPLE}"), &inputs(THREADS), &options);
        let per_case = densities.chunks(CELLS as usize).zip(samples.chunks(THREADS as usize));
        for ((density, samples), case) in per_case.zip(&cases) {
            let p = p_value(density, samples.as_flattened());
            if p < significance {
                failures.push(format!("p = {p:e}, compensated {compensated}: {case:?}"));
            }
        }
    }
    assert!(failures.is_empty(), "{} of {} at significance {significance:e}:\n{}", failures.len(), 2 * cases.len(), failures.join("\n"));
}

fn p_value(probabilities: &[f32], cells: &[u32]) -> f64 {
    let mut observed = vec![0u64; CELLS as usize + 1];
    cells.iter().for_each(|&cell| observed[cell as usize] += 1);
    // A hundredth of a hit more in each cell: a horizon may cut off a sliver that all points of the quadrature miss.
    let mut expected: Vec<f64> = probabilities.iter().map(|&probability| f64::from(probability) * cells.len() as f64 + 0.01).collect();
    // What a microfacet sends across a horizon is no sample.
    expected.push((cells.len() as f64 - expected.iter().sum::<f64>()).max(0.01));
    chi_square_test(&observed, &expected).p_value
}
