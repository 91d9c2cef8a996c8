// Slots for new keys that depend on the keys alone, not on which thread comes first: Binder, section 3.4.3.
//
// Every key proposes itself to its probes in order by a single atomicMax, and a slot keeps the largest word that was ever proposed to it.
// Who displaces another key proposes that one further on. This is Gale and Shapley's deferred acceptance: a stable matching of
// keys and slots, the same in whatever order they propose. Threads with one key do no harm to each other, as what turned one down
// turns the others down. Words only grow, so it ends; nobody waits.
//
// A word, from its top: standing (2 bits), priority (4), fingerprint (20), distance from home (6), by which a displaced key is known to
// whoever carries it. Since the distance is held against the prober's, too, a fingerprint is compared with those of the same home alone:
// the expected number of false matches per key is the occupancy times 2^-20.
//
// Deviations and why: the largest instead of the smallest, so that zeroed memory is empty. Priority decides among cells of earlier frames
// that nobody has touched in this one; new ones have no history to tell them apart by. The paper's single atomicMin would leave a
// displaced key's samples without a cell though its next slot may be free, and which ones that hits would depend on the order.
//
// Tried: coarser cells first, which stand in for many finer ones (Binder, section 5). In a table of 0.02 cells per pixel (one frame, 96x54,
// width 8), insertions that fail went from 0.84 to 0.67 on cornell and relMSE from 0.074 to 0.042, but FLIP from 0.118 to 0.126, as what
// is left is coarse; on the hall nothing improved. First come, first served is at 0.84, 0.073 and 0.115 there.
#ifndef FILTER_HPSF_ORDERED_GLSL
#define FILTER_HPSF_ORDERED_GLSL

#include "filter/hpsf/table.glsl"

/// New in an empty slot; any other standing is greater, and keeps it off.
const uint STANDING_NEW = 0u;
/// Of an earlier frame, not touched in this one so far.
const uint STANDING_OLD = 1u;
/// New in the slot of an old one, whose priority it keeps.
const uint STANDING_EVICTOR = 2u;
/// Of an earlier frame, touched in this one: stays.
const uint STANDING_TOUCHED = 3u;
const uint STANDING_SHIFT = 30u;
const uint PRIORITY_SHIFT = 26u;
const uint PRIORITY_MASK = 15u << PRIORITY_SHIFT;
const uint DISTANCE_MASK = (1u << DISTANCE_BITS) - 1u;

uint standing_of(uint word) {
    return word >> STANDING_SHIFT;
}

/// Of an old cell: more samples make up for age, 2 bits of them for a frame. 0..15.
uint priority_of(Cell cell) {
    return uint(clamp(8 + findMSB(cell.count) / 2 - int(cell.age), 0, 15));
}

uint old_word(uint word, Cell cell) {
    return word & KEY_MASK | priority_of(cell) << PRIORITY_SHIFT | STANDING_OLD << STANDING_SHIFT;
}

/// The home of a key whose word is in `slot`.
uint home_of(uint slot, uint word) {
    uint distance = word & DISTANCE_MASK;
    return slot >= distance ? slot - distance : slot + CAPACITY - distance;
}

#endif
