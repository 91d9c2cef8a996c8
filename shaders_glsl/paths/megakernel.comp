// Path tracing to radiance: paths/megakernel.glsl, the terms summed up.
#include "paths/megakernel.glsl"

layout(local_size_x = 32) in;

layout(set = 1, binding = 0, COLOR_FORMAT) writeonly uniform image2D radiance;
/// Scattered rays in the low, shadow rays in the high 16 bits.
layout(set = 1, binding = 1, r32ui) writeonly uniform uimage2D ray_count;

/// Of a pixel in a frame of several submissions, from one to the next. In single precision, so that where a sum is cut changes no bit.
struct Sum {
    vec3 radiance;
    uint counts;
};
layout(set = 1, binding = 2, scalar) buffer Sums { Sum at[]; } sums;

void resume_pixel(uvec2 pixel, inout Terms terms, inout uvec2 counts) {
    Sum sum = sums.at[pixel.y * frame.extent.x + pixel.x];
    terms.before = sum.radiance;
    counts = uvec2(sum.counts & 0xffffu, sum.counts >> 16);
}

void write_pixel(uvec2 pixel, Terms terms, uint samples, uvec2 counts) {
    if (samples < samples_of(pixel)) {
        sums.at[pixel.y * frame.extent.x + pixel.x] = Sum(terms.before, pack_counts(counts));
        return;
    }
    imageStore(radiance, ivec2(pixel), finite_or_black(terms.before / float(samples)));
    imageStore(ray_count, ivec2(pixel), uvec4(pack_counts(counts)));
}

void main() {
    trace_pixels(gl_WorkGroupID.x, gl_LocalInvocationIndex);
}
