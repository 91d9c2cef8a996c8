// Isotropic GGX: distribution, Smith visibility, sampling of visible normals. Directions with a `_local` frame have
// the shading normal along +z; the other functions take the cosines they need.
//
// Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007 (distribution: equation 33; half vectors and
// their Jacobians: section 4). Heitz, "Understanding the Masking-Shadowing Function", JCGT 3(2), 2014 (equations 72 and 99). Visible
// normals: Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023. For reflection: Eto and Tokuyoshi, "Bounded
// VNDF Sampling for Smith-GGX Reflections", SIGGRAPH Asia 2023 (equations 5 and 6, listings 1 and 2).
//
// Deviations and why: sin^2 of the half vector is taken from the cross product, not 1 - cos^2, which has no digits left below alpha 0.01.
// Masking and shadowing are separable in the plain model, since glTF 2.0 appendix B.3.2 states their product, and height-correlated,
// which is the more accurate form and what the tables hold, with ENERGY_COMPENSATION. Refraction uses the same term as reflection.
#ifndef LIB_MICROFACET_GLSL
#define LIB_MICROFACET_GLSL

#include "lib/constants.glsl"
#include "shared/parameters.glsl"

/// Below this alpha (roughness 0.032) a lobe is a mirror: it is narrower than a tenth of a degree, and single precision cannot tell
/// its directions apart. src/scene/effects.rs classifies materials with the same number.
const float MIRROR_ALPHA = 1e-3;

/// GGX density of normals at `h`, 1/sr. Both unit.
float ggx_distribution(float alpha, vec3 normal, vec3 h) {
    float cosine = dot(normal, h);
    if (cosine <= 0.0) {
        return 0.0;
    }
    vec3 across = cross(normal, h);
    float a2 = alpha * alpha;
    float d = dot(across, across) + a2 * cosine * cosine;
    return a2 / (PI * d * d);
}

/// cos * sqrt(1 + alpha^2 tan^2): the length of a direction stretched by alpha, Heitz 2018.
float stretched_length(float alpha, float cosine) {
    return sqrt(alpha * alpha * (1.0 - cosine * cosine) + cosine * cosine);
}

/// Smith G2 / (4 cos_o cos_i), for positive cosines.
float smith_visibility(float alpha, float cos_o, float cos_i) {
    float length_o = stretched_length(alpha, cos_o);
    float length_i = stretched_length(alpha, cos_i);
    if (ENERGY_COMPENSATION == 0u) {
        return 1.0 / max((cos_o + length_o) * (cos_i + length_i), 1e-20);
    }
    return 0.5 / max(cos_i * length_o + cos_o * length_i, 1e-20);
}

/// Equation 5: how far the cap of visible normals reaches if only those that reflect upwards are wanted; 1 keeps all.
float reflection_bound(float alpha, float cos_o) {
    float s = 1.0 + sqrt(max(0.0, 1.0 - cos_o * cos_o));
    float a2 = alpha * alpha;
    return (1.0 - a2) * s * s / (s * s + a2 * cos_o * cos_o);
}

/// A normal visible from `wo_local`; `bound` is 1 for all of them (refraction), or reflection_bound.
vec3 sample_visible_normal(vec3 wo_local, float alpha, float bound, vec2 u) {
    vec3 stretched = normalize(vec3(alpha * wo_local.xy, wo_local.z));
    float phi = 2.0 * PI * u.x;
    float lower = bound * stretched.z;
    float z = (1.0 - u.y) * (1.0 + lower) - lower;
    vec3 cap = vec3(sqrt(max(0.0, (1.0 - z) * (1.0 + z))) * vec2(cos(phi), sin(phi)), z);
    vec3 h = cap + stretched;
    return normalize(vec3(alpha * h.xy, max(h.z, 1e-7)));
}

/// Density, 1/sr, of the direction that `wo` is reflected to by a normal sampled with that bound. `distribution`: ggx_distribution there.
float reflection_pdf(float distribution, float alpha, float bound, float cos_o) {
    return distribution / (2.0 * (bound * cos_o + stretched_length(alpha, cos_o)));
}

/// Density, 1/sr, of the direction that `wo` is refracted to; `oh`, `ih`: cosines with the half vector, ih negative.
float refraction_pdf(float distribution, float alpha, float cos_o, float oh, float ih, float eta) {
    float visible = 2.0 * distribution * oh / (cos_o + stretched_length(alpha, cos_o));
    float scale = oh + eta * ih;
    return visible * eta * eta * abs(ih) / (scale * scale);
}

/// The microfacet normal, on the side of `normal`, that refracts `wo` to `wi`.
vec3 refraction_half_vector(vec3 wo, vec3 wi, vec3 normal, float eta) {
    vec3 h = normalize(wo + eta * wi);
    return dot(h, normal) < 0.0 ? -h : h;
}

#endif
