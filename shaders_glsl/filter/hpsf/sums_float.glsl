// Sums of cells by float atomics, for filter/hpsf/collect.glsl. Fewer bytes; the order of additions shows in the last digits.
/// Per slot: red, green, blue, samples.
layout(set = 1, binding = 9, scalar) buffer Sums { float at[]; } sums;

bool add_sample(uint slot, vec3 radiance, float dither) {
    for (uint channel = 0u; channel < 3u; channel++) {
        atomicAdd(sums.at[4u * slot + channel], radiance[channel]);
    }
    return atomicAdd(sums.at[4u * slot + 3u], 1.0) == 0.0;
}
