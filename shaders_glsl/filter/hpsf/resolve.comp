// Looks up each pixel's filtered radiance (filter/hpsf/look_up.glsl). Where the sample's insertion failed, the pixel shows its own radiance
// unfiltered, and `samples` is 0.
#include "lib/colour.glsl"
#include "lib/storage.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(set = 1, binding = 0, COLOR_FORMAT) readonly uniform image2D direct;
layout(set = 1, binding = 1, COLOR_FORMAT) readonly uniform image2D indirect;
layout(set = 1, binding = 2, rgba32f) readonly uniform image2D filter_position;
layout(set = 1, binding = 3, r32ui) readonly uniform uimage2D filter_normal;
layout(set = 1, binding = 4, r32ui) readonly uniform uimage2D filter_incident;
layout(set = 1, binding = 9, r32ui) readonly uniform uimage2D filter_layer;
layout(set = 1, binding = 5, scalar) readonly buffer Keys { uint at[]; } keys;
layout(set = 1, binding = 6, scalar) readonly buffer Cells { CELL_WORDS at[]; } cells;
/// w: variance, the mean of the channels'; below 0 where nothing is known, not even by a sample of the pixel's own.
layout(set = 1, binding = 7, COLOR_FORMAT) writeonly uniform image2D mean;
/// Samples that the pixel's radiance is the mean of; 0 where it is its own alone, or there is no filter vertex.
layout(set = 1, binding = 8, r32ui) writeonly uniform uimage2D samples;

#include "filter/hpsf/look_up.glsl"
#include "filter/hpsf/part.glsl"

/// Of the mean, as the pixel's own sample has it, one of `count`: noisy, and right in the mean.
float variance_of_mean(vec3 own, vec3 average, uint count) {
    return mean_square(count > 1u ? own - average : own) / float(max(count, 2u) - 1u);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), frame.extent))) {
        return;
    }
    vec4 position = imageLoad(filter_position, pixel);
    if (!(position.w > 0.0)) {
        imageStore(mean, pixel, vec4(0.0));
        imageStore(samples, pixel, uvec4(0u));
        return;
    }
    FilterPoint point = filter_point(uvec2(pixel), position, imageLoad(filter_normal, pixel).x, imageLoad(filter_incident, pixel).x);
    vec4 own = own_sample(pixel);
    point.layer = layer_of_part(imageLoad(filter_layer, pixel).x);
    if (PART == PART_GLOSSY && point.layer == 0u) {
        imageStore(mean, pixel, storable(vec4(own.rgb, variance_of_mean(own.rgb, own.rgb, 0u))));
        imageStore(samples, pixel, uvec4(1u));
        return;
    }
    Known known = known_of(point, uvec2(pixel));
    vec3 average = known.cells > 0u ? known.mean : own.w * own.rgb;
    uint samples_per_cell = known.samples / max(known.cells, 1u);
    float variance = known.cells == 0u && own.w == 0.0 ? -1.0 : variance_of_mean(own.rgb, average, samples_per_cell);
    imageStore(mean, pixel, storable(vec4(average, variance)));
    imageStore(samples, pixel, uvec4(known.samples));
}
