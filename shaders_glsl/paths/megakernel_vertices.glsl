// Path tracing, the terms apart, with the list of filter vertices behind the first one: paths/vertices.glsl.
#define SEPARATE_TERMS
#define SHARED_JITTER
#define VERTEX_LIST
#include "paths/megakernel.glsl"
#include "paths/vertices_output.glsl"
#include "filter/nhpsf/known.glsl"

layout(local_size_x = 32) in;

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

void write_pixel(uvec2 pixel, Terms terms, uint samples, uvec2 counts) {
    write_terms_and_rays(pixel, terms, counts);
    write_list(pixel, terms);
}

void main() {
    trace_pixels(gl_WorkGroupID.x, gl_LocalInvocationIndex);
}
