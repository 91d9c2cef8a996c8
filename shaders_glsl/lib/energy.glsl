// The energy that one bounce between microfacets loses, given back.
//
// Single-scattering GGX with F = 1 loses, in a white furnace (on average | seen straight on | at 80 degrees):
//     roughness 0.25: 1.3 % | 0.5 % | 6.7 %    0.5: 12 % | 8.4 % | 16 %    0.75: 36 % | 37 % | 28 %    1: 62 % | 69 % | 48 %
// The loss is returned as a diffuse-like lobe: Kulla and Conty, "Revisiting Physically Based Shading at Imageworks", SIGGRAPH 2017
// course: f = F_ms (1 - E(o)) (1 - E(i)) / (pi (1 - E_avg)), with Favg squared in F_ms as Hill corrected it. It is reciprocal.
//
// The diffuse base of a dielectric gets what reflection leaves, in the same form (Kelemen and Szirmay-Kalos, "A Microfacet Based
// Coupled Specular-Matte BRDF Model", 2001): (1 - R(o)) (1 - R(i)) / (pi (1 - R_avg)) in place of appendix B's 1 - F(V.H), which gains
// energy at grazing angles. A thin wall transmits what its lost lobe does not reflect, 1 - F_ms.
//
// A rough refracting boundary loses L = 1 - E, E being reflection and refraction together, for the index of refraction of either side.
// A share t of it is transmitted as (L_near(o) / pi) (L_far(i) / L_far_avg), the rest is reflected. Reciprocity demands that as much etendue
// crosses both ways: t_near eta_near^2 L_near_avg = t_far eta_far^2 L_far_avg. Fresnel's averages fulfil
// (1 - F_near) eta_near^2 = (1 - F_far) eta_far^2, so t_near = (1 - F_near) L_far_avg / max(L_near_avg, L_far_avg) does it, and is at most 1.
//
// src/paths/energy.rs computes the tables, and states their layout. In a furnace what is left is their interpolation error: within 0.5 %
// from 0 to 86.5 degrees for indices from 1.1 on, 1 to 3 % beyond 89 degrees. Relative indices outside 1/3.1 .. 3.1 are treated as the nearest of these.
#ifndef LIB_ENERGY_GLSL
#define LIB_ENERGY_GLSL

#include "shared/bindings.glsl"
#include "lib/fresnel.glsl"
#include "lib/microfacet.glsl"

const bool COMPENSATE_ENERGY = ENERGY_COMPENSATION == 1u;
/// Without any of these nothing rough reflects, the host makes no tables, and all surfaces are treated as mirrors of their f0 and f90.
const bool ENERGY_TABLES = EFFECT_GLOSSY || EFFECT_ROUGH_TRANSMISSION || EFFECT_CLEARCOAT;

// The same numbers as in src/paths/energy.rs.
const uint COSINES = 32u;
const uint ROUGHNESSES = 32u;
const uint GLASS_COSINES = 26u;
const uint GLASS_ROUGHNESSES = 26u;
const uint GLASS_IORS = 33u;
const float GLASS_IOR_RANGE = 0.7155417528;
const uint AVERAGES = COSINES * ROUGHNESSES;
const uint GLASS = 2u * (AVERAGES + ROUGHNESSES);
const uint GLASS_AVERAGES = GLASS_COSINES * GLASS_ROUGHNESSES * GLASS_IORS;

/// A place between two of `count` nodes of an axis, for x in 0..1: the node below, and how far beyond it.
void axis_place(float x, uint count, out uint node, out float beyond) {
    float place = clamp(x, 0.0, 1.0) * float(count - 1u);
    node = min(uint(place), count - 2u);
    beyond = place - float(node);
}

vec2 ggx_entry(uint entry) {
    FloatBuffer table = FloatBuffer(frame.energy_tables);
    return vec2(table.at[2u * entry], table.at[2u * entry + 1u]);
}

/// Albedo of the GGX reflection lobe for F = 1 in x, for F = Schlick's rise alone in y. Any Schlick F then reflects f0 (x - y) + f90 y.
vec2 reflected_energy(float cosine, float alpha) {
    if (!ENERGY_TABLES || alpha < MIRROR_ALPHA) {
        return vec2(1.0, schlick_rise(cosine));
    }
    uint column, row;
    float x, y;
    axis_place(sqrt(max(cosine, 0.0)), COSINES, column, x);
    axis_place(sqrt(alpha), ROUGHNESSES, row, y);
    uint at = row * COSINES + column;
    return mix(mix(ggx_entry(at), ggx_entry(at + 1u), x), mix(ggx_entry(at + COSINES), ggx_entry(at + COSINES + 1u), x), y);
}

