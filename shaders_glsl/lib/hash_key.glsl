// Keys of path vertices, and two hashes of them: Binder, section 3.1.2 and algorithm 1; Meijer, algorithms 2 and 3.
//
// A key is the cell of a grid of a power of two metres that a position lies in, that power, and a quantised normal. Cells are numbered from the
// world's zero, not from the frame's origin: coordinates are integers modulo 2^32, the origin's part of them is exact, and so
// they stay when the origin moves, wherever the scene is.
//
// The grid is shifted by a third of a cell along each axis at even levels, and by two thirds at odd ones (Chan, "Approximate Nearest Neighbor
// Queries Revisited", 1998): floors at zero, and whatever else is built to round measures, would lie in borders of cells of all levels, where
// rounding gives every sample to either side by chance, so that each cell has half of them, and other ones with each driver. With
// thirds, cells of a level still are made of eight of the one below. Measured (hpsf, relMSE): `material`, whose floor is such a plane, at 128x72
// 0.269 to 0.248 in one frame, 0.176 to 0.160 after 16; cornell at 32x18 with cells of 4 pixels, without jitter, after 256 frames
// 0.0073 to 0.0029.
//
// Deviations and why: floor instead of Meijer's conversion to int, which would make the cells around zero twice as wide. The exponent is
// taken from the bits, as Meijer does, but is part of both hashes: equal coordinates of two levels are different cells. Normals are
// turned by a fixed rotation before they are quantised, because the axes, the commonest normals of all, would lie on borders
// of the octahedral grid.
#ifndef LIB_HASH_KEY_GLSL
#define LIB_HASH_KEY_GLSL

#include "lib/packing.glsl"
#include "lib/rng.glsl"

struct CellKey {
    ivec3 cell;
    /// Cells are 2^level metres wide.
    int level;
    uint normal;
    /// Of a layered material (Binder, section 3.1.2): 0 its diffuse lobe; else what the radiance of its other lobes depends on.
    uint layer;
};

/// 2^exponent, for -126..127.
float power_of_two(int exponent) {
    return uintBitsToFloat(uint(exponent + 127) << 23);
}

/// Level of the largest cell that is not wider than `width` metres.
int level_of_width(float width) {
    return clamp(int((floatBitsToUint(width) >> 23) & 0xffu) - 127, -100, 100);
}

bool is_odd(int level) {
    return (level & 1) == 1;
}

/// floor(x + 1/3) at even levels, floor(x + 2/3) at odd ones, also where a float has no digits left for the sum.
int shifted_floor(float x, int level) {
    float whole = floor(x);
    return int(whole) + (x - whole >= (is_odd(level) ? 1.0 / 3.0 : 2.0 / 3.0) ? 1 : 0);
}

/// shifted_floor((local + steps 2^log2_step) / 2^level) modulo 2^32. Exact for cells up to the step; larger ones round like the sum.
int cell_coordinate(float local, int steps, int log2_step, int level) {
    // Beyond 2^30 cells positions have long lost the digits that would tell cells apart.
    float scaled = clamp(local * power_of_two(-level), -1073741824.0, 1073741824.0);
    int finer = log2_step - level;
    if (finer >= 0) {
        return shifted_floor(scaled, level) + (finer < 32 ? steps << finer : 0);
    }
    int coarser = min(-finer, 30);
    int whole = steps >> coarser;
    int rest = steps - (whole << coarser);
    return whole + shifted_floor(scaled + float(rest) * power_of_two(-coarser), level);
}

ivec3 cell_of(vec3 local, ivec3 steps, int log2_step, int level) {
    return ivec3(
        cell_coordinate(local.x, steps.x, log2_step, level),
        cell_coordinate(local.y, steps.y, log2_step, level),
        cell_coordinate(local.z, steps.z, log2_step, level));
}

const mat3 NORMALS_TURNED = mat3(0.7476, 0.4915, -0.4466, -0.2794, 0.8448, 0.4563, 0.6016, -0.2163, 0.7690);

/// One of 2^bits cells of directions, bits 0..8.
uint quantise_normal(vec3 n, uint bits) {
    uvec2 split = uvec2((bits + 1u) / 2u, bits / 2u);
    vec2 cells = vec2(uvec2(1u) << split);
    vec2 p = octahedral_encode(NORMALS_TURNED * n) * 0.5 + 0.5;
    uvec2 q = uvec2(clamp(p * cells, vec2(0.0), cells - 1.0));
    return q.x | q.y << split.x;
}

