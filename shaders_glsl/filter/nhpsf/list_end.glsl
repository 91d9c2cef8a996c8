// Where lists of vertices may end (paths/vertices.glsl): at one that cells know.
#ifndef FILTER_NHPSF_LIST_END_GLSL
#define FILTER_NHPSF_LIST_END_GLSL

#include "filter/nhpsf/known.glsl"
#include "lib/packing.glsl"
#include "paths/primary.glsl"
#include "paths/vertices.glsl"

const uint UNKNOWN_DARK = 1u;

bool is_known(uint pixel, uint index, FilterVertex vertex) {
    if (NHPSF_UNKNOWN == UNKNOWN_DARK) {
        return true;
    }
    uvec2 at = uvec2(pixel % frame.extent.x, pixel / frame.extent.x);
    float distance = view_plane_distance(primary_ray(at, frame.jitter), frame.camera, vertex.travelled);
    FilterPoint point = vertex_point(at, vec4(vertex.position, distance), pack_normal(vertex.normal), pack_normal(vertex.incident));
    return known_at(point, vertex_numbers(at, index)).count > 0u;
}

#endif