/// Its average over cosine-weighted directions.
vec2 average_reflected_energy(float alpha) {
    if (!ENERGY_TABLES || alpha < MIRROR_ALPHA) {
        return vec2(1.0, 1.0 / 21.0);
    }
    uint row;
    float y;
    axis_place(sqrt(alpha), ROUGHNESSES, row, y);
    return mix(ggx_entry(AVERAGES + row), ggx_entry(AVERAGES + row + 1u), y);
}

/// reflected_energy for both directions, and their average.
struct GgxEnergy {
    vec2 o;
    vec2 i;
    vec2 average;
};

GgxEnergy ggx_energy(float alpha, float cos_o, float cos_i) {
    return GgxEnergy(reflected_energy(cos_o, alpha), reflected_energy(cos_i, alpha), average_reflected_energy(alpha));
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
    vec3 single = vec3(e.o.x, e.i.x, e.average.x);
    vec3 rise = vec3(e.o.y, e.i.y, e.average.y);
    float multiple = multiple_fresnel(vec3(f0), f90, e.average.x).x;
    vec3 left = 1.0 - (f0 * (single - rise) + f90 * rise + multiple * (1.0 - single));
    return left.z > 1e-4 ? max(left.x, 0.0) * max(left.y, 0.0) / left.z : 0.0;
}

/// 1 - (k0 + k1 f0 + k2 f90) of a boundary's table entry.
float glass_entry(uint entry, vec3 weights) {
    FloatBuffer table = FloatBuffer(frame.energy_tables);
    uint at = GLASS + 3u * entry;
    return max(1.0 - dot(vec3(table.at[at], table.at[at + 1u], table.at[at + 2u]), weights), 0.0);
}

/// Signed square root of (eta - 1) / (eta + 1), from -range..range to 0..1.
float glass_ior_axis(float eta) {
    float r = (eta - 1.0) / (eta + 1.0);
    return 0.5 + 0.5 / GLASS_IOR_RANGE * sign(r) * sqrt(abs(r));
}

/// What a refracting boundary loses of light from a direction (x), and on average (y). `weights`: 1, f0, f90.
vec2 glass_loss(float cosine, float alpha, float eta, vec3 weights) {
    uint column, row, layer;
    float x, y, z;
    axis_place(sqrt(max(cosine, 0.0)), GLASS_COSINES, column, x);
    axis_place(sqrt(alpha), GLASS_ROUGHNESSES, row, y);
    axis_place(glass_ior_axis(eta), GLASS_IORS, layer, z);
    vec2 loss = vec2(0.0);
    [[dont_unroll]] for (uint corner = 0u; corner < 4u; corner++) {
        uint r = row + (corner & 1u);
        uint l = layer + (corner >> 1);
        float weight = ((corner & 1u) != 0u ? y : 1.0 - y) * ((corner >> 1) != 0u ? z : 1.0 - z);
        uint line = l * GLASS_ROUGHNESSES + r;
        uint at = line * GLASS_COSINES + column;
        loss += weight * vec2(mix(glass_entry(at, weights), glass_entry(at + 1u, weights), x), glass_entry(GLASS_AVERAGES + line, weights));
    }
    return loss;
}

/// 1 - the hemispherical average of Fresnel's reflectance, seen from the near side: fit of Kulla and Conty for eta >= 1; from the denser
/// side the etendue's ratio gives it.
float average_transmittance(float eta) {
    float dense = max(eta, 1.0 / eta);
    float from_rare = 1.0 - (dense - 1.0) / (4.08567 + 1.00071 * dense);
    return eta >= 1.0 ? from_rare : from_rare / (dense * dense);
}

/// The lobes of a refracting boundary's lost energy, 1/sr, reflected (x) and transmitted (y), `cos_i` being on the respective side.
vec2 lost_glass_lobes(float alpha, float eta, float f0, float f90, float cos_o, float cos_i) {
    if (!EFFECT_ROUGH_TRANSMISSION || alpha < MIRROR_ALPHA) {
        return vec2(0.0);
    }
    vec3 weights = vec3(1.0, f0, f90);
    vec2 o = vec2(0.0), i_near = vec2(0.0), i_far = vec2(0.0);
    // A loop, so that drivers that inline everything compile the look-up once.
    [[dont_unroll]] for (uint k = 0u; k < 3u; k++) {
        vec2 loss = glass_loss(k == 0u ? cos_o : cos_i, alpha, k == 2u ? 1.0 / eta : eta, weights);
        o = k == 0u ? loss : o;
        i_near = k == 1u ? loss : i_near;
        i_far = loss;
    }
    float transmitted = average_transmittance(eta) * i_far.y / max(max(o.y, i_far.y), 1e-6);
    vec2 shape = vec2(i_near.x, i_far.x) / max(vec2(i_near.y, i_far.y), 1e-6);
    return INV_PI * o.x * shape * vec2(1.0 - transmitted, transmitted);
}

#endif
