// One interface over every acceleration structure: `trace_closest` and `trace_any`, both through one traversal call site (a driver
// that inlines everything compiles each call site anew). The structure is chosen by the file that ACCEL_FILE names; build.rs
// compiles a shader that includes this file once for each file of shaders_glsl/accel/structures/.
//
// A structure's file defines
//     bool accel_trace(Ray ray, bool any_hit, uint alpha_seed, out Hit hit);
// with alpha mask and stochastic blend decided inside by `alpha_passes` (accel/alpha.glsl).
#ifndef ACCEL_TRACE_GLSL
#define ACCEL_TRACE_GLSL

#include "shared/bindings.glsl"
#include "accel/ray.glsl"
#include "accel/alpha.glsl"
#include "ACCEL_FILE"

/// Nearest hit in (t_min, t_max). `alpha_seed` decides stochastic transparency: the same seed sees the same holes.
bool trace_closest(Ray ray, uint alpha_seed, out Hit hit) {
    return accel_trace(ray, false, alpha_seed, hit);
}

/// Whether anything lies in (t_min, t_max).
bool trace_any(Ray ray, uint alpha_seed) {
    Hit hit;
    return accel_trace(ray, true, alpha_seed, hit);
}

#endif
