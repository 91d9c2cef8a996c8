// Unidirectional path tracing: a path and its steps from ray to ray. Kernels trace the rays: paths/megakernel.glsl whole paths in one,
// paths/wavefront/ each step of all paths at once.
//
// Kajiya, "The Rendering Equation", 1986; next event estimation and the power heuristic: Veach, "Robust Monte Carlo Methods for Light
// Transport Simulation", 1997, sections 9.2.4 and 10.3.4. Terms at the filter vertex: paths/terms.glsl (Meijer, algorithm 1).
// Russian roulette: from paths.roulette_start on, a path goes on with probability clamp(max(throughput) eta^2, 0.05, 0.95); eta^2
// undoes the compression of radiance by refraction, so that a path through glass is not ended for it.
//
// A path of paths.max_bounces bounces has that many scattering events after the primary hit; light is looked for at each of them and
// at the primary hit, and the ray scattered last can still find a light, and nothing else.
#ifndef PATHS_PATH_GLSL
#define PATHS_PATH_GLSL

#include "accel/ray.glsl"
#include "lib/bsdf.glsl"
#include "lib/layer.glsl"
#include "lib/lights.glsl"
#include "lib/ray_cone.glsl"
#include "lib/sampler.glsl"
#include "paths/hit.glsl"
#include "paths/light_candidates.glsl"
#include "paths/primary.glsl"
#include "paths/terms.glsl"
#include "paths/vertices.glsl"

/// Pairs of sample dimensions that a vertex takes: light, point on it, direction, lobe and roulette.
const uint PAIRS_PER_VERTEX = 4u;
/// Where those begin that select among candidate lights: behind the deepest path's, 16 for each vertex.
const uint SELECTION_PAIRS = 1u + PAIRS_PER_VERTEX * 66u;
/// And those of further shadow rays at the first vertex: behind these, light, point on it and selection.
const uint EXTRA_PAIRS = SELECTION_PAIRS + 16u * 66u;
const uint PAIRS_PER_EXTRA_RAY = 3u;

const uint NO_VERTEX = ~0u;

const uint LIGHTS_SOLE_APART = 1u;

struct Path {
    /// The scattered ray: being traced, or to be traced after this vertex's shadow rays.
    Ray ray;
    /// Footprint at the ray's origin.
    RayCone cone;
    /// From the filter vertex on; up to it while there is none.
    vec3 throughput;
    /// Of the filter vertex's lobes for what follows; 0 and 1 while there is none.
    float diffuse_weight;
    vec3 specular_weight;
    /// Density of the ray's direction, 1/sr.
    float pdf;
    /// The ray's direction could not have been found by light sampling.
    bool delta;
    /// Product of eta^2 of all refractions.
    float eta_scale;
    /// Vertices before the ray's origin: 0 for the camera's ray.
    uint vertex;
    /// The last filter vertex so far, or NO_VERTEX less the diffuse vertices that are still to be passed in front of the first one.
    uint filter_vertex;
    /// Length of all rays that have arrived, metres.
    float travelled;
    Sampler numbers;
#ifdef RETRACES
    /// Shadow rays at the first vertex, in the frame that the path is of.
    uint first_rays;
#endif
#ifdef VERTEX_LIST
    /// Of the pixel in the list of vertices.
    uint place;
#endif
};

/// The path has no filter vertex so far.
bool is_in_front(Path path) {
    return path.filter_vertex >= NO_VERTEX - HPSF_VERTEX;
}

/// Light that waits for its shadow ray; none where the ray's t_max is below 0.
struct Pending {
    Ray ray;
    uint alpha_seed;
    uint term;
    float diffuse_weight;
    vec3 specular_weight;
    vec3 radiance;
};

/// Paths of a pixel in this frame. A number that is not whole is so on average over pixels and frames: which pixels take one more is
/// independent of what they see.
uint samples_of(uvec2 pixel) {
#ifdef SHARED_JITTER
    return 1u;
#else
    uint most = frame.samples + 1u;
    return frame.more_samples > unit_float(pcg3d(uvec3(pixel, frame.frame ^ frame.seed)).y) ? most : frame.samples;
#endif
}

