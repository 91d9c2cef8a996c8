// hpsf.insertion = ordered: slots for the keys that are new in this frame, before any sample is added (filter/hpsf/ordered.glsl).
#include "filter/hpsf/ordered_points.glsl"

void main() {
    CellPoint at;
    if (!find_point(at)) {
        return;
    }
    for (uint level = 0u; level < parameters.hpsf_levels; level++) {
        CellKey key = key_of(at.point, at.numbers, at.coarser + int(level));
        uint slot = find_slot(key);
        if (slot == NO_SLOT) {
            propose(home_slot(key), words_of(key).x);
        } else if (standing_of(keys.at[slot]) == STANDING_OLD) {
            atomicOr(keys.at[slot], STANDING_TOUCHED << STANDING_SHIFT);
        }
    }
}
