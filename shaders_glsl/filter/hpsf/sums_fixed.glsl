// Sums of cells in fixed point: what filter/hpsf/collect.glsl adds samples to.
#include "filter/hpsf/fixed_point.glsl"

/// Per slot: low and high word of red, green, blue; samples; nothing.
layout(set = 1, binding = 9, scalar) buffer Sums { uint at[]; } sums;

bool add_sample(uint slot, vec3 radiance, float dither) {
    for (uint channel = 0u; channel < 3u; channel++) {
        uvec2 units = to_fixed(radiance[channel], dither);
        uint at = 8u * slot + 2u * channel;
        uint before = atomicAdd(sums.at[at], units.x);
        uint high = units.y + (before + units.x < before ? 1u : 0u);
        if (high > 0u) {
            atomicAdd(sums.at[at + 1u], high);
        }
    }
    return atomicAdd(sums.at[8u * slot + 6u], 1u) == 0u;
}
