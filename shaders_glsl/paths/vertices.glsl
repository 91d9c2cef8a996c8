// The filter vertices of a path behind its first one, a list that the path writes as it goes: Meijer, sections 4.3 and 7.
//
// At a filter vertex k, R_k is what its diffuse lobe receives, as if its albedo were 1 (paths/terms.glsl). A path finds
//
//   R_k = radiance_k + attenuation_(k+1) R_(k+1)
//
// `radiance`: emission, light sampled, and all that mirrors, glass and glossy lobes between k and k + 1 bring. `attenuation`: weight of k's
// diffuse lobe, throughput of what lies between, albedo of k + 1. So what a vertex receives can be replaced by what a cell knows
// of it, at any vertex, without counting anything twice. k = 0 is the filter vertex of paths/terms.glsl, whose diffuse_indirect is
// without the list's part; `specular_attenuation` leads from vertex 1 to its specular_indirect.
//
// Behind the first vertex, a surface with other lobes beside the diffuse one is either: with the probability that its diffuse lobe would be
// sampled it is a filter vertex and nothing but diffuse, else the path passes it as it passes a mirror. Both are divided by their
// probability. So a list is a chain, and no vertex passes specular radiance on to several before it.
//
// A vertex is three times 16 bytes (Meijer counts 20: two hashes, and the attenuation): its place is kept instead of a hash, as cells
// of several levels and jitters are looked for from it, and its radiance.
#ifndef PATHS_VERTICES_GLSL
#define PATHS_VERTICES_GLSL

#include "lib/packing.glsl"
#include "paths/terms.glsl"

#ifdef VERTEX_LIST

/// Longest list; the path ends there, or with the ray from there, which can find a light and nothing else.
layout(constant_id = 204) const uint MOST_VERTICES = 1;
/// The last vertex of such a list is there to be looked up: no light is looked for at it.
layout(constant_id = 205) const bool LAST_IS_READ = true;

/// Stores vertex `index` of a pixel's list, that has received nothing so far. `attenuation`: what becomes of its diffuse lobe's radiance on the
/// way to the one of the vertex before. Defined by the kernel.
void keep_vertex(uint pixel, uint index, FilterVertex vertex, vec3 attenuation);

/// Takes what a stored vertex has received, for all of its path, or for one step of it where the kernel makes no more. Defined by the kernel.
void keep_light(uint pixel, uint index, vec3 radiance);

/// Whether a list may end with this vertex, as there is something to be read for it. Else the path goes on, and brings its vertex before what
/// it finds, until it comes to one that is known or is as long as any. Defined by the kernel.
bool is_known(uint pixel, uint index, FilterVertex vertex);

/// Leaves what has been found at the list's last vertex to the kernel.
void finish_vertex(uint pixel, Terms terms) {
    if (terms.vertices > 0u) {
        keep_light(pixel, terms.vertices - 1u, terms.behind);
    }
}

/// The list's next vertex; `throughput`: from the vertex before on, this one's albedo included.
void begin_vertex(uint pixel, FilterVertex at, vec3 throughput, float diffuse_weight, vec3 specular_weight, inout Terms terms) {
    finish_vertex(pixel, terms);
    if (terms.vertices == 0u) {
        terms.specular_attenuation = specular_weight * throughput;
    }
    keep_vertex(pixel, terms.vertices, at, diffuse_weight * throughput);
    terms.vertices++;
    terms.behind = vec3(0.0);
}

uint vertices_behind(Terms terms) {
    return terms.vertices;
}

bool next_is_last(Terms terms) {
    return terms.vertices + 1u == MOST_VERTICES;
}

bool list_ends(Terms terms) {
    return terms.vertices == MOST_VERTICES;
}

#else

uint vertices_behind(Terms terms) {
    return 0u;
}

bool list_ends(Terms terms) {
    return false;
}

#endif

#endif
