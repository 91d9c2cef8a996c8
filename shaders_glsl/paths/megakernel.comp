// Path tracing to radiance: paths/megakernel.glsl, the terms summed up.
#include "paths/megakernel.glsl"

layout(local_size_x = 32) in;

layout(set = 1, binding = 0, COLOR_FORMAT) writeonly uniform image2D radiance;
/// Scattered rays in the low, shadow rays in the high 16 bits.
layout(set = 1, binding = 1, r32ui) writeonly uniform uimage2D ray_count;

void write_pixel(uvec2 pixel, Terms terms, uint samples, uvec2 counts) {
    imageStore(radiance, ivec2(pixel), finite_or_black(terms.before / float(samples)));
    imageStore(ray_count, ivec2(pixel), uvec4(pack_counts(counts)));
}

void main() {
    trace_pixels(gl_WorkGroupID.x, gl_LocalInvocationIndex);
}
