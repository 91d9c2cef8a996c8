// What cells know of a vertex.
#ifndef FILTER_NHPSF_KNOWN_GLSL
#define FILTER_NHPSF_KNOWN_GLSL

#include "filter/nhpsf/vertex.glsl"
#include "filter/hpsf/find.glsl"
#include "filter/hpsf/stored_cell.glsl"

layout(set = 1, binding = 20, scalar) readonly buffer KnownKeys { uint at[]; } known_keys;
layout(set = 1, binding = 21, scalar) readonly buffer KnownCells { CELL_WORDS at[]; } known_cells;

uint key_word(uint at) {
    return known_keys.at[at];
}

Cell known_cell(CellKey key) {
    uint slot = find_slot(key);
    return slot == NO_SLOT ? EMPTY_CELL : unpack_cell(known_cells.at[slot]);
}

/// Of the finest level that has enough samples, or else of the one that has most.
Cell known_at(FilterPoint point, vec4 numbers) {
    Cell best = EMPTY_CELL;
    for (uint level = 0u; level < parameters.hpsf_levels && best.count < max(parameters.hpsf_few, 1u); level++) {
        Cell cell = known_cell(key_of(point, numbers, int(parameters.nhpsf_wider + level)));
        if (cell.count > best.count) {
            best = cell;
        }
    }
    return best;
}

const uint FORM_PAPER = 1u;

/// What a vertex sends on (filter/nhpsf/transport.comp). `received`: by the path's own rays.
vec3 sent_by(Cell known, vec3 received) {
    if (NHPSF_FORM == FORM_PAPER) {
        return received + known.mean;
    }
    return known.count > 0u ? known.mean : received;
}

#endif
