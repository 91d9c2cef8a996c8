// The hash table: Binder, section 3.2. A key's place is looked for in hpsf.probes slots from the one that its first hash names; its second
// hash is its fingerprint there (section 3.2.1), or, with hpsf.keys, two words that hold the key itself. Keys are never moved, and eviction
// leaves holes, so that all these slots are searched before a key is taken to be absent. filter/hpsf/find.glsl and claim.glsl do
// so in a kernel's buffer of keys.
#ifndef FILTER_HPSF_TABLE_GLSL
#define FILTER_HPSF_TABLE_GLSL

#include "filter/hpsf/iteration.glsl"
#include "lib/hash_key.glsl"
#include "shared/bindings.glsl"

layout(constant_id = 221) const uint CAPACITY = 1;
/// Which part of the light behind the filter vertex the table is about (hpsf.split, hpsf.glossy).
layout(constant_id = 231) const uint PART = 0;

const uint PART_DIRECT = 1u;
const uint PART_INDIRECT = 2u;
const uint PART_GLOSSY = 3u;

const uint KEYS_FINGERPRINT = 0u;
const uint KEYS_EXACT = 1u;
const uint NORMALS_KEY = 0u;
const uint NORMALS_SIMILAR = 2u;
const uint TIME_FRAME = 0u;
const uint TIME_AVERAGE = 1u;
const uint TIME_INTEGRATE = 2u;
const uint TIME_HYBRID = 3u;
const uint TIME_DETECT = 4u;
/// What is filtered again has no history.
const uint TIME = ITERATION == 0u ? HPSF_TIME : TIME_FRAME;
const uint TABLE_PERSISTENT = 0u;
const uint TABLE_SWAPPED = 1u;

/// Of the lobes that the table is about; 0: the diffuse one.
uint layer_of_part(uint layer) {
    return PART == PART_GLOSSY ? layer : 0u;
}

/// Slots are given in a fixed order (filter/hpsf/ordered.glsl), in which words of a slot differ by more than the key.
const bool ORDERED = HPSF_INSERTION == 1u || HPSF_EVICTION == 1u;
const bool EXACT = HPSF_KEYS == KEYS_EXACT && !ORDERED && PART != PART_GLOSSY;
/// Of a slot in the buffer of keys. Zero: an empty slot.
const uint KEY_WORDS = EXACT ? 2u : 1u;
/// Bits of a slot's first word that tell its key.
const uint KEY_MASK = ORDERED ? 0x03ffffffu : ~0u;
/// Lowest bits of an ordered word: how far from home the key is.
const uint DISTANCE_BITS = 6u;
const uint NO_SLOT = ~0u;
const uint MOST_SAMPLES = 0xffffffu;

/// What a cell knows; filter/hpsf/stored_cell.glsl has its bits.
struct Cell {
    vec3 mean;
    /// Samples that the mean is over, 0..MOST_SAMPLES.
    uint count;
    /// Frames since the last one, 0..255.
    uint age;
};

const Cell EMPTY_CELL = Cell(vec3(0.0), 0u, 0u);

/// What stands for a key in its home slot: the first KEY_WORDS words, under KEY_MASK.
uvec2 words_of(CellKey key) {
    if (EXACT) {
        return exact_key(key);
    }
    uint normal_bits = HPSF_NORMALS == NORMALS_KEY ? 0u : parameters.hpsf_normal_bits;
    uint fingerprint = normal_bits == 0u ? hash_fingerprint(key) : fingerprint_with_normal(key, normal_bits);
    if (!ORDERED) {
        return uvec2(fingerprint, 0u);
    }
    fingerprint <<= DISTANCE_BITS;
    fingerprint &= KEY_MASK;
    return uvec2(fingerprint == 0u ? 1u << (DISTANCE_BITS + normal_bits) : fingerprint, 0u);
}

/// The same `distance` slots further.
uvec2 at_distance(uvec2 words, uint distance) {
    return ORDERED ? uvec2(words.x | distance, 0u) : words;
}

/// Which bits of words are the normal, where hpsf.normals is fingerprint.
uvec2 normal_mask() {
    uint mask = (1u << parameters.hpsf_normal_bits) - 1u;
    return EXACT ? uvec2(0u, 0xffu << 23) : uvec2(ORDERED ? mask << DISTANCE_BITS : mask, 0u);
}

uint normal_of(uvec2 words) {
    words &= normal_mask();
    return EXACT ? words.y >> 23 : ORDERED ? words.x >> DISTANCE_BITS : words.x;
}

/// The slot that the search for a key begins at.
uint home_slot(CellKey key) {
    return hash_slot(hash_index(key, HPSF_NORMALS == NORMALS_KEY), CAPACITY);
}

/// Slot number `distance` of a search.
uint probe(uint home, uint distance) {
    uint slot = home + distance;
    return slot < CAPACITY ? slot : slot - CAPACITY;
}

/// The mean of both, each sample counting as much.
Cell add_cells(Cell a, Cell b) {
    float both = max(float(a.count) + float(b.count), 1.0);
    return Cell(mix(a.mean, b.mean, float(b.count) / both), min(a.count + b.count, MOST_SAMPLES), 0u);
}

#endif