/// Of a frame in several submissions: paths of each pixel that earlier ones have traced, and those of a pixel after this one.
uint first_sample_here() {
#ifdef SHARED_JITTER
    return 0u;
#else
    return frame.share_begin;
#endif
}

uint samples_up_to_here(uvec2 pixel) {
    return min(samples_of(pixel), frame.share_end);
}

/// Scattered rays in the low, shadow rays in the high 16 bits.
uint pack_counts(uvec2 counts) {
    uvec2 most = min(counts, 0xffffu);
    return most.x | most.y << 16;
}

/// The numbers that a path is made of, from the first one on.
Sampler path_numbers(uvec2 pixel, uint sample_index) {
#ifdef SHARED_JITTER
    if (SCRAMBLE == SCRAMBLE_TILE) {
        return sampler_of_tile(pixel, sample_index, frame.seed);
    }
#endif
    return sampler_begin(pixel, sample_index, frame.seed);
}

/// From a camera, through a pixel's point at `jitter` where all samples share one.
Path path_from(Camera camera, vec2 jitter, uvec2 pixel, uint sample_index) {
    Path path;
    path.numbers = path_numbers(pixel, sample_index);
#ifdef SHARED_JITTER
    vec2 offset = jitter;
#else
    vec2 offset = sample_2d(path.numbers) - 0.5;
#endif
    path.ray = camera_ray(camera, pixel, offset);
    path.cone = camera_cone(camera);
    path.throughput = vec3(1.0);
    path.diffuse_weight = 0.0;
    path.specular_weight = vec3(1.0);
    path.pdf = 0.0;
    path.delta = true;
    path.eta_scale = 1.0;
    path.vertex = 0u;
    path.filter_vertex = NO_VERTEX - HPSF_VERTEX;
#ifdef VERTEX_LIST
    path.place = pixel.y * frame.extent.x + pixel.x;
#endif
    path.travelled = 0.0;
    return path;
}

Path path_begin(uvec2 pixel, uint sample_index) {
    return path_from(frame.camera, frame.jitter, pixel, sample_index);
}

/// The same holes for everything that one ray of one sample sees, others for the next.
uint alpha_seed(Path path) {
    return EFFECT_ALPHA_BLEND ? pcg3d(uvec3(path.numbers.scramble, path.numbers.index, path.vertex)).x : 0u;
}

/// Shadow rays at the path's first vertex, without the sole light's.
uint first_shadow_rays(Path path) {
#ifdef RETRACES
    return path.first_rays;
#else
    return parameters.first_shadow_rays;
#endif
}

/// The sole light has a shadow ray of its own where the camera's ray arrives (lights.sole).
bool has_sole_ray(uint vertex) {
    return EFFECT_SOLE_LIGHT && LIGHTS_SOLE == LIGHTS_SOLE_APART && vertex == 0u;
}

/// Visits to the first vertex, one for each of its shadow rays.
uint first_visits() {
    return parameters.first_shadow_rays + (has_sole_ray(0u) ? 1u : 0u);
}

/// For light found by following the path's ray, against light sampling with density `light_pdf`.
float emission_weight(Path path, float light_pdf) {
    if (path.delta || DIRECT == DIRECT_BSDF) {
        return 1.0;
    }
    if (path.vertex == 1u && has_sole_ray(0u) && light_pdf > 0.0) {
        light_pdf /= 1.0 - frame.sole_probability;
    }
    return DIRECT == DIRECT_NEE ? 0.0 : power_heuristic(path.pdf, competing_pdf(light_pdf));
}

/// Where light belongs that the path's ray has found. `from_light`: straight, not reflected.
uint term_of(Path path, Terms terms, bool from_light) {
    if (is_in_front(path)) {
        return TERM_BEFORE;
    }
    if (vertices_behind(terms) > 0u) {
        return TERM_BEHIND;
    }
    return from_light && path.vertex == path.filter_vertex + 1u ? TERM_DIRECT : TERM_INDIRECT;
}

vec3 clamp_indirect(vec3 radiance, uint vertex) {
    float largest = max(radiance.r, max(radiance.g, radiance.b));
    bool clamps = parameters.clamp_radiance > 0.0 && vertex > 1u && largest > parameters.clamp_radiance;
    return clamps ? radiance * (parameters.clamp_radiance / largest) : radiance;
}

