// The energy that one bounce between microfacets loses, given back.
//
// Here the loss 1 - E is returned as a diffuse-like lobe, Kulla and Conty, "Revisiting Physically Based Shading at Imageworks",
// SIGGRAPH 2017 course: f = F_ms (1 - E(o)) (1 - E(i)) / (pi (1 - E_avg)), with F_ms after Hill's correction (F_avg squared).
#ifndef LIB_ENERGY_GLSL
#define LIB_ENERGY_GLSL

#include "shared/bindings.glsl"
#include "lib/fresnel.glsl"
#include "lib/microfacet.glsl"

const bool COMPENSATE_ENERGY = ENERGY_COMPENSATION == 1u;

/// Albedos of the GGX reflection lobe for the two directions and their average: for F = 1 in x, for F = Schlick's rise alone in y. Any
/// Schlick F then reflects f0 (x - y) + f90 y.
struct GgxEnergy {
    vec2 o;
    vec2 i;
    vec2 average;
};

GgxEnergy ggx_energy(float alpha, float cos_o, float cos_i) {
    return GgxEnergy(vec2(1.0, schlick_rise(cos_o)), vec2(1.0, schlick_rise(cos_i)), vec2(1.0, 1.0 / 21.0));
}

/// Share of the lost energy that later bounces reflect: Favg^2 Eavg / (1 - Favg (1 - Eavg)).
vec3 multiple_fresnel(vec3 f0, float f90, float average) {
    vec3 f = f0 + (f90 - f0) / 21.0;
    return f * f * average / (1.0 - f * (1.0 - average));
}

/// The lobe of the lost energy, 1/sr: its albedo is 1 - E(o).
float lost_lobe(GgxEnergy e) {
    return INV_PI * (1.0 - e.o.x) * (1.0 - e.i.x) / max(1.0 - e.average.x, 1e-6);
}

/// What a dielectric's reflection leaves to the diffuse base, for both directions: (1 - R(o)) (1 - R(i)) / (1 - R_avg).
float base_coupling(GgxEnergy e, float f0, float f90) {
    float multiple = multiple_fresnel(vec3(f0), f90, e.average.x).x;
    vec3 single = vec3(e.o.x, e.i.x, e.average.x), rise = vec3(e.o.y, e.i.y, e.average.y);
    vec3 left = 1.0 - (f0 * (single - rise) + f90 * rise + multiple * (1.0 - single));
    return left.z > 1e-4 ? max(left.x, 0.0) * max(left.y, 0.0) / left.z : 0.0;
}

/// A refracting boundary's lost energy, returned: reflected (x) and transmitted (y) lobes, 1/sr. Both for `cos_i` on their own side.
vec2 lost_glass_lobes(float alpha, float eta, float f0, float f90, float cos_o, float cos_i) {
    return vec2(0.0);
}

#endif
