// From a filter vertex to the key of its cell: Meijer, algorithm 3; Binder, algorithm 1.
//
// The cell is as wide as hpsf.width pixels appear at the vertex, rounded down to a power of two. The position is jittered in the tangent
// plane by up to hpsf.jitter cells either way, and the level is found again where it has got to, so that all jittered
// positions at one place agree on their cell. That replaces the cells' visible borders by noise (Binder, section 3.1.4).
//
// Deviations and why: two numbers in a basis of the tangent plane, where the thesis jitters in three and takes the normal's part out by
// |n| * delta, which is no projection. The distance is measured along the view, which mirrors turn along with it; the thesis takes
// the largest component along the world's axes, which makes levels change when the scene turns.
#ifndef FILTER_HPSF_CELL_GLSL
#define FILTER_HPSF_CELL_GLSL

#include "filter/footprint.glsl"
#include "filter/hpsf/iteration.glsl"
#include "lib/frame.glsl"
#include "lib/hash_key.glsl"
#include "lib/layer.glsl"
#include "lib/sampler.glsl"
#include "paths/primary.glsl"

/// Behind all dimensions that a path of 66 vertices takes (paths/path.glsl).
const uint JITTER_DIMENSION = 2048u;
/// Of a pixel in one filtering: of its sample, and of up to 8 lookups.
const uint MOST_JITTERS = 9u;

struct FilterPoint {
    vec3 position;
    vec3 normal;
    /// The way the path arrives.
    vec3 incident;
    /// Along the view, metres.
    float distance;
    /// Where it grows: its gradient over the position.
    vec3 away;
    /// Of the lobes that the radiance is of (lib/layer.glsl); 0: the diffuse one.
    uint layer;
};

/// A point with what its keys depend on.
struct CellPoint {
    FilterPoint point;
    /// Of the jitter.
    vec4 numbers;
    /// Levels above the one of the point's distance.
    int coarser;
};

/// Of one pixel, where its vertex is written.
FilterPoint filter_point(uvec2 pixel, vec4 position, uint normal, uint incident) {
    float view_cosine = dot(primary_ray(pixel, frame.jitter).direction, frame.camera.forward);
    vec3 arrives = unpack_normal(incident);
    return FilterPoint(position.xyz, unpack_normal(normal), arrives, position.w, arrives * view_cosine, 0u);
}

/// Numbers in [0, 1)^4 of a pixel's jitter `index` in this frame and filtering: for the position, and for the normal.
vec4 jitter_numbers(uvec2 pixel, uint index) {
    if (HPSF_JITTER_BY == 0u) {
        uvec4 bits = pcg4d(uvec4(pixel, frame.seed + ITERATION * 0x9e3779b9u, frame.first_sample * 16u + index));
        return vec4(unit_float(bits.xy), unit_float(bits.zw));
    }
    Sampler numbers = sampler_begin(pixel, frame.first_sample, frame.seed);
    numbers.dimension = JITTER_DIMENSION + 2u * (MOST_JITTERS * ITERATION + index);
    vec2 first = sample_2d(numbers);
    return vec4(first, sample_2d(numbers));
}

/// `number`, in [0, 1): with hpsf.blend, a place between two levels is of either, the nearer the likelier. The mean over numbers is
/// log2(width) - 1/2, as that of rounding down is over widths. It takes the line away at which levels change; FLIP of stills hardly feels it
/// (16 frames, 96x54: cornell 0.1245 to 0.1250, material 0.185 to 0.187), as cells of two levels share the samples there.
///
/// With hpsf.shrink, cells are the smaller the more frames there have been, and have the more samples all the same: where cells integrate,
/// their mean goes to the radiance of a point.
int level_at(float distance, float number) {
    float width = parameters.hpsf_width * pixel_footprint(max(distance, 0.0));
    if (parameters.hpsf_shrink > 0.0) {
        width *= pow(float(frame.frame) + 1.0, -parameters.hpsf_shrink);
    }
    return level_of_width(HPSF_BLEND == 1u ? width * exp2(number - 0.5) : width);
}

/// A number in [0, 1) of a jitter's: what is below 2^-12 of the first one, on which positions hardly depend.
float level_number(vec4 numbers) {
    return fract(numbers.x * 4096.0);
}

/// Levels that a glossy layer's cells are finer.
int finer_levels(uint layer) {
    return layer == 0u ? 0 : int(0.5 - parameters.hpsf_glossy_finer * log2(roughness_of(layer)));
}

/// The key of a vertex, jittered by numbers in [0, 1)^4, `coarser` levels above the one of its distance.
CellKey key_of(FilterPoint point, vec4 numbers, int coarser) {
    coarser -= finer_levels(point.layer);
    Basis basis = basis_around(point.normal);
    float number = level_number(numbers);
    int level = level_at(point.distance, number) + coarser;
    vec2 shift = (2.0 * numbers.xy - 1.0) * (parameters.hpsf_jitter * power_of_two(level));
    vec3 offset = shift.x * basis.tangent + shift.y * basis.bitangent;
    int level_there = level_at(point.distance + dot(offset, point.away), number) + coarser;
    vec2 tilt = (2.0 * numbers.zw - 1.0) * (parameters.hpsf_normal_jitter * exp2(-0.5 * float(parameters.hpsf_normal_bits)));
    vec3 normal = normalize(point.normal + tilt.x * basis.tangent + tilt.y * basis.bitangent);
    ivec3 cell = cell_of(point.position + offset, frame.origin_steps, frame.log2_origin_step, level_there);
    uint incident = point.layer == 0u ? 0u : quantise_normal(point.incident, parameters.hpsf_incident_bits);
    return CellKey(cell, level_there, quantise_normal(normal, parameters.hpsf_normal_bits), point.layer | incident);
}

#endif
