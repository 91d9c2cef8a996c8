// Appends to queues (queue.glsl): each subgroup counts its entries by a ballot and reserves places for all of them by one atomic addition,
// a second one where they begin a workgroup more. Places are in order within a subgroup, so that neighbours stay neighbours.
#ifndef PATHS_WAVEFRONT_APPEND_GLSL
#define PATHS_WAVEFRONT_APPEND_GLSL

#include "paths/wavefront/queue.glsl"

layout(set = 1, binding = 0, scalar) buffer Heads { QueueHead at[]; } heads;

/// The place of this thread's entry; nothing where it has none.
uint append(uint queue, bool has_entry) {
    uvec4 entries = subgroupBallot(has_entry);
    uint count = subgroupBallotBitCount(entries);
    uint first = 0u;
    if (count > 0u && subgroupElect()) {
        first = atomicAdd(heads.at[queue].count, count);
        uint more = groups_of(first + count) - groups_of(first);
        if (more > 0u) {
            atomicAdd(heads.at[queue].groups, more);
        }
    }
    return subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(entries);
}

#endif
