// What became of this frame's insertions, looked up again when all are done, so that the filter itself counts nothing.
//
// A sample's key is held against the key of its slot's owner (filter/hpsf/owners.comp), both found anew from their vertices: whole keys,
// whatever the table keeps of them. Keys that only earlier frames have touched are not known any more, and not counted.
#include "filter/hpsf/cell.glsl"
#include "filter/hpsf/find.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, rgba32f) readonly uniform image2D filter_position;
layout(set = 1, binding = 1, r32ui) readonly uniform uimage2D filter_normal;
layout(set = 1, binding = 2, r32ui) readonly uniform uimage2D filter_incident;
layout(set = 1, binding = 3, scalar) readonly buffer Keys { uint at[]; } keys;
layout(set = 1, binding = 4, scalar) readonly buffer Owners { uint at[]; } owners;
/// Slots that the sample's finest key was looked for in: 1 where it is at home, hpsf.probes + 1 where it is in none, 0 without a vertex.
layout(set = 1, binding = 5, r32ui) writeonly uniform uimage2D hpsf_probed;
/// Levels, of hpsf.levels, at which the sample's insertion failed.
layout(set = 1, binding = 6, r32ui) writeonly uniform uimage2D hpsf_failed;
/// Levels at which the sample shares a slot with another key.
layout(set = 1, binding = 7, r32ui) writeonly uniform uimage2D hpsf_collided;
/// Slots whose number is the pixel's, modulo the number of pixels, and those taken among them: their sums are the table's.
layout(set = 1, binding = 8, r32ui) writeonly uniform uimage2D hpsf_slots;
layout(set = 1, binding = 9, r32ui) writeonly uniform uimage2D hpsf_taken;
layout(set = 1, binding = 10, r32ui) readonly uniform uimage2D filter_layer;

uint key_word(uint at) {
    return keys.at[at];
}

CellKey key_at(uvec2 pixel, uint level) {
    ivec2 at = ivec2(pixel);
    vec4 position = imageLoad(filter_position, at);
    FilterPoint point = filter_point(pixel, position, imageLoad(filter_normal, at).x, imageLoad(filter_incident, at).x);
    return key_of(point, jitter_numbers(pixel, 0u), int(level));
}

/// The key of the slot's owner.
CellKey owner_of(uint slot) {
    uint pixel = owners.at[slot] / 4u;
    return key_at(uvec2(pixel % frame.extent.x, pixel / frame.extent.x), owners.at[slot] % 4u);
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, frame.extent))) {
        return;
    }
    ivec2 at = ivec2(pixel);
    uint probed = 0u;
    uint failed = 0u;
    uint collided = 0u;
    bool has_sample = imageLoad(filter_position, at).w > 0.0 && has_diffuse_lobe(imageLoad(filter_layer, at).x);
    uint levels = has_sample ? parameters.hpsf_levels : 0u;
    for (uint level = 0u; level < levels; level++) {
        CellKey key = key_at(pixel, level);
        uint distance = distance_to(key);
        probed = level == 0u ? distance + 1u : probed;
        if (distance == parameters.hpsf_probes) {
            failed++;
        } else if (owner_of(probe(home_slot(key), distance)) != key) {
            collided++;
        }
    }
    uint slots = 0u;
    uint taken = 0u;
    for (uint slot = pixel.y * frame.extent.x + pixel.x; slot < CAPACITY; slot += frame.extent.x * frame.extent.y) {
        slots++;
        taken += key_word(KEY_WORDS * slot) != NO_FINGERPRINT ? 1u : 0u;
    }
    imageStore(hpsf_probed, at, uvec4(probed));
    imageStore(hpsf_failed, at, uvec4(failed));
    imageStore(hpsf_collided, at, uvec4(collided));
    imageStore(hpsf_slots, at, uvec4(slots));
    imageStore(hpsf_taken, at, uvec4(taken));
}
