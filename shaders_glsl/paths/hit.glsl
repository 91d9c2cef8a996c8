// From a hit to everything that shading needs: place, normals, material.
#ifndef PATHS_HIT_GLSL
#define PATHS_HIT_GLSL

#include "shared/bindings.glsl"
#include "accel/ray.glsl"
#include "lib/frame.glsl"
#include "lib/lights.glsl"
#include "lib/packing.glsl"
#include "lib/ray_cone.glsl"
#include "lib/ray_offset.glsl"
#include "lib/surface.glsl"

/// Where textures are looked up.
struct TexturePoint {
    vec2 uv[2];
    /// Level of detail of a texture of edge 1.
    float level;
};

struct HitPoint {
    RayOrigin origin;
    /// Unit, towards the triangle's front.
    vec3 front_ws;
    bool on_front;
    uint material;
    vec3 emission;
    Surface surface;
};

struct Triangle {
    uvec3 corners;
    vec3 weights;
    vec3 edge1_ws;
    vec3 edge2_ws;
};

vec4 sample_texture(TextureSlot slot, TexturePoint at, vec4 otherwise) {
    if (!EFFECT_TEXTURES || slot.texture == ~0u) {
        return otherwise;
    }
    vec3 uv = vec3(at.uv[slot.texture >> 31], 1.0);
    vec2 transformed = vec2(
        dot(vec3(slot.transform[0], slot.transform[1], slot.transform[2]), uv),
        dot(vec3(slot.transform[3], slot.transform[4], slot.transform[5]), uv));
    float level = TEXTURE_LEVEL == 0u ? at.level + slot.log2_size + parameters.lod_bias : 0.0;
    return textureLod(textures[nonuniformEXT(slot.texture & 0x7fffffffu)], transformed, level);
}

vec2 interpolate_uv0(Mesh mesh, Triangle triangle) {
    VertexAttributesBuffer attributes = VertexAttributesBuffer(mesh.attributes);
    return triangle.weights.x * attributes.at[triangle.corners.x].uv0 + triangle.weights.y * attributes.at[triangle.corners.y].uv0
        + triangle.weights.z * attributes.at[triangle.corners.z].uv0;
}

vec2 interpolate_uv1(Mesh mesh, Triangle triangle) {
    if (!HAS(mesh.uv1)) {
        return vec2(0.0);
    }
    Vec2Buffer uv1 = Vec2Buffer(mesh.uv1);
    return triangle.weights.x * uv1.at[triangle.corners.x] + triangle.weights.y * uv1.at[triangle.corners.y]
        + triangle.weights.z * uv1.at[triangle.corners.z];
}

vec4 vertex_color(Mesh mesh, uint vertex) {
    uvec2 bits = Uvec2Buffer(mesh.colors).at[vertex];
    return vec4(unpackUnorm2x16(bits.x), unpackUnorm2x16(bits.y));
}

vec4 interpolate_color(Mesh mesh, Triangle triangle) {
    if (!EFFECT_VERTEX_COLORS || !HAS(mesh.colors)) {
        return vec4(1.0);
    }
    return triangle.weights.x * vertex_color(mesh, triangle.corners.x) + triangle.weights.y * vertex_color(mesh, triangle.corners.y)
        + triangle.weights.z * vertex_color(mesh, triangle.corners.z);
}

/// Where the textures of a hit are looked up; level of detail from the ray's cone and the triangle's texel density.
TexturePoint texture_point(Mesh mesh, Triangle triangle, RayCone cone, float cosine) {
    TexturePoint at = TexturePoint(vec2[2](vec2(0.0), vec2(0.0)), 0.0);
    if (!EFFECT_TEXTURES) {
        return at;
    }
    at.uv[0] = interpolate_uv0(mesh, triangle);
    at.uv[1] = interpolate_uv1(mesh, triangle);
    if (TEXTURE_LEVEL == 0u) {
        VertexAttributesBuffer attributes = VertexAttributesBuffer(mesh.attributes);
        vec2 a = attributes.at[triangle.corners.x].uv0;
        vec2 e1 = attributes.at[triangle.corners.y].uv0 - a;
        vec2 e2 = attributes.at[triangle.corners.z].uv0 - a;
        float area = length(cross(triangle.edge1_ws, triangle.edge2_ws));
        at.level = cone_level(cone, abs(e1.x * e2.y - e1.y * e2.x) / max(area, 1e-30), cosine);
    }
    return at;
}

Triangle fetch_triangle(Instance instance, Mesh mesh, Hit hit) {
    Triangle triangle;
    triangle.corners = Uvec3Buffer(mesh.triangles).at[hit.primitive];
    triangle.weights = vec3(1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics);
    Vec3Buffer positions = Vec3Buffer(mesh.positions);
    vec3 a = positions.at[triangle.corners.x];
    triangle.edge1_ws = transform_vector(instance.object_to_world, positions.at[triangle.corners.y] - a);
    triangle.edge2_ws = transform_vector(instance.object_to_world, positions.at[triangle.corners.z] - a);
    return triangle;
}

