// Adds each pixel's radiance behind its filter vertex to a cell: Binder, section 3.2; Meijer, algorithm 4.
//
// A key that is new claims the first empty slot of its probes by atomicCompSwap. Threads with the same key see the same slots taken in
// front of it, so no key gets two slots; one that finds no slot adds nothing, and its pixel goes unfiltered. With hpsf.levels, the
// sample is added to as many ever coarser cells (Binder, 3.3.2). Whoever claims a slot also writes what earlier frames know of
// the cell, in `seeds`: with swapped tables its mean so far; else, and where it is new, that of cells of neighbouring
// levels (Binder, 3.4.2), which a camera that has moved left behind: the finer ones are added up, or the coarser one counts with a
// damped weight, a quarter of its samples by area times hpsf.seed_weight.
//
// Deviations and why: Meijer's algorithm 4 goes on to its second loop after a match and would add twice; here the search ends with it.
#include "filter/hpsf/cell.glsl"
#include "filter/hpsf/table.glsl"
#include "lib/colour.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 2, rgba32f) readonly uniform image2D filter_position;
layout(set = 1, binding = 3, r32ui) readonly uniform uimage2D filter_normal;
layout(set = 1, binding = 4, r32ui) readonly uniform uimage2D filter_incident;
layout(set = 1, binding = 5, scalar) buffer Fingerprints { uint at[]; } fingerprints;
layout(set = 1, binding = 6, scalar) writeonly buffer Seeds { uvec4 at[]; } seeds;
/// What earlier frames know: the last frame's table, or this one where it persists.
layout(set = 1, binding = 7, scalar) readonly buffer KnownCells { uvec4 at[]; } known_cells;
layout(set = 1, binding = 8, scalar) readonly buffer KnownFingerprints { uint at[]; } known_fingerprints;

/// Adds a sample to a slot's sums. `dither`: in [0, 1). Defined by the kernel.
void add_sample(uint slot, vec3 radiance, float dither);

/// What earlier frames know of a key; nothing where it is new.
Cell known_cell(CellKey key) {
    uint fingerprint = hash_fingerprint(key);
    uint home = home_slot(key);
    for (uint i = 0u; i < parameters.hpsf_probes; i++) {
        uint slot = probe(home, i);
        uint found = HPSF_TABLE == TABLE_SWAPPED ? known_fingerprints.at[slot] : fingerprints.at[slot];
        if (found == fingerprint) {
            return unpack_cell(known_cells.at[slot]);
        }
    }
    return EMPTY_CELL;
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

/// The slot of a key, claimed where it is new; NO_SLOT where all probes are taken.
uint find_or_claim(CellKey key) {
    uint fingerprint = hash_fingerprint(key);
    uint home = home_slot(key);
    for (uint i = 0u; i < parameters.hpsf_probes; i++) {
        if (fingerprints.at[probe(home, i)] == fingerprint) {
            return probe(home, i);
        }
    }
    for (uint i = 0u; i < parameters.hpsf_probes; i++) {
        uint slot = probe(home, i);
        uint found = fingerprints.at[slot];
        if (found == NO_FINGERPRINT) {
            found = atomicCompSwap(fingerprints.at[slot], NO_FINGERPRINT, fingerprint);
            if (found == NO_FINGERPRINT) {
                seeds.at[slot] = pack_cell(HPSF_TIME == TIME_FRAME ? EMPTY_CELL : seed_of(key));
                return slot;
            }
        }
        if (found == fingerprint) {
            return slot;
        }
    }
    return NO_SLOT;
}

void collect_pixel() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return;
    }
    vec4 position = imageLoad(filter_position, pixel);
    vec4 direct = imageLoad(diffuse_direct, pixel);
    vec4 indirect = imageLoad(diffuse_indirect, pixel);
    vec3 radiance = direct.rgb + indirect.rgb;
    if (!(position.w > 0.0) || direct.w * indirect.w == 0.0 || !all_finite(radiance)) {
        return;
    }
    FilterPoint point = filter_point(uvec2(pixel), position, imageLoad(filter_normal, pixel).x, imageLoad(filter_incident, pixel).x);
    vec4 numbers = jitter_numbers(uvec2(pixel), 0u);
    float dither = unit_float(pcg3d(uvec3(pixel, frame.first_sample ^ frame.seed)).z);
    for (uint level = 0u; level < parameters.hpsf_levels; level++) {
        uint slot = find_or_claim(key_of(point, numbers, int(level)));
        if (slot != NO_SLOT) {
            add_sample(slot, clamp(radiance, vec3(0.0), vec3(parameters.hpsf_largest)), dither);
        }
    }
}
