// A binary tree over instances, or parts of them, whose leaves are binary trees over triangles (src/accel/bvh.rs builds both), in one loop.
//
// Nodes hold their children's bounds; the nearer child is visited first, the other one goes onto a stack. A ray that enters an
// instance goes on in mesh space, with distances unchanged since its direction is not normalized again, until the stack is back at
// the height that it had there.
// Nodes and triangles are read as texels: a software driver fetches one at once, where it would load a struct word by word and thread
// by thread, which is four times as slow; hardware reads both through the same caches.
// The stack cannot overflow: each inner node on the way pushes one child at most, and the builder bounds the nodes on any way by
// BVH_TOP_DEPTH and BVH_MESH_DEPTH (src/accel/tree.rs).
#ifndef ACCEL_STRUCTURES_BVH_GLSL
#define ACCEL_STRUCTURES_BVH_GLSL

#include "accel/alpha.glsl"
#include "accel/ray.glsl"
#include "lib/intersect.glsl"
#include "shared/bindings.glsl"
#include "shared/bvh.glsl"

/// BvhNode or BvhEntry, four texels each; corners of triangles in mesh space, three texels each, metres.
layout(set = 0, binding = 3) uniform usamplerBuffer bvh_nodes;
layout(set = 0, binding = 4) uniform usamplerBuffer bvh_triangles;

layout(buffer_reference, scalar) readonly buffer BvhRootBuffer { BvhRoot root; };

/// Off where the device takes fewer texels than there are (SwiftShader: 65536); then they are read by address.
layout(constant_id = 210) const bool BVH_AS_TEXELS = true;

uvec4 fetch_node_texel(int texel) {
    if (BVH_AS_TEXELS) {
        return texelFetch(bvh_nodes, texel);
    }
    return Uvec4Buffer(BvhRootBuffer(frame.accel).root.nodes).at[texel];
}

uvec4 fetch_triangle_texel(int texel) {
    if (BVH_AS_TEXELS) {
        return texelFetch(bvh_triangles, texel);
    }
    return Uvec4Buffer(BvhRootBuffer(frame.accel).root.triangles).at[texel];
}

BvhNode fetch_node(uint index) {
    int texel = int(4 * index);
    uvec4 a = fetch_node_texel(texel);
    uvec4 b = fetch_node_texel(texel + 1);
    uvec4 c = fetch_node_texel(texel + 2);
    uvec4 d = fetch_node_texel(texel + 3);
    return BvhNode(
        uintBitsToFloat(a.xyz), a.w, uintBitsToFloat(b.xyz), b.w, uintBitsToFloat(c.xyz), c.w, uintBitsToFloat(d.xyz), d.w);
}

BvhEntry fetch_entry(uint index) {
    int texel = int(4 * index);
    uvec4 d = fetch_node_texel(texel + 3);
    return BvhEntry(
        vec4[3](
            uintBitsToFloat(fetch_node_texel(texel)),
            uintBitsToFloat(fetch_node_texel(texel + 1)),
            uintBitsToFloat(fetch_node_texel(texel + 2))),
        d.x, d.y, d.z, d.w);
}

vec3 fetch_corner(uint index) {
    return uintBitsToFloat(fetch_triangle_texel(int(index)).xyz);
}

/// Height of the stack at which an instance is left, for a ray that is in none.
const uint IN_TOP_LEVEL = 0xffffffffu;

/// The ray in the space that it goes through now.
struct LocalRay {
    vec3 origin;
    vec3 direction;
    vec3 reciprocal;
    /// In mesh space only.
    TriangleRay triangle;
};

LocalRay world_ray(Ray ray) {
    return LocalRay(ray.origin, ray.direction, finite_reciprocal(ray.direction), TriangleRay(vec3(0.0), vec3(0.0), 0u));
}

LocalRay mesh_ray(Ray ray, vec4 world_to_object[3]) {
    vec4 origin = vec4(ray.origin, 1.0);
    LocalRay local;
    local.origin = vec3(dot(world_to_object[0], origin), dot(world_to_object[1], origin), dot(world_to_object[2], origin));
    local.direction = vec3(
        dot(world_to_object[0].xyz, ray.direction), dot(world_to_object[1].xyz, ray.direction), dot(world_to_object[2].xyz, ray.direction));
    local.reciprocal = finite_reciprocal(local.direction);
    local.triangle = triangle_ray(local.origin, local.direction);
    return local;
}

bool intersect_triangle(LocalRay ray, vec3 p0, vec3 p1, vec3 p2, float t_min, float t_max, out float t, out vec2 barycentrics) {
    if (INTERSECTION == 0) {
        return intersect_watertight(ray.triangle, p0, p1, p2, t_min, t_max, t, barycentrics)
            && lies_ahead(ray.origin, ray.direction, p0, p1, p2);
    }
    return intersect_moeller_trumbore(ray.origin, ray.direction, p0, p1, p2, t_min, t_max, t, barycentrics);
}

bool accel_trace(Ray ray, bool any_hit, uint alpha_seed, out Hit hit) {
    uint stack[BVH_TOP_DEPTH + BVH_MESH_DEPTH];
    uint height = 0;
    uint base = IN_TOP_LEVEL;
    LocalRay local = world_ray(ray);
    uint instance = 0, first_triangle = 0, flags = 0;
    uint current = BvhRootBuffer(frame.accel).root.root;
    bool found = false;
    hit.t = ray.t_max;

    while (current != BVH_EMPTY) {
        if ((current & BVH_LEAF) == 0) {
            BvhNode node = fetch_node(current);
            float t0 = intersect_box(local.origin, local.reciprocal, ray.t_min, hit.t, node.min0, node.max0);
            float t1 = intersect_box(local.origin, local.reciprocal, ray.t_min, hit.t, node.min1, node.max1);
            bool ordered = t0 <= t1;
            if (max(t0, t1) < MISSED) {
                stack[height++] = ordered ? node.child1 : node.child0;
            }
            if (min(t0, t1) < MISSED) {
                current = ordered ? node.child0 : node.child1;
                continue;
            }
        } else if (base == IN_TOP_LEVEL) {
            BvhEntry entry = fetch_entry(current & ~BVH_LEAF);
            local = mesh_ray(ray, entry.world_to_object);
            instance = entry.instance;
            first_triangle = entry.first_triangle;
            flags = entry.flags;
            current = entry.root;
            base = height;
            continue;
        } else {
            uint first = current & BVH_FIRST_MASK;
            uint end = first + ((current >> BVH_COUNT_SHIFT) & 3u);
            for (uint i = first; i <= end; i++) {
                float t;
                vec2 barycentrics;
                bool hits = intersect_triangle(local, fetch_corner(3 * i), fetch_corner(3 * i + 1), fetch_corner(3 * i + 2), ray.t_min, hit.t, t, barycentrics);
                if (hits && ((flags & INSTANCE_ALPHA) == 0 || alpha_passes(instance, i - first_triangle, barycentrics, alpha_seed))) {
                    hit = Hit(t, instance, i - first_triangle, barycentrics);
                    found = true;
                }
            }
            if (found && any_hit) {
                break;
            }
        }
        if (height == base) {
            base = IN_TOP_LEVEL;
            local = world_ray(ray);
        }
        current = height == 0 ? BVH_EMPTY : stack[--height];
    }
    return found;
}

#endif