/// Adds what the path's ray has found: radiance emitted towards its origin.
void add_emission(Path path, vec3 radiance, float light_pdf, inout Terms terms) {
    vec3 arrived = clamp_indirect(path.throughput * radiance * emission_weight(path, light_pdf), path.vertex);
    add_term(terms, term_of(path, terms, true), path.diffuse_weight, path.specular_weight, arrived);
}

/// The path's ray has left the scene.
void add_environment(Path path, inout Terms terms) {
    vec3 radiance = environment_radiance(path.ray.direction);
    add_emission(path, radiance, environment_pdf(path.ray.direction), terms);
}

const Ray NO_RAY = Ray(vec3(0.0), 0.0, vec3(0.0, 0.0, 1.0), -1.0);

bool is_diffuse(HitPoint point) {
    return max_component(diffuse_albedo(point.surface)) > 0.0;
}

Pending no_light() {
    Pending pending;
    pending.ray = NO_RAY;
    return pending;
}

/// Light that may arrive at a vertex from a light.
Pending pending_light(Path path, Terms terms, HitPoint point, ChosenLight light) {
    Pending pending = no_light();
    BsdfValue value = light.value;
    vec3 radiance = light.radiance;
    vec3 albedo = diffuse_albedo(point.surface);
    if (path.vertex == path.filter_vertex) {
        pending.term = vertices_behind(terms) > 0u ? TERM_BEHIND : TERM_DIRECT;
        pending.diffuse_weight = is_diffuse(point) ? value.diffuse : 0.0;
        pending.specular_weight = path.throughput * value.specular;
        pending.radiance = radiance;
    } else {
        pending.term = term_of(path, terms, false);
        pending.diffuse_weight = path.diffuse_weight;
        pending.specular_weight = path.specular_weight;
        pending.radiance = clamp_indirect(path.throughput * (albedo * value.diffuse + value.specular) * radiance, path.vertex + 1u);
    }
    vec3 most = max(vec3(pending.diffuse_weight), pending.specular_weight) * pending.radiance;
    if (max(most.r, max(most.g, most.b)) > 0.0) {
        pending.ray = shadow_ray(point.origin, light.direction, light.distance);
    }
    return pending;
}

/// Looks for light at a vertex, by one of `rays` shadow rays; nothing waits where there is none to be found.
Pending sample_direct(Path path, Terms terms, HitPoint point, vec3 wo, vec4 u, float selection, float rays) {
    ChosenLight light;
    if (!choose_light(point.origin.position, point.surface, wo, u, selection, has_sole_ray(path.vertex), light)) {
        return no_light();
    }
    light.radiance /= rays;
    return pending_light(path, terms, point, light);
}

/// The sole light at the first vertex, in front of filters: it has no noise that they could take away.
Pending sample_sole(Path path, Terms terms, HitPoint point, vec3 wo) {
    ChosenLight light;
    if (!choose_sole_light(point.origin.position, point.surface, wo, light)) {
        return no_light();
    }
    Pending pending = pending_light(path, terms, point, light);
    pending.term = TERM_BEFORE;
    return pending;
}

/// Chooses the path's next ray; false where the path ends here.
bool scatter(inout Path path, Terms terms, HitPoint point, vec3 wo, vec4 u) {
    BsdfSample next;
    if (!bsdf_sample(point.surface, wo, u.xyz, next)) {
        return false;
    }
    if (path.vertex == path.filter_vertex) {
        path.diffuse_weight = is_diffuse(point) ? next.diffuse_weight : 0.0;
        path.specular_weight = path.throughput * next.specular_weight;
        path.throughput = vec3(1.0);
    } else {
        path.throughput *= diffuse_albedo(point.surface) * next.diffuse_weight + next.specular_weight;
    }
    path.eta_scale *= next.eta * next.eta;
    path.cone = cone_scatter(path.cone, next.pdf, next.delta);
    path.pdf = next.pdf;
    path.delta = next.delta;
    path.ray = Ray(leave_surface(point.origin, next.direction), 0.0, next.direction, FAR_AWAY);

    // Behind the first filter vertex a path works for cells, however little of it the pixel sees.
    vec3 attenuation = vertices_behind(terms) > 0u ? vec3(1.0) : terms.attenuation;
    vec3 total = path.throughput * (attenuation * path.diffuse_weight + path.specular_weight);
    float survival = max(total.r, max(total.g, total.b)) * path.eta_scale;
    if (!(survival > 0.0)) {
        return false;
    }
    if (ROULETTE == 1u && path.vertex >= parameters.roulette_start) {
        survival = clamp(survival, 0.05, 0.95);
        path.throughput /= survival;
        return u.w < survival;
    }
    return true;
}

