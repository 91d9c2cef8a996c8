// Path tracing to radiance: paths/megakernel.glsl, the terms summed up.
#include "lib/storage.glsl"
#include "paths/megakernel.glsl"

layout(local_size_x = 32) in;

layout(set = 1, binding = 0, COLOR_FORMAT) writeonly uniform image2D radiance;
/// Scattered rays in the low, shadow rays in the high 16 bits.
layout(set = 1, binding = 1, r32ui) writeonly uniform uimage2D ray_count;

/// A number that is not whole is so on average over pixels and frames: which pixels take one more is independent of what they see.
uint samples_of(uvec2 pixel) {
    uint most = frame.samples + 1u;
    return frame.more_samples > unit_float(pcg3d(uvec3(pixel, frame.frame ^ frame.seed)).y) ? most : frame.samples;
}

void write_pixel(uvec2 pixel, Terms terms, uint samples, uvec2 counts) {
    vec3 mean = terms.before / float(samples);
    bool finite = !any(isnan(mean)) && !any(isinf(mean));
    imageStore(radiance, ivec2(pixel), storable(vec4(finite ? mean : vec3(0.0), finite ? 1.0 : 0.0)));
    imageStore(ray_count, ivec2(pixel), uvec4(pack_counts(counts)));
}

void main() {
    trace_pixels(gl_WorkGroupID.x, gl_LocalInvocationIndex);
}
