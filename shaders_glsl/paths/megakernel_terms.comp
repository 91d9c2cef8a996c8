// Path tracing, one path per pixel through the g-buffer's point, the terms apart: paths/terms.glsl.
#define SEPARATE_TERMS
#define SHARED_JITTER
#include "paths/megakernel.glsl"

layout(local_size_x = 32) in;

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

/// How far a camera without mirrors would see the vertex, measured along its view: reflections keep the angle between a ray and the view
/// direction that they mirror along with it.
float view_plane_distance(uvec2 pixel, float travelled) {
    return travelled * dot(primary_ray(pixel, frame.jitter).direction, frame.camera.forward);
}

/// A sample with a value that is not a number is no sample: it must not enter a history.
vec4 finite_or_black(vec3 value) {
    bool finite = !any(isnan(value)) && !any(isinf(value));
    return storable(vec4(finite ? value : vec3(0.0), finite ? 1.0 : 0.0));
}

uint samples_of(uvec2 pixel) {
    return 1u;
}

void write_pixel(uvec2 at, Terms terms, uint samples, uvec2 counts) {
    ivec2 pixel = ivec2(at);
    imageStore(before, pixel, finite_or_black(terms.before));
    imageStore(attenuation, pixel, finite_or_black(terms.attenuation));
    imageStore(diffuse_direct, pixel, finite_or_black(received(terms.diffuse_direct, terms.attenuation)));
    imageStore(diffuse_indirect, pixel, finite_or_black(received(terms.diffuse_indirect, terms.attenuation)));
    imageStore(specular_direct, pixel, finite_or_black(terms.specular_direct));
    imageStore(specular_indirect, pixel, finite_or_black(terms.specular_indirect));
    imageStore(ray_count, pixel, uvec4(pack_counts(counts)));
    FilterVertex vertex = terms.vertex;
    imageStore(filter_position, pixel, vec4(vertex.position, view_plane_distance(at, vertex.travelled)));
    imageStore(filter_normal, pixel, uvec4(vertex.travelled > 0.0 ? pack_normal(vertex.normal) : 0u));
    imageStore(filter_incident, pixel, uvec4(vertex.travelled > 0.0 ? pack_normal(vertex.incident) : 0u));
}

void main() {
    trace_pixels(gl_WorkGroupID.x, gl_LocalInvocationIndex);
}
