// Looks keys up in the table: Binder, section 3.2.
#ifndef FILTER_HPSF_FIND_GLSL
#define FILTER_HPSF_FIND_GLSL

#include "filter/hpsf/table.glsl"

/// A word of the kernel's buffer of keys. Defined by the kernel.
uint key_word(uint at);

bool holds(uint slot, uvec2 words) {
    return key_word(KEY_WORDS * slot) == words.x && (KEY_WORDS == 1u || key_word(KEY_WORDS * slot + 1u) == words.y);
}

/// How far from home a key is, or hpsf.probes where it is in no slot.
uint distance_to(CellKey key) {
    uvec2 words = words_of(key);
    uint home = home_slot(key);
    uint distance = 0u;
    while (distance < parameters.hpsf_probes && !holds(probe(home, distance), words)) {
        distance++;
    }
    return distance;
}

/// The slot of a key; NO_SLOT where it has none.
uint find_slot(CellKey key) {
    uint distance = distance_to(key);
    return distance < parameters.hpsf_probes ? probe(home_slot(key), distance) : NO_SLOT;
}

#endif
