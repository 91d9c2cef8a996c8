// Queues of the wavefront path tracer. One for the paths of each turn, one for the shadow rays that the turn sends; their heads lie in one
// buffer, so that what a turn appends is the next one's size of dispatch, and no memory is cleared between turns.
#ifndef PATHS_WAVEFRONT_QUEUE_GLSL
#define PATHS_WAVEFRONT_QUEUE_GLSL

/// Threads of a workgroup over a queue: 65535 groups of them cover 3840x2160 pixels.
const uint QUEUE_GROUP = 128u;

/// 16 bytes.
struct QueueHead {
    /// The workgroups of an indirect dispatch over the queue.
    uint groups;
    uint rows;
    uint layers;
    /// Entries.
    uint count;
};

/// Of the pass: which visits to vertices it is for.
layout(push_constant) uniform Arguments {
    uint turn;
};

/// Heads of a turn's queues.
uint paths_of(uint turn) {
    return 2u * turn;
}

uint shadow_rays_of(uint turn) {
    return 2u * turn + 1u;
}

uint groups_of(uint count) {
    return (count + QUEUE_GROUP - 1u) / QUEUE_GROUP;
}

#endif
