// Path tracing, the terms apart, with the list of filter vertices behind the first one: paths/vertices.glsl.
#define SEPARATE_TERMS
#define SHARED_JITTER
#define VERTEX_LIST
#include "paths/megakernel.glsl"
#include "paths/terms_output.glsl"
#include "paths/vertices_output.glsl"
#include "filter/nhpsf/list_end.glsl"

layout(local_size_x = 32) in;

/// Length of the pixel's list.
layout(set = 1, binding = 23, r32ui) writeonly uniform uimage2D path_vertices;
layout(set = 1, binding = 26, scalar) writeonly buffer VertexLight { ReceivedLight at[]; } vertex_light;

void keep_vertex(uint pixel, uint index, FilterVertex vertex, vec3 attenuation) {
    store_place(pixel, index, vertex, attenuation);
    vertex_light.at[place_in_list(pixel, index)].incident = pack_normal(vertex.incident);
}

void keep_light(uint pixel, uint index, vec3 radiance) {
    vertex_light.at[place_in_list(pixel, index)].radiance = radiance;
}

void write_pixel(uvec2 pixel, Terms terms, uint samples, uvec2 counts) {
    write_terms_and_rays(pixel, terms, counts);
    finish_vertex(pixel.y * frame.extent.x + pixel.x, terms);
    imageStore(specular_attenuation, ivec2(pixel), finite_or_black(terms.specular_attenuation));
    imageStore(path_vertices, ivec2(pixel), uvec4(terms.vertices));
}

void main() {
    trace_pixels(gl_WorkGroupID.x, gl_LocalInvocationIndex);
}
