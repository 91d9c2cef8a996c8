// Continues a path of each pixel by one scattered ray and one shadow ray: Meijer, section 4.4, steps 4 and 5.
//
// The pixel keeps the deepest valid path that is not yet as deep as paths.max_bounces, or with anhpsf.choice = importance the one that cells
// have more use for (filter/anhpsf/choice.glsl). The deepest is the one that it has continued so far; where
// there is none, the path of this frame goes on from the vertex that its list ends with, which it has only looked up. A path is no longer
// valid when the surface that its ray leaves has moved, or the frame's origin has: rays must leave from exact places. A restart ends all.
//
// A step is the path tracer's (`follow` and `visit` of paths/path.glsl). The ray arrives, perhaps at a light; the vertex before has then received
// all that it receives by this path, but for what comes through the new vertex, and enters its cell (transport.comp). At the new vertex a
// light is looked for and the next ray chosen, which waits for the next frame. A mirror in between takes a frame, too.
//
// A vertex whose light is sent again in every frame (anhpsf.transport = all) must be sent as often whatever becomes of its path: else those count
// more from which the path has not left the scene, and Cornell's box, open in front, would be 6 % too bright. So a chain whose path has
// ended waits for as long as the path could have lived.
//
// Deviations and why: the thesis stores what it finds in cells as it finds it, direct light at once and what comes through the next vertex
// one frame later, as two samples of which each is only a part; here a vertex waits until its sample is complete, 16 bytes for that. Light from
// specular lobes is followed as nhpsf follows it; the thesis is diffuse alone.
#define SEPARATE_TERMS
#define SHARED_JITTER
#define VERTEX_LIST
#include "accel/trace.glsl"
#include "filter/anhpsf/chain.glsl"
#include "filter/anhpsf/choice.glsl"
#include "filter/nhpsf/known.glsl"
#include "paths/end.glsl"
#include "paths/vertex_light.glsl"
#include "paths/wavefront/state.glsl"

layout(local_size_x = 32) in;

layout(set = 1, binding = 0, scalar) readonly buffer Ends { PathEnd at[]; } ends;
/// The lists of this frame's paths.
layout(set = 1, binding = 1, scalar) readonly buffer ListPlaces { vec4 at[]; } list_places;
layout(set = 1, binding = 2, scalar) readonly buffer ListLinks { uvec4 at[]; } list_links;
layout(set = 1, binding = 3, scalar) readonly buffer ListLight { ReceivedLight at[]; } list_light;
/// Kept: the path's state, and its chain.
layout(set = 1, binding = 4, scalar) buffer ContinuedPaths { Continued at[]; } continued;
layout(set = 1, binding = 5, scalar) buffer Rays { StoredRay at[]; } rays;
layout(set = 1, binding = 6, scalar) buffer Weights { StoredWeights at[]; } weights;
layout(set = 1, binding = 7, scalar) buffer Footprints { StoredFootprint at[]; } footprints;
layout(set = 1, binding = 8, scalar) buffer ChainPlaces { vec4 at[]; } chain_places;
layout(set = 1, binding = 9, scalar) buffer ChainLinks { uvec4 at[]; } chain_links;
layout(set = 1, binding = 10, scalar) buffer ChainLight { ReceivedLight at[]; } chain_light;
/// Vertices of the chain in this frame, and those of them, the first ones, that are complete.
layout(set = 1, binding = 11, r32ui) writeonly uniform uimage2D chain_vertices;
layout(set = 1, binding = 12, r32ui) writeonly uniform uimage2D chain_samples;

/// Scattered rays in the low, shadow rays in the high 16 bits.
layout(set = 1, binding = 13, r32ui) uniform uimage2D ray_count;

/// Last vertex of this frame's lists.
layout(constant_id = 207) const uint LIST_END = 0;

const Hit NOTHING = Hit(0.0, 0u, 0u, vec2(0.0));

uvec2 coordinates_of(uint pixel) {
    return uvec2(pixel % frame.extent.x, pixel / frame.extent.x);
}

/// Position, and view-plane distance of the path.
vec4 place_of(uvec2 coordinates, FilterVertex vertex) {
    return vec4(vertex.position, view_plane_distance(primary_ray(coordinates, frame.jitter), frame.camera, vertex.travelled));
}

void keep_vertex(uint pixel, uint index, FilterVertex vertex, vec3 attenuation) {
    uint at = place_in_list(pixel, index);
    chain_places.at[at] = place_of(coordinates_of(pixel), vertex);
    chain_links.at[at] = uvec4(floatBitsToUint(attenuation), pack_normal(vertex.normal));
    chain_light.at[at].incident = pack_normal(vertex.incident);
}

void keep_light(uint pixel, uint index, vec3 radiance) {
    chain_light.at[place_in_list(pixel, index)].radiance = radiance;
}

/// The vertex that a step begins with: its radiance alone will change.
void keep_origin(uint at, vec4 place, uvec4 link, uint incident) {
    chain_places.at[at] = place;
    chain_links.at[at] = link;
    chain_light.at[at].incident = incident;
}

