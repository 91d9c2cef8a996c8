// Wavefront path tracing, before each sample of a frame: empty queues, and the sample's number.
#include "lib/elements.glsl"
#include "paths/wavefront/queue.glsl"

layout(local_size_x = 64) in;

/// Queues.
layout(constant_id = 203) const uint HEADS = 1;

layout(set = 1, binding = 0, scalar) writeonly buffer Heads { QueueHead at[]; } heads;
/// ~0 before the first sample of a frame.
layout(set = 1, binding = 1, scalar) buffer SampleNumber { uint number; } sample_number;

void main() {
    uint i = element_index();
    if (i < HEADS) {
        heads.at[i] = QueueHead(0u, 1u, 1u, 0u);
    }
    if (i == 0u) {
        sample_number.number++;
    }
}
