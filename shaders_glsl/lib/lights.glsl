// Choosing a light, a point or direction on it, and the density of that choice for directions found otherwise (multiple importance sampling).
//
// Lights are chosen by power: a scene's only one without a size by its share, the others from an alias table (src/scene/lights.rs).
// Triangles: uniform in area. Spheres: uniform in the cone they fill, Shirley, Wang and Zimmerman, "Monte Carlo Techniques for Direct Lighting
// Calculations", 1996; from inside, over all directions.
// Environment maps: texels by the alias method, in proportion to radiance times solid angle, uniform in (u, v) within a texel.
// Point, spot and directional lights, falloff and range: KHR_lights_punctual ("Range Property", "Inner and Outer Cone Angles").
//
// Triangles shine from their front, counter-clockwise in the mesh's own space, unless the material is double-sided. A sphere shines
// both ways, as a thin shell would. A kernel that includes this defines `emitted_radiance`.
// Deviations and why: the cone's 1 - cos comes from sin^2 without a difference (lib/sampling.glsl), so a small or far sphere keeps its precision.
#ifndef LIB_LIGHTS_GLSL
#define LIB_LIGHTS_GLSL

#include "shared/bindings.glsl"
#include "accel/ray.glsl"
#include "lib/constants.glsl"
#include "lib/frame.glsl"
#include "lib/sampling.glsl"

struct LightSample {
    /// Unit, towards the light.
    vec3 direction;
    /// Metres; FAR_AWAY for directional lights and the environment.
    float distance;
    /// Emitted radiance; for delta lights irradiance on a plane facing the light (intensity / distance^2).
    vec3 radiance;
    /// 1/sr, including the probability of choosing this light; for delta lights that probability alone.
    float pdf;
    bool delta;
    uint light;
};

/// Radiance that a triangle emits at a point, whichever side: emission times texture. Defined by the kernel.
vec3 emitted_radiance(uint instance, uint primitive, vec2 barycentrics);

/// KHR_lights_punctual's recommended window: 1 near, 0 from the range on.
float range_window(float distance, float inverse_range) {
    float x = distance * inverse_range;
    float x2 = x * x;
    return clamp(1.0 - x2 * x2, 0.0, 1.0);
}

/// A triangle of an instance in the world.
struct Emitter {
    vec3 origin;
    vec3 edge1;
    vec3 edge2;
    /// Twice the area long, towards the front.
    vec3 area_normal;
    bool double_sided;
};

vec3 transform_vector(vec4 rows[3], vec3 v) {
    return vec3(dot(rows[0].xyz, v), dot(rows[1].xyz, v), dot(rows[2].xyz, v));
}

Emitter emitter_of(uint instance_index, uint primitive) {
    Instance instance = InstanceBuffer(frame.instances).at[instance_index];
    Mesh mesh = MeshBuffer(frame.meshes).at[instance.mesh];
    uvec3 corner = Uvec3Buffer(mesh.triangles).at[primitive];
    Vec3Buffer positions = Vec3Buffer(mesh.positions);
    vec3 a = positions.at[corner.x];
    Emitter emitter;
    emitter.origin = transform_vector(instance.object_to_world, a)
        + vec3(instance.object_to_world[0].w, instance.object_to_world[1].w, instance.object_to_world[2].w);
    emitter.edge1 = transform_vector(instance.object_to_world, positions.at[corner.y] - a);
    emitter.edge2 = transform_vector(instance.object_to_world, positions.at[corner.z] - a);
    float winding = (instance.flags & INSTANCE_MIRRORED) != 0u ? -1.0 : 1.0;
    emitter.area_normal = winding * cross(emitter.edge1, emitter.edge2);
    uint material = UintBuffer(mesh.triangle_materials).at[primitive];
    emitter.double_sided = (MaterialBuffer(frame.materials).at[material].flags & MATERIAL_DOUBLE_SIDED) != 0u;
    return emitter;
}

