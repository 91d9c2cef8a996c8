// Where a kernel leaves the lists of its paths: paths/vertices.glsl. Vertex i of a pixel is at i * pixels + pixel.
#ifndef PATHS_VERTICES_OUTPUT_GLSL
#define PATHS_VERTICES_OUTPUT_GLSL

#include "paths/terms_output.glsl"
#include "paths/vertices.glsl"

layout(set = 1, binding = 10, COLOR_FORMAT) writeonly uniform image2D specular_attenuation;
/// Length of the pixel's list.
layout(set = 1, binding = 11, r32ui) writeonly uniform uimage2D path_vertices;
/// Position relative to the frame's origin, and view-plane distance of the path up to it, metres.
layout(set = 1, binding = 12, scalar) writeonly buffer VertexPlaces { vec4 at[]; } vertex_places;
/// Attenuation, and the normal's bits.
layout(set = 1, binding = 13, scalar) writeonly buffer VertexLinks { uvec4 at[]; } vertex_links;
/// Radiance, and the bits of the way that the path arrives.
layout(set = 1, binding = 14, scalar) writeonly buffer VertexLight { uvec4 at[]; } vertex_light;

void keep_vertex(uint pixel, uint index, PathVertex vertex) {
    uvec2 at = uvec2(pixel % frame.extent.x, pixel / frame.extent.x);
    uint place = index * frame.extent.x * frame.extent.y + pixel;
    vertex_places.at[place] = vec4(vertex.at.position, view_plane_distance(primary_ray(at, frame.jitter), frame.camera, vertex.at.travelled));
    vertex_links.at[place] = uvec4(floatBitsToUint(vertex.attenuation), pack_normal(vertex.at.normal));
    vertex_light.at[place] = uvec4(floatBitsToUint(vertex.radiance), pack_normal(vertex.at.incident));
}

void write_list(uvec2 at, Terms terms) {
    finish_vertex(at.y * frame.extent.x + at.x, terms);
    imageStore(specular_attenuation, ivec2(at), finite_or_black(terms.specular_attenuation));
    imageStore(path_vertices, ivec2(at), uvec4(terms.vertices));
}

#endif
