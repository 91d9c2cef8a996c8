// Images that a megakernel leaves the terms of its paths in, and its count of rays.
#ifndef PATHS_TERMS_OUTPUT_GLSL
#define PATHS_TERMS_OUTPUT_GLSL

layout(set = 1, binding = 0, COLOR_FORMAT) writeonly uniform image2D before;
layout(set = 1, binding = 1, COLOR_FORMAT) writeonly uniform image2D attenuation;
layout(set = 1, binding = 2, COLOR_FORMAT) writeonly uniform image2D diffuse_direct;
layout(set = 1, binding = 3, COLOR_FORMAT) writeonly uniform image2D diffuse_indirect;
layout(set = 1, binding = 4, COLOR_FORMAT) writeonly uniform image2D specular_direct;
layout(set = 1, binding = 5, COLOR_FORMAT) writeonly uniform image2D specular_indirect;
layout(set = 1, binding = 6, r32ui) writeonly uniform uimage2D ray_count;
/// Position relative to the frame's origin, metres; w: view-plane distance of the path up to it, 0 where there is no filter vertex.
layout(set = 1, binding = 7, rgba32f) writeonly uniform image2D filter_position;
/// Shading normal and the way the path arrives (lib/packing.glsl).
layout(set = 1, binding = 8, r32ui) writeonly uniform uimage2D filter_normal;
layout(set = 1, binding = 9, r32ui) writeonly uniform uimage2D filter_incident;
/// Where the specular terms may be filtered (lib/layer.glsl); else 0.
layout(set = 1, binding = 16, r32ui) writeonly uniform uimage2D filter_layer;

#include "paths/write_terms.glsl"

void write_terms_and_rays(uvec2 pixel, Terms terms, uvec2 counts) {
    write_terms(pixel, terms);
    imageStore(ray_count, ivec2(pixel), uvec4(pack_counts(counts)));
}

#endif