bool is_known(uint pixel, uint index, FilterVertex vertex) {
    return true;
}

bool has_moved(uint index) {
    Instance instance = InstanceBuffer(frame.instances).at[index];
    return EFFECT_OBJECT_ANIMATION && instance.object_to_world != instance.previous_object_to_world;
}

bool is_valid(Continued path) {
    bool lives = CHOOSES || path.grows == 1u || path.frames_left > 0u;
    return path.vertices > 0u && lives && path.origin_steps == frame.origin_steps && !has_moved(path.instance);
}

/// The path that waits at the end of this frame's list, from that vertex on.
Path path_at(PathEnd end, Sampler numbers) {
    Path path;
    path.ray = Ray(vec3(0.0), 0.0, end.direction, -1.0);
    path.cone = end.cone;
    path.throughput = vec3(1.0);
    path.diffuse_weight = 0.0;
    path.specular_weight = vec3(0.0);
    path.pdf = 0.0;
    path.delta = false;
    path.eta_scale = 1.0;
    path.vertex = end.vertex;
    path.filter_vertex = end.vertex;
    path.travelled = end.travelled;
    path.numbers = numbers;
    return path;
}

/// A path on its way through the frame.
struct Walk {
    Path path;
    /// At its newest vertex.
    Hit hit;
    Terms terms;
    /// No ray has to find its first vertex.
    bool begins;
    bool goes_on;
};

/// The path that waits at the end of this frame's list; its first vertex is the chain's vertex `index`.
Walk walk_from_end(uint pixel, uint index, Sampler numbers) {
    PathEnd end = ends.at[pixel];
    uint from = place_in_list(pixel, LIST_END);
    keep_origin(place_in_list(pixel, index), list_places.at[from], list_links.at[from], list_light.at[from].incident);
    Terms terms = no_terms();
    terms.vertices = index + 1u;
    Walk walk = Walk(path_at(end, numbers), end.hit, terms, true, true);
    walk.path.place = pixel;
    return walk;
}

/// The path that the last frame has kept.
Walk walk_from_kept(uint pixel, Continued before, Sampler numbers) {
    uint from = place_in_list(pixel, before.vertices - 1u);
    Terms terms = no_terms();
    terms.vertices = WHOLE_CHAIN ? before.vertices : 1u;
    ReceivedLight light = chain_light.at[from];
    terms.behind = light.radiance;
    if (!WHOLE_CHAIN) {
        keep_origin(place_in_list(pixel, 0u), chain_places.at[from], chain_links.at[from], light.incident);
    }
    Path path = restored_path(rays.at[pixel], weights.at[pixel], footprints.at[pixel], numbers);
    Walk walk = Walk(path, NOTHING, terms, false, before.grows == 1u);
    walk.path.place = pixel;
    return walk;
}

/// Whether the path makes room for the one that waits at the end of this frame's list: where it has ended, or by choice at a vertex that `is_new`
/// (filter/anhpsf/choice.glsl). One that passes a mirror goes on, as its last filter vertex is incomplete.
bool gives_way(uint pixel, Walk walk, bool is_new, bool is_last) {
    if (walk.begins || ends.at[pixel].vertex == NO_VERTEX) {
        return false;
    }
    if (!is_new) {
        return is_last || !walk.goes_on;
    }
    uvec2 coordinates = coordinates_of(pixel);
    uint index = walk.terms.vertices;
    uint own = place_in_list(pixel, index - 1u);
    uvec4 own_link = chain_links.at[own];
    FilterPoint point = vertex_point(coordinates, chain_places.at[own], own_link.w, chain_light.at[own].incident);
    Cell own_cell = known_at(point, vertex_numbers(coordinates, index - 1u));
    if (is_last || own_cell.count == 0u) {
        return own_cell.count > 0u;
    }
    uint from = place_in_list(pixel, LIST_END);
    uvec4 link = list_links.at[from];
    point = vertex_point(coordinates, list_places.at[from], link.w, list_light.at[from].incident);
    vec3 own_attenuation = uintBitsToFloat(own_link.xyz);
    float chance = chance_to_give_way(own_cell, own_attenuation, known_at(point, vertex_numbers(coordinates, index)), uintBitsToFloat(link.xyz));
    walk.path.numbers.dimension = SELECTION_PAIRS + 16u * walk.path.vertex + 14u;
    return sample_1d(walk.path.numbers) < chance;
}
/// One ray that the path scatters, unless it begins, and one shadow ray, from its newest vertex or from that of the path that it gives way to.
/// Both are counted. `chain`: vertices of the path that has given way, and those of them that are complete.
void step_path(uint pixel, bool is_last, inout Walk walk, inout uvec2 chain, inout uvec2 counts) {
    const uint turns = CHOOSES ? 3u : 2u;
    uint vertices = walk.terms.vertices;
    Pending pending;
    pending.ray = NO_RAY;
    for (uint turn = 0u; turn < turns; turn++) {
        bool lights = turn + 1u == turns;
        if (turn == 1u && !lights && gives_way(pixel, walk, walk.terms.vertices > vertices, is_last)) {
            finish_vertex(pixel, walk.terms);
            chain = uvec2(walk.terms.vertices, vertices);
            walk = walk_from_end(pixel, walk.terms.vertices, walk.path.numbers);
            pending.ray = NO_RAY;
        } else if (turn == 1u && !lights || turn == 0u && !walk.goes_on) {
            continue;
        }
        Ray ray = pending.ray;
        uint seed = pending.alpha_seed;
        if (!lights) {
            ray = walk.path.ray;
            seed = alpha_seed(walk.path);
        }
        counts += uvec2(!lights && !walk.begins, lights && ray.t_max > 0.0);
        Hit found;
        bool blocked = accel_trace(ray, lights, seed, found);
        if (lights) {
            if (ray.t_max > 0.0 && !blocked) {
                add_term(walk.terms, pending.term, pending.diffuse_weight, pending.specular_weight, pending.radiance);
            }
            break;
        }
        if (!walk.begins) {
            walk.hit = found;
            walk.goes_on = follow(walk.path, blocked, found, walk.terms);
        }
        uint shadow_rays = 1u;
        walk.goes_on = walk.goes_on && visit(walk.path, walk.hit, !walk.begins, shadow_rays, walk.terms, pending);
    }
}

