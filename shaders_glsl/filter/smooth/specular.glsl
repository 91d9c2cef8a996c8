// What the smoothing of the specular terms begins with: their sum, and for its variance its square, which is nearly the
// same for a single sample of so wide a distribution.
//
// No cell averages these terms, only the picture's history does (display/temporal.comp), whose frames come after all smoothing. What noise a
// pixel has in the end is that of their mean, so one frame counts as so much less noisy, and is smoothed the less: a first frame can take
// passes whose blur a sixteenth would suffer from. Measured (hpsf+ with hpsf.jitter=0.4, FLIP of the first and the 16th frame): Sponza at
// 256x144 with two passes 0.154 and 0.079, with three 0.147 and 0.086, with three that know of history 0.147 and 0.080; the hall at 128x72
// 0.248 and 0.157, with three 0.251 and 0.157.
#include "lib/colour.glsl"
#include "lib/storage.glsl"
#include "shared/bindings.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, COLOR_FORMAT) readonly uniform image2D specular_direct;
layout(set = 1, binding = 5, COLOR_FORMAT) readonly uniform image2D specular_indirect;
layout(set = 1, binding = 6, COLOR_FORMAT) writeonly uniform image2D specular;
layout(set = 1, binding = 7, r32ui) writeonly uniform uimage2D samples;

/// Over which the picture will be a mean, this one included. Defined by the kernel.
float frames_seen(ivec2 pixel);

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return;
    }
    vec3 sum = imageLoad(specular_direct, pixel).rgb + imageLoad(specular_indirect, pixel).rgb;
    float frames = frames_seen(pixel);
    imageStore(specular, pixel, storable(vec4(sum, mean_square(sum) / frames)));
    imageStore(samples, pixel, uvec4(uint(round(frames))));
}
