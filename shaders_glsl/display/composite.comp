// Recombines the terms of a path: Meijer, section 4.1 (paths/terms.glsl states the sum).
#include "shared/bindings.glsl"
#include "lib/storage.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

/// A filter has summed up two terms, and the first is its result.
layout(constant_id = 202) const bool ONE_DIFFUSE = false;
layout(constant_id = 204) const bool ONE_SPECULAR = false;

layout(set = 1, binding = 0, COLOR_FORMAT) readonly uniform image2D before;
layout(set = 1, binding = 1, COLOR_FORMAT) readonly uniform image2D attenuation;
layout(set = 1, binding = 2, COLOR_FORMAT) readonly uniform image2D diffuse_direct;
layout(set = 1, binding = 3, COLOR_FORMAT) readonly uniform image2D diffuse_indirect;
layout(set = 1, binding = 4, COLOR_FORMAT) readonly uniform image2D specular_direct;
layout(set = 1, binding = 5, COLOR_FORMAT) readonly uniform image2D specular_indirect;
layout(set = 1, binding = 6, COLOR_FORMAT) writeonly uniform image2D radiance;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return;
    }
    vec3 diffuse = imageLoad(diffuse_direct, pixel).rgb;
    if (!ONE_DIFFUSE) {
        diffuse += imageLoad(diffuse_indirect, pixel).rgb;
    }
    vec3 specular = imageLoad(specular_direct, pixel).rgb;
    if (!ONE_SPECULAR) {
        specular += imageLoad(specular_indirect, pixel).rgb;
    }
    vec3 sum = imageLoad(before, pixel).rgb + imageLoad(attenuation, pixel).rgb * diffuse + specular;
    imageStore(radiance, pixel, storable(vec4(sum, 1.0)));
}
