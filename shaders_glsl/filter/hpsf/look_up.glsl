// What cells know around a pixel's vertex: Binder, algorithm 1; Meijer, algorithm 5. The kernel has buffers `keys` and `cells`.
//
// The pixel reads the cell that its own sample went to, or the mean of hpsf.lookups cells, found by as many further jitters: more of them
// leave less of the jitter's noise. A cell of fewer samples than hpsf.few is helped out by cells of similar normals at its place (Binder,
// 3.2.2), by its neighbours in the tangent plane (3.3.1), or by the next coarser level that has enough (3.3.2).
#ifndef FILTER_HPSF_LOOK_UP_GLSL
#define FILTER_HPSF_LOOK_UP_GLSL

#include "filter/hpsf/cell.glsl"
#include "filter/hpsf/find.glsl"
#include "filter/hpsf/stored_cell.glsl"

uint key_word(uint at) {
    return keys.at[at];
}

Cell cell_of_key(CellKey key) {
    uint slot = find_slot(key);
    return slot == NO_SLOT ? EMPTY_CELL : unpack_cell(cells.at[slot]);
}

/// With the cells of the same place whose normals are similar (Binder, section 3.2.2, figure 7c).
Cell with_similar(Cell cell, CellKey key, vec3 normal) {
    uvec2 words = words_of(key);
    uint home = home_slot(key);
    for (uint i = 0u; i < parameters.hpsf_probes; i++) {
        if (holds_similar(probe(home, i), at_distance(words, i), normal)) {
            cell = add_cells(cell, unpack_cell(cells.at[probe(home, i)]));
        }
    }
    return cell;
}

/// With the eight cells around it in the tangent plane.
Cell with_neighbours(Cell cell, FilterPoint point, vec4 numbers, int coarser) {
    Basis basis = basis_around(point.normal);
    float size = power_of_two(level_at(point.distance, level_number(numbers)) + coarser - finer_levels(point.layer));
    vec3 centre = point.position;
    for (uint i = 0u; i < 9u; i++) {
        if (i != 4u) {
            vec2 step = (vec2(i % 3u, i / 3u) - 1.0) * size;
            point.position = centre + step.x * basis.tangent + step.y * basis.bitangent;
            cell = add_cells(cell, cell_of_key(key_of(point, numbers, coarser)));
        }
    }
    return cell;
}

/// Whether the cells that make up a coarser one differ by more than their noise: a chi-square test of equal means, against its expectation
/// and hpsf.adaptive of its standard deviations, where a sample's standard deviation is its mean.
bool splits(CellKey key) {
    Cell children[8];
    Cell all = EMPTY_CELL;
    float known = 0.0;
    for (uint i = 0u; i < 8u; i++) {
        children[i] = cell_of_key(child_of(key, i));
        all = add_cells(all, children[i]);
        known += children[i].count > 0u ? 1.0 : 0.0;
    }
    float spread = 0.0;
    for (uint i = 0u; i < 8u; i++) {
        float difference = dot(children[i].mean - all.mean, vec3(1.0));
        spread += float(children[i].count) * difference * difference;
    }
    float mean = dot(all.mean, vec3(1.0));
    float freedom = known - 1.0;
    return freedom > 0.0 && spread > mean * mean * (freedom + parameters.hpsf_adaptive * sqrt(2.0 * freedom));
}

/// The coarsest level whose cell does not split (Binder, section 3.1.3). The children decide, all alike: a choice by how far one cell is from
/// its parent would keep exactly the cells that chance has made stand out.
///
/// Against cells that all are as wide as the coarsest (cornell, 128x72, one frame, FLIP and relMSE; 4 to 16 pixels): 0.101 and 0.0105 instead of
/// 0.114 and 0.0113; after 16 frames 0.061 and 0.0048 instead of 0.102 and 0.0092. Cells that all are as fine as the finest are better
/// there: 0.084 and 0.0095, 0.049 and 0.0036. So it mends wide cells, and is no reason for them. What is filtered again has not the noise that the
/// test takes it for.
uint adaptive_level(FilterPoint point, vec4 numbers) {
    uint level = parameters.hpsf_levels - 1u;
    while (level > 0u && splits(key_of(point, numbers, int(level)))) {
        level--;
    }
    return level;
}

/// What is known at one jittered place: of the finest level that has enough samples, or else of the coarsest one.
Cell look_up(FilterPoint point, vec4 numbers) {
    Cell best = EMPTY_CELL;
    uint finest = parameters.hpsf_adaptive > 0.0 && ITERATION == 0u ? adaptive_level(point, numbers) : 0u;
    for (uint level = finest; level < parameters.hpsf_levels && best.count < max(parameters.hpsf_few, 1u); level++) {
        CellKey key = key_of(point, numbers, int(level));
        Cell cell = cell_of_key(key);
        if (HPSF_NORMALS == NORMALS_SIMILAR && cell.count < parameters.hpsf_few) {
            cell = with_similar(cell, key, point.normal);
        }
        if (HPSF_NEIGHBOURS == 1u && cell.count < parameters.hpsf_few) {
            cell = with_neighbours(cell, point, numbers, int(level));
        }
        if (cell.count > best.count) {
            best = cell;
        }
    }
    return best;
}

/// Of a pixel's vertex.
struct Known {
    /// Over cells.
    vec3 mean;
    /// Of all these cells.
    uint samples;
    /// How many; 0: nothing is known.
    uint cells;
};

Known known_of(FilterPoint point, uvec2 pixel) {
    Known all = Known(vec3(0.0), 0u, 0u);
    for (uint i = 1u; i <= parameters.hpsf_lookups; i++) {
        Cell cell = look_up(point, jitter_numbers(pixel, i));
        if (cell.count > 0u) {
            all = Known(all.mean + cell.mean, all.samples + cell.count, all.cells + 1u);
        }
    }
    if (all.cells == 0u) {
        Cell cell = look_up(point, jitter_numbers(pixel, 0u));
        all = Known(cell.mean, cell.count, min(cell.count, 1u));
    }
    all.mean /= float(max(all.cells, 1u));
    return all;
}

#endif
