// Whole paths in one kernel. Each turn of the loop traces a ray through the one traversal call site, for some threads a shadow ray, for
// others a scattered one. A thread has several pixels and starts the next path when one has ended, so that no thread waits for its
// neighbours' longer paths, and every turn has a ray to trace.
#ifndef PATHS_MEGAKERNEL_GLSL
#define PATHS_MEGAKERNEL_GLSL

#include "accel/trace.glsl"
#include "paths/path.glsl"
#ifdef RETRACES
#include "paths/retraced.glsl"
#endif

/// Tiles of 8x4 pixels that a workgroup of 32 threads works off.
layout(constant_id = 201) const uint TILES = 1;

/// What a workgroup traces: pixels of the picture; or, where the kernel retraces, one path of the last frame for each square of pixels.
struct Field {
    /// Number of the workgroup among those of its field.
    uint group;
    uvec2 extent;
    bool retraced;
};

Field field_of(uint group) {
#ifdef RETRACES
    if (group >= RETRACING_GROUP) {
        return Field(group - RETRACING_GROUP, frame.frame > 0u ? retraced_extent() : uvec2(1u, 0u), true);
    }
#endif
    return Field(group, frame.extent, false);
}

/// The next path of a pixel, or a square's from the last frame. One call, whatever it is: the same instructions for the same bits.
Path field_path(Field field, uvec2 pixel, uint sampled) {
    Camera camera = frame.camera;
    vec2 jitter = frame.jitter;
    uint sample_index = frame.first_sample + sampled;
#ifdef RETRACES
    if (field.retraced) {
        camera = frame.previous_camera;
        jitter = frame.previous_jitter;
        sample_index = frame.first_sample - 1u;
        pixel = retraced_pixel(pixel, sample_index);
    }
#endif
    Path path = path_from(camera, jitter, pixel, sample_index);
#ifdef RETRACES
    path.first_rays = field.retraced ? frame.previous_first_rays : parameters.first_shadow_rays;
#endif
    return path;
}

/// The thread's pixel in tile `turn` or the first one after it that lies in the field; false where there is none.
bool find_pixel(Field field, uint thread, inout uint turn, out uvec2 pixel) {
    for (; turn < TILES; turn++) {
        pixel = pixel_in_tile(field.extent.x, field.group * TILES + turn, thread);
        if (all(lessThan(pixel, field.extent))) {
            return true;
        }
    }
    return false;
}

/// Takes a pixel's result so far, a sum over `samples`; `counts`: its scattered rays and shadow rays. Defined by the kernel.
void write_pixel(uvec2 pixel, Terms terms, uint samples, uvec2 counts);

#ifndef SHARED_JITTER
/// What write_pixel has taken in the submission before, of the same frame. Defined by the kernel.
void resume_pixel(uvec2 pixel, inout Terms terms, inout uvec2 counts);
#endif

/// Where a pixel's result begins.
void begin_pixel(uvec2 pixel, out Terms terms, out uvec2 counts) {
    terms = no_terms();
    counts = uvec2(0u);
#ifndef SHARED_JITTER
    if (first_sample_here() > 0u) {
        resume_pixel(pixel, terms, counts);
    }
#endif
}

#ifdef KEEP_ENDS
/// Takes a pixel's path where it has ended: at `hit`, if it has ended at a surface. Defined by the kernel.
void keep_end(uvec2 pixel, Path path, Hit hit, Terms terms);
#endif

/// The paths of all pixels of a thread, one after the other.
void trace_pixels(uint group, uint thread) {
    Field field = field_of(group);
    uint turn = 0u;
    uint sampled = first_sample_here();
    uvec2 pixel;
    bool paths_left = find_pixel(field, thread, turn, pixel);
    uint samples = samples_up_to_here(pixel);
    Path path = field_path(field, pixel, sampled);
    Terms terms;
    uvec2 counts;
    begin_pixel(pixel, terms, counts);
    Pending pending;
    pending.ray = NO_RAY;
    // Shadow rays that the path's last vertex has yet to send.
    uint shadow_rays = 0u;
    Hit hit;
    bool ended = false;
    while (paths_left) {
        bool lights = pending.ray.t_max > 0.0;
        bool scatters = !lights && shadow_rays == 0u;
        Ray ray = pending.ray;
        uint seed = pending.alpha_seed;
        if (scatters) {
            ray = path.ray;
            seed = alpha_seed(path);
        }
        Hit found;
        bool blocked = accel_trace(ray, lights, seed, found);
        counts += uvec2(scatters, lights);

        bool shade = shadow_rays > 0u;
        if (scatters) {
            shade = follow(path, blocked, found, terms);
            ended = !shade;
            hit = found;
        } else if (lights && !blocked) {
            add_term(terms, pending.term, pending.diffuse_weight, pending.specular_weight, pending.radiance);
        }
        pending.ray = NO_RAY;
        if (shade) {
            ended = !visit(path, hit, scatters, shadow_rays, terms, pending);
        }
        if (ended && pending.ray.t_max <= 0.0) {
            sampled++;
            terms.attenuation = sampled < samples ? vec3(0.0) : terms.attenuation;
            if (sampled == samples) {
#ifdef KEEP_ENDS
                keep_end(pixel, path, hit, terms);
#endif
                write_pixel(pixel, terms, samples, counts);
                sampled = first_sample_here();
                turn++;
                paths_left = find_pixel(field, thread, turn, pixel);
                samples = samples_up_to_here(pixel);
                begin_pixel(pixel, terms, counts);
            }
            path = field_path(field, pixel, sampled);
            ended = false;
        }
    }
}

#endif
