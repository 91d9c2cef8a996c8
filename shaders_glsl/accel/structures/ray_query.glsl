// The driver's own structures through VK_KHR_ray_query (src/accel/ray_query.rs builds them).
#ifndef ACCEL_STRUCTURES_RAY_QUERY_GLSL
#define ACCEL_STRUCTURES_RAY_QUERY_GLSL

#include "accel/alpha.glsl"
#include "accel/ray.glsl"
#include "shared/bindings.glsl"

bool accel_trace(Ray ray, bool any_hit, uint alpha_seed, out Hit hit) {
    bool opaque = !EFFECT_ALPHA_MASK && !EFFECT_ALPHA_BLEND;
    uint flags = (opaque ? gl_RayFlagsOpaqueEXT : gl_RayFlagsNoneEXT) | (any_hit ? gl_RayFlagsTerminateOnFirstHitEXT : gl_RayFlagsNoneEXT);
    rayQueryEXT query;
    rayQueryInitializeEXT(query, top_level, flags, 0xff, ray.origin, ray.t_min, ray.direction, ray.t_max);
    while (rayQueryProceedEXT(query)) {
        // Only triangles that are not opaque come here.
        uint instance = rayQueryGetIntersectionInstanceCustomIndexEXT(query, false);
        uint primitive = rayQueryGetIntersectionPrimitiveIndexEXT(query, false);
        if (alpha_passes(instance, primitive, rayQueryGetIntersectionBarycentricsEXT(query, false), alpha_seed)) {
            rayQueryConfirmIntersectionEXT(query);
        }
    }
    if (rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT) {
        // Reading anything else after a miss is undefined, and a crash on lavapipe.
        return false;
    }
    hit.t = rayQueryGetIntersectionTEXT(query, true);
    hit.instance = rayQueryGetIntersectionInstanceCustomIndexEXT(query, true);
    hit.primitive = rayQueryGetIntersectionPrimitiveIndexEXT(query, true);
    hit.barycentrics = rayQueryGetIntersectionBarycentricsEXT(query, true);
    return true;
}

#endif
