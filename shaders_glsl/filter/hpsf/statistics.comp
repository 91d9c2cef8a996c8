// What became of this frame's insertions, looked up again when all are done, so that the filter itself counts nothing.
#include "filter/hpsf/cell.glsl"
#include "filter/hpsf/table.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, rgba32f) readonly uniform image2D filter_position;
layout(set = 1, binding = 1, r32ui) readonly uniform uimage2D filter_normal;
layout(set = 1, binding = 2, r32ui) readonly uniform uimage2D filter_incident;
layout(set = 1, binding = 3, scalar) readonly buffer Fingerprints { uint at[]; } fingerprints;
/// Slots that the sample's finest key was looked for in: 1 where it is at home, hpsf.probes + 1 where it is in none, 0 without a vertex.
layout(set = 1, binding = 4, r32ui) writeonly uniform uimage2D hpsf_probed;
/// Levels, of hpsf.levels, at which the sample's insertion failed.
layout(set = 1, binding = 5, r32ui) writeonly uniform uimage2D hpsf_failed;
/// Taken slots among those whose number is the pixel's, modulo the number of pixels: their sum is that of the table.
layout(set = 1, binding = 6, r32ui) writeonly uniform uimage2D hpsf_taken;

uint probes_to(CellKey key) {
    uint fingerprint = hash_fingerprint(key);
    uint home = home_slot(key);
    uint distance = 0u;
    while (distance < parameters.hpsf_probes && fingerprints.at[probe(home, distance)] != fingerprint) {
        distance++;
    }
    return distance + 1u;
}

uint taken_slots(uint first) {
    uint taken = 0u;
    for (uint slot = first; slot < CAPACITY; slot += frame.extent.x * frame.extent.y) {
        taken += fingerprints.at[slot] != NO_FINGERPRINT ? 1u : 0u;
    }
    return taken;
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, frame.extent))) {
        return;
    }
    ivec2 at = ivec2(pixel);
    vec4 position = imageLoad(filter_position, at);
    uint probed = 0u;
    uint failed = 0u;
    if (position.w > 0.0) {
        FilterPoint point = filter_point(pixel, position, imageLoad(filter_normal, at).x, imageLoad(filter_incident, at).x);
        vec4 numbers = jitter_numbers(pixel, 0u);
        probed = probes_to(key_of(point, numbers, 0));
        for (uint level = 0u; level < parameters.hpsf_levels; level++) {
            failed += probes_to(key_of(point, numbers, int(level))) > parameters.hpsf_probes ? 1u : 0u;
        }
    }
    imageStore(hpsf_probed, at, uvec4(probed));
    imageStore(hpsf_failed, at, uvec4(failed));
    imageStore(hpsf_taken, at, uvec4(taken_slots(pixel.y * frame.extent.x + pixel.x)));
}