/// Normals transform by the inverse transpose.
vec3 transform_normal(vec4 world_to_object[3], vec3 n) {
    return normalize(n.x * world_to_object[0].xyz + n.y * world_to_object[1].xyz + n.z * world_to_object[2].xyz);
}

/// Interpolated, on the triangle's front side, not yet bent by a normal map.
vec3 vertex_normal_ws(Instance instance, Mesh mesh, Triangle triangle) {
    VertexAttributesBuffer attributes = VertexAttributesBuffer(mesh.attributes);
    vec3 n = triangle.weights.x * unpack_normal(attributes.at[triangle.corners.x].normal)
        + triangle.weights.y * unpack_normal(attributes.at[triangle.corners.y].normal)
        + triangle.weights.z * unpack_normal(attributes.at[triangle.corners.z].normal);
    return transform_normal(instance.world_to_object, n);
}

/// Unit tangent in the world and the handedness of the bitangent; zero where the mesh has none.
vec4 vertex_tangent_ws(Instance instance, Mesh mesh, Triangle triangle) {
    VertexAttributesBuffer attributes = VertexAttributesBuffer(mesh.attributes);
    uvec3 bits = uvec3(
        attributes.at[triangle.corners.x].tangent, attributes.at[triangle.corners.y].tangent, attributes.at[triangle.corners.z].tangent);
    if (any(equal(bits, uvec3(0u)))) {
        return vec4(0.0);
    }
    vec4 first = unpack_tangent(bits.x);
    vec3 t = triangle.weights.x * first.xyz + triangle.weights.y * unpack_tangent(bits.y).xyz
        + triangle.weights.z * unpack_tangent(bits.z).xyz;
    // A mirroring transform turns the bitangent's cross product around.
    float handedness = (instance.flags & INSTANCE_MIRRORED) != 0u ? -first.w : first.w;
    return vec4(transform_vector(instance.object_to_world, t), handedness);
}

/// A normal map's direction, `scale` applied to its slopes (glTF 2.0, 3.9.3).
vec3 mapped_normal(TextureSlot slot, float scale, TexturePoint at, vec3 normal, vec4 tangent) {
    if (!EFFECT_NORMAL_MAPS || slot.texture == ~0u) {
        return normal;
    }
    vec3 t = tangent.xyz - dot(tangent.xyz, normal) * normal;
    if (!(dot(t, t) > 1e-20)) {
        return normal;
    }
    t = normalize(t);
    vec3 bitangent = tangent.w * cross(normal, t);
    vec3 local = sample_texture(slot, at, vec4(0.5, 0.5, 1.0, 1.0)).xyz * 2.0 - 1.0;
    local.xy *= scale;
    vec3 bent = local.x * t + local.y * bitangent + local.z * normal;
    return dot(bent, bent) > 1e-12 ? normalize(bent) : normal;
}

vec4 base_color_at(uint material, TexturePoint at, vec4 color) {
    MaterialBuffer materials = MaterialBuffer(frame.materials);
    return color * materials.at[material].base_color * sample_texture(materials.at[material].base_color_texture, at, vec4(1.0));
}

vec3 emission_at(uint material, TexturePoint at) {
    MaterialBuffer materials = MaterialBuffer(frame.materials);
    if ((materials.at[material].flags & MATERIAL_EMISSIVE) == 0u) {
        return vec3(0.0);
    }
    return materials.at[material].emission * sample_texture(materials.at[material].emission_texture, at, vec4(1.0)).rgb;
}

/// What lib/lights.glsl asks for: emission at a point of a triangle, at the finest level.
vec3 emitted_radiance(uint instance_index, uint primitive, vec2 barycentrics) {
    Instance instance = InstanceBuffer(frame.instances).at[instance_index];
    Mesh mesh = MeshBuffer(frame.meshes).at[instance.mesh];
    uint material = UintBuffer(mesh.triangle_materials).at[primitive];
    TexturePoint at = TexturePoint(vec2[2](vec2(0.0), vec2(0.0)), -100.0);
    if (EFFECT_TEXTURES && MaterialBuffer(frame.materials).at[material].emission_texture.texture != ~0u) {
        Triangle triangle;
        triangle.corners = Uvec3Buffer(mesh.triangles).at[primitive];
        triangle.weights = vec3(1.0 - barycentrics.x - barycentrics.y, barycentrics);
        at.uv[0] = interpolate_uv0(mesh, triangle);
        at.uv[1] = interpolate_uv1(mesh, triangle);
    }
    return emission_at(material, at);
}

void add_reflection(uint material, TexturePoint at, inout Surface surface) {
    MaterialBuffer materials = MaterialBuffer(frame.materials);
    vec4 metallic_roughness = sample_texture(materials.at[material].metallic_roughness_texture, at, vec4(1.0));
    surface.metallic = materials.at[material].metallic * metallic_roughness.b;
    float roughness = clamp(materials.at[material].roughness * metallic_roughness.g, 0.0, 1.0);
    surface.alpha = roughness * roughness;
    float specular = materials.at[material].specular * sample_texture(materials.at[material].specular_texture, at, vec4(1.0)).a;
    vec3 specular_color =
        materials.at[material].specular_color * sample_texture(materials.at[material].specular_color_texture, at, vec4(1.0)).rgb;
    surface.dielectric_f0 = min(f0_from_ior(materials.at[material].ior) * specular_color, 1.0) * specular;
    surface.dielectric_f90 = specular;
}

