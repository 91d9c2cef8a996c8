// Maps from the unit square to directions, triangles and tables, and their densities.
//
// Concentric disk: Shirley and Chiu, "A Low Distortion Map Between Disk and Square", 1997. Triangle: Heitz, "A Low-Distortion Map
// Between Triangle and Square", 2019. Alias method: Walker 1977, tables after Vose 1991 (src/scene/lights.rs).
#ifndef LIB_SAMPLING_GLSL
#define LIB_SAMPLING_GLSL

#include "shared/scene.glsl"
#include "lib/constants.glsl"

/// Uniform on the unit disk.
vec2 sample_disk(vec2 u) {
    vec2 p = 2.0 * u - 1.0;
    if (p.x == 0.0 && p.y == 0.0) {
        return vec2(0.0);
    }
    bool wide = abs(p.x) > abs(p.y);
    float radius = wide ? p.x : p.y;
    float angle = wide ? 0.25 * PI * (p.y / p.x) : 0.5 * PI - 0.25 * PI * (p.x / p.y);
    return radius * vec2(cos(angle), sin(angle));
}

/// Direction around +z with density cos / pi.
vec3 sample_cosine_hemisphere(vec2 u) {
    vec2 p = sample_disk(u);
    return vec3(p, sqrt(max(0.0, 1.0 - dot(p, p))));
}

float cosine_hemisphere_pdf(float cosine) {
    return max(cosine, 0.0) * INV_PI;
}

/// Uniform on the unit sphere: density 1 / (4 pi).
vec3 sample_sphere(vec2 u) {
    float z = 1.0 - 2.0 * u.x;
    float phi = 2.0 * PI * u.y;
    return vec3(sqrt(max(0.0, 1.0 - z * z)) * vec2(cos(phi), sin(phi)), z);
}

const float UNIFORM_SPHERE_PDF = 0.25 * INV_PI;

/// 1 - cos of the half angle under which a sphere is seen, from the squared sine of it (radius / distance)^2 below 1. The plain
/// difference has no correct digit left below 0.02 degrees.
float one_minus_cos_from_sin2(float sin2) {
    return sin2 / (1.0 + sqrt(max(0.0, 1.0 - sin2)));
}

/// Uniform in the cone around +z whose half angle has this 1 - cos. Density: 1 / (2 pi one_minus_cos).
vec3 sample_cone(vec2 u, float one_minus_cos) {
    float drop = u.x * one_minus_cos;
    float phi = 2.0 * PI * u.y;
    return vec3(sqrt(max(0.0, drop * (2.0 - drop))) * vec2(cos(phi), sin(phi)), 1.0 - drop);
}

float cone_pdf(float one_minus_cos) {
    return 0.5 * INV_PI / one_minus_cos;
}

/// Uniform on a triangle: the weights of its second and third vertex.
vec2 sample_triangle(vec2 u) {
    if (u.y > u.x) {
        u.x *= 0.5;
        u.y -= u.x;
    } else {
        u.y *= 0.5;
        u.x -= u.y;
    }
    return u;
}

/// The bucket of an alias table of `count` entries that u in [0, 1) falls into. `u` becomes its place within the bucket, in [0, 1),
/// with log2(count) of its 24 bits fewer.
uint alias_bucket(uint count, inout float u) {
    float scaled = u * float(count);
    uint bucket = min(uint(scaled), count - 1u);
    u = clamp(scaled - float(bucket), 0.0, 0.99999994);
    return bucket;
}

/// What a bucket decides for u in [0, 1). `u` is stretched to be used again.
uint alias_choice(AliasEntry entry, uint bucket, inout float u) {
    bool keep = u < entry.threshold;
    u = keep ? u / entry.threshold : (u - entry.threshold) / (1.0 - entry.threshold);
    u = min(u, 0.99999994);
    return keep ? bucket : entry.alias;
}

/// Latitude-longitude map: u = 1/2 - atan2(x, z) / (2 pi), v = angle from +y / pi. atan instead of acos, which is coarse at the poles.
vec2 direction_to_latlong(vec3 d) {
    float around = d.x == 0.0 && d.z == 0.0 ? 0.0 : atan(d.x, d.z);
    return vec2(0.5 - around * (0.5 * INV_PI), atan(length(d.xz), d.y) * INV_PI);
}

vec3 latlong_to_direction(vec2 uv) {
    float phi = (0.5 - uv.x) * 2.0 * PI;
    float theta = uv.y * PI;
    return vec3(sin(theta) * sin(phi), cos(theta), sin(theta) * cos(phi));
}

#endif
