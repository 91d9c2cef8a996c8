// Where the light of the wavefront's paths adds up, term by term. Only one thread has a path in each turn.
#ifndef PATHS_WAVEFRONT_SUMS_GLSL
#define PATHS_WAVEFRONT_SUMS_GLSL

#include "paths/terms.glsl"
#include "paths/vertex_light.glsl"
#include "paths/vertices.glsl"
#include "paths/wavefront/records.glsl"

layout(set = 1, binding = 8, scalar) buffer Front { StoredFront at[]; } front;
#ifdef SEPARATE_TERMS
layout(set = 1, binding = 9, scalar) buffer Direct { StoredLobes at[]; } direct;
layout(set = 1, binding = 10, scalar) buffer Indirect { StoredLobes at[]; } indirect;
#endif
#ifdef VERTEX_LIST
layout(set = 1, binding = 26, scalar) buffer VertexLight { ReceivedLight at[]; } vertex_light;
#endif

bool is_any(vec3 a, vec3 b) {
    return any(notEqual(a, vec3(0.0))) || any(notEqual(b, vec3(0.0)));
}

#ifdef VERTEX_LIST
void keep_light(uint pixel, uint index, vec3 radiance) {
    if (is_any(radiance, vec3(0.0))) {
        vertex_light.at[place_in_list(pixel, index)].radiance += radiance;
    }
}
#endif

/// Adds what has been found; most terms are zero, and cost no bytes.
void add_to_sums(uint slot, Terms found) {
    if (is_any(found.before, vec3(0.0))) {
        front.at[slot].before += found.before;
    }
#ifdef SEPARATE_TERMS
    if (is_any(found.diffuse_direct, found.specular_direct)) {
        direct.at[slot].diffuse += found.diffuse_direct;
        direct.at[slot].specular += found.specular_direct;
    }
    if (is_any(found.diffuse_indirect, found.specular_indirect)) {
        indirect.at[slot].diffuse += found.diffuse_indirect;
        indirect.at[slot].specular += found.specular_indirect;
    }
#endif
#ifdef VERTEX_LIST
    uvec2 pixel = pixel_of_slot(slot);
    finish_vertex(pixel.y * frame.extent.x + pixel.x, found);
#endif
}

#endif
