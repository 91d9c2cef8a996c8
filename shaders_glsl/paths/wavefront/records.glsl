// What lies in the buffers of the wavefront path tracer, scalar layout. A slot is a pixel: thread i % 32 of tile i / 32.
#ifndef PATHS_WAVEFRONT_RECORDS_GLSL
#define PATHS_WAVEFRONT_RECORDS_GLSL

#include "accel/ray.glsl"
#include "lib/ray_cone.glsl"
#include "paths/primary.glsl"

/// The scattered ray to be traced, or traced last.
struct StoredRay {
    vec3 origin;
    uint alpha_seed;
    vec3 direction;
    /// Vertices before the origin, filter vertex, delta.
    uint marks;
};

struct StoredWeights {
    vec3 throughput;
    float diffuse_weight;
    vec3 specular_weight;
    float eta_scale;
};

struct StoredFootprint {
    RayCone cone;
    float travelled;
    float pdf;
};

/// Of a Hit after a miss.
const float NOTHING_HIT = -1.0;

/// A shadow ray.
struct StoredShadowRay {
    vec3 origin;
    float t_max;
    vec3 direction;
    uint alpha_seed;
};

/// What it brings.
struct StoredLight {
    vec3 radiance;
    float diffuse_weight;
    vec3 specular_weight;
    /// Where it belongs: light_target.
    uint target;
};

/// A queue has no more slots (queue.glsl), and a list no more than 16 vertices.
const int SLOT_BITS = 24;
const int TERM_BITS = 2;

/// Its path's slot, the term, and the length of the path's list, whose last vertex TERM_BEHIND is about.
uint light_target(uint slot, uint term, uint vertices) {
    return slot | term << SLOT_BITS | vertices << (SLOT_BITS + TERM_BITS);
}

uint target_slot(uint target) {
    return bitfieldExtract(target, 0, SLOT_BITS);
}

uint target_term(uint target) {
    return bitfieldExtract(target, SLOT_BITS, TERM_BITS);
}

uint target_vertices(uint target) {
    return target >> (SLOT_BITS + TERM_BITS);
}

/// Terms in front of the filter vertex, or the sum of all.
struct StoredFront {
    vec3 before;
    vec3 attenuation;
};

/// Terms behind one lobe each.
struct StoredLobes {
    vec3 diffuse;
    vec3 specular;
};

struct StoredVertex {
    vec3 position;
    float travelled;
    vec3 normal;
    vec3 incident;
    uint layer;
};

uvec2 pixel_of_slot(uint slot) {
    return pixel_in_tile(frame.extent.x, slot / 32u, slot % 32u);
}

#endif
