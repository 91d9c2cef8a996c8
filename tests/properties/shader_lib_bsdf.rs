//! lib/bsdf.glsl against the equations that it states, in double precision, and what must hold on every surface.

use crate::common;
use crate::surface::{CASE, Case, options};
use bytemuck::{Pod, Zeroable};
use glam::DVec3;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use std::f64::consts::PI;

/// The case's pair of directions evaluated, a direction sampled, and that direction evaluated.
const KERNEL: &str = "
struct In { Case c; };
struct Out {
    float diffuse; vec3 specular; float pdf; vec3 albedo;
    uint valid; vec3 direction; float diffuse_weight; vec3 specular_weight; float sample_pdf; uint delta; float eta;
    float again_diffuse; vec3 again_specular; float again_pdf;
};
void kernel(uint i) {
    Surface s = surface_of(inputs[i].c);
    BsdfValue v = bsdf_evaluate(s, inputs[i].c.wo, inputs[i].c.wi);
    BsdfSample r;
    uint valid = bsdf_sample(s, inputs[i].c.wo, inputs[i].c.u, r) ? 1u : 0u;
    BsdfValue w = bsdf_evaluate(s, inputs[i].c.wo, r.direction);
    outputs[i] = Out(v.diffuse, v.specular, v.pdf, diffuse_albedo(s), valid, r.direction, r.diffuse_weight, r.specular_weight, r.pdf,
        r.delta ? 1u : 0u, r.eta, w.diffuse, w.specular, w.pdf);
}
";

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
struct Out {
    diffuse: f32,
    specular: [f32; 3],
    pdf: f32,
    albedo: [f32; 3],
    valid: u32,
    direction: [f32; 3],
    diffuse_weight: f32,
    specular_weight: [f32; 3],
    sample_pdf: f32,
    delta: u32,
    eta: f32,
    again_diffuse: f32,
    again_specular: [f32; 3],
    again_pdf: f32,
}

impl Out {
    /// f cos of the case's directions.
    fn value(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| f64::from(self.albedo[k]) * f64::from(self.diffuse) + f64::from(self.specular[k]))
    }

    /// What goes into a picture.
    fn radiance_terms(&self) -> impl Iterator<Item = f32> {
        let singles = [self.diffuse, self.pdf, self.diffuse_weight, self.sample_pdf, self.eta];
        singles.into_iter().chain(self.specular).chain(self.specular_weight).chain(self.direction).chain(self.albedo)
    }
}

fn run(cases: &[Case], compensated: bool) -> Vec<Out> {
    run_with(cases, compensated, &[])
}

fn run_with(cases: &[Case], compensated: bool, constants: &[(u32, u32)]) -> Vec<Out> {
    let gpu = common::gpu();
    let (mut options, _tables) = options(&gpu, compensated);
    options.constants.extend(constants);
    common::run_kernel_with(&gpu, &format!("{CASE}{KERNEL}"), cases, &options)
}

/// Uniform on the sphere.
fn direction(rng: &mut Pcg32) -> DVec3 {
    let (z, phi) = (rng.random_range(-1.0..1.0f64), rng.random_range(0.0..2.0 * PI));
    DVec3::new((1.0 - z * z).sqrt() * phi.cos(), (1.0 - z * z).sqrt() * phi.sin(), z)
}

/// Any surface, without clearcoat, above which the viewer is.
fn random_case(rng: &mut Pcg32) -> Case {
    let channel = |rng: &mut Pcg32| [0; 3].map(|_| rng.random_range(0.0..1.0f32));
    let pick = |rng: &mut Pcg32, ends: [f32; 2]| match rng.random_range(0..4) {
        0 => ends[0],
        1 => ends[1],
        _ => rng.random_range(ends[0]..ends[1]),
    };
    let mut wo = direction(rng);
    wo.z = wo.z.abs();
    Case {
        base_color: channel(rng),
        metallic: pick(rng, [0.0, 1.0]),
        roughness: rng.random_range(0.15..1.0),
        ior: rng.random_range(1.05..2.5),
        specular: pick(rng, [0.0, 1.0]),
        specular_color: channel(rng),
        transmission: pick(rng, [0.0, 1.0]),
        thin: rng.random_range(0..2),
        inside: rng.random_range(0..2),
        wo: wo.as_vec3().to_array(),
        wi: direction(rng).as_vec3().to_array(),
        u: channel(rng),
        ..Case::default()
    }
}

