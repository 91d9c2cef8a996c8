// The surface model's parameters: glTF 2.0 appendix B metallic-roughness with KHR_materials_specular, _ior, _transmission, _volume and
// _clearcoat, seen from one side.
//
// It is a mixture of three: a metal (weight metallic), an opaque dielectric with a diffuse base (1 - metallic)(1 - transmission), and
// a glass (1 - metallic) transmission, all reflecting by the same GGX normals, under a clearcoat.
#ifndef LIB_SURFACE_GLSL
#define LIB_SURFACE_GLSL

#include "shared/effects.glsl"
#include "lib/colour.glsl"
#include "lib/fresnel.glsl"
#include "lib/microfacet.glsl"

/// Which lobes of a surface count.
const uint PART_WHOLE = 0u;
const uint PART_DIFFUSE = 1u;
/// All but the diffuse one.
const uint PART_SPECULAR = 2u;

struct Surface {
    /// Unit, on the side of the viewer.
    vec3 geometric_normal_ws;
    /// Unit, visible to the viewer (visible_normal of lib/frame.glsl).
    vec3 normal_ws;
    vec3 clearcoat_normal_ws;
    /// Linear, 0..1.
    vec3 base_color;
    float metallic;
    /// roughness^2.
    float alpha;
    /// Reflectance of the dielectric at normal incidence: min(f0_from_ior(ior) * specular colour, 1) * specular.
    vec3 dielectric_f0;
    /// And at grazing: specular.
    float dielectric_f90;
    float transmission;
    /// Index of refraction of the far side over the viewer's side (relative_ior). Of no effect where thin.
    float eta;
    /// Light passes unrefracted (KHR_materials_volume's thickness 0).
    bool thin;
    /// 0 on the inner side of a volume.
    float clearcoat;
    float clearcoat_alpha;
    /// PART_*: what is evaluated and sampled; their values add up to the whole's.
    uint part;
};

/// White Lambert without reflection.
Surface surface_default(vec3 normal_ws) {
    return Surface(normal_ws, normal_ws, normal_ws, vec3(1.0), 0.0, 1.0, vec3(0.0), 0.0, 0.0, 1.0, true, 0.0, 0.0, PART_WHOLE);
}

const bool EFFECT_TRANSMISSION = EFFECT_SMOOTH_TRANSMISSION || EFFECT_ROUGH_TRANSMISSION;
const bool EFFECT_REFLECTION = EFFECT_GLOSSY || EFFECT_MIRROR || EFFECT_TRANSMISSION;

float glass_part(Surface s) {
    return EFFECT_TRANSMISSION ? (1.0 - s.metallic) * s.transmission : 0.0;
}

float opaque_part(Surface s) {
    return (1.0 - s.metallic) - glass_part(s);
}

/// What the diffuse lobe's values are to be multiplied by. 0 for a metal and for full transmission.
vec3 diffuse_albedo(Surface s) {
    return s.base_color * opaque_part(s);
}

/// Below its clearcoat it has another lobe than the diffuse one. Where it has none, microfacets and their tables are left alone: a tenth of a
/// frame of the hall, which evaluates every candidate light.
bool reflects(Surface s) {
    return EFFECT_REFLECTION && (s.metallic > 0.0 || s.transmission > 0.0 || s.dielectric_f90 > 0.0);
}

/// Metal and opaque dielectric reflect as mirrors.
bool reflection_is_delta(Surface s) {
    return EFFECT_MIRROR && (!EFFECT_GLOSSY || s.alpha < MIRROR_ALPHA);
}

/// The glass reflects and transmits in single directions: it is smooth, or does not bend light.
bool glass_is_delta(Surface s) {
    bool straight = !s.thin && abs(s.eta - 1.0) < LEAST_REFRACTION;
    return EFFECT_SMOOTH_TRANSMISSION && (!EFFECT_ROUGH_TRANSMISSION || s.alpha < MIRROR_ALPHA || straight);
}

bool clearcoat_is_delta(Surface s) {
    return s.clearcoat_alpha < MIRROR_ALPHA;
}

/// Of the lobes other than the diffuse one.
float least_alpha(Surface s) {
    return s.clearcoat > 0.0 ? min(s.alpha, s.clearcoat_alpha) : s.alpha;
}

/// Of the lobes other than the diffuse one together, seen head on; 0..2.
vec3 specular_colour(Surface s) {
    vec3 opaque = s.metallic * s.base_color + opaque_part(s) * s.dielectric_f0;
    return opaque + glass_part(s) * s.base_color + s.clearcoat;
}

/// It has lobes other than the diffuse one, none of them of a single direction.
bool is_glossy(Surface s) {
    bool delta = reflection_is_delta(s) || glass_part(s) > 0.0 && glass_is_delta(s) || s.clearcoat > 0.0 && clearcoat_is_delta(s);
    return (reflects(s) || EFFECT_REFLECTION && s.clearcoat > 0.0) && !delta;
}

/// Reflectance of the opaque dielectric at a microfacet.
vec3 dielectric_fresnel(Surface s, float cosine) {
    return mix(s.dielectric_f0, vec3(s.dielectric_f90), schlick_rise(cosine));
}

/// Reflectance of metal and opaque dielectric at a microfacet, by their parts.
vec3 opaque_fresnel(Surface s, float cosine) {
    return s.metallic * mix(s.base_color, vec3(1.0), schlick_rise(cosine)) + opaque_part(s) * dielectric_fresnel(s, cosine);
}

/// Reflectance of the glass at a microfacet, not scaled by its part. What it leaves, 1 - its greatest component, is transmitted.
vec3 glass_fresnel(Surface s, float cosine) {
    if (s.thin) {
        return dielectric_fresnel(s, cosine);
    }
    float rise = dielectric_rise(cosine, s.eta);
    return rise >= 1.0 ? vec3(1.0) : clamp(mix(s.dielectric_f0, vec3(s.dielectric_f90), rise), 0.0, 1.0);
}

/// KHR_materials_clearcoat: Schlick with ior 1.5, times the coat's weight.
float clearcoat_fresnel(Surface s, float cosine) {
    return s.clearcoat * mix(0.04, 1.0, schlick_rise(cosine));
}

#endif