/// Density, 1/sr, of a uniform point of the triangle, seen along the unit `direction` from `distance`; 0 where it does not shine that way.
float emitter_pdf(Emitter emitter, vec3 direction, float distance) {
    float facing = -dot(emitter.area_normal, direction);
    facing = emitter.double_sided ? abs(facing) : facing;
    return facing > 0.0 ? 2.0 * distance * distance / facing : 0.0;
}

bool sample_triangle_light(Light light, vec3 position, vec2 u, inout LightSample result) {
    Emitter emitter = emitter_of(light.instance, light.primitive);
    vec2 barycentrics = sample_triangle(u);
    vec3 to_light = emitter.origin + barycentrics.x * emitter.edge1 + barycentrics.y * emitter.edge2 - position;
    result.distance = length(to_light);
    result.direction = to_light / max(result.distance, 1e-20);
    result.pdf *= emitter_pdf(emitter, result.direction, result.distance);
    if (!(result.pdf > 0.0)) {
        return false;
    }
    result.radiance = emitted_radiance(light.instance, light.primitive, barycentrics);
    return true;
}

/// Distance along a unit direction to a sphere, or a negative number. From inside: the far side.
///
/// The nearest point's distance to the centre is taken from a vector, not from b^2 - c, which cancels far away (Haines et al., "Precision
/// Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019).
float intersect_sphere(vec3 to_centre, vec3 direction, float radius) {
    float along = dot(to_centre, direction);
    vec3 miss = to_centre - along * direction;
    float half_chord2 = radius * radius - dot(miss, miss);
    if (half_chord2 < 0.0) {
        return -1.0;
    }
    float half_chord = sqrt(half_chord2);
    bool inside = dot(to_centre, to_centre) < radius * radius;
    return inside ? along + half_chord : along - half_chord;
}

/// Density, 1/sr, of directions towards a sphere.
float sphere_pdf(vec3 to_centre, float radius) {
    float distance2 = dot(to_centre, to_centre);
    float radius2 = radius * radius;
    return distance2 <= radius2 ? UNIFORM_SPHERE_PDF : cone_pdf(one_minus_cos_from_sin2(radius2 / distance2));
}

bool sample_sphere_light(PunctualLight light, vec3 position, vec2 u, inout LightSample result) {
    vec3 to_centre = light.position - position;
    float distance2 = dot(to_centre, to_centre);
    float radius2 = light.radius * light.radius;
    if (distance2 <= radius2) {
        result.direction = sample_sphere(u);
    } else {
        vec3 local = sample_cone(u, one_minus_cos_from_sin2(radius2 / distance2));
        result.direction = to_world(basis_around(to_centre * inversesqrt(distance2)), local);
    }
    float hit = intersect_sphere(to_centre, result.direction, light.radius);
    result.distance = hit > 0.0 ? hit : dot(to_centre, result.direction);
    result.radiance = light.emission * range_window(result.distance, light.inverse_range);
    result.pdf *= sphere_pdf(to_centre, light.radius);
    return result.distance > 0.0;
}

bool sample_punctual_light(uint kind, PunctualLight light, vec3 position, inout LightSample result) {
    result.delta = true;
    if (kind == LIGHT_DIRECTIONAL) {
        result.direction = -light.direction;
        result.radiance = light.emission;
        return true;
    }
    vec3 to_light = light.position - position;
    float distance2 = dot(to_light, to_light);
    if (!(distance2 > 0.0)) {
        return false;
    }
    result.distance = sqrt(distance2);
    result.direction = to_light / result.distance;
    result.radiance = light.emission * (range_window(result.distance, light.inverse_range) / distance2);
    if (kind == LIGHT_SPOT) {
        float falloff = clamp(dot(-result.direction, light.direction) * light.cone_scale + light.cone_offset, 0.0, 1.0);
        result.radiance *= falloff * falloff;
    }
    return any(greaterThan(result.radiance, vec3(0.0)));
}