fn random_cases(seed: u64, count: usize) -> Vec<Case> {
    let mut rng = Pcg32::seed_from_u64(seed);
    (0..count).map(|_| random_case(&mut rng)).collect()
}

/// The plain model, f cos, from its definition.
mod appendix_b {
    use super::*;

    fn schlick(f0: f64, f90: f64, cosine: f64) -> f64 {
        f0 + (f90 - f0) * (1.0 - cosine).powi(5)
    }

    fn distribution(alpha: f64, h: DVec3) -> f64 {
        let a2 = alpha * alpha;
        if h.z > 0.0 { a2 / (PI * (h.z * h.z * (a2 - 1.0) + 1.0).powi(2)) } else { 0.0 }
    }

    /// Smith's G2, separable (B.3.2).
    fn masking(alpha: f64, cosines: [f64; 2]) -> f64 {
        let lambda = |cosine: f64| 0.5 * ((1.0 + alpha * alpha * (1.0 / (cosine * cosine) - 1.0)).sqrt() - 1.0);
        1.0 / ((1.0 + lambda(cosines[0])) * (1.0 + lambda(cosines[1])))
    }

    /// Unpolarised, by the cosines of Snell's law.
    fn dielectric(cosine: f64, eta: f64) -> f64 {
        let sin2 = (1.0 - cosine * cosine) / (eta * eta);
        if sin2 >= 1.0 {
            return 1.0;
        }
        let transmitted = (1.0 - sin2).sqrt();
        let ratio = |a: f64, b: f64| ((a - b) / (a + b)).powi(2);
        0.5 * (ratio(cosine, eta * transmitted) + ratio(eta * cosine, transmitted))
    }

    struct Parameters {
        alpha: f64,
        metallic: f64,
        transmission: f64,
        specular: f64,
        base: [f64; 3],
        f0: [f64; 3],
        eta: f64,
        thin: bool,
    }

    impl Parameters {
        fn glass_fresnel(&self, cosine: f64) -> [f64; 3] {
            if self.thin {
                return self.f0.map(|f0| schlick(f0, self.specular, cosine));
            }
            let f = dielectric(cosine, self.eta);
            let normal = dielectric(1.0, self.eta);
            let rise = (f - normal) / (1.0 - normal);
            self.f0.map(|f0| if f == 1.0 { 1.0 } else { (f0 + (self.specular - f0) * rise).clamp(0.0, 1.0) })
        }
    }

    fn parameters(case: &Case) -> Parameters {
        let ior = f64::from(case.ior);
        let reflectance = ((1.0 - ior) / (1.0 + ior)).powi(2);
        let specular = f64::from(case.specular);
        Parameters {
            alpha: f64::from(case.roughness).powi(2),
            metallic: case.metallic.into(),
            transmission: case.transmission.into(),
            specular,
            base: case.base_color.map(f64::from),
            f0: case.specular_color.map(|color| (reflectance * f64::from(color)).min(1.0) * specular),
            eta: if case.inside == 0 { ior } else { 1.0 / ior },
            thin: case.thin == 1,
        }
    }

    /// Around the normal +z.
    pub fn value(case: &Case) -> [f64; 3] {
        let p = parameters(case);
        let [wo, wi] = [case.wo, case.wi].map(|v| DVec3::from_array(v.map(f64::from)));
        if wi.z > 0.0 { reflection(&p, wo, wi) } else { transmission(&p, wo, wi) }
    }

