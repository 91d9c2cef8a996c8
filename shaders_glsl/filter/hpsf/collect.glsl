// Adds radiance behind a filter vertex to a cell, each pixel's (pixel_sample.glsl) or that of a path's further vertices
// (filter/nhpsf/vertex_sample.glsl): Binder, section 3.2; Meijer, algorithm 4.
//
// With hpsf.levels, the sample is added to as many ever coarser cells (Binder, 3.3.2). Whoever is the first of a frame at a cell that
// nothing is known of also writes what it begins with, in `seeds`: with swapped tables its mean so far; else, and where it is new, that of
// cells of neighbouring levels (Binder, 3.4.2), which a camera that has moved left behind: the finer ones are added up, or the coarser
// one counts with a damped weight, a quarter of its samples by area times hpsf.seed_weight.
#include "filter/hpsf/cell.glsl"
#include "filter/hpsf/find.glsl"
#include "filter/hpsf/stored_cell.glsl"
#include "lib/colour.glsl"

/// What goes into cells.
struct CellSample {
    CellPoint at;
    vec3 radiance;
    /// In [0, 1).
    float dither;
};

/// The invocation's sample; false where it has none. Defined by the kernel.
bool find_sample(out CellSample one);

layout(set = 1, binding = 5, scalar) buffer Keys { uint at[]; } keys;
layout(set = 1, binding = 6, scalar) writeonly buffer Seeds { CELL_WORDS at[]; } seeds;
/// What earlier frames know: the last frame's table, or this one where it persists.
layout(set = 1, binding = 7, scalar) readonly buffer KnownCells { CELL_WORDS at[]; } known_cells;
layout(set = 1, binding = 8, scalar) readonly buffer KnownKeys { uint at[]; } known_keys;

#include "filter/hpsf/claim.glsl"

/// Adds a sample to a slot's sums; whether it is the frame's first there. `dither`: in [0, 1). Defined by the kernel.
bool add_sample(uint slot, vec3 radiance, float dither);

uint key_word(uint at) {
    return HPSF_TABLE == TABLE_SWAPPED ? known_keys.at[at] : keys.at[at];
}

/// What earlier frames know of a key; nothing where it is new.
Cell known_cell(CellKey key) {
    uint slot = find_slot(key);
    return slot == NO_SLOT ? EMPTY_CELL : unpack_cell(known_cells.at[slot]);
}

/// What a cell begins with.
Cell seed_of(CellKey key) {
    Cell known = EMPTY_CELL;
    if (HPSF_TABLE == TABLE_SWAPPED) {
        known = known_cell(key);
    }
    if (known.count > 0u || HPSF_SEED == 0u) {
        return known;
    }
    for (uint i = 0u; i < 8u; i++) {
        known = add_cells(known, known_cell(child_of(key, i)));
    }
    if (known.count == 0u) {
        known = known_cell(parent_of(key));
        known.count = uint(float(known.count) * 0.25 * parameters.hpsf_seed_weight);
    }
    return known;
}

/// Nothing is in the slot's cell so far.
bool is_unknown(uint slot) {
    return HPSF_TABLE == TABLE_SWAPPED || unpack_cell(known_cells.at[slot]).count == 0u;
}

/// The radiance, no brighter than hpsf.limit times what the slot's cell knows from hpsf.few samples or more.
///
/// That is biased, and feeds on itself, since the mean is of limited samples: light that fewer than one in hpsf.limit samples finds fades
/// from a cell, however bright it is. A cell that knows only black takes everything. Measured after 16 frames of 96x54 pixels, mean radiance
/// over that without a limit, and relMSE likewise: cornell 0.998 and 0.998 with a limit of 10, 0.97 and 1.02 with 3; material
/// 0.975 and 0.97 with 10, 0.65 and 1.15 with 3. A limit of 10 gains little, and less than 10 loses light.
vec3 limited(vec3 radiance, CellKey key, uint slot) {
    Cell known = HPSF_TABLE == TABLE_SWAPPED ? known_cell(key) : unpack_cell(known_cells.at[slot]);
    float most = parameters.hpsf_limit * luminance(known.mean);
    float own = luminance(radiance);
    return known.count >= parameters.hpsf_few && most > 0.0 && own > most ? radiance * (most / own) : radiance;
}

void main() {
    CellSample one;
    if (!find_sample(one) || !all_finite(one.radiance)) {
        return;
    }
    for (uint level = 0u; level < parameters.hpsf_levels; level++) {
        CellKey key = key_of(one.at.point, one.at.numbers, one.at.coarser + int(level));
        uint slot = find_or_claim(key);
        if (slot == NO_SLOT) {
            continue;
        }
        vec3 added = parameters.hpsf_limit > 0.0 && ITERATION == 0u ? limited(one.radiance, key, slot) : one.radiance;
        bool first = add_sample(slot, clamp(added, vec3(0.0), vec3(parameters.hpsf_largest)), one.dither);
        if (first && TIME != TIME_FRAME && is_unknown(slot)) {
            seeds.at[slot] = pack_cell(seed_of(key));
        }
    }
}
