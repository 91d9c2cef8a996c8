//! A surface as its diffuse lobe alone and as all its others (Surface::part): together they are the whole, in value and in what samples find.

use crate::common;
use crate::surface::{CASE, Case, options};
use bytemuck::{Pod, Zeroable};
use pathspace::metrics::statistics::BatchMeans;

/// Values of one pair of directions, and the mean weight of 2048 samples of a shifted lattice (Roberts' R3, in integers), of one part.
const KERNEL: &str = "
#include \"lib/rng.glsl\"
struct In { Case c; uint part; uint seed; };
struct Out { float diffuse; float specular; float albedo; };
void kernel(uint i) {
    Surface s = surface_of(inputs[i].c);
    s.part = inputs[i].part;
    uvec3 shift = pcg3d(uvec3(inputs[i].seed, inputs[i].part, 2u));
    float sum = 0.0;
    for (uint k = 0u; k < 2048u; k++) {
        uvec3 bits = shift + k * uvec3(3518319155u, 2882110345u, 2360945575u);
        BsdfSample r;
        if (bsdf_sample(s, inputs[i].c.wo, vec3(unit_float(bits.xy), unit_float(bits.z)), r)) {
            sum += (diffuse_albedo(s).g * r.diffuse_weight + r.specular_weight.g) * r.eta * r.eta;
        }
    }
    BsdfValue v = bsdf_evaluate(s, inputs[i].c.wo, inputs[i].c.wi);
    outputs[i] = Out(v.diffuse, v.specular.g, sum / 2048.0);
}
";

const BATCHES: u32 = 16;

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Input {
    case: Case,
    part: u32,
    seed: u32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Output {
    diffuse: f32,
    specular: f32,
    albedo: f32,
}

fn cases() -> Vec<Case> {
    let plain = [
        Case::dielectric(0.0, 1.5),
        Case::dielectric(0.3, 1.5),
        Case { specular: 0.0, ..Case::dielectric(1.0, 1.5) },
        Case { metallic: 0.5, base_color: [0.9, 0.6, 0.3], ..Case::dielectric(0.4, 1.5) },
        Case { transmission: 0.5, ..Case::dielectric(0.2, 1.5) },
        Case { clearcoat: 1.0, clearcoat_roughness: 0.1, ..Case::dielectric(0.6, 1.5) },
    ];
    let wi = [0.48, 0.6, 0.64];
    plain.into_iter().flat_map(|case| [0.9, 0.3].map(|cosine| Case { wi, ..case }.seen_at(cosine))).collect()
}

/// 24 comparisons of means, each beyond 5 standard errors once in 10^4 with 15 degrees of freedom.
#[test]
fn the_diffuse_lobe_and_the_others_add_up_to_the_surface() {
    let gpu = common::gpu();
    let cases = cases();
    for compensated in [false, true] {
        let (options, _tables) = options(&gpu, compensated);
        let of_case = |&case| (0..3).flat_map(move |part| (0..BATCHES).map(move |seed| Input { case, part, seed }));
        let inputs: Vec<Input> = cases.iter().flat_map(of_case).collect();
        let outputs: Vec<Output> = common::run_kernel_with(&gpu, &format!("{CASE}{KERNEL}"), &inputs, &options);
        for (case, parts) in cases.iter().zip(outputs.chunks(3 * BATCHES as usize)) {
            let [whole, diffuse, specular] = [0, 1, 2].map(|part| &parts[part * BATCHES as usize..][..BATCHES as usize]);
            assert_eq!((diffuse[0].diffuse, diffuse[0].specular), (whole[0].diffuse, 0.0), "{case:?}");
            assert_eq!((specular[0].diffuse, specular[0].specular), (0.0, whole[0].specular), "{case:?}");
            let [w, d, s] = [whole, diffuse, specular].map(|part| part.iter().map(|o| f64::from(o.albedo)).collect::<BatchMeans>());
            let error = [w, d, s].iter().map(BatchMeans::variance_of_mean).sum::<f64>().sqrt();
            assert!((d.mean + s.mean - w.mean).abs() < 5.0 * error + 1e-5, "{case:?}: {} + {} is not {}", d.mean, s.mean, w.mean);
        }
    }
}