    fn reflection(p: &Parameters, wo: DVec3, wi: DVec3) -> [f64; 3] {
        let h = (wo + wi).normalize();
        let vh = wo.dot(h);
        let specular = distribution(p.alpha, h) * masking(p.alpha, [wo.z, wi.z]) / (4.0 * wo.z * wi.z);
        let dielectric = p.f0.map(|f0| schlick(f0, p.specular, vh));
        let left = 1.0 - dielectric.into_iter().fold(0.0, f64::max);
        let glass = p.glass_fresnel(vh);
        [0, 1, 2].map(|k| {
            let metal = specular * schlick(p.base[k], 1.0, vh);
            let opaque = left * p.base[k] / PI + specular * dielectric[k];
            let glass = specular * glass[k];
            wi.z * (p.metallic * metal + (1.0 - p.metallic) * ((1.0 - p.transmission) * opaque + p.transmission * glass))
        })
    }

    fn transmission(p: &Parameters, wo: DVec3, wi: DVec3) -> [f64; 3] {
        let mirrored = DVec3::new(wi.x, wi.y, -wi.z);
        let h = if p.thin { (wo + mirrored).normalize() } else { (wo + p.eta * wi).normalize() };
        let h = if h.z < 0.0 { -h } else { h };
        let (oh, ih) = (wo.dot(h), wi.dot(h));
        let common = distribution(p.alpha, h) * masking(p.alpha, [wo.z, -wi.z]);
        let lobe = match p.thin {
            true => common / (4.0 * wo.z * -wi.z),
            false if oh <= 0.0 || ih >= 0.0 => 0.0,
            // Walter et al., equation 21, for radiance: without the numerator's eta^2.
            false => oh * -ih * common / (wo.z * -wi.z * (oh + p.eta * ih).powi(2)),
        };
        let passed = 1.0 - p.glass_fresnel(oh.abs()).into_iter().fold(0.0, f64::max);
        [0, 1, 2].map(|k| -wi.z * (1.0 - p.metallic) * p.transmission * passed * lobe * p.base[k])
    }
}

#[test]
fn the_plain_model_is_that_of_gltf_appendix_b() {
    let cases = random_cases(1, 200_000);
    let mut lit = [0; 2];
    for (case, out) in cases.iter().zip(run(&cases, false)) {
        let expected = appendix_b::value(case);
        lit[usize::from(case.wi[2] < 0.0)] += usize::from(expected[0] > 1e-3);
        for (value, expected) in out.value().into_iter().zip(expected) {
            // Near the tail of a narrow refraction the half vector, normalised in single precision, costs three digits.
            assert!((value - expected).abs() <= 2e-3 * expected + 1e-5, "{value} for {expected}: {case:?}");
        }
    }
    assert!(lit.iter().all(|&count| count > 10_000), "{lit:?}: the test saw too little light");
}

#[test]
fn reflection_and_thin_transmission_are_reciprocal() {
    let mut cases = random_cases(2, 50_000);
    cases.iter_mut().for_each(|case| case.thin |= u32::from(case.wi[2] < 0.0));
    // Through a thin wall the other side's viewer looks the other way.
    let swapped = |case: &Case| {
        let side = if case.wi[2] < 0.0 { -1.0 } else { 1.0 };
        let normal = [0.0, 0.0, side];
        Case { wo: case.wi, wi: case.wo, normal, geometric_normal: normal, ..*case }
    };
    let back: Vec<Case> = cases.iter().map(swapped).collect();
    for compensated in [false, true] {
        for ((there, again), case) in run(&cases, compensated).iter().zip(run(&back, compensated)).zip(&cases) {
            for (a, b) in there.value().into_iter().zip(again.value()) {
                let (a, b) = (a / f64::from(case.wi[2].abs()), b / f64::from(case.wo[2]));
                assert!((a - b).abs() <= 1e-3 * a.max(b) + 1e-5, "{a} and {b}: {case:?}");
            }
        }
    }
}

