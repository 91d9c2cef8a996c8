// A path's radiance, kept apart at the filter vertex: Meijer, section 4.1, figure 6 and algorithm 1.
//
//   radiance = before + attenuation * (diffuse_direct + diffuse_indirect) + specular_direct + specular_indirect
//
// The filter vertex is the first one with a diffuse lobe (with hpsf.glossy, or a glossy one: filter/hpsf/part.glsl), or, with hpsf.vertex,
// the second or third: final gathering (Binder, figure 10), in which `before` holds what the vertices in front of it send themselves.
// Measured on cornell, 16 paths per pixel: filtering at the second vertex leaves 1/1.7 of the variance of indirect light, 1/2.1 where cells are
// filled before; the rest is the choice of the first vertex' direction, so that the paper's "dramatically" does not hold here. Of the whole
// picture (128x72), relMSE is 0.0027, 0.0043 without a filter, and on the hall 0.066, 0.070.
//
// `before`: emitted or scattered in front of it; and, with lights.sole, what the sole light sends to the first vertex, which has no noise to be
// filtered. `attenuation`: throughput up to it times its diffuse albedo, which is multiplied in nowhere else and divided out nowhere. The
// diffuse terms: what its diffuse lobe receives, direct light and the rest apart, as if its albedo were 1. The specular terms: what its other
// lobes send on, throughput up to it included.
//
// Deviations and why: the algorithm stores one attenuation for diffuse and specular (attenIF) and one radiance after it. Here a
// direction that both lobes could have sampled carries a weight for each, so the sum is the plain path tracer's for every material,
// and the specular part, which depends on the direction, needs no albedo taken out.
#ifndef PATHS_TERMS_GLSL
#define PATHS_TERMS_GLSL

#include "lib/storage.glsl"
#include "shared/parameters.glsl"

/// Where the terms are kept apart.
struct FilterVertex {
    /// Relative to the frame's origin, metres.
    vec3 position;
    /// Shading normal.
    vec3 normal;
    /// Unit, the way the path arrives.
    vec3 incident;
    /// Length of the path up to it, metres; 0 where there is none, EMITS where there is none and what the camera sees is a light.
    float travelled;
    /// Of its other lobes (lib/layer.glsl), where the specular terms may be filtered; else 0.
    uint layer;
};

const float EMITS = -1.0;

struct Terms {
    vec3 before;
    vec3 attenuation;
    vec3 diffuse_direct;
    vec3 diffuse_indirect;
    vec3 specular_direct;
    vec3 specular_indirect;
    FilterVertex vertex;
#ifdef VERTEX_LIST
    /// Vertices of the path's list so far (paths/vertices.glsl).
    uint vertices;
    /// What the last one's diffuse lobe receives, but for what comes through the next one.
    vec3 behind;
    /// Of the first one's radiance on the way to `specular_indirect`.
    vec3 specular_attenuation;
#endif
};

/// Where a contribution belongs.
const uint TERM_BEFORE = 0u;
const uint TERM_DIRECT = 1u;
const uint TERM_INDIRECT = 2u;
/// To the last vertex of the list.
const uint TERM_BEHIND = 3u;

Terms no_terms() {
    FilterVertex none = FilterVertex(vec3(0.0), vec3(0.0), vec3(0.0), 0.0, 0u);
#ifdef VERTEX_LIST
    return Terms(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), none, 0u, vec3(0.0), vec3(0.0));
#else
    return Terms(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), none);
#endif
}

/// Radiance that arrives through the filter vertex's lobes with these weights; in front of it the weights are 0 and 1.
void add_term(inout Terms terms, uint term, float diffuse_weight, vec3 specular_weight, vec3 radiance) {
#ifdef VERTEX_LIST
    if (term == TERM_BEHIND) {
        terms.behind += diffuse_weight * radiance;
        return;
    }
#endif
#ifdef SEPARATE_TERMS
    if (term == TERM_DIRECT) {
        terms.diffuse_direct += diffuse_weight * radiance;
        terms.specular_direct += specular_weight * radiance;
        return;
    }
    if (term == TERM_INDIRECT) {
        terms.diffuse_indirect += diffuse_weight * radiance;
        terms.specular_indirect += specular_weight * radiance;
        return;
    }
#endif
    terms.before += (terms.attenuation * diffuse_weight + specular_weight) * radiance;
}

const uint ALBEDO_DIVIDED = 1u;
/// What is divided by instead of a smaller attenuation.
const float LEAST_DIVISOR = 1e-3;

/// A diffuse term for filters. With paths.albedo divided, as renderers have it that trace reflected radiance and know its albedo only
/// afterwards: their product goes through an image, and is divided by the attenuation. That loses the precision of small products, and all
/// of a channel that the surface does not reflect, although its neighbours might (Meijer, section 4.1). display/composite multiplies again.
vec3 received(vec3 diffuse, vec3 attenuation) {
    return ALBEDO == ALBEDO_DIVIDED ? stored(attenuation * diffuse) / max(attenuation, LEAST_DIVISOR) : diffuse;
}

/// What to put out. A sample with a value that is not a number is no sample: it must not enter a history.
vec4 finite_or_black(vec3 value) {
    bool finite = !any(isnan(value)) && !any(isinf(value));
    return storable(vec4(finite ? value : vec3(0.0), finite ? 1.0 : 0.0));
}

#endif