/// The middle of a cell of directions.
vec3 middle_of_normals(uint normal, uint bits) {
    uvec2 split = uvec2((bits + 1u) / 2u, bits / 2u);
    uvec2 cells = uvec2(1u) << split;
    vec2 q = vec2(normal & (cells.x - 1u), normal >> split.x) + 0.5;
    // Nearly a rotation: its transpose inverts it up to the length.
    return normalize(octahedral_decode(q / vec2(cells) * 2.0 - 1.0) * NORMALS_TURNED);
}

/// The cell of the next coarser level that this one is part of.
CellKey parent_of(CellKey key) {
    return CellKey((key.cell + (is_odd(key.level) ? 0 : 1)) >> 1, key.level + 1, key.normal, key.layer);
}

/// One of the eight cells of the next finer level.
CellKey child_of(CellKey key, uint i) {
    ivec3 first = key.cell * 2 - (is_odd(key.level) ? 1 : 0);
    return CellKey(first + ivec3(i & 1u, (i >> 1) & 1u, i >> 2), key.level - 1, key.normal, key.layer);
}

/// Where to look for the key: nested PCG, as Meijer's algorithm 2.
uint hash_index(CellKey key, bool with_normal) {
    uint hash = pcg_hash(uint(key.level) + (with_normal ? key.normal << 16 : 0u));
    hash = pcg_hash(hash + uint(key.cell.z));
    hash = pcg_hash(hash + uint(key.cell.x));
    hash = pcg_hash(hash + uint(key.cell.y));
    return key.layer == 0u ? hash : pcg_hash(hash + key.layer);
}

uint murmur_mix(uint hash, uint word) {
    word *= 0xcc9e2d51u;
    word = (word << 15 | word >> 17) * 0x1b873593u;
    hash ^= word;
    return (hash << 13 | hash >> 19) * 5u + 0xe6546b64u;
}

/// What marks an empty cell, and is no key's fingerprint.
const uint NO_FINGERPRINT = 0u;

/// What tells keys at one place apart: Appleby's MurmurHash3 (x86, 32 bits) of the key's words, four of them, or five where it has a layer.
uint hash_fingerprint(CellKey key) {
    uint hash = murmur_mix(0x9747b28cu, uint(key.cell.x));
    hash = murmur_mix(hash, uint(key.cell.y));
    hash = murmur_mix(hash, uint(key.cell.z));
    hash = murmur_mix(hash, uint(key.level & 0xffff) | key.normal << 16);
    hash = key.layer == 0u ? hash ^ 16u : murmur_mix(hash, key.layer) ^ 20u;
    hash = (hash ^ hash >> 16) * 0x85ebca6bu;
    hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
    return max(hash ^ hash >> 16, 1u);
}

/// As `hash_fingerprint`, of the key without its normal, shortened for the normal's `bits`, which follow as they are: the low ones.
uint fingerprint_with_normal(CellKey key, uint bits) {
    uint rest = hash_fingerprint(CellKey(key.cell, key.level, 0u, key.layer)) << bits;
    return (rest == 0u ? 1u << bits : rest) | key.normal;
}

/// All of a diffuse layer's key in two words, neither of them zero: coordinates modulo 2^16, the level modulo 64, 8 bits of normal. It tells keys apart that
/// are less than 2^16 cells from each other, as those in one view are: from the eye, cells of one level are at most
/// 2 / (width in pixels * angle of a pixel) cells away, 2^13 of one pixel in 8K.
uvec2 exact_key(CellKey key) {
    uvec3 cell = uvec3(key.cell) & 0xffffu;
    uint rest = cell.z | (uint(key.level) & 63u) << 16 | (key.normal & 0xffu) << 22;
    return uvec2(cell.x | cell.y << 16 & 0x7fffffffu, cell.y >> 15 | rest << 1) | 0x80000000u;
}

/// A hash scaled to 0..capacity - 1.
uint hash_slot(uint hash, uint capacity) {
    uint slot;
    uint fraction;
    umulExtended(hash, capacity, slot, fraction);
    return slot;
}

#endif
