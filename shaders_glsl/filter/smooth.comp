// What a cell's jitter leaves as noise is smoothed over the screen: one step of an edge-avoiding a-trous filter. Dammertz, Sewtz, Hanika,
// Lensch, "Edge-Avoiding A-Trous Wavelet Transform for fast Global Illumination Filtering", HPG 2010, section 3: 5x5 taps of a B3 spline,
// STEP pixels apart. Binder, chapter 4, leaves this to complementary filters. Albedo is not part of what is smoothed.
//
// Deviations and why: no weight by colour, which would keep the very noise that is to go; instead, pixels that many samples know are
// smoothed less. Positions count by the distance from the tangent plane, so that a floor seen at a flat angle is smoothed like a wall; both
// weights are linear and need no exponential.
#include "filter/footprint.glsl"
#include "filter/similar.glsl"
#include "lib/packing.glsl"
#include "lib/storage.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

/// Pixels between taps.
layout(constant_id = 224) const int STEP = 1;

layout(set = 1, binding = 0, COLOR_FORMAT) readonly uniform image2D noisy;
/// w: view-plane distance; 0 where there is no filter vertex.
layout(set = 1, binding = 1, rgba32f) readonly uniform image2D filter_position;
layout(set = 1, binding = 2, r32ui) readonly uniform uimage2D filter_normal;
/// Samples that the noisy value is the mean of.
layout(set = 1, binding = 3, r32ui) readonly uniform uimage2D samples;
layout(set = 1, binding = 4, COLOR_FORMAT) writeonly uniform image2D smoothed;

const float SPLINE[3] = float[](0.375, 0.25, 0.0625);

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 extent = ivec2(frame.extent);
    if (any(greaterThanEqual(pixel, extent))) {
        return;
    }
    vec4 centre = imageLoad(filter_position, pixel);
    if (!(centre.w > 0.0)) {
        imageStore(smoothed, pixel, vec4(0.0));
        return;
    }
    vec3 normal = unpack_normal(imageLoad(filter_normal, pixel).x);
    float reach = parameters.hpsf_smooth_reach * float(STEP) * pixel_footprint(centre.w);
    float least_cosine = cos(radians(parameters.hpsf_smooth_angle));
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 25; i++) {
        ivec2 tap = ivec2(i % 5, i / 5) - 2;
        ivec2 other = pixel + tap * STEP;
        if (any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, extent))) {
            continue;
        }
        vec4 position = imageLoad(filter_position, other);
        float aligned = alignment(unpack_normal(imageLoad(filter_normal, other).x), normal, least_cosine);
        float near = max(1.0 - abs(dot(position.xyz - centre.xyz, normal)) / reach, 0.0);
        float weight = position.w > 0.0 ? SPLINE[abs(tap.x)] * SPLINE[abs(tap.y)] * aligned * near : 0.0;
        sum += weight * vec4(imageLoad(noisy, other).rgb, 1.0);
    }
    float noise = min(float(parameters.hpsf_smooth_few) / max(float(imageLoad(samples, pixel).x), 1.0), 1.0);
    imageStore(smoothed, pixel, storable(vec4(mix(imageLoad(noisy, pixel).rgb, sum.rgb / sum.w, noise), 1.0)));
}
