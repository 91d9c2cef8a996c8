// hpsf, samples into cells, summed by float atomics: filter/hpsf/collect.glsl. Fewer bytes; the order of additions shows in the last digits.
#extension GL_EXT_shader_atomic_float : require

layout(set = 1, binding = 0, COLOR_FORMAT) readonly uniform image2D diffuse_direct;
layout(set = 1, binding = 1, COLOR_FORMAT) readonly uniform image2D diffuse_indirect;
/// Per slot: red, green, blue, samples.
layout(set = 1, binding = 9, scalar) buffer Sums { float at[]; } sums;

#include "filter/hpsf/collect.glsl"

bool add_sample(uint slot, vec3 radiance, float dither) {
    for (uint channel = 0u; channel < 3u; channel++) {
        atomicAdd(sums.at[4u * slot + channel], radiance[channel]);
    }
    return atomicAdd(sums.at[4u * slot + 3u], 1.0) == 0.0;
}

void main() {
    collect_pixel();
}