void add_transmission(uint material, TexturePoint at, bool entering, inout Surface surface) {
    MaterialBuffer materials = MaterialBuffer(frame.materials);
    surface.transmission =
        materials.at[material].transmission * sample_texture(materials.at[material].transmission_texture, at, vec4(1.0)).r;
    surface.thin = materials.at[material].thickness == 0.0;
    surface.eta = relative_ior(materials.at[material].ior, entering);
}

void add_clearcoat(uint material, TexturePoint at, vec3 normal, vec4 tangent, bool outside, inout Surface surface) {
    MaterialBuffer materials = MaterialBuffer(frame.materials);
    surface.clearcoat =
        outside ? materials.at[material].clearcoat * sample_texture(materials.at[material].clearcoat_texture, at, vec4(1.0)).r : 0.0;
    float roughness = clamp(
        materials.at[material].clearcoat_roughness * sample_texture(materials.at[material].clearcoat_roughness_texture, at, vec4(1.0)).g,
        0.0,
        1.0);
    surface.clearcoat_alpha = roughness * roughness;
    surface.clearcoat_normal_ws = mapped_normal(materials.at[material].clearcoat_normal_texture, 1.0, at, normal, tangent);
}

/// Everything about a hit, for a path that arrives along `direction` with a footprint of `cone` there.
HitPoint hit_point(Hit hit, vec3 direction, RayCone cone) {
    Instance instance = InstanceBuffer(frame.instances).at[hit.instance];
    Mesh mesh = MeshBuffer(frame.meshes).at[instance.mesh];
    Triangle triangle = fetch_triangle(instance, mesh, hit);
    float winding = (instance.flags & INSTANCE_MIRRORED) != 0u ? -1.0 : 1.0;

    HitPoint point;
    point.front_ws = winding * normalize(cross(triangle.edge1_ws, triangle.edge2_ws));
    float facing = dot(point.front_ws, direction);
    point.on_front = facing < 0.0;
    point.material = UintBuffer(mesh.triangle_materials).at[hit.primitive];
    point.origin = ray_origin_of_hit(instance, mesh, triangle.corners, hit.barycentrics, point.front_ws);

    MaterialBuffer materials = MaterialBuffer(frame.materials);
    TexturePoint at = texture_point(mesh, triangle, cone, facing);
    bool shines = point.on_front || (materials.at[point.material].flags & MATERIAL_DOUBLE_SIDED) != 0u;
    point.emission = shines ? emission_at(point.material, at) : vec3(0.0);

    // Seen from behind, the whole tangent frame turns around (glTF 2.0, 3.9.7).
    float side = point.on_front ? 1.0 : -1.0;
    vec3 normal = vertex_normal_ws(instance, mesh, triangle);
    vec4 tangent = EFFECT_NORMAL_MAPS ? vertex_tangent_ws(instance, mesh, triangle) : vec4(0.0);
    vec3 mapped = mapped_normal(materials.at[point.material].normal_texture, materials.at[point.material].normal_scale, at, normal, tangent);

    Surface surface = surface_default(side * normal);
    surface.base_color = base_color_at(point.material, at, interpolate_color(mesh, triangle)).rgb;
    surface.geometric_normal_ws = side * point.front_ws;
    surface.normal_ws = visible_normal(side * mapped, -direction);
    if (EFFECT_REFLECTION || EFFECT_CLEARCOAT) {
        add_reflection(point.material, at, surface);
    }
    if (EFFECT_TRANSMISSION) {
        add_transmission(point.material, at, point.on_front, surface);
    }
    if (EFFECT_CLEARCOAT) {
        bool outside = point.on_front || surface.thin;
        add_clearcoat(point.material, at, normal, tangent, outside, surface);
        surface.clearcoat_normal_ws = visible_normal(side * surface.clearcoat_normal_ws, -direction);
    }
    point.surface = surface;
    return point;
}

/// The colour of the lobes other than the diffuse one changes over the surface.
bool is_painted(HitPoint point) {
    MaterialBuffer materials = MaterialBuffer(frame.materials);
    uint textures = materials.at[point.material].specular_texture.texture & materials.at[point.material].specular_color_texture.texture
        & materials.at[point.material].transmission_texture.texture & materials.at[point.material].clearcoat_texture.texture;
    bool colours = point.surface.metallic > 0.0 || point.surface.transmission > 0.0;
    bool coloured = EFFECT_VERTEX_COLORS || materials.at[point.material].base_color_texture.texture != ~0u;
    return EFFECT_TEXTURES && textures != ~0u || colours && coloured;
}

#endif