/// Radiance that crosses a boundary is scaled by the squared ratio of the indices.
#[test]
fn refraction_is_reciprocal_up_to_eta_squared() {
    let mut cases = random_cases(3, 50_000);
    for case in &mut cases {
        (case.thin, case.transmission, case.metallic) = (0, 1.0, 0.0);
        case.wi[2] = -case.wi[2].abs();
    }
    let normal = [0.0, 0.0, -1.0];
    let swapped = |case: &Case| Case { wo: case.wi, wi: case.wo, inside: 1 - case.inside, normal, geometric_normal: normal, ..*case };
    let back: Vec<Case> = cases.iter().map(swapped).collect();
    for compensated in [false, true] {
        let mut lit = 0;
        for ((there, again), case) in run(&cases, compensated).iter().zip(run(&back, compensated)).zip(&cases) {
            let eta = f64::from(if case.inside == 0 { case.ior } else { 1.0 / case.ior });
            let (a, b) = (eta * eta * there.value()[0] / f64::from(-case.wi[2]), again.value()[0] / f64::from(case.wo[2]));
            lit += usize::from(a > 1e-3);
            // At the critical angle what passes grows as a square root: 1e-7 in a cosine is 3e-4 in the value.
            assert!((a - b).abs() <= 5e-3 * a.max(b) + 3e-4, "{a} and {b}: {case:?}");
        }
        assert!(lit > 10_000, "{lit}: the test saw too little light");
    }
}

#[test]
fn a_sample_weighs_value_over_density_of_its_direction() {
    let cases = random_cases(4, 100_000);
    for compensated in [false, true] {
        let mut valid = 0;
        for (case, out) in cases.iter().zip(run(&cases, compensated)).filter(|(_, out)| out.valid == 1 && out.delta == 0) {
            valid += 1;
            let close = |a: f32, b: f32| (a - b).abs() <= 1e-4 * b.abs() + 1e-6;
            assert!(close(out.sample_pdf, out.again_pdf), "{} and {}: {case:?}", out.sample_pdf, out.again_pdf);
            assert!(close(out.diffuse_weight * out.sample_pdf, out.again_diffuse), "{case:?}");
            for k in 0..3 {
                assert!(close(out.specular_weight[k] * out.sample_pdf, out.again_specular[k]), "{case:?}");
            }
        }
        assert!(valid > 70_000, "{valid} samples are valid");
    }
}

/// Interpolated and mapped normals that disagree with the triangle's: light neither passes through an opaque surface, nor is there a
/// sample of a direction on the wrong side.
#[test]
fn nothing_leaks_where_normals_disagree() {
    let mut rng = Pcg32::seed_from_u64(5);
    let mut cases = random_cases(5, 100_000);
    for case in &mut cases {
        case.clearcoat = 0.5;
        case.clearcoat_roughness = 0.3;
        case.normal = (DVec3::Z + 0.9 * direction(&mut rng)).normalize().as_vec3().to_array();
    }
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    for (case, out) in cases.iter().zip(run(&cases, true)) {
        let agree = dot(case.wi, case.normal) * case.wi[2] > 0.0;
        let lit = out.diffuse > 0.0 || out.specular.iter().any(|&v| v > 0.0);
        assert!(agree || !lit, "{out:?}: {case:?}");
        let through = case.transmission > 0.0 && case.metallic < 1.0;
        assert!(through || !lit || case.wi[2] > 0.0, "{out:?}: {case:?}");
        if out.valid == 1 {
            assert!(dot(out.direction, case.normal) * out.direction[2] > 0.0, "{out:?}: {case:?}");
            assert!(through || out.direction[2] > 0.0, "{out:?}: {case:?}");
        }
    }
}

#[test]
fn without_specular_a_dielectric_is_lambert_to_the_last_bit() {
    let mut cases = random_cases(6, 1000);
    for case in &mut cases {
        (case.metallic, case.transmission, case.specular) = (0.0, 0.0, 0.0);
        case.wi[2] = case.wi[2].abs();
    }
    for compensated in [false, true] {
        for (case, out) in cases.iter().zip(run(&cases, compensated)) {
            assert_eq!(out.specular, [0.0; 3]);
            assert!((out.diffuse - std::f32::consts::FRAC_1_PI * case.wi[2]).abs() <= f32::EPSILON * out.diffuse, "{out:?}");
            assert_eq!(out.albedo, case.base_color);
        }
    }
}

