// A path between two kernels of the wavefront path tracer, 100 bytes: parts that are read together lie together, and the extend kernel
// reads 32 and writes 20 of them. The sample sequence is not kept: it follows from the pixel.
#ifndef PATHS_WAVEFRONT_STATE_GLSL
#define PATHS_WAVEFRONT_STATE_GLSL

#include "paths/path.glsl"
#include "paths/wavefront/records.glsl"

const uint VERTEX_BITS = 8u;
const uint VERTEX_MASK = 0xffu;

StoredRay stored_ray(Path path) {
    uint marks = path.vertex | (path.filter_vertex & VERTEX_MASK) << VERTEX_BITS | (path.delta ? 1u : 0u) << (2u * VERTEX_BITS);
    return StoredRay(path.ray.origin, alpha_seed(path), path.ray.direction, marks);
}

StoredWeights stored_weights(Path path) {
    return StoredWeights(path.throughput, path.diffuse_weight, path.specular_weight, path.eta_scale);
}

StoredFootprint stored_footprint(Path path) {
    return StoredFootprint(path.cone, path.travelled, path.pdf);
}

Path restored_path(StoredRay ray, StoredWeights weights, StoredFootprint footprint, Sampler numbers) {
    Path path;
    path.ray = Ray(ray.origin, 0.0, ray.direction, FAR_AWAY);
    path.cone = footprint.cone;
    path.throughput = weights.throughput;
    path.diffuse_weight = weights.diffuse_weight;
    path.specular_weight = weights.specular_weight;
    path.pdf = footprint.pdf;
    path.delta = (ray.marks >> (2u * VERTEX_BITS)) != 0u;
    path.eta_scale = weights.eta_scale;
    path.vertex = ray.marks & VERTEX_MASK;
    uint filter_vertex = (ray.marks >> VERTEX_BITS) & VERTEX_MASK;
    path.filter_vertex = filter_vertex >= VERTEX_MASK - HPSF_VERTEX ? filter_vertex | ~VERTEX_MASK : filter_vertex;
    path.travelled = footprint.travelled;
    path.numbers = numbers;
    return path;
}

#endif