/// The layer of the specular terms, where these may be filtered (filter/hpsf/part.glsl says why not everywhere); else 0.
uint layer_to_filter(Path path, HitPoint point) {
    bool is_first = HPSF_VERTEX == 0u && path.filter_vertex == NO_VERTEX;
    if (HPSF_GLOSSY != 1u || !is_first || !is_glossy(point.surface)) {
        return 0u;
    }
    vec3 colour = path.throughput * (is_painted(point) ? specular_colour(point.surface) : vec3(1.0));
    return glossy_layer(coloured(point.material, colour), sqrt(least_alpha(point.surface)), is_diffuse(point));
}

/// The path arrives at a surface with a lobe to be filtered, and finds it to be a filter vertex or not. False where the path ends there.
bool arrive_at_filter(inout Path path, inout HitPoint point, inout Terms terms) {
    vec3 albedo = diffuse_albedo(point.surface);
    FilterVertex vertex = FilterVertex(point.origin.position, point.surface.normal_ws, path.ray.direction, path.travelled, layer_to_filter(path, point));
    if (is_in_front(path)) {
        if (path.filter_vertex < NO_VERTEX) {
            path.filter_vertex++;
            return true;
        }
        path.filter_vertex = path.vertex;
        terms.attenuation = path.throughput * albedo;
        terms.vertex = vertex;
        return true;
    }
#ifdef VERTEX_LIST
    if (LAST_IS_READ && next_is_last(terms) && !is_known(path.place, terms.vertices, vertex)) {
        return true;
    }
    float chance = sampling_techniques(point.surface, -path.ray.direction).diffuse;
    path.numbers.dimension = SELECTION_PAIRS + 16u * path.vertex + 15u;
    if (!(sample_1d(path.numbers) < chance)) {
        point.surface.part = PART_SPECULAR;
        path.throughput /= 1.0 - chance;
        return true;
    }
    point.surface.part = PART_DIFFUSE;
    begin_vertex(path.place, vertex, path.throughput * albedo / chance, path.diffuse_weight, path.specular_weight, terms);
    path.filter_vertex = path.vertex;
    path.throughput = vec3(1.0);
    path.specular_weight = vec3(0.0);
    return !(LAST_IS_READ && list_ends(terms));
#else
    return true;
#endif
}

/// The path arrives at a surface: adds what it emits. False where the path ends there.
bool arrive(inout Path path, Hit hit, inout HitPoint point, inout Terms terms) {
    MaterialBuffer materials = MaterialBuffer(frame.materials);
    path.travelled += hit.t;
    if (EFFECT_TRANSMISSION && !point.on_front && !point.surface.thin) {
        path.throughput *= exp(-materials.at[point.material].absorption * hit.t);
    }
    if (EFFECT_UNLIT && (materials.at[point.material].flags & MATERIAL_UNLIT) != 0u) {
        add_term(terms, term_of(path, terms, false), path.diffuse_weight, path.specular_weight, path.throughput * point.surface.base_color);
        return false;
    }
    if (any(greaterThan(point.emission, vec3(0.0)))) {
        terms.vertex.travelled = path.vertex == 0u ? EMITS : terms.vertex.travelled;
        float light_pdf;
        triangle_light_pdf(hit.instance, hit.primitive, path.ray.direction, hit.t, light_pdf);
        add_emission(path, point.emission, light_pdf, terms);
    }
    if (path.vertex > parameters.max_bounces || list_ends(terms)) {
        return false;
    }
    bool filters = is_diffuse(point) || layer_to_filter(path, point) != 0u;
    return !filters || arrive_at_filter(path, point, terms);
}

