// Where light has changed, cells forget: Binder, section 3.4.1, the hybrid of temporal filtering and integration.
//
// How much is in filter/hpsf/forgetting.glsl. Light that stands still has changed by exactly nothing, and is integrated; at a shadow's edge
// the relative change is near 1, and what is new is all. Each pixel puts its limit to the cells of its sample before they are merged, and
// to those that it will look up, where no sample of this frame may have gone: the smallest one stands, in whatever order.
//
// What an object uncovers may look different from what its cells remember, without any path that tells so: nobody saw it when it changed. So
// where retraced paths tell that something has come into view, cells that had no sample in the last frame know nothing. Elsewhere these
// are cells that the jitter has missed, and keep what they know.
#include "filter/hpsf/changes.glsl"
#include "filter/hpsf/find.glsl"
#include "filter/hpsf/forgetting.glsl"
#include "filter/hpsf/stored_cell.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(constant_id = 223) const bool FLOAT_SUMS = false;

layout(set = 1, binding = 0, rgba32f) readonly uniform image2D filter_position;
layout(set = 1, binding = 1, r32ui) readonly uniform uimage2D filter_normal;
layout(set = 1, binding = 2, r32ui) readonly uniform uimage2D filter_incident;
layout(set = 1, binding = 3, scalar) readonly buffer Changes { uint at[]; } changes;
layout(set = 1, binding = 4, scalar) readonly buffer Keys { uint at[]; } keys;
layout(set = 1, binding = 5, scalar) readonly buffer Sums { uint at[]; } sums;
layout(set = 1, binding = 6, scalar) buffer Cells { CELL_WORDS at[]; } cells;
layout(set = 1, binding = 7, scalar) buffer Seeds { CELL_WORDS at[]; } seeds;
/// Relative change of the light in the pixel's cells, 0..1; 1 where something has come into view, or other lobes have changed.
layout(set = 1, binding = 8, r32f) writeonly uniform image2D change;
layout(set = 1, binding = 9, r32ui) readonly uniform uimage2D filter_layer;

uint key_word(uint at) {
    return keys.at[at];
}

/// Retraced paths that tell of a cell.
struct Change {
    uint paths;
    vec3 now;
    vec3 before;
};

vec3 sums_at(uint at) {
    return vec3(
        from_fixed(changes.at[at], changes.at[at + 1u]),
        from_fixed(changes.at[at + 2u], changes.at[at + 3u]),
        from_fixed(changes.at[at + 4u], changes.at[at + 5u]));
}

uint change_fingerprint(uint at, uint own) {
    return changes.at[at];
}

Change change_of_key(CellKey key) {
    uint slot = find_change(key);
    return slot == NO_SLOT ? Change(0u, vec3(0.0), vec3(0.0)) : Change(changes.at[slot + 1u], sums_at(slot + 2u), sums_at(slot + 8u));
}

/// Around a vertex, whether something has come into view, and whether lobes have changed that the table is not about.
bvec2 told_around(FilterPoint point, vec4 numbers) {
    uint slot = find_change(surroundings_key(point, numbers));
    return slot == NO_SLOT ? bvec2(false) : bvec2(changes.at[slot + UNCOVERED] > 0u, changes.at[slot + OTHER_LOBES] > 0u);
}

/// At a level, or at the next coarser one where enough paths tell of it.
float change_at(FilterPoint point, vec4 numbers, uint level) {
    Change best = Change(0u, vec3(0.0), vec3(0.0));
    for (; level < parameters.hpsf_levels + FURTHER_LEVELS && best.paths < parameters.hpsf_retraced_few; level++) {
        Change found = change_of_key(change_key(point, numbers, level));
        if (found.paths > best.paths) {
            best = found;
        }
    }
    return relative_difference(best.now, best.before);
}

uint new_samples(uint slot) {
    return FLOAT_SUMS ? uint(uintBitsToFloat(sums.at[4u * slot + 3u])) : sums.at[8u * slot + 6u];
}

/// `forgets_unseen`: cells that nobody saw in the last frame know nothing.
void forget(CellKey key, float relative_change, bool forgets_unseen) {
    uint slot = find_slot(key);
    if (slot == NO_SLOT) {
        return;
    }
    uint known = cells.at[slot][LAST_WORD];
    bool unseen = unpack_age(known) > 0u;
    uint limit = forgets_unseen && unseen ? 0u : past_samples(relative_change, max(new_samples(slot), 1u));
    // All but the count is the same for all.
    atomicMin(cells.at[slot][LAST_WORD], with_count(known, limit));
    atomicMin(seeds.at[slot][LAST_WORD], with_count(seeds.at[slot][LAST_WORD], limit));
}

/// The cells at one jittered place, of all levels; the greatest change.
float forget_cells(FilterPoint point, vec4 numbers, bool uncovered) {
    float most = 0.0;
    for (uint level = 0u; level < parameters.hpsf_levels; level++) {
        float found = change_at(point, numbers, level);
        if (found > 0.0 || uncovered) {
            forget(key_of(point, numbers, int(level)), found, uncovered);
        }
        most = max(most, found);
    }
    return most;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return;
    }
    vec4 position = imageLoad(filter_position, pixel);
    uint layer = layer_of_part(imageLoad(filter_layer, pixel).x);
    float shown = 0.0;
    if (position.w > 0.0 && (PART != PART_GLOSSY || layer != 0u)) {
        FilterPoint point = filter_point(uvec2(pixel), position, imageLoad(filter_normal, pixel).x, imageLoad(filter_incident, pixel).x);
        point.layer = layer;
        bool uncovered = false;
        bool others_changed = false;
        for (uint i = 0u; i <= parameters.hpsf_lookups && (i == 0u || uncovered || shown > 0.0); i++) {
            vec4 numbers = jitter_numbers(uvec2(pixel), i);
            bvec2 told = told_around(point, numbers);
            uncovered = uncovered || told.x;
            others_changed = others_changed || told.y;
            shown = max(shown, forget_cells(point, numbers, uncovered));
        }
        shown = uncovered || others_changed ? 1.0 : shown;
    }
    imageStore(change, pixel, vec4(shown));
}
