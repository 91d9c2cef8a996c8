// Continues a path of each pixel by one scattered ray and one shadow ray: Meijer, section 4.4, steps 4 and 5.
//
// The pixel keeps the deepest valid path that is not yet as deep as paths.max_bounces. That is the one that it has continued so far; where
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
#include "paths/end.glsl"
#include "paths/wavefront/state.glsl"

layout(local_size_x = 32) in;

layout(set = 1, binding = 0, scalar) readonly buffer Ends { PathEnd at[]; } ends;
/// The lists of this frame's paths.
layout(set = 1, binding = 1, scalar) readonly buffer ListPlaces { vec4 at[]; } list_places;
layout(set = 1, binding = 2, scalar) readonly buffer ListLinks { uvec4 at[]; } list_links;
layout(set = 1, binding = 3, scalar) readonly buffer ListLight { uvec4 at[]; } list_light;
/// Kept: the path's state, and its chain.
layout(set = 1, binding = 4, scalar) buffer ContinuedPaths { Continued at[]; } continued;
layout(set = 1, binding = 5, scalar) buffer Rays { StoredRay at[]; } rays;
layout(set = 1, binding = 6, scalar) buffer Weights { StoredWeights at[]; } weights;
layout(set = 1, binding = 7, scalar) buffer Footprints { StoredFootprint at[]; } footprints;
layout(set = 1, binding = 8, scalar) buffer ChainPlaces { vec4 at[]; } chain_places;
layout(set = 1, binding = 9, scalar) buffer ChainLinks { uvec4 at[]; } chain_links;
layout(set = 1, binding = 10, scalar) buffer ChainLight { uvec4 at[]; } chain_light;
/// Vertices of the chain in this frame, and those of them, the first ones, that are complete.
layout(set = 1, binding = 11, r32ui) writeonly uniform uimage2D chain_vertices;
layout(set = 1, binding = 12, r32ui) writeonly uniform uimage2D chain_samples;

/// Scattered rays in the low, shadow rays in the high 16 bits.
layout(set = 1, binding = 13, r32ui) uniform uimage2D ray_count;

/// Last vertex of this frame's lists.
layout(constant_id = 207) const uint LIST_END = 0;

/// The vertex that the step begins with, as it is stored: its radiance alone changes.
struct Origin {
    uint index;
    vec4 place;
    uvec4 link;
    uint incident;
};

Origin origin;

uint at_of(uint pixel, uint index) {
    return index * frame.extent.x * frame.extent.y + pixel;
}

void keep_vertex(uint pixel, uint index, PathVertex vertex) {
    uint at = at_of(pixel, index);
    uvec2 coordinates = uvec2(pixel % frame.extent.x, pixel / frame.extent.x);
    bool is_origin = index == origin.index;
    vec4 place = vec4(vertex.at.position, view_plane_distance(primary_ray(coordinates, frame.jitter), frame.camera, vertex.at.travelled));
    uvec4 link = uvec4(floatBitsToUint(vertex.attenuation), pack_normal(vertex.at.normal));
    chain_places.at[at] = is_origin ? origin.place : place;
    chain_links.at[at] = is_origin ? origin.link : link;
    uint incident = is_origin ? origin.incident : pack_normal(vertex.at.incident);
    chain_light.at[at] = uvec4(floatBitsToUint(vertex.radiance), incident);
}

bool is_known(uint pixel, uint index, FilterVertex vertex) {
    return true;
}

bool has_moved(uint index) {
    Instance instance = InstanceBuffer(frame.instances).at[index];
    return EFFECT_OBJECT_ANIMATION && instance.object_to_world != instance.previous_object_to_world;
}

