// Keys propose themselves to slots: filter/hpsf/ordered.glsl. The kernel has a buffer `keys`.
#ifndef FILTER_HPSF_PROPOSE_GLSL
#define FILTER_HPSF_PROPOSE_GLSL

#include "filter/hpsf/ordered.glsl"

const uint NO_RANK = ~0u;

/// Proposes a word at its home, and whatever that displaces.
void propose(uint home, uint word) {
    uint distance = 0u;
    while (distance < parameters.hpsf_probes) {
        uint held = atomicMax(keys.at[probe(home, distance)], word | distance);
        if (held == NO_FINGERPRINT || held == (word | distance)) {
            return;
        }
        if (held < (word | distance)) {
            home = home_of(probe(home, distance), held);
            word = held & ~DISTANCE_MASK;
            distance = held & DISTANCE_MASK;
        }
        distance++;
    }
}

/// The next slot in the order of a key's preference: priority of the old cell, then distance. Both are the same all through the pass.
uint next_rank(uint home, uint from) {
    uint next = NO_RANK;
    for (uint i = 0u; i < parameters.hpsf_probes; i++) {
        uint word = keys.at[probe(home, i)];
        uint rank = (word & PRIORITY_MASK) >> (PRIORITY_SHIFT - DISTANCE_BITS) | i;
        bool open = standing_of(word) == STANDING_OLD || standing_of(word) == STANDING_EVICTOR;
        next = open && rank >= from ? min(next, rank) : next;
    }
    return next;
}

/// Proposes a word to the slots that may be taken, and whatever new one that displaces. The slot whose old cell gave way, or NO_SLOT.
uint evict_for(uint home, uint word) {
    uint rank = next_rank(home, 0u);
    while (rank != NO_RANK) {
        uint slot = probe(home, rank & DISTANCE_MASK);
        uint mine = STANDING_EVICTOR << STANDING_SHIFT | rank >> DISTANCE_BITS << PRIORITY_SHIFT | word | rank & DISTANCE_MASK;
        uint held = atomicMax(keys.at[slot], mine);
        if (standing_of(held) == STANDING_OLD) {
            return slot;
        }
        if (held == mine) {
            return NO_SLOT;
        }
        uint from = rank + 1u;
        if (held < mine) {
            home = home_of(slot, held);
            word = held & KEY_MASK & ~DISTANCE_MASK;
            from = 0u;
        }
        rank = next_rank(home, from);
    }
    return NO_SLOT;
}

#endif
