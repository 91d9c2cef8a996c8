// Path tracing to radiance: paths/path.glsl, the terms summed up.
#include "paths/path.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, rgba32f) writeonly uniform image2D radiance;
/// Scattered rays in the low, shadow rays in the high 16 bits.
layout(set = 1, binding = 1, r32ui) writeonly uniform uimage2D ray_count;

/// Samples per pixel of this frame.
layout(constant_id = 200) const uint SAMPLES = 1;

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, frame.extent))) {
        return;
    }
    uvec2 counts;
    vec3 sum = trace_paths(pixel, frame.first_sample, SAMPLES, counts).before / float(SAMPLES);
    bool finite = !any(isnan(sum)) && !any(isinf(sum));
    imageStore(radiance, ivec2(pixel), vec4(finite ? sum : vec3(0.0), finite ? 1.0 : 0.0));
    imageStore(ray_count, ivec2(pixel), uvec4(counts.x | counts.y << 16));
}
