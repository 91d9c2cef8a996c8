// Lists of filter vertices (paths/vertices.glsl) of the wavefront's paths: between two kernels they are what they are in the end.
#ifndef PATHS_WAVEFRONT_LISTS_GLSL
#define PATHS_WAVEFRONT_LISTS_GLSL

#include "paths/path.glsl"
#ifdef VERTEX_LIST
#include "filter/nhpsf/list_end.glsl"
#include "paths/vertices_output.glsl"
#include "paths/wavefront/sums.glsl"

/// Length of the pixel's list.
layout(set = 1, binding = 23, r32ui) uniform uimage2D path_vertices;

void keep_vertex(uint pixel, uint index, FilterVertex vertex, vec3 attenuation) {
    store_place(pixel, index, vertex, attenuation);
    vertex_light.at[place_in_list(pixel, index)] = ReceivedLight(vec3(0.0), pack_normal(vertex.incident));
}

void restore_list(uvec2 pixel, inout Path path, inout Terms terms) {
    path.place = pixel.y * frame.extent.x + pixel.x;
    terms.vertices = imageLoad(path_vertices, ivec2(pixel)).x;
}

/// After a visit, before which the list had so many vertices.
void store_list(uvec2 pixel, uint before, Terms terms) {
    if (terms.vertices > before) {
        imageStore(path_vertices, ivec2(pixel), uvec4(terms.vertices));
    }
    if (terms.vertices > before && before == 0u) {
        imageStore(specular_attenuation, ivec2(pixel), finite_or_black(terms.specular_attenuation));
    }
}

#else

void restore_list(uvec2 pixel, inout Path path, inout Terms terms) {
}

void store_list(uvec2 pixel, uint before, Terms terms) {
}

#endif

#endif
