// Looks keys up in the table: Binder, section 3.2.
#ifndef FILTER_HPSF_FIND_GLSL
#define FILTER_HPSF_FIND_GLSL

#include "filter/hpsf/table.glsl"

/// A word of the kernel's buffer of keys. Defined by the kernel.
uint key_word(uint at);

uvec2 words_at(uint slot) {
    return uvec2(key_word(KEY_WORDS * slot) & KEY_MASK, EXACT ? key_word(KEY_WORDS * slot + 1u) : 0u);
}

bool holds(uint slot, uvec2 words) {
    return (key_word(KEY_WORDS * slot) & KEY_MASK) == words.x && (!EXACT || key_word(KEY_WORDS * slot + 1u) == words.y);
}

/// How far from home a key is, or hpsf.probes where it is in no slot.
uint distance_to(CellKey key) {
    uvec2 words = words_of(key);
    uint home = home_slot(key);
    uint distance = 0u;
    while (distance < parameters.hpsf_probes && !holds(probe(home, distance), at_distance(words, distance))) {
        distance++;
    }
    return distance;
}

/// The slot of a key; NO_SLOT where it has none.
uint find_slot(CellKey key) {
    uint distance = distance_to(key);
    return distance < parameters.hpsf_probes ? probe(home_slot(key), distance) : NO_SLOT;
}

/// Whether the slot `distance` from home holds the key of the same place with another normal, no more than hpsf.similar from `normal`.
bool holds_similar(uint slot, uvec2 words, vec3 normal) {
    uvec2 held = words_at(slot);
    if (held == words || ((held ^ words) & ~normal_mask()) != uvec2(0u)) {
        return false;
    }
    vec3 other = middle_of_normals(normal_of(held), parameters.hpsf_normal_bits);
    return dot(other, normal) >= cos(radians(parameters.hpsf_similar));
}

#endif
