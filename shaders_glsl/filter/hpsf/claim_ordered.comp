// hpsf.insertion = ordered: slots for the keys that are new in this frame, before any sample is added (filter/hpsf/ordered.glsl).
#include "filter/hpsf/cell.glsl"
#include "filter/hpsf/find.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, rgba32f) readonly uniform image2D filter_position;
layout(set = 1, binding = 1, r32ui) readonly uniform uimage2D filter_normal;
layout(set = 1, binding = 2, r32ui) readonly uniform uimage2D filter_incident;
layout(set = 1, binding = 3, scalar) buffer Keys { uint at[]; } keys;

#include "filter/hpsf/propose.glsl"

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
        CellKey key = key_of(point, numbers, int(level));
        uint slot = find_slot(key);
        if (slot == NO_SLOT) {
            propose(home_slot(key), words_of(key).x);
        } else if (standing_of(keys.at[slot]) == STANDING_OLD) {
            atomicOr(keys.at[slot], STANDING_TOUCHED << STANDING_SHIFT);
        }
    }
}
