// Unidirectional path tracing, whole paths in one kernel: one traversal call site in a loop whose turns alternate between a
// scattered ray and a shadow ray, so that neighbouring threads stay together.
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

#include "accel/trace.glsl"
#include "lib/bsdf.glsl"
#include "lib/lights.glsl"
#include "lib/ray_cone.glsl"
#include "lib/sampler.glsl"
#include "paths/hit.glsl"
#include "paths/primary.glsl"
#include "paths/terms.glsl"

const uint DIRECT_MIS = 0u;
const uint DIRECT_NEE = 1u;
const uint DIRECT_BSDF = 2u;

/// Pairs of sample dimensions that a vertex takes: light, point on it, direction, lobe and roulette.
const uint PAIRS_PER_VERTEX = 4u;
/// Where those of further shadow rays at the first vertex begin: behind the deepest path's.
const uint EXTRA_PAIRS = 1u + PAIRS_PER_VERTEX * 66u;

const uint NO_VERTEX = ~0u;

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
    uint filter_vertex;
    Sampler numbers;
};

/// Light that waits for its shadow ray.
struct Pending {
    Ray ray;
    uint term;
    float diffuse_weight;
    vec3 specular_weight;
    vec3 radiance;
};

Path path_begin(uvec2 pixel, uint sample_index) {
    Path path;
    path.numbers = sampler_begin(pixel, sample_index, frame.seed);
#ifdef SHARED_JITTER
    vec2 offset = frame.jitter;
#else
    vec2 offset = sample_2d(path.numbers) - 0.5;
#endif
    path.ray = primary_ray(pixel, offset);
    path.cone = primary_cone();
    path.throughput = vec3(1.0);
    path.diffuse_weight = 0.0;
    path.specular_weight = vec3(1.0);
    path.pdf = 0.0;
    path.delta = true;
    path.eta_scale = 1.0;
    path.vertex = 0u;
    path.filter_vertex = NO_VERTEX;
    return path;
}

/// The same holes for everything that one ray of one sample sees, others for the next.
uint alpha_seed(Path path, uint ray) {
    return EFFECT_ALPHA_BLEND ? pcg3d(uvec3(path.numbers.scramble, path.numbers.index, path.vertex * 32u + ray)).x : 0u;
}

float power_heuristic(float a, float b) {
    return a * a / max(a * a + b * b, 1e-30);
}

/// For light found by following the path's ray, against light sampling with density `light_pdf`.
float emission_weight(Path path, float light_pdf) {
    if (path.delta || DIRECT == DIRECT_BSDF) {
        return 1.0;
    }
    return DIRECT == DIRECT_NEE ? 0.0 : power_heuristic(path.pdf, light_pdf);
}