/// A sphere light in front of what the ray has hit. It stops the ray.
bool meet_sphere_light(Path path, bool hit_something, float t, inout Terms terms) {
    Ray ray = path.ray;
    ray.t_max = hit_something ? t : ray.t_max;
    float distance;
    uint light;
    if (!EFFECT_SPHERE_LIGHT || !intersect_sphere_lights(ray, distance, light)) {
        return false;
    }
    float light_pdf;
    vec3 radiance = sphere_light_radiance(light, ray.origin, distance, light_pdf);
    add_emission(path, radiance, light_pdf, terms);
    return true;
}

/// The path's ray has been traced. False where the path ends: at a light, or outside of the scene.
bool follow(inout Path path, bool found, Hit hit, inout Terms terms) {
    if (meet_sphere_light(path, found, hit.t, terms)) {
        return false;
    }
    if (!found) {
        add_environment(path, terms);
        return false;
    }
    path.cone = cone_advance(path.cone, hit.t);
    return true;
}

/// Path space regularization, Kaplanyan and Dachsbacher 2013: seen from a diffuse vertex, a narrow lobe that hardly any ray finds is as good as
/// a wider one that many find. Mirrors and glass stay as they are, for what they send on is found by no shadow ray, and would come on top.
void regularize(inout Surface s) {
    float alpha = parameters.regularized_roughness * parameters.regularized_roughness;
    if (reflects(s) && !reflection_is_delta(s) && glass_part(s) == 0.0) {
        s.alpha = max(s.alpha, alpha);
    }
    if (s.clearcoat > 0.0 && !clearcoat_is_delta(s)) {
        s.clearcoat_alpha = max(s.clearcoat_alpha, alpha);
    }
}

/// One visit to the vertex that the path's ray has hit, for one shadow ray, `pending`; `shadow_rays`: that are left to send after it. The last
/// visit chooses the next ray. False where the path ends.
bool visit(inout Path path, Hit hit, bool arrives, inout uint shadow_rays, inout Terms terms, inout Pending pending) {
    vec3 wo = -path.ray.direction;
    HitPoint point = hit_point(hit, path.ray.direction, path.cone);
    if (!is_in_front(path) && path.vertex > path.filter_vertex) {
        regularize(point.surface);
    }
#ifdef VERTEX_LIST
    if (!arrives && path.filter_vertex == path.vertex && vertices_behind(terms) > 0u) {
        point.surface.part = PART_DIFFUSE;
    }
#endif
    if (arrives && !arrive(path, hit, point, terms)) {
        return false;
    }
    if (arrives && has_sole_ray(path.vertex)) {
        shadow_rays = first_shadow_rays(path);
        pending = sample_sole(path, terms, point, wo);
        pending.alpha_seed = alpha_seed(path) + 1u + shadow_rays;
        return true;
    }
    uint rays = path.vertex == 0u ? first_shadow_rays(path) : 1u;
    shadow_rays = (arrives ? rays : shadow_rays) - 1u;
    bool first = shadow_rays == rays - 1u;
    uint extra = EXTRA_PAIRS + PAIRS_PER_EXTRA_RAY * shadow_rays;
    path.numbers.dimension = first ? 1u + PAIRS_PER_VERTEX * path.vertex : extra;
    vec4 light;
    light.xy = sample_2d(path.numbers);
    light.zw = sample_2d(path.numbers);
    path.numbers.dimension = first ? SELECTION_PAIRS + 16u * path.vertex : extra + 2u;
    pending = sample_direct(path, terms, point, wo, light, sample_1d(path.numbers), float(rays));
    pending.alpha_seed = alpha_seed(path) + 1u + shadow_rays;
    if (shadow_rays > 0u) {
        return true;
    }
    path.numbers.dimension = 3u + PAIRS_PER_VERTEX * path.vertex;
    vec2 direction = sample_2d(path.numbers);
    bool goes_on = scatter(path, terms, point, wo, vec4(direction, sample_2d(path.numbers)));
    path.vertex++;
    return goes_on;
}

#endif
