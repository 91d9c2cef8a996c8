// Whether a hit counts: glTF's alpha modes, from base colour alpha (factor x texture x vertex colour; glTF 2.0, section 3.9.4).
//
// The texture's finest level is read: rays of every footprint must see the same surface (shadow rays have none), and averages drift
// across the cutoff, so that foliage would thin out with distance.
// Blend is stochastic: a hash of seed, instance and primitive decides. A ray meets a triangle at most once, so nothing finer is
// needed, and neither the order in which a structure finds candidates nor its rounding changes the picture.
#ifndef ACCEL_ALPHA_GLSL
#define ACCEL_ALPHA_GLSL

#include "lib/rng.glsl"
#include "shared/bindings.glsl"

/// Alpha of the base colour texture at a hit; 1 where there is none.
float texture_alpha(Mesh mesh, TextureSlot slot, uvec3 triangle, vec3 weights) {
    if (!EFFECT_TEXTURES || slot.texture == ~0u) {
        return 1.0;
    }
    vec2 uv;
    if ((slot.texture & 0x80000000u) != 0) {
        Vec2Buffer uv1 = Vec2Buffer(mesh.uv1);
        uv = uv1.at[triangle.x] * weights.x + uv1.at[triangle.y] * weights.y + uv1.at[triangle.z] * weights.z;
    } else {
        VertexAttributesBuffer vertices = VertexAttributesBuffer(mesh.attributes);
        uv = vertices.at[triangle.x].uv0 * weights.x + vertices.at[triangle.y].uv0 * weights.y + vertices.at[triangle.z].uv0 * weights.z;
    }
    vec3 u_row = vec3(slot.transform[0], slot.transform[1], slot.transform[2]);
    vec3 v_row = vec3(slot.transform[3], slot.transform[4], slot.transform[5]);
    uv = vec2(dot(u_row, vec3(uv, 1.0)), dot(v_row, vec3(uv, 1.0)));
    return textureLod(textures[nonuniformEXT(slot.texture & 0x7fffffffu)], uv, 0.0).a;
}

/// Alpha of the vertex colours at a hit; 1 where there are none.
float vertex_alpha(Mesh mesh, uvec3 triangle, vec3 weights) {
    if (!EFFECT_VERTEX_COLORS || !HAS(mesh.colors)) {
        return 1.0;
    }
    Uvec2Buffer colors = Uvec2Buffer(mesh.colors);
    vec3 alpha = vec3(colors.at[triangle.x].y >> 16, colors.at[triangle.y].y >> 16, colors.at[triangle.z].y >> 16);
    return dot(alpha, weights) * (1.0 / 65535.0);
}

/// Whether the surface is there at this hit.
bool alpha_passes(uint instance, uint primitive, vec2 barycentrics, uint alpha_seed) {
    if (!EFFECT_ALPHA_MASK && !EFFECT_ALPHA_BLEND) {
        return true;
    }
    Mesh mesh = MeshBuffer(frame.meshes).at[InstanceBuffer(frame.instances).at[instance].mesh];
    uint material = UintBuffer(mesh.triangle_materials).at[primitive];
    MaterialBuffer materials = MaterialBuffer(frame.materials);
    uint flags = materials.at[material].flags;
    if ((flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND)) == 0) {
        return true;
    }
    uvec3 triangle = Uvec3Buffer(mesh.triangles).at[primitive];
    vec3 weights = vec3(1.0 - barycentrics.x - barycentrics.y, barycentrics);
    float alpha = materials.at[material].base_color.a * vertex_alpha(mesh, triangle, weights)
        * texture_alpha(mesh, materials.at[material].base_color_texture, triangle, weights);
    if ((flags & MATERIAL_ALPHA_MASK) != 0) {
        return alpha >= materials.at[material].alpha_cutoff;
    }
    return unit_float(pcg3d(uvec3(alpha_seed, instance, primitive)).x) < alpha;
}

#endif
