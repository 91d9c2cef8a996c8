// The light that a vertex sends a shadow ray to, and what it brings if it arrives.
//
// Resampled importance sampling: Talbot, Cline and Egbert, "Importance Resampling for Global Illumination", EGSR 2005, section 3, by one
// weighted reservoir as in Bitterli et al., "Spatiotemporal Reservoir Resampling", SIGGRAPH 2020, algorithm 3. `lights.candidates` lights come
// from the alias table of powers, which knows nothing of the vertex; one is kept with a probability in proportion to its contribution
// without shadow, its weight in multiple importance sampling included.
//
// That weight may be any function of the direction as long as those of both techniques add up to 1 (Veach 1997, section 9.2). The
// density of the light that is kept has no closed form; candidates times the density of one stands for it, on both sides.
// Deviations and why: the candidates are not independent. Their first number is stratified and the others are rotated copies, which
// keeps each one's density, all that the estimator's mean depends on, and spreads them over the table.
#ifndef PATHS_LIGHT_CANDIDATES_GLSL
#define PATHS_LIGHT_CANDIDATES_GLSL

#include "lib/bsdf.glsl"
#include "lib/colour.glsl"
#include "lib/lights.glsl"

const uint DIRECT_MIS = 0u;
const uint DIRECT_NEE = 1u;
const uint DIRECT_BSDF = 2u;

/// Lights for each candidate: among few, power alone chooses well.
const uint LIGHTS_PER_CANDIDATE = 4u;
/// Rotations of a candidate's numbers, 2^-24: the powers of the root of x^4 = x + 1 (R3, Roberts 2018).
const vec3 CANDIDATE_ROTATION = vec3(0.81917251, 0.67104360, 0.54970046);

struct ChosenLight {
    vec3 direction;
    float distance;
    /// Over the density and times the weight in multiple importance sampling, before the BSDF.
    vec3 radiance;
    BsdfValue value;
};

float power_heuristic(float a, float b) {
    return a * a / max(a * a + b * b, 1e-30);
}

uint light_candidates() {
    return clamp(frame.light_count / LIGHTS_PER_CANDIDATE, 1u, parameters.light_candidates);
}

/// What light sampling's density counts for against BSDF sampling's.
float competing_pdf(float light_pdf) {
    return light_pdf * float(light_candidates());
}

/// By u: light (2), point on it (2); `apart`: of the lights other than the sole one. False where it brings nothing.
bool light_candidate(vec3 position, Surface surface, vec3 wo, Techniques techniques, vec4 u, bool apart, out ChosenLight light) {
    LightSample found;
    if (!sample_light(position, u, apart, found) || (DIRECT == DIRECT_BSDF && !found.delta)) {
        return false;
    }
    BsdfValue value = evaluate_with(surface, wo, found.direction, techniques);
    float weight = found.delta || DIRECT == DIRECT_NEE ? 1.0 : power_heuristic(competing_pdf(found.pdf), value.pdf);
    light = ChosenLight(found.direction, found.distance, found.radiance * (weight / found.pdf), value);
    return true;
}

/// The sole light, with certainty. False where it brings nothing.
bool choose_sole_light(vec3 position, Surface surface, vec3 wo, out ChosenLight chosen) {
    LightSample found;
    if (!sample_sole_light(position, 1.0, found)) {
        return false;
    }
    BsdfValue value = evaluate_with(surface, wo, found.direction, sampling_techniques(surface, wo));
    chosen = ChosenLight(found.direction, found.distance, found.radiance, value);
    return true;
}

/// By u for the first candidate and `selection` among all, both uniform; `apart`: of the lights other than the sole one. False where no
/// candidate brings anything.
bool choose_light(vec3 position, Surface surface, vec3 wo, vec4 u, float selection, bool apart, out ChosenLight chosen) {
    uint count = light_candidates();
    vec3 albedo = diffuse_albedo(surface);
    Techniques techniques = sampling_techniques(surface, wo);
    float sum = 0.0;
    float kept = 0.0;
    for (uint i = 0u; i < count; i++) {
        vec4 numbers = vec4((float(i) + u.x) / float(count), fract(u.yzw + float(i) * CANDIDATE_ROTATION));
        ChosenLight light;
        if (!light_candidate(position, surface, wo, techniques, numbers, apart, light)) {
            continue;
        }
        float contribution = max_component((albedo * light.value.diffuse + light.value.specular) * light.radiance);
        sum += contribution;
        if (contribution > 0.0 && choose(contribution / sum, selection)) {
            chosen = light;
            kept = contribution;
        }
    }
    if (!(kept > 0.0)) {
        return false;
    }
    chosen.radiance *= sum / (float(count) * kept);
    return true;
}

#endif
