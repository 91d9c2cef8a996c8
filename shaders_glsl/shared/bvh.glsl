// The binary bounding volume hierarchy of accel/structures/bvh.glsl, two levels in one array of nodes: the top level over instances,
// or parts of them, then each mesh's own. The host's structs are generated from this file when built.
#ifndef SHARED_BVH_GLSL
#define SHARED_BVH_GLSL

#include "shared/scene.glsl"

/// An inner node, with the bounds of both its children: four texels.
struct BvhNode {
    vec3 min0;
    /// A child: the index of its node, or BVH_LEAF and what the leaf holds. In the top level the index of a BvhEntry; in a mesh's, the
    /// number of triangles less one in bits 29 and 30 and the first one's index in the array of triangles below.
    uint child0;
    vec3 max0;
    uint child1;
    vec3 min1;
    uint padding0;
    vec3 max1;
    uint padding1;
};

const uint BVH_LEAF = 0x80000000u;
const uint BVH_COUNT_SHIFT = 29u;
const uint BVH_FIRST_MASK = 0x1fffffffu;
/// A tree without anything in it.
const uint BVH_EMPTY = 0xffffffffu;

/// Inner nodes on the longest way through the top level, and through a mesh: the builder keeps to both.
const uint BVH_TOP_DEPTH = 24u;
const uint BVH_MESH_DEPTH = 40u;

/// Part of an instance, and what a ray needs to go on inside it: four texels, in the same array as the nodes.
struct BvhEntry {
    vec4 world_to_object[3];
    /// The part's root, as a child.
    uint root;
    /// Of the mesh, in the array of triangles.
    uint first_triangle;
    uint instance;
    /// INSTANCE_* bits.
    uint flags;
};

/// What FrameData.accel points at.
struct BvhRoot {
    /// Nodes and triangles once more, for devices that take fewer texels.
    Address nodes;
    Address triangles;
    /// The top level's root, as a child.
    uint root;
    uint padding;
};

#endif
