// hpsf.eviction = priority: keys that have found no slot take those of cells that nobody has touched in this frame, of the lowest priority
// first: Binder, section 3.4.3, and filter/hpsf/ordered.glsl. Only where the table is full does this pass do more than look.
#include "filter/hpsf/cell.glsl"
#include "filter/hpsf/find.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, rgba32f) readonly uniform image2D filter_position;
layout(set = 1, binding = 1, r32ui) readonly uniform uimage2D filter_normal;
layout(set = 1, binding = 2, r32ui) readonly uniform uimage2D filter_incident;
layout(set = 1, binding = 3, scalar) buffer Keys { uint at[]; } keys;
layout(set = 1, binding = 4, scalar) writeonly buffer Cells { uvec4 at[]; } cells;

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
        if (find_slot(key) == NO_SLOT) {
            uint evicted = evict_for(home_slot(key), words_of(key).x);
            if (evicted != NO_SLOT) {
                cells.at[evicted] = uvec4(0u);
            }
        }
    }
}
