// What the smoothing of the specular terms begins with: their sum, and for its variance its square, which is nearly the
// same for a single sample of so wide a distribution.
#include "lib/colour.glsl"
#include "lib/storage.glsl"
#include "shared/bindings.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, COLOR_FORMAT) readonly uniform image2D specular_direct;
layout(set = 1, binding = 1, COLOR_FORMAT) readonly uniform image2D specular_indirect;
layout(set = 1, binding = 2, COLOR_FORMAT) writeonly uniform image2D specular;
layout(set = 1, binding = 3, r32ui) writeonly uniform uimage2D samples;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return;
    }
    vec3 sum = imageLoad(specular_direct, pixel).rgb + imageLoad(specular_indirect, pixel).rgb;
    imageStore(specular, pixel, storable(vec4(sum, mean_square(sum))));
    imageStore(samples, pixel, uvec4(1u));
}
