// Where kernels leave the lists of their paths: paths/vertices.glsl. What vertices receive: paths/vertex_light.glsl.
#ifndef PATHS_VERTICES_OUTPUT_GLSL
#define PATHS_VERTICES_OUTPUT_GLSL

#include "lib/packing.glsl"
#include "paths/primary.glsl"
#include "paths/vertex_light.glsl"
#include "paths/vertices.glsl"

layout(set = 1, binding = 22, COLOR_FORMAT) writeonly uniform image2D specular_attenuation;
/// Position relative to the frame's origin, and view-plane distance of the path up to it, metres.
layout(set = 1, binding = 24, scalar) writeonly buffer VertexPlaces { vec4 at[]; } vertex_places;
/// Attenuation, and the normal's bits.
layout(set = 1, binding = 25, scalar) writeonly buffer VertexLinks { uvec4 at[]; } vertex_links;

/// All of a vertex but its light.
void store_place(uint pixel, uint index, FilterVertex vertex, vec3 attenuation) {
    uvec2 at = uvec2(pixel % frame.extent.x, pixel / frame.extent.x);
    uint place = place_in_list(pixel, index);
    vertex_places.at[place] = vec4(vertex.position, view_plane_distance(primary_ray(at, frame.jitter), frame.camera, vertex.travelled));
    vertex_links.at[place] = uvec4(floatBitsToUint(attenuation), pack_normal(vertex.normal));
}

#endif
