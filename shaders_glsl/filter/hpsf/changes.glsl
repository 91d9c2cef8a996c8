// What retraced paths say about the light in a cell: Binder, section 3.4.1, whose averages of differences are in voxels, too.
//
// Keys are those of the filter, but that cells of glossy lobes are as wide as those of the diffuse one: smooth surfaces' own would hardly have a
// path each. Of a cell's paths, this table has the sum of their radiance now and that of the same paths in the last
// frame: both in fixed point, with the same rounding, so that equal light leaves equal bits. Made anew in every frame.
//
// The search for a key goes from slot to slot to the first that is its own or empty. There are more slots than a frame can have keys, so every
// key finds one, and it does not matter to what a key's slot says which one that is: whoever comes first, a frame's changes are the same. Nothing
// is ever removed, so a key that is not met before an empty slot is in none. Measured (hpsf+, cornell-object and cornell-light, 256x144): a quarter
// of the slots is taken, and no search is longer than 10.
//
// Deviations and why: no limit to the search, as there is one in the table of cells, which may be full.
#ifndef FILTER_HPSF_CHANGES_GLSL
#define FILTER_HPSF_CHANGES_GLSL

#include "filter/hpsf/cell.glsl"
#include "filter/hpsf/fixed_point.glsl"
#include "filter/hpsf/table.glsl"

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

/// Of the cell around a vertex in which paths are counted that have come to another surface, or whose other lobes have changed.
CellKey surroundings_key(FilterPoint point, vec4 numbers) {
    return change_key(point, numbers, parameters.hpsf_levels + FURTHER_LEVELS);
}

/// The first word of a slot that begins at `at`; `own`, if it was empty and is the invocation's now. Defined by the kernel.
uint change_fingerprint(uint at, uint own);

/// Where a key's slot begins; NO_SLOT where it has none.
uint find_change(CellKey key) {
    uint own = hash_fingerprint(key);
    uint slot = hash_slot(hash_index(key, true), CHANGE_CAPACITY);
    uint held = change_fingerprint(CHANGE_WORDS * slot, own);
    while (held != own && held != NO_FINGERPRINT) {
        slot = slot + 1u < CHANGE_CAPACITY ? slot + 1u : 0u;
        held = change_fingerprint(CHANGE_WORDS * slot, own);
    }
    return held == own ? CHANGE_WORDS * slot : NO_SLOT;
}

#endif