/// Writes what the next frame goes on with: the path, or the chain alone where its vertices are sent again or have not been sent yet.
void keep_path(uint pixel, Walk walk, bool goes_on, bool waits, uint frames_left) {
    uint vertices = goes_on || waits ? walk.terms.vertices : 0u;
    continued.at[pixel] = Continued(vertices, goes_on ? 1u : 0u, frames_left, walk.hit.instance, frame.origin_steps);
    if (goes_on) {
        rays.at[pixel] = stored_ray(walk.path);
        weights.at[pixel] = stored_weights(walk.path);
        footprints.at[pixel] = stored_footprint(walk.path);
    }
}

void write_lengths(uvec2 coordinates, uvec2 vertices_and_samples) {
    imageStore(chain_vertices, ivec2(coordinates), uvec4(vertices_and_samples.x));
    imageStore(chain_samples, ivec2(coordinates), uvec4(vertices_and_samples.y));
}

/// Vertices of a chain after the step, and those of them that are complete.
uvec2 lengths_of(Walk walk, uint vertices, bool begins, bool is_last) {
    bool waits = walk.goes_on && !(is_last && walk.terms.vertices == vertices);
    bool is_new = begins || walk.terms.vertices > vertices;
    // Sent again, a vertex is sent from the frame after its own on, even if its path has ended there.
    bool is_incomplete = waits || (is_new && (is_last || WHOLE_CHAIN));
    return uvec2(walk.terms.vertices, walk.terms.vertices - (is_incomplete ? 1u : 0u));
}

void continue_path(uvec2 coordinates, uint pixel) {
    Continued before = continued.at[pixel];
    bool begins = !is_valid(before);
    if (begins && ends.at[pixel].vertex == NO_VERTEX) {
        continued.at[pixel].vertices = 0u;
        write_lengths(coordinates, uvec2(0u));
        return;
    }
    if (!begins && before.grows == 0u && WHOLE_CHAIN) {
        continued.at[pixel].frames_left = before.frames_left - 1u;
        write_lengths(coordinates, uvec2(before.vertices));
        return;
    }
    Sampler numbers = path_numbers(coordinates, frame.first_sample);
    Walk walk = begins ? walk_from_end(pixel, 0u, numbers) : walk_from_kept(pixel, before, numbers);
    // The last ray has to find a vertex to be looked up, and `arrive` ends paths that are too deep.
    bool is_last = walk.path.vertex > parameters.max_bounces;
    if (is_last) {
        walk.path.filter_vertex -= walk.path.vertex - parameters.max_bounces;
        walk.path.vertex = parameters.max_bounces;
    }
    uint vertices = walk.terms.vertices;
    uint counted = imageLoad(ray_count, ivec2(coordinates)).x;
    uvec2 counts = uvec2(counted & 0xffffu, counted >> 16);
    uvec2 chain = uvec2(0u);
    step_path(pixel, is_last, walk, chain, counts);
    imageStore(ray_count, ivec2(coordinates), uvec4(pack_counts(counts)));
    finish_vertex(pixel, walk.terms);
    bool gave_way = chain.x > 0u;
    write_lengths(coordinates, gave_way ? chain : lengths_of(walk, vertices, begins, is_last));
    uint frames_left = walk.begins ? parameters.max_bounces + 1u - ends.at[pixel].vertex : before.frames_left - 1u;
    keep_path(pixel, walk, walk.goes_on && (gave_way || !is_last), gave_way || WHOLE_CHAIN, frames_left);
}

void main() {
    uvec2 coordinates = pixel_in_tile(frame.extent.x, gl_WorkGroupID.x, gl_LocalInvocationIndex);
    if (all(lessThan(coordinates, frame.extent))) {
        continue_path(coordinates, coordinates.y * frame.extent.x + coordinates.x);
    }
}