/// Where light belongs that the path's ray has found. `from_light`: straight, not reflected.
uint term_of(Path path, bool from_light) {
    if (path.filter_vertex == NO_VERTEX) {
        return TERM_BEFORE;
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
    add_term(terms, term_of(path, true), path.diffuse_weight, path.specular_weight, arrived);
}

/// The path's ray has left the scene.
void add_environment(Path path, inout Terms terms) {
    vec3 radiance = environment_radiance(path.ray.direction);
    add_emission(path, radiance, environment_pdf(path.ray.direction), terms);
}

/// Looks for light at a vertex; nothing waits where there is none to be found.
Pending sample_direct(Path path, HitPoint point, vec3 wo, vec4 u, float rays) {
    Pending pending;
    pending.ray = Ray(vec3(0.0), 0.0, vec3(0.0, 0.0, 1.0), -1.0);
    LightSample light;
    if (!sample_light(point.origin.position, u, light) || (DIRECT == DIRECT_BSDF && !light.delta)) {
        return pending;
    }
    BsdfValue value = bsdf_evaluate(point.surface, wo, light.direction);
    float weight = light.delta || DIRECT == DIRECT_NEE ? 1.0 : power_heuristic(light.pdf, value.pdf);
    vec3 radiance = light.radiance * (weight / (light.pdf * rays));
    vec3 albedo = diffuse_albedo(point.surface);
    if (path.vertex == path.filter_vertex) {
        pending.term = TERM_DIRECT;
        pending.diffuse_weight = value.diffuse;
        pending.specular_weight = path.throughput * value.specular;
        pending.radiance = radiance;
    } else {
        pending.term = term_of(path, false);
        pending.diffuse_weight = path.diffuse_weight;
        pending.specular_weight = path.specular_weight;
        pending.radiance = clamp_indirect(path.throughput * (albedo * value.diffuse + value.specular) * radiance, path.vertex + 1u);
    }
    vec3 most = max(vec3(pending.diffuse_weight), pending.specular_weight) * pending.radiance;
    if (max(most.r, max(most.g, most.b)) > 0.0) {
        pending.ray.origin = leave_surface(point.origin, light.direction);
        pending.ray.direction = light.direction;
        pending.ray.t_max = light.distance * SHADOW_RAY_END;
    }
    return pending;
}

/// Chooses the path's next ray; false where the path ends here. `attenuation` is that of the path's terms.
bool scatter(inout Path path, HitPoint point, vec3 wo, vec4 u, vec3 attenuation) {
    BsdfSample next;
    if (!bsdf_sample(point.surface, wo, u.xyz, next)) {
        return false;
    }
    if (path.vertex == path.filter_vertex) {
        path.diffuse_weight = next.diffuse_weight;
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

/// The path arrives at a surface: adds what it emits. False where the path ends there.
bool arrive(inout Path path, Hit hit, HitPoint point, inout Terms terms) {
    MaterialBuffer materials = MaterialBuffer(frame.materials);
    if (EFFECT_TRANSMISSION && !point.on_front && !point.surface.thin) {
        path.throughput *= exp(-materials.at[point.material].absorption * hit.t);
    }
    if (EFFECT_UNLIT && (materials.at[point.material].flags & MATERIAL_UNLIT) != 0u) {
        add_term(terms, term_of(path, false), path.diffuse_weight, path.specular_weight, path.throughput * point.surface.base_color);
        return false;
    }
    if (any(greaterThan(point.emission, vec3(0.0)))) {
        float light_pdf;
        triangle_light_pdf(hit.instance, hit.primitive, path.ray.direction, hit.t, light_pdf);
        add_emission(path, point.emission, light_pdf, terms);
    }
    vec3 albedo = diffuse_albedo(point.surface);
    if (path.filter_vertex == NO_VERTEX && max(albedo.r, max(albedo.g, albedo.b)) > 0.0) {
        path.filter_vertex = path.vertex;
        terms.attenuation = path.throughput * albedo;
    }
    return path.vertex <= parameters.max_bounces;
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

/// Follows one path after another, `samples` of them, and returns the sum of their terms. `counts`: scattered rays and shadow rays.
Terms trace_paths(uvec2 pixel, uint first_sample, uint samples, out uvec2 counts) {
    Terms sum = no_terms();
    Terms terms = no_terms();
    counts = uvec2(0u);
    uint done = 0u;
    Path path = path_begin(pixel, first_sample);
    Pending pending;
    Hit hit;
    vec3 wo;
    uint shadow_rays = 0u;
    bool goes_on = false;
    while (done < samples) {
        bool shadow = shadow_rays > 0u;
        Ray ray = path.ray;
        if (shadow) {
            ray = pending.ray;
        }
        Hit found;
        bool traced = ray.t_max > ray.t_min;
        bool hit_something = traced && accel_trace(ray, shadow, alpha_seed(path, shadow_rays), found);
        counts[shadow ? 1 : 0] += traced ? 1u : 0u;

        bool ended = false;
        bool shade = false;
        if (shadow) {
            if (traced && !hit_something) {
                add_term(terms, pending.term, pending.diffuse_weight, pending.specular_weight, pending.radiance);
            }
            shadow_rays--;
            shade = shadow_rays > 0u;
            ended = !shade && !goes_on;
        } else if (meet_sphere_light(path, hit_something, found.t, terms)) {
            ended = true;
        } else if (!hit_something) {
            add_environment(path, terms);
            ended = true;
        } else {
            hit = found;
            wo = -path.ray.direction;
            path.cone = cone_advance(path.cone, hit.t);
            shade = true;
        }
        if (shade) {
            HitPoint point = hit_point(hit, -wo, path.cone);
            if (shadow || arrive(path, hit, point, terms)) {
                path.numbers.dimension = shadow ? EXTRA_PAIRS + 2u * shadow_rays : 1u + PAIRS_PER_VERTEX * path.vertex;
                float rays = path.vertex == 0u ? float(parameters.first_shadow_rays) : 1.0;
                vec2 choice = sample_2d(path.numbers);
                pending = sample_direct(path, point, wo, vec4(choice, sample_2d(path.numbers)), rays);
                if (!shadow) {
                    vec2 direction = sample_2d(path.numbers);
                    goes_on = scatter(path, point, wo, vec4(direction, sample_2d(path.numbers)), terms.attenuation);
                    shadow_rays = uint(rays);
                }
            } else {
                ended = true;
            }
        } else if (shadow && goes_on) {
            path.vertex++;
        }
        if (ended) {
            sum.before += terms.before;
#ifdef SEPARATE_TERMS
            sum = terms;
#endif
            terms = no_terms();
            done++;
            path = path_begin(pixel, first_sample + done);
            shadow_rays = 0u;
        }
    }
    return sum;
}

#endif
