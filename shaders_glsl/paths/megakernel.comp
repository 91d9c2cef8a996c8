// Path tracing to radiance: paths/path.glsl, the terms summed up.
#include "paths/path.glsl"

layout(local_size_x = 32) in;

layout(set = 1, binding = 0, rgba32f) writeonly uniform image2D radiance;
/// Scattered rays in the low, shadow rays in the high 16 bits.
layout(set = 1, binding = 1, r32ui) writeonly uniform uimage2D ray_count;

/// Samples per pixel of this frame.
layout(constant_id = 200) const uint SAMPLES = 1;

void write_pixel(uvec2 pixel, Terms terms, uvec2 counts) {
    vec3 mean = terms.before / float(SAMPLES);
    bool finite = !any(isnan(mean)) && !any(isinf(mean));
    imageStore(radiance, ivec2(pixel), vec4(finite ? mean : vec3(0.0), finite ? 1.0 : 0.0));
    imageStore(ray_count, ivec2(pixel), uvec4(pack_counts(counts)));
}

void main() {
    trace_pixels(gl_WorkGroupID.x, gl_LocalInvocationIndex, SAMPLES);
}
