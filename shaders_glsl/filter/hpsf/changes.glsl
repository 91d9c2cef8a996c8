// What retraced paths say about the light in a cell: Binder, section 3.4.1, whose averages of differences are in voxels, too.
//
// Keys are those of the filter, but that cells of glossy lobes are as wide as those of the diffuse one: smooth surfaces' own would hardly have a
// path each. Of a cell's paths, this table has the sum of their radiance now and that of the same paths in the last
// frame: both in fixed point, with the same rounding, so that equal light leaves equal bits. Made anew in every frame.
//
// Deviations and why: one slot per key, no probing. Where two cells meet in a slot, the second is not known, and the next coarser cell
// speaks for it; there are many fewer retraced paths than slots for them.
#ifndef FILTER_HPSF_CHANGES_GLSL
#define FILTER_HPSF_CHANGES_GLSL

#include "filter/hpsf/cell.glsl"
#include "filter/hpsf/fixed_point.glsl"

layout(constant_id = 225) const uint CHANGE_CAPACITY = 1;

/// Levels coarser than the filter's: retraced paths are few, and a change that is found in a large cell is still one.
const uint FURTHER_LEVELS = 2u;

/// Words of a slot: fingerprint, number of paths, low and high word of each channel, now and before, number of paths that have come to another
/// surface, and of those on which the lobes have changed that the table is not about.
const uint CHANGE_WORDS = 16u;
const uint UNCOVERED = 14u;
const uint OTHER_LOBES = 15u;

/// Of a vertex, `level` levels above that of its distance.
CellKey change_key(FilterPoint point, vec4 numbers, uint level) {
    return key_of(point, numbers, int(level) + finer_levels(point.layer));
}

/// Of the cells around a vertex in which paths are counted that have come to another surface: two, as one may find its slot taken.
const uint UNCOVERED_LEVELS = 2u;

CellKey uncovered_key(FilterPoint point, vec4 numbers, uint level) {
    return change_key(point, numbers, parameters.hpsf_levels + FURTHER_LEVELS + level);
}

uint change_slot(CellKey key) {
    return CHANGE_WORDS * hash_slot(hash_index(key, true), CHANGE_CAPACITY);
}

#endif
