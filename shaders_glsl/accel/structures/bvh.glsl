// A binary tree over instances, or parts of them, whose leaves are binary trees over triangles (src/accel/bvh.rs builds both), in one loop.
//
// Nodes hold their children's bounds; the nearer child is visited first, the other one goes onto a stack. Where any hit will do, it is
// the farther child: boxes around a ray's origin come nearest of all, and what lies in them is mostly the surface that the ray leaves.
// A ray that enters an instance goes on in mesh space, with distances unchanged since its direction is not normalized again, until the
// stack is back at the height that it had there.
// What outlives an iteration is kept short, and what an entry says of a hit is read when it is wanted: a software driver blends every
// variable that only some threads write, and hardware runs more threads with fewer registers.
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

/// Of a BvhEntry.
mat3x4 fetch_world_to_object(uint entry) {
    int texel = int(4 * entry);
    return mat3x4(
        uintBitsToFloat(fetch_node_texel(texel)), uintBitsToFloat(fetch_node_texel(texel + 1)), uintBitsToFloat(fetch_node_texel(texel + 2)));
}

/// `root`, `first_triangle`, `instance` and `flags` of a BvhEntry.
uvec4 fetch_entry_end(uint entry) {
    return fetch_node_texel(int(4 * entry + 3));
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

void enter_world(Ray ray, inout LocalRay local) {
    local.origin = ray.origin;
    local.direction = ray.direction;
    local.reciprocal = finite_reciprocal(ray.direction);
}

void enter_mesh(Ray ray, mat3x4 world_to_object, inout LocalRay local) {
    local.origin = vec4(ray.origin, 1.0) * world_to_object;
    local.direction = vec4(ray.direction, 0.0) * world_to_object;
    local.reciprocal = finite_reciprocal(local.direction);
    local.triangle = triangle_ray(local.direction);
}

bool intersect_triangle(LocalRay ray, vec3 p0, vec3 p1, vec3 p2, float t_min, float t_max, out float t, out vec2 barycentrics) {
    if (INTERSECTION == 0) {
        return intersect_watertight(ray.origin, ray.triangle, p0, p1, p2, t_min, t_max, t, barycentrics)
            && lies_ahead(ray.origin, ray.direction, p0, p1, p2);
    }
    return intersect_moeller_trumbore(ray.origin, ray.direction, p0, p1, p2, t_min, t_max, t, barycentrics);
}

/// A hit as the tree names it.
struct BvhHit {
    float t;
    vec2 barycentrics;
    /// In the arrays of nodes and of triangles; `entry` is NO_ENTRY for none.
    uint entry;
    uint triangle;
};

const uint NO_ENTRY = 0xffffffffu;

Hit resolve(BvhHit hit) {
    uvec4 entry = fetch_entry_end(hit.entry);
    return Hit(hit.t, entry.z, hit.triangle - entry.y, hit.barycentrics);
}

bool passes(uint entry, uint triangle, vec2 barycentrics, uint alpha_seed) {
    if (!EFFECT_ALPHA_MASK && !EFFECT_ALPHA_BLEND) {
        return true;
    }
    uvec4 end = fetch_entry_end(entry);
    return (end.w & INSTANCE_ALPHA) == 0 || alpha_passes(end.z, triangle - end.y, barycentrics, alpha_seed);
}

/// Shortens `hit` to the nearest triangle of a mesh's leaf.
void intersect_leaf(uint leaf, LocalRay ray, float t_min, uint entry, uint alpha_seed, inout BvhHit hit) {
    uint first = leaf & BVH_FIRST_MASK;
    uint last = first + ((leaf >> BVH_COUNT_SHIFT) & 3u);
    for (uint i = first; i <= last; i++) {
        float t;
        vec2 barycentrics;
        bool hits = intersect_triangle(ray, fetch_corner(3 * i), fetch_corner(3 * i + 1), fetch_corner(3 * i + 2), t_min, hit.t, t, barycentrics);
        if (hits && passes(entry, i, barycentrics, alpha_seed)) {
            hit = BvhHit(t, barycentrics, entry, i);
        }
    }
}

bool accel_trace(Ray ray, bool any_hit, uint alpha_seed, out Hit hit) {
    uint stack[BVH_TOP_DEPTH + BVH_MESH_DEPTH];
    uint height = 0;
    uint base = IN_TOP_LEVEL;
    LocalRay local;
    enter_world(ray, local);
    uint entry = NO_ENTRY;
    BvhHit nearest = BvhHit(ray.t_max, vec2(0.0), NO_ENTRY, 0);
    uint current = BvhRootBuffer(frame.accel).root.root;

    while (current != BVH_EMPTY) {
        bool done = false;
        if ((current & BVH_LEAF) == 0) {
            BvhNode node = fetch_node(current);
            float t0 = intersect_box(local.origin, local.reciprocal, ray.t_min, nearest.t, node.min0, node.max0);
            float t1 = intersect_box(local.origin, local.reciprocal, ray.t_min, nearest.t, node.min1, node.max1);
            bool both = max(t0, t1) < MISSED;
            bool ordered = both && any_hit ? t0 > t1 : t0 <= t1;
            if (both) {
                stack[height++] = ordered ? node.child1 : node.child0;
            }
            current = ordered ? node.child0 : node.child1;
            done = min(t0, t1) >= MISSED;
        } else if (base == IN_TOP_LEVEL) {
            entry = current & ~BVH_LEAF;
            enter_mesh(ray, fetch_world_to_object(entry), local);
            current = fetch_entry_end(entry).x;
            base = height;
        } else {
            intersect_leaf(current, local, ray.t_min, entry, alpha_seed, nearest);
            if (any_hit && nearest.entry != NO_ENTRY) {
                break;
            }
            done = true;
        }
        if (done) {
            if (height == base) {
                base = IN_TOP_LEVEL;
                enter_world(ray, local);
            }
            current = height == 0 ? BVH_EMPTY : stack[--height];
        }
    }
    if (nearest.entry == NO_ENTRY) {
        return false;
    }
    hit = resolve(nearest);
    return true;
}

#endif
