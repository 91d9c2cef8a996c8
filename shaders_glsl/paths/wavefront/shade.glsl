// Wavefront path tracing: one visit to the vertex that each path has arrived at (`visit` of paths/path.glsl). The light that it might
// get goes to one queue with its shadow ray, the path itself to another if it goes on.
//
// A turn is one visit. The first vertex has one for each of its shadow rays; every other one has one.
#include "paths/wavefront/append.glsl"
#include "paths/wavefront/lists.glsl"
#include "paths/wavefront/state.glsl"
#include "paths/wavefront/sums.glsl"

layout(local_size_x = QUEUE_GROUP) in;

layout(set = 1, binding = 1, scalar) readonly buffer SampleNumber { uint number; } sample_number;
layout(set = 1, binding = 2, scalar) readonly buffer Queue { uint at[]; } queue;
layout(set = 1, binding = 3, scalar) buffer Rays { StoredRay at[]; } rays;
layout(set = 1, binding = 4, scalar) buffer Weights { StoredWeights at[]; } weights;
layout(set = 1, binding = 5, scalar) buffer Footprints { StoredFootprint at[]; } footprints;
layout(set = 1, binding = 6, scalar) readonly buffer Hits { Hit at[]; } hits;
layout(set = 1, binding = 7, r32ui) uniform uimage2D ray_count;
layout(set = 1, binding = 11, scalar) writeonly buffer NextQueue { uint at[]; } next_queue;
layout(set = 1, binding = 12, scalar) writeonly buffer ShadowRays { StoredShadowRay at[]; } shadow_rays;
layout(set = 1, binding = 13, scalar) writeonly buffer Lights { StoredLight at[]; } lights;
#ifdef SEPARATE_TERMS
layout(set = 1, binding = 14, scalar) writeonly buffer Vertices { StoredVertex at[]; } vertices;
#endif

void count_rays(uvec2 pixel, uvec2 rays) {
    uint counted = imageLoad(ray_count, ivec2(pixel)).x;
    imageStore(ray_count, ivec2(pixel), uvec4(pack_counts(uvec2(counted & 0xffffu, counted >> 16) + rays)));
}

/// The filter vertex has been found in this turn.
void store_filter_vertex(uint slot, Terms terms) {
    front.at[slot].attenuation = terms.attenuation;
#ifdef SEPARATE_TERMS
    FilterVertex vertex = terms.vertex;
    vertices.at[slot] = StoredVertex(vertex.position, vertex.travelled, vertex.normal, vertex.incident, vertex.layer);
#endif
}

/// True where the path goes on. The light to be found is `pending`, for `target`.
bool shade(uint slot, inout Pending pending, inout uint target) {
    uvec2 pixel = pixel_of_slot(slot);
    Sampler numbers = path_numbers(pixel, frame.first_sample + sample_number.number);
    Path path = restored_path(rays.at[slot], weights.at[slot], footprints.at[slot], numbers);
    Hit hit = hits.at[slot];
    Terms terms = no_terms();
    restore_list(pixel, path, terms);
    uint vertices = vertices_behind(terms);
    bool filters = is_in_front(path);
    if (!filters) {
        terms.attenuation = front.at[slot].attenuation;
    }
    bool arrives = turn == 0u || turn >= first_visits();
    bool goes_on = !arrives || follow(path, hit.t >= 0.0, hit, terms);
    if (goes_on) {
        uint left = first_visits() - turn;
        goes_on = visit(path, hit, arrives, left, terms, pending);
    }
    count_rays(pixel, uvec2(arrives, pending.ray.t_max > 0.0));
    add_to_sums(slot, terms);
    store_list(pixel, vertices, terms);
    if (filters && !is_in_front(path)) {
        store_filter_vertex(slot, terms);
    }
    target = light_target(slot, pending.term, vertices_behind(terms));
    if (goes_on) {
        rays.at[slot] = stored_ray(path);
        weights.at[slot] = stored_weights(path);
        footprints.at[slot] = stored_footprint(path);
    }
    return goes_on;
}

void main() {
    uint i = gl_GlobalInvocationID.x;
    Pending pending;
    pending.ray = NO_RAY;
    uint slot = 0u;
    uint target = 0u;
    bool goes_on = false;
    if (i < heads.at[paths_of(turn)].count) {
        slot = queue.at[i];
        goes_on = shade(slot, pending, target);
    }
    uint place = append(paths_of(turn + 1u), goes_on);
    if (goes_on) {
        next_queue.at[place] = slot;
    }
    bool waits = pending.ray.t_max > 0.0;
    place = append(shadow_rays_of(turn), waits);
    if (waits) {
        Ray ray = pending.ray;
        shadow_rays.at[place] = StoredShadowRay(ray.origin, ray.t_max, ray.direction, pending.alpha_seed);
        lights.at[place] = StoredLight(pending.radiance, pending.diffuse_weight, pending.specular_weight, target);
    }
}