/// Texel of the environment map: radiance, density over the unit square. x wraps around, y ends at the poles.
vec4 environment_texel(ivec2 texel) {
    ivec2 size = ivec2(frame.environment_size);
    texel = ivec2((texel.x + size.x) % size.x, clamp(texel.y, 0, size.y - 1));
    return Vec4Buffer(frame.environment_texels).at[texel.y * size.x + texel.x];
}

/// Radiance from a direction, bilinear between texel centres.
vec3 environment_radiance(vec3 direction) {
    if (frame.environment_size.x == 0u) {
        return frame.environment_radiance;
    }
    vec2 at = direction_to_latlong(direction) * vec2(frame.environment_size) - 0.5;
    ivec2 texel = ivec2(floor(at));
    vec2 weight = at - vec2(texel);
    vec3 top = mix(environment_texel(texel).rgb, environment_texel(texel + ivec2(1, 0)).rgb, weight.x);
    vec3 bottom = mix(environment_texel(texel + ivec2(0, 1)).rgb, environment_texel(texel + ivec2(1, 1)).rgb, weight.x);
    return mix(top, bottom, weight.y);
}

/// Density over solid angle of one over the map's unit square, 1/sr.
float latlong_pdf(float pdf_uv, float v) {
    return pdf_uv / (2.0 * PI * PI * max(sin(PI * v), 1e-7));
}

/// Density, 1/sr, with which sample_light returns this direction to the environment.
float environment_pdf(vec3 direction) {
    if (!EFFECT_ENVIRONMENT_LIGHT || frame.environment_light == ~0u) {
        return 0.0;
    }
    float chosen = LightBuffer(frame.lights).at[frame.environment_light].probability;
    if (frame.environment_size.x == 0u) {
        return chosen * UNIFORM_SPHERE_PDF;
    }
    vec2 uv = direction_to_latlong(direction);
    ivec2 texel = min(ivec2(uv * vec2(frame.environment_size)), ivec2(frame.environment_size) - 1);
    return chosen * latlong_pdf(environment_texel(texel).w, uv.y);
}

/// u.x chooses the column and decides the bucket, u.y the row: both keep their low bits for the place within the texel.
bool sample_environment(vec2 u, inout LightSample result) {
    if (frame.environment_size.x == 0u) {
        result.direction = sample_sphere(u);
        result.radiance = frame.environment_radiance;
        result.pdf *= UNIFORM_SPHERE_PDF;
        return true;
    }
    uvec2 size = frame.environment_size;
    uint column = alias_bucket(size.x, u.x);
    uint row = alias_bucket(size.y, u.y);
    uint bucket = row * size.x + column;
    uint texel = alias_choice(AliasBuffer(frame.environment_alias).at[bucket], bucket, u.x);
    vec2 uv = (vec2(texel % size.x, texel / size.x) + u) / vec2(size);
    result.direction = latlong_to_direction(uv);
    result.radiance = environment_radiance(result.direction);
    result.pdf *= latlong_pdf(environment_texel(ivec2(texel % size.x, texel / size.x)).w, uv.y);
    return true;
}

/// The sole light, with the probability `chosen`. Returns false where it does not shine on `position`.
bool sample_sole_light(vec3 position, float chosen, out LightSample result) {
    result = LightSample(vec3(0.0, 0.0, 1.0), FAR_AWAY, vec3(0.0), chosen, true, frame.sole_light);
    if (!EFFECT_SOLE_LIGHT || frame.sole_light == ~0u) {
        return false;
    }
    PunctualLight light = PunctualLightBuffer(frame.punctual_lights).at[frame.sole_light];
    return sample_punctual_light(LightBuffer(frame.lights).at[frame.sole_light].kind, light, position, result);
}