bool is_valid(Continued path) {
    return path.vertices > 0u && (path.grows == 1u || path.frames_left > 0u) && path.origin_steps == frame.origin_steps && !has_moved(path.instance);
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

/// One ray that the path scatters, unless it `begins`, and one shadow ray, which are counted. False where the path ends.
bool step_path(inout Path path, inout Hit hit, inout Terms terms, bool begins, inout uvec2 counts) {
    Pending pending;
    pending.ray = NO_RAY;
    uint shadow_rays = 1u;
    bool goes_on = true;
    for (uint turn = 0u; turn < 2u; turn++) {
        bool lights = turn == 1u;
        Ray ray = pending.ray;
        uint seed = pending.alpha_seed;
        if (!lights) {
            ray = path.ray;
            seed = alpha_seed(path);
        }
        counts += uvec2(!lights && !begins, lights && ray.t_max > 0.0);
        Hit found;
        bool blocked = accel_trace(ray, lights, seed, found);
        if (lights) {
            if (ray.t_max > 0.0 && !blocked) {
                add_term(terms, pending.term, pending.diffuse_weight, pending.specular_weight, pending.radiance);
            }
            break;
        }
        if (!begins) {
            hit = found;
            goes_on = follow(path, blocked, found, terms);
        }
        goes_on = goes_on && visit(path, hit, !begins, shadow_rays, terms, pending);
    }
    return goes_on;
}

void load_origin(uint pixel, uint vertices, inout Terms terms) {
    uint from = at_of(pixel, vertices - 1u);
    terms.vertices = WHOLE_CHAIN ? vertices : 1u;
    uvec4 light = chain_light.at[from];
    origin = Origin(terms.vertices - 1u, chain_places.at[from], chain_links.at[from], light.w);
    terms.behind.radiance = uintBitsToFloat(light.xyz);
}

void begin_chain(uint pixel, inout Terms terms) {
    uint from = at_of(pixel, LIST_END);
    terms.vertices = 1u;
    origin = Origin(0u, list_places.at[from], list_links.at[from], list_light.at[from].w);
}

/// Writes what the next frame goes on with; nothing where the path has ended, and its light is not sent again.
void keep_path(uint pixel, Path path, Hit hit, Terms terms, bool goes_on, uint frames_left) {
    uint vertices = goes_on || WHOLE_CHAIN ? terms.vertices : 0u;
    continued.at[pixel] = Continued(vertices, goes_on ? 1u : 0u, frames_left, hit.instance, frame.origin_steps);
    if (goes_on) {
        rays.at[pixel] = stored_ray(path);
        weights.at[pixel] = stored_weights(path);
        footprints.at[pixel] = stored_footprint(path);
    }
}

void write_lengths(uvec2 coordinates, uint vertices, uint samples) {
    imageStore(chain_vertices, ivec2(coordinates), uvec4(vertices));
    imageStore(chain_samples, ivec2(coordinates), uvec4(samples));
}

void continue_path(uvec2 coordinates, uint pixel) {
    Continued before = continued.at[pixel];
    PathEnd end = ends.at[pixel];
    bool begins = !is_valid(before);
    if (begins && end.vertex == NO_VERTEX) {
        continued.at[pixel].vertices = 0u;
        write_lengths(coordinates, 0u, 0u);
        return;
    }
    if (!begins && before.grows == 0u) {
        continued.at[pixel].frames_left = before.frames_left - 1u;
        write_lengths(coordinates, before.vertices, before.vertices);
        return;
    }
    Sampler numbers = path_numbers(coordinates, frame.first_sample);
    Terms terms = no_terms();
    Path path;
    Hit hit = end.hit;
    if (begins) {
        begin_chain(pixel, terms);
        path = path_at(end, numbers);
    } else {
        load_origin(pixel, before.vertices, terms);
        path = restored_path(rays.at[pixel], weights.at[pixel], footprints.at[pixel], numbers);
    }
    path.place = pixel;
    // The last ray has to find a vertex to be looked up, and `arrive` ends paths that are too deep.
    bool is_last = path.vertex > parameters.max_bounces;
    if (is_last) {
        path.filter_vertex -= path.vertex - parameters.max_bounces;
        path.vertex = parameters.max_bounces;
    }
    uint vertices = terms.vertices;
    uint counted = imageLoad(ray_count, ivec2(coordinates)).x;
    uvec2 counts = uvec2(counted & 0xffffu, counted >> 16);
    bool goes_on = step_path(path, hit, terms, begins, counts);
    imageStore(ray_count, ivec2(coordinates), uvec4(pack_counts(counts)));
    finish_vertex(pixel, terms);
    bool waits = goes_on && !(is_last && terms.vertices == vertices);
    bool is_new = begins || terms.vertices > vertices;
    // Sent again, a vertex is sent from the frame after its own on, even if its path has ended there.
    bool is_incomplete = waits || (is_new && (is_last || WHOLE_CHAIN));
    write_lengths(coordinates, terms.vertices, terms.vertices - (is_incomplete ? 1u : 0u));
    uint frames_left = begins ? parameters.max_bounces + 1u - end.vertex : before.frames_left - 1u;
    keep_path(pixel, path, hit, terms, goes_on && !is_last, frames_left);
}

void main() {
    uvec2 coordinates = pixel_in_tile(frame.extent.x, gl_WorkGroupID.x, gl_LocalInvocationIndex);
    if (all(lessThan(coordinates, frame.extent))) {
        continue_path(coordinates, coordinates.y * frame.extent.x + coordinates.x);
    }
}
