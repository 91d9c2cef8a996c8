// Slots for new keys: Binder, section 3.2; Meijer, algorithm 4. The kernel has a buffer `keys`.
//
// A new key claims the first empty slot of its probes by compare-and-exchange. Threads with the same key see the same slots taken in
// front of it, so no key gets two slots; one that finds no slot adds nothing, and its pixel goes unfiltered.
//
// A key of two words claims one after the other. Who finds the first word to be its own, or sets it, goes on to the second; who finds
// another's there goes on to the next slot, even if it was the one to set the first. Each word is set once and never changes in
// a frame, so threads with one key still decide alike at each slot, nobody waits for anybody, and 64-bit integers are not needed. The
// slot belongs to the key whose second word is in it: whoever sets that has claimed it.
//
// Deviations and why: Meijer's algorithm 4 goes on to its second loop after a match and would add twice; here the search ends with it.
#ifndef FILTER_HPSF_CLAIM_GLSL
#define FILTER_HPSF_CLAIM_GLSL

#include "filter/hpsf/table.glsl"

bool is_here(uint slot, uvec2 words) {
    return (keys.at[KEY_WORDS * slot] & KEY_MASK) == words.x && (!EXACT || keys.at[KEY_WORDS * slot + 1u] == words.y);
}

/// What a word held; it holds `own` now if that was nothing.
uint claim_word(uint at, uint own) {
    uint held = keys.at[at];
    return held == NO_FINGERPRINT ? atomicCompSwap(keys.at[at], NO_FINGERPRINT, own) : held;
}

/// The slot of a key, claimed where it is new; NO_SLOT where all probes are taken, or slots have been given (filter/hpsf/ordered.glsl).
uint find_or_claim(CellKey key) {
    uvec2 words = words_of(key);
    uint home = home_slot(key);
    for (uint i = 0u; i < parameters.hpsf_probes; i++) {
        if (is_here(probe(home, i), at_distance(words, i))) {
            return probe(home, i);
        }
    }
    if (ORDERED) {
        return NO_SLOT;
    }
    for (uint i = 0u; i < parameters.hpsf_probes; i++) {
        uint slot = probe(home, i);
        uint last = 0u;
        uint held = claim_word(KEY_WORDS * slot, words.x);
        if (EXACT && (held == NO_FINGERPRINT || held == words.x)) {
            last = 1u;
            held = claim_word(KEY_WORDS * slot + 1u, words.y);
        }
        if (last + 1u == KEY_WORDS && (held == NO_FINGERPRINT || held == words[last])) {
            return slot;
        }
    }
    return NO_SLOT;
}

#endif