/// Numbers that files may hold: every combination of the ends of each range, seen and lit from everywhere.
fn extreme_cases() -> Vec<Case> {
    let grazing = 1e-6f32;
    let directions = [[0.0, 0.0, 1.0], [1.0, 0.0, grazing], [-1.0, 0.0, grazing], [0.8, 0.0, 0.6], [-0.8, 0.0, 0.6]];
    let below = directions.map(|[x, y, z]| [x, y, -z]);
    let mut rng = Pcg32::seed_from_u64(7);
    let mut cases = Vec::new();
    for roughness in [0.0, 0.0316, 0.032, 0.05, 1.0] {
        for ior in [0.0, 1.0, 1.0005, 1.5, 100.0] {
            for bits in 0..128u32 {
                let bit = |k: u32| (bits >> k & 1) as f32;
                let wo = directions[rng.random_range(0..5)];
                let wi = if rng.random_range(0..2) == 0 { directions[rng.random_range(0..5)] } else { below[rng.random_range(0..5)] };
                let edge = |rng: &mut Pcg32| [0.0, 0.5, 0.999_999_94][rng.random_range(0..3)];
                cases.push(Case {
                    base_color: [bit(0); 3],
                    metallic: bit(1),
                    roughness,
                    ior,
                    specular: bit(2),
                    specular_color: [1000.0 * bit(3), 1.0, 0.0],
                    transmission: bit(4),
                    thin: bits >> 5 & 1,
                    inside: bits >> 6,
                    clearcoat: bit(3),
                    clearcoat_roughness: roughness,
                    wo,
                    wi,
                    u: [edge(&mut rng), edge(&mut rng), edge(&mut rng)],
                    ..Case::default()
                });
            }
        }
    }
    cases
}

#[test]
fn extremes_give_finite_values_and_unit_directions() {
    let cases = extreme_cases();
    for compensated in [false, true] {
        for (case, out) in cases.iter().zip(run(&cases, compensated)) {
            assert!(out.radiance_terms().all(f32::is_finite), "{out:?}: {case:?}");
            let negative = [out.diffuse, out.pdf, out.diffuse_weight].into_iter().chain(out.specular).chain(out.specular_weight);
            assert!(negative.into_iter().all(|value| value >= 0.0), "{out:?}: {case:?}");
            let [x, y, z] = out.direction;
            assert!((x * x + y * y + z * z - 1.0).abs() < 1e-5, "{out:?}: {case:?}");
        }
    }
}

/// What a scene does not call for is compiled away, and changes nothing: constants 0 to 4 are the effects from glossy to clearcoat.
#[test]
fn effects_that_a_surface_does_not_call_for_change_nothing() {
    let off = |effects: &[u32]| effects.iter().map(|&id| (id, 0)).collect::<Vec<_>>();
    let rough = |case: &Case| Case { roughness: case.roughness.max(0.1), ..*case };
    type Surfaces = fn(&Case) -> Case;
    let families: [(Surfaces, &[u32]); 4] = [
        (|case| Case { metallic: 0.0, transmission: 0.0, specular: 0.0, ..*case }, &[0, 1, 2, 3, 4]),
        (|case| Case { transmission: 0.0, ..*case }, &[1, 2, 3, 4]),
        (|case| Case { transmission: 0.0, roughness: 0.0, ..*case }, &[0, 2, 3, 4]),
        (|case| Case { transmission: 1.0, metallic: 0.0, ..*case }, &[0, 1, 2, 4]),
    ];
    let base: Vec<Case> = random_cases(8, 2000).iter().map(rough).collect();
    let cases: Vec<Vec<Case>> = families.iter().map(|(family, _)| base.iter().map(family).collect()).collect();
    let all = run(&cases.concat(), true);
    for (((_, unneeded), cases), all) in families.iter().zip(&cases).zip(all.chunks(base.len())) {
        for ((a, b), case) in all.iter().zip(&run_with(cases, true, &off(unneeded))).zip(cases) {
            assert_eq!((a.valid, a.delta), (b.valid, b.delta), "{case:?}");
            for (a, b) in a.radiance_terms().zip(b.radiance_terms()).filter(|_| a.valid == 1) {
                assert!((a - b).abs() <= 1e-4 * a.abs() + 1e-6, "{a} and {b} without {unneeded:?}: {case:?}");
            }
        }
    }
}
