// Each pixel's filter vertex.
#ifndef FILTER_HPSF_PIXEL_POINT_GLSL
#define FILTER_HPSF_PIXEL_POINT_GLSL

#include "filter/hpsf/cell.glsl"
#include "filter/hpsf/table.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 10, rgba32f) readonly uniform image2D filter_position;
layout(set = 1, binding = 11, r32ui) readonly uniform uimage2D filter_normal;
layout(set = 1, binding = 12, r32ui) readonly uniform uimage2D filter_incident;
layout(set = 1, binding = 15, r32ui) readonly uniform uimage2D filter_layer;

bool find_point(out CellPoint at) {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return false;
    }
    vec4 position = imageLoad(filter_position, pixel);
    at.point = filter_point(uvec2(pixel), position, imageLoad(filter_normal, pixel).x, imageLoad(filter_incident, pixel).x);
    at.point.layer = layer_of_part(imageLoad(filter_layer, pixel).x);
    at.numbers = jitter_numbers(uvec2(pixel), 0u);
    at.coarser = 0;
    return position.w > 0.0 && (PART != PART_GLOSSY || at.point.layer != 0u);
}

#endif
