// Where a secondary ray starts, so that it neither meets the surface that it leaves nor skips the next one.
//
// Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, section 6.8: the hit point comes from barycentrics, not from
// the distance, with a bound on its rounding error (6.8.5) carried through the instance's transform; the origin moves along the
// geometric normal just out of that box. The bound follows the coordinates, so scenes of 10^-3 m and of 10^6 m behave alike.
// Deviations and why: pbrt gives what the next ray loses on its way back into mesh space, and in the triangle test, to that ray's t_min;
// traversals here start at t_min = 0 and may be a device's own, so it is part of this bound. What slivers add to it depends on the triangle
// that is tested, not on the one that the ray leaves: the watertight test sees to it (lib/intersect.glsl).
#ifndef LIB_RAY_OFFSET_GLSL
#define LIB_RAY_OFFSET_GLSL

#include "shared/bindings.glsl"
#include "accel/ray.glsl"
#include "lib/constants.glsl"

const uint RAY_OFFSET_ERROR_BOUND = 0u;
/// Metres, for RAY_OFFSET epsilon.
const float FIXED_OFFSET = 1e-4;
/// n roundings of up to 2^-24 each; second-order terms are far below what `leave_surface` adds.
const float ROUNDING = 5.9604645e-8;
/// Interpolation, 7, and the next ray's triangle test: differences to the corners, shear, edges and weighted sum, 9.
const float TRIANGLE_ROUNDINGS = 16.0 * ROUNDING;
/// Three products and sums of an affine transform, its translation, and the matrix' own elements.
const float TRANSFORM_ROUNDINGS = 5.0 * ROUNDING;
/// A shadow ray ends this share of the way to its light: rounding of direction, length and the point on the light.
const float SHADOW_RAY_END = 1.0 - 1e-4;

/// World space, relative to the frame's origin, metres.
struct RayOrigin {
    vec3 position;
    /// Largest error of each coordinate.
    vec3 error;
    /// Unit, geometric, either side.
    vec3 normal;
};

vec3 affine_linear(vec4 rows[3], vec3 v) {
    return vec3(dot(rows[0].xyz, v), dot(rows[1].xyz, v), dot(rows[2].xyz, v));
}

vec3 affine_absolute(vec4 rows[3], vec3 v) {
    return vec3(dot(abs(rows[0].xyz), v), dot(abs(rows[1].xyz), v), dot(abs(rows[2].xyz), v));
}

vec3 affine_translation(vec4 rows[3]) {
    return vec3(rows[0].w, rows[1].w, rows[2].w);
}

/// Corners in mesh space; barycentrics weigh p1 and p2; `normal` is geometric, in the world.
RayOrigin ray_origin(Instance instance, vec3 p0, vec3 p1, vec3 p2, vec2 barycentrics, vec3 normal) {
    vec3 part0 = (1.0 - barycentrics.x - barycentrics.y) * p0;
    vec3 part1 = barycentrics.x * p1;
    vec3 part2 = barycentrics.y * p2;
    vec3 point = part0 + part1 + part2;
    vec3 translation = affine_translation(instance.object_to_world);
    vec3 position = affine_linear(instance.object_to_world, point) + translation;

    vec3 magnitude = abs(part0) + abs(part1) + abs(part2);
    vec3 forth = affine_absolute(instance.object_to_world, magnitude) + abs(translation);
    vec3 back = affine_absolute(instance.world_to_object, abs(position)) + abs(affine_translation(instance.world_to_object));
    // The triangle test shears the axes into each other: a floor at y = 0 has no error of its own in y, but that of x and z at
    // grazing angles.
    vec3 mixed = TRIANGLE_ROUNDINGS * magnitude + TRANSFORM_ROUNDINGS * back;
    vec3 object_error = vec3(max(mixed.x, max(mixed.y, mixed.z)));
    return RayOrigin(position, TRANSFORM_ROUNDINGS * forth + affine_absolute(instance.object_to_world, object_error), normal);
}

RayOrigin ray_origin_of_hit(Instance instance, Mesh mesh, uvec3 corners, vec2 barycentrics, vec3 normal) {
    Vec3Buffer positions = Vec3Buffer(mesh.positions);
    return ray_origin(instance, positions.at[corners.x], positions.at[corners.y], positions.at[corners.z], barycentrics, normal);
}

/// Origin of a ray that leaves along `direction`, on that side of the surface.
vec3 leave_surface(RayOrigin origin, vec3 direction) {
    vec3 outwards = dot(origin.normal, direction) < 0.0 ? -origin.normal : origin.normal;
    if (RAY_OFFSET != RAY_OFFSET_ERROR_BOUND) {
        return origin.position + FIXED_OFFSET * outwards;
    }
    vec3 moved = origin.position + dot(abs(origin.normal), origin.error) * outwards;
    // The sum rounds, too: on to the next float outwards.
    return moved + sign(outwards) * abs(moved) * (2.0 * ROUNDING);
}

/// To just before the point that lies `distance` along the unit `direction` from the surface itself. The ray sets out nearer to it than the
/// surface is: with the surface's distance it would pass a light close to a large triangle, and leave it in its own shadow.
/// A fixed offset is kept from the light, too, as renderers do that know no better.
Ray shadow_ray(RayOrigin origin, vec3 direction, float distance) {
    vec3 start = leave_surface(origin, direction);
    if (distance >= FAR_AWAY) {
        return Ray(start, 0.0, direction, FAR_AWAY);
    }
    if (RAY_OFFSET != RAY_OFFSET_ERROR_BOUND) {
        return Ray(start, 0.0, direction, distance - 2.0 * FIXED_OFFSET);
    }
    vec3 way = distance * direction + (origin.position - start);
    float left = length(way);
    return Ray(start, 0.0, way / max(left, 1e-30), left * SHADOW_RAY_END);
}

#endif
