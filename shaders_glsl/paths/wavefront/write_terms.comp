// Wavefront path tracing, last stage: each pixel's terms, from where they added up to images.
#define SEPARATE_TERMS
#include "lib/elements.glsl"
#include "paths/wavefront/records.glsl"

layout(local_size_x = 64) in;

layout(set = 1, binding = 0, COLOR_FORMAT) writeonly uniform image2D before;
layout(set = 1, binding = 1, COLOR_FORMAT) writeonly uniform image2D attenuation;
layout(set = 1, binding = 2, COLOR_FORMAT) writeonly uniform image2D diffuse_direct;
layout(set = 1, binding = 3, COLOR_FORMAT) writeonly uniform image2D diffuse_indirect;
layout(set = 1, binding = 4, COLOR_FORMAT) writeonly uniform image2D specular_direct;
layout(set = 1, binding = 5, COLOR_FORMAT) writeonly uniform image2D specular_indirect;
/// Position relative to the frame's origin, metres; w: view-plane distance of the path up to it, 0 where there is no filter vertex.
layout(set = 1, binding = 6, rgba32f) writeonly uniform image2D filter_position;
/// Shading normal and the way the path arrives (lib/packing.glsl).
layout(set = 1, binding = 7, r32ui) writeonly uniform uimage2D filter_normal;
layout(set = 1, binding = 8, r32ui) writeonly uniform uimage2D filter_incident;
/// Where the specular terms may be filtered (lib/layer.glsl); else 0.
layout(set = 1, binding = 13, r32ui) writeonly uniform uimage2D filter_layer;
layout(set = 1, binding = 9, scalar) readonly buffer Front { StoredFront at[]; } front;
layout(set = 1, binding = 10, scalar) readonly buffer Direct { StoredLobes at[]; } direct;
layout(set = 1, binding = 11, scalar) readonly buffer Indirect { StoredLobes at[]; } indirect;
layout(set = 1, binding = 12, scalar) readonly buffer Vertices { StoredVertex at[]; } vertices;

#include "paths/write_terms.glsl"

void main() {
    uint slot = element_index();
    uvec2 pixel = pixel_of_slot(slot);
    if (any(greaterThanEqual(pixel, frame.extent))) {
        return;
    }
    StoredVertex v = vertices.at[slot];
    StoredLobes d = direct.at[slot];
    StoredLobes i = indirect.at[slot];
    StoredFront f = front.at[slot];
    FilterVertex vertex = FilterVertex(v.position, v.normal, v.incident, v.travelled, v.layer);
    write_terms(pixel, Terms(f.before, f.attenuation, d.diffuse, i.diffuse, d.specular, i.specular, vertex));
}
