// Wavefront path tracing: the nearest hit of each path's ray, and nothing else, so that this kernel needs few registers.
#include "accel/trace.glsl"
#include "paths/wavefront/queue.glsl"
#include "paths/wavefront/records.glsl"

layout(local_size_x = QUEUE_GROUP) in;

layout(set = 1, binding = 0, scalar) readonly buffer Heads { QueueHead at[]; } heads;
layout(set = 1, binding = 1, scalar) readonly buffer Queue { uint at[]; } queue;
layout(set = 1, binding = 2, scalar) readonly buffer Rays { StoredRay at[]; } rays;
layout(set = 1, binding = 3, scalar) writeonly buffer Hits { Hit at[]; } hits;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= heads.at[paths_of(turn)].count) {
        return;
    }
    uint slot = queue.at[i];
    StoredRay ray = rays.at[slot];
    Hit hit;
    if (!trace_closest(Ray(ray.origin, 0.0, ray.direction, FAR_AWAY), ray.alpha_seed, hit)) {
        hit = Hit(NOTHING_HIT, 0u, 0u, vec2(0.0));
    }
    hits.at[slot] = hit;
}
