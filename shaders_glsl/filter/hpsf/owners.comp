// Of each slot, one of the samples that went there, so that the statistics can hold the other samples' keys against its own.
#include "filter/hpsf/cell.glsl"
#include "filter/hpsf/find.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, rgba32f) readonly uniform image2D filter_position;
layout(set = 1, binding = 1, r32ui) readonly uniform uimage2D filter_normal;
layout(set = 1, binding = 2, r32ui) readonly uniform uimage2D filter_incident;
layout(set = 1, binding = 3, scalar) readonly buffer Keys { uint at[]; } keys;
/// Per slot: the first of its pixels times 4, plus the level among hpsf.levels; all ones where no sample of this frame went there.
layout(set = 1, binding = 4, scalar) buffer Owners { uint at[]; } owners;

uint key_word(uint at) {
    return keys.at[at];
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    ivec2 at = ivec2(pixel);
    if (any(greaterThanEqual(pixel, frame.extent))) {
        return;
    }
    vec4 position = imageLoad(filter_position, at);
    if (!(position.w > 0.0)) {
        return;
    }
    FilterPoint point = filter_point(pixel, position, imageLoad(filter_normal, at).x, imageLoad(filter_incident, at).x);
    vec4 numbers = jitter_numbers(pixel, 0u);
    for (uint level = 0u; level < parameters.hpsf_levels; level++) {
        uint slot = find_slot(key_of(point, numbers, int(level)));
        if (slot != NO_SLOT) {
            atomicMin(owners.at[slot], 4u * (pixel.y * frame.extent.x + pixel.x) + level);
        }
    }
}
