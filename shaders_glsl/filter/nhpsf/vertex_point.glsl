// A vertex behind a path's first one that enters a cell, one for each element.
#ifndef FILTER_NHPSF_VERTEX_POINT_GLSL
#define FILTER_NHPSF_VERTEX_POINT_GLSL

#include "filter/nhpsf/vertex.glsl"
#include "lib/elements.glsl"

layout(local_size_x = 32) in;

layout(set = 1, binding = 10, r32ui) readonly uniform uimage2D path_vertices;
layout(set = 1, binding = 11, scalar) readonly buffer VertexPlaces { vec4 at[]; } vertex_places;
layout(set = 1, binding = 12, scalar) readonly buffer VertexLinks { uvec4 at[]; } vertex_links;
layout(set = 1, binding = 13, scalar) readonly buffer VertexLight { uvec4 at[]; } vertex_light;

/// Vertices of a list that enter cells: the first ones.
layout(constant_id = 206) const uint STORED_VERTICES = 1;

bool find_point(out CellPoint at) {
    uint place = element_index();
    uint pixels = frame.extent.x * frame.extent.y;
    uint index = place / pixels;
    uvec2 pixel = uvec2(place % pixels % frame.extent.x, place % pixels / frame.extent.x);
    if (index >= STORED_VERTICES || index >= imageLoad(path_vertices, ivec2(pixel)).x) {
        return false;
    }
    at.point = vertex_point(pixel, vertex_places.at[place], vertex_links.at[place].w, vertex_light.at[place].w);
    at.numbers = vertex_numbers(pixel, index);
    at.coarser = int(parameters.nhpsf_wider);
    return at.point.distance > 0.0;
}

#endif
