// Evaluation and sampling of lib/surface.glsl's model.
//
// Plain model: glTF 2.0 appendix B.2 and B.3 (metal_brdf, dielectric_brdf, fresnel_mix), KHR_materials_specular (fresnel_mix with weight),
// KHR_materials_transmission (thin-walled BTDF: the reflection lobe mirrored), KHR_materials_volume (refraction: Walter et al. 2007,
// equation 21), KHR_materials_clearcoat (fresnel_coat). With ENERGY_COMPENSATION: lib/energy.glsl.
// Diffuse: Lambert, or Burley, "Physically-Based Shading at Disney", SIGGRAPH 2012 course, section 5.3; compensated: renormalised as in
// Lagarde and de Rousiers, "Moving Frostbite to PBR", 2014, listing 2.
// Separation of the diffuse albedo: Meijer, section 4.1 and algorithm 1.
//
// f cos = diffuse_albedo * diffuse + specular: the diffuse lobe's colour is the caller's to multiply, `specular` holds all else.
// Radiance flows towards `wo`: refraction divides it by eta^2. Lobes of a single direction are sampled, never evaluated.
// A direction counts as reflected or transmitted by the geometric normal, and contributes only if the shading normal agrees: nothing leaks.
//
// Deviations and why: a refracting surface uses the exact Fresnel formula (lib/fresnel.glsl). With compensation the clearcoat takes
// its own directional albedo from the base, not F(N.V); as in the extension the coat's attenuation depends on `wo` alone, so a coated
// surface is not reciprocal.
#ifndef LIB_BSDF_GLSL
#define LIB_BSDF_GLSL

#include "shared/parameters.glsl"
#include "lib/constants.glsl"
#include "lib/energy.glsl"
#include "lib/frame.glsl"
#include "lib/sampling.glsl"
#include "lib/surface.glsl"

const uint LOBE_DIFFUSE = 1u;
const uint LOBE_SPECULAR = 2u;
const uint LOBE_TRANSMISSION = 4u;
const uint LOBE_CLEARCOAT = 8u;

/// Values times |cos|, without lobes of a single direction.
struct BsdfValue {
    /// To be multiplied by diffuse_albedo; 1/sr.
    float diffuse;
    /// Everything else, with its colour; 1/sr.
    vec3 specular;
    /// Density with which bsdf_sample returns this direction, 1/sr.
    float pdf;
};

struct BsdfSample {
    /// Unit.
    vec3 direction;
    /// f cos / pdf = diffuse_albedo * diffuse_weight + specular_weight.
    float diffuse_weight;
    vec3 specular_weight;
    /// 1/sr; the probability itself where delta.
    float pdf;
    /// LOBE_* that proposed the direction. Reflected light lost between microfacets and returned is proposed by LOBE_DIFFUSE.
    uint lobe;
    bool delta;
    /// Far index of refraction over near index where light was refracted, else 1: throughput * eta^2 is what roulette may look at.
    float eta;
};

bool bsdf_sample(Surface s, vec3 wo, vec3 u, out BsdfSample result);
BsdfValue bsdf_evaluate(Surface s, vec3 wo, vec3 wi);

#include "lib/bsdf_evaluate.glsl"
#include "lib/bsdf_sample.glsl"

#endif
