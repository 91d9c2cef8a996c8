// Adds each retraced path to the cell of its filter vertex: filter/hpsf/changes.glsl.
//
// A path whose vertex is now nearer or farther by more than a cell has met another surface, in front of the old one or behind it. That
// tells nothing about the light on either, but that something has come into view there: filter/hpsf/forget.comp. Of paths without the lobes
// that the table is about, it only counts whether others have changed.
#include "filter/hpsf/changes.glsl"
#include "lib/elements.glsl"
#include "paths/retraced.glsl"

layout(local_size_x = 64) in;

layout(set = 1, binding = 0, scalar) readonly buffer KeptPaths { Kept at[]; } kept;
layout(set = 1, binding = 1, scalar) readonly buffer RetracedPaths { Retraced at[]; } retraced;
layout(set = 1, binding = 2, scalar) buffer Changes { uint at[]; } changes;

void add_fixed(uint at, float value, float dither) {
    uvec2 units = to_fixed(clamp(value, 0.0, parameters.hpsf_largest), dither);
    uint before = atomicAdd(changes.at[at], units.x);
    atomicAdd(changes.at[at + 1u], units.y + (before + units.x < before ? 1u : 0u));
}

/// Of the lobes that the table is about.
vec3 radiance_of(Kept path) {
    return PART == PART_GLOSSY ? path.specular : path.diffuse;
}

bool others_changed(Kept now, Kept before) {
    bool lobes = any(PART == PART_GLOSSY ? notEqual(now.diffuse, before.diffuse) : notEqual(now.specular, before.specular));
    return lobes || now.unfiltered != before.unfiltered;
}

bool has_lobes(uint layer) {
    return PART == PART_GLOSSY ? layer != 0u : has_diffuse_lobe(layer);
}

uint change_fingerprint(uint at, uint own) {
    uint held = atomicCompSwap(changes.at[at], NO_FINGERPRINT, own);
    return held == NO_FINGERPRINT ? own : held;
}

/// `word` of its slot.
void count(CellKey key, uint word) {
    atomicAdd(changes.at[find_change(key) + word], 1u);
}

void add_path(CellKey key, vec3 now, vec3 before, float dither) {
    uint slot = find_change(key);
    atomicAdd(changes.at[slot + 1u], 1u);
    for (uint channel = 0u; channel < 3u; channel++) {
        add_fixed(slot + 2u + 2u * channel, now[channel], dither);
        add_fixed(slot + 8u + 2u * channel, before[channel], dither);
    }
}

void main() {
    uint index = element_index();
    uvec2 extent = retraced_extent();
    if (index >= extent.x * extent.y) {
        return;
    }
    Kept before = kept.at[index];
    uvec2 pixel = retraced_pixel(uvec2(index % extent.x, index / extent.x), frame.first_sample - 1u);
    Retraced path = retraced.at[index];
    vec4 numbers = jitter_numbers(pixel, 0u);
    float cell = power_of_two(level_at(before.distance, level_number(numbers)));
    if (!(path.now.distance > 0.0)) {
        return;
    }
    float view_cosine = dot(camera_ray(frame.previous_camera, pixel, frame.previous_jitter).direction, frame.previous_camera.forward);
    vec3 arrives = unpack_normal(path.incident);
    uint layer = layer_of_part(path.layer);
    FilterPoint point = FilterPoint(path.position, unpack_normal(path.normal), arrives, path.now.distance, arrives * view_cosine, layer);
    if (abs(path.now.distance - before.distance) > cell) {
        count(surroundings_key(point, numbers), UNCOVERED);
        return;
    }
    float dither = unit_float(pcg3d(uvec3(pixel, frame.first_sample ^ frame.seed)).z);
    for (uint level = 0u; level < parameters.hpsf_levels + FURTHER_LEVELS && has_lobes(path.layer); level++) {
        add_path(change_key(point, numbers, level), radiance_of(path.now), radiance_of(before), dither);
    }
    if (others_changed(path.now, before)) {
        count(surroundings_key(point, numbers), OTHER_LOBES);
    }
}
