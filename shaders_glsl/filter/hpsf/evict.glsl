// hpsf.eviction = priority: keys that have found no slot take those of cells that nobody has touched in this frame, of the lowest priority
// first: Binder, section 3.4.3, and filter/hpsf/ordered.glsl. Only where the table is full does this pass do more than look.
#include "filter/hpsf/ordered_points.glsl"
#include "filter/hpsf/stored_cell.glsl"

layout(set = 1, binding = 4, scalar) writeonly buffer Cells { CELL_WORDS at[]; } cells;

void main() {
    CellPoint at;
    if (!find_point(at)) {
        return;
    }
    for (uint level = 0u; level < parameters.hpsf_levels; level++) {
        CellKey key = key_of(at.point, at.numbers, at.coarser + int(level));
        if (find_slot(key) == NO_SLOT) {
            uint evicted = evict_for(home_slot(key), words_of(key).x);
            if (evicted != NO_SLOT) {
                cells.at[evicted] = pack_cell(EMPTY_CELL);
            }
        }
    }
}