/// Chooses a light by u.xy (bucket, threshold) and a direction to it by u.zw; `apart`: not the sole one. Returns false where it does not
/// shine on `position`.
bool sample_light(vec3 position, vec4 u, bool apart, out LightSample result) {
    float sole = EFFECT_SOLE_LIGHT ? frame.sole_probability : 0.0;
    // By the threshold's number: the bucket's keeps all its bits, for as many lights as there are.
    if (!apart && u.y < sole) {
        return sample_sole_light(position, sole, result);
    }
    result = LightSample(vec3(0.0, 0.0, 1.0), FAR_AWAY, vec3(0.0), 0.0, false, 0u);
    if (frame.light_count == 0u) {
        return false;
    }
    float others = 1.0 - sole;
    u.y = apart ? u.y : min((u.y - sole) / others, 0.99999994);
    uint bucket = alias_bucket(frame.light_count, u.x);
    result.light = alias_choice(AliasBuffer(frame.light_alias).at[bucket], bucket, u.y);
    Light light = LightBuffer(frame.lights).at[result.light];
    result.pdf = apart ? light.probability / others : light.probability;
    if (EFFECT_EMISSIVE_LIGHT && light.kind == LIGHT_TRIANGLE) {
        return sample_triangle_light(light, position, u.zw, result);
    }
    if (EFFECT_ENVIRONMENT_LIGHT && light.kind == LIGHT_ENVIRONMENT) {
        return sample_environment(u.zw, result);
    }
    PunctualLightBuffer punctual = PunctualLightBuffer(frame.punctual_lights);
    if (EFFECT_SPHERE_LIGHT && light.kind == LIGHT_SPHERE) {
        return sample_sphere_light(punctual.at[result.light], position, u.zw, result);
    }
    return EFFECT_PUNCTUAL_LIGHT && sample_punctual_light(light.kind, punctual.at[result.light], position, result);
}

/// Whether a hit triangle shines back along a ray's unit `direction`, and the density, 1/sr, with which sample_light finds that point
/// from the ray's origin, `distance` away. False for a triangle that is no light.
bool triangle_light_pdf(uint instance_index, uint primitive, vec3 direction, float distance, out float pdf) {
    pdf = 0.0;
    Instance instance = InstanceBuffer(frame.instances).at[instance_index];
    if (!EFFECT_EMISSIVE_LIGHT || instance.first_light == ~0u) {
        return false;
    }
    uint rank = UintBuffer(MeshBuffer(frame.meshes).at[instance.mesh].triangle_emitters).at[primitive];
    if (rank == ~0u) {
        return false;
    }
    float density = emitter_pdf(emitter_of(instance_index, primitive), direction, distance);
    pdf = density * LightBuffer(frame.lights).at[instance.first_light + rank].probability;
    return density > 0.0;
}

/// Nearest sphere light in (t_min, t_max) of a ray; spheres come first among the lights. They are in no acceleration structure and cast no shadow.
bool intersect_sphere_lights(Ray ray, out float t, out uint light_index) {
    t = ray.t_max;
    light_index = ~0u;
    for (uint i = 0u; EFFECT_SPHERE_LIGHT && i < frame.light_count; i++) {
        if (LightBuffer(frame.lights).at[i].kind != LIGHT_SPHERE) {
            break;
        }
        PunctualLightBuffer spheres = PunctualLightBuffer(frame.punctual_lights);
        vec3 to_centre = spheres.at[i].position - ray.origin;
        float hit = intersect_sphere(to_centre, ray.direction, spheres.at[i].radius);
        if (hit > ray.t_min && hit < t) {
            t = hit;
            light_index = i;
        }
    }
    return light_index != ~0u;
}

/// Radiance of a sphere light that a ray met at `distance`, and the density, 1/sr, with which sample_light finds that direction.
vec3 sphere_light_radiance(uint light_index, vec3 origin, float distance, out float pdf) {
    PunctualLight light = PunctualLightBuffer(frame.punctual_lights).at[light_index];
    pdf = LightBuffer(frame.lights).at[light_index].probability * sphere_pdf(light.position - origin, light.radius);
    return light.emission * range_window(distance, light.inverse_range);
}

#endif
