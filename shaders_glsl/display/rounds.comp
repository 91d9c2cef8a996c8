// The mean over a frame's rounds so far.
#include "shared/bindings.glsl"
#include "lib/storage.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, COLOR_FORMAT) readonly uniform image2D picture;
layout(set = 1, binding = 1, COLOR_FORMAT) uniform image2D mean;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return;
    }
    vec3 before = frame.round == 0u ? vec3(0.0) : imageLoad(mean, pixel).rgb;
    vec3 now = imageLoad(picture, pixel).rgb;
    imageStore(mean, pixel, storable(vec4(before + (now - before) / float(frame.round + 1u), 1.0)));
}
