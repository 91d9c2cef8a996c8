// Where a secondary ray starts so that it neither hits its own surface nor leaks through the next one.
//
// Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, section 6.8: the hit point comes from barycentrics, not from
// t, with a bound on its rounding error (6.8.5) carried through the instance's transform (6.8.6); the origin moves along the
// geometric normal just out of the box of that error (6.8.6, offset ray origins). The bound scales with the coordinates, so a scene
// of any size behaves the same.
// Deviations and why: a traversal that transforms the ray into mesh space rounds once more there, by as much as the transform of the
// point; ERROR_SCALE covers both ways.
#ifndef LIB_RAY_OFFSET_GLSL
#define LIB_RAY_OFFSET_GLSL

#include "shared/bindings.glsl"

const uint RAY_OFFSET_ERROR_BOUND = 0u;
/// Metres, for RAY_OFFSET epsilon.
const float FIXED_OFFSET = 1e-4;
/// gamma(n) = n u / (1 - n u), u = 2^-24.
const float UNIT_ROUNDOFF = 5.9604645e-8;
const float GAMMA_3 = 3.0 * UNIT_ROUNDOFF;
const float GAMMA_7 = 7.0 * UNIT_ROUNDOFF;
const float ERROR_SCALE = 2.0;
/// A shadow ray ends this fraction of the way to its light: rounding of its direction and length, and of the point on the light.
const float SHADOW_RAY_END = 1.0 - 1e-4;

struct RayOrigin {
    vec3 position;
    /// Largest rounding error of each coordinate.
    vec3 error;
    /// Unit, geometric, either side.
    vec3 normal;
};

vec3 transform_rows(vec4 rows[3], vec3 v) {
    return vec3(dot(rows[0].xyz, v), dot(rows[1].xyz, v), dot(rows[2].xyz, v));
}

vec3 transform_absolute(vec4 rows[3], vec3 v) {
    return vec3(dot(abs(rows[0].xyz), v), dot(abs(rows[1].xyz), v), dot(abs(rows[2].xyz), v));
}

RayOrigin ray_origin_of_hit(Instance instance, Mesh mesh, uvec3 corners, vec2 barycentrics, vec3 normal) {
    Vec3Buffer positions = Vec3Buffer(mesh.positions);
    vec3 weighted0 = (1.0 - barycentrics.x - barycentrics.y) * positions.at[corners.x];
    vec3 weighted1 = barycentrics.x * positions.at[corners.y];
    vec3 weighted2 = barycentrics.y * positions.at[corners.z];
    vec3 object = weighted0 + weighted1 + weighted2;
    vec3 object_error = GAMMA_7 * (abs(weighted0) + abs(weighted1) + abs(weighted2));
    vec3 translation = vec3(instance.object_to_world[0].w, instance.object_to_world[1].w, instance.object_to_world[2].w);
    RayOrigin origin;
    origin.position = transform_rows(instance.object_to_world, object) + translation;
    origin.error = GAMMA_3 * (transform_absolute(instance.object_to_world, abs(object)) + abs(translation))
        + (1.0 + GAMMA_3) * transform_absolute(instance.object_to_world, object_error);
    origin.normal = normal;
    return origin;
}

/// Origin for a ray that leaves along `direction`, on that side of the surface.
vec3 leave_surface(RayOrigin origin, vec3 direction) {
    float side = dot(origin.normal, direction) < 0.0 ? -1.0 : 1.0;
    if (RAY_OFFSET != RAY_OFFSET_ERROR_BOUND) {
        return origin.position + side * FIXED_OFFSET * origin.normal;
    }
    float reach = ERROR_SCALE * dot(abs(origin.normal), origin.error);
    vec3 moved = origin.position + side * reach * origin.normal;
    // The sum rounds by up to half a unit in the last place: outwards.
    return moved + side * sign(origin.normal) * abs(moved) * UNIT_ROUNDOFF;
}

#endif
