// Two-level binary tree in buffers (src/accel/bvh.rs builds it).
#ifndef ACCEL_STRUCTURES_BVH_GLSL
#define ACCEL_STRUCTURES_BVH_GLSL

#include "accel/alpha.glsl"
#include "accel/ray.glsl"
#include "lib/intersect.glsl"
#include "shared/bindings.glsl"
#include "shared/bvh.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer BvhNodeBuffer { BvhNode at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer BvhInstanceBuffer { BvhInstance at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer BvhRootBuffer { BvhRoot root; };

bool accel_trace(Ray ray, bool any_hit, uint alpha_seed, out Hit hit) {
    BvhRoot root = BvhRootBuffer(frame.accel).root;
    BvhNodeBuffer nodes = BvhNodeBuffer(root.nodes);
    BvhInstanceBuffer instances = BvhInstanceBuffer(root.instances);
    Vec3Buffer triangles = Vec3Buffer(root.triangles);

    uint stack[BVH_TOP_DEPTH + BVH_MESH_DEPTH];
    uint top = 0;
    // Height of the stack at which the instance is left; 0xffffffff in the top level.
    uint base = 0xffffffffu;
    uint instance = 0, first_triangle = 0;
    vec3 origin = ray.origin;
    vec3 reciprocal = finite_reciprocal(ray.direction);
    TriangleRay triangle_space = TriangleRay(vec3(0), vec3(0), 0);
    float t_max = ray.t_max;
    bool found = false;
    uint current = root.root;
    while (true) {
        if ((current & BVH_LEAF) == 0) {
            BvhNode node = nodes.at[current];
            float t0 = intersect_box(origin, reciprocal, ray.t_min, t_max, node.min0, node.max0);
            float t1 = intersect_box(origin, reciprocal, ray.t_min, t_max, node.min1, node.max1);
            bool first_is_near = t0 <= t1;
            uint near = first_is_near ? node.child0 : node.child1;
            uint far = first_is_near ? node.child1 : node.child0;
            if (!isinf(max(t0, t1))) {
                stack[top++] = far;
            }
            if (!isinf(min(t0, t1))) {
                current = near;
                continue;
            }
        } else if (base == 0xffffffffu) {
            if (current != BVH_EMPTY) {
                instance = current & ~BVH_LEAF;
                BvhInstance placed = instances.at[instance];
                mat4x3 m = transpose(mat3x4(placed.world_to_object[0], placed.world_to_object[1], placed.world_to_object[2]));
                origin = m * vec4(ray.origin, 1.0);
                vec3 direction = m * vec4(ray.direction, 0.0);
                reciprocal = finite_reciprocal(direction);
                triangle_space = triangle_ray(origin, direction);
                first_triangle = placed.first_triangle;
                base = top;
                current = placed.root;
                continue;
            }
        } else {
            uint first = current & BVH_FIRST_MASK;
            uint count = ((current >> BVH_COUNT_SHIFT) & 3) + 1;
            for (uint i = first; i < first + count; i++) {
                float t; vec2 uv;
                if (intersect_watertight(triangle_space, triangles.at[3*i], triangles.at[3*i+1], triangles.at[3*i+2], ray.t_min, t_max, t, uv)) {
                    t_max = t;
                    hit = Hit(t, instance, i - first_triangle, uv);
                    found = true;
                }
            }
            if (found && any_hit) break;
        }
        if (top == base) {
            base = 0xffffffffu;
            origin = ray.origin;
            reciprocal = finite_reciprocal(ray.direction);
        }
        if (top == 0) break;
        current = stack[--top];
    }
    return found;
}
#endif
