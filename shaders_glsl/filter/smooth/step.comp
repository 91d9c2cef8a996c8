// What cells leave as noise is smoothed over the screen: one step of an edge-avoiding a-trous filter. Dammertz, Sewtz, Hanika, Lensch,
// "Edge-Avoiding A-Trous Wavelet Transform for fast Global Illumination Filtering", HPG 2010, section 3: 5x5 taps of a B3 spline,
// STEP pixels apart. Binder, chapter 4, leaves this to complementary filters. Albedo is not part of what is smoothed.
//
// The variance of what is smoothed goes along, as in Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG 2017, section 4.3: a
// step takes those taps for similar whose luminance differs by no more than noise does, so that what cells know better over frames is
// smoothed less. The first step knows no variance yet but each pixel's own, from one sample: it takes all taps, and
// moves no pixel by more than noise explains. Weights by the luminance of few samples would keep the very noise that is to go, so the
// BLIND steps after it allow for more (hpsf.smooth_few).
//
// Two pixels are as similar one way as the other: the larger of their variances counts. By the centre's alone, as in the paper, a bright
// sample takes in its dark surroundings and they do not take it in, and 5 % of Sponza's light is lost in one frame.
//
// Deviations and why: positions count by the distance from the tangent plane, so that a floor seen at a flat angle is smoothed like a wall.
// All weights are polynomials and need no exponential. The variance is not filtered by squared weights alone: each pixel's
// comes from one sample, so its weighted mean is taken first, and then what the weights leave of it. Taps of later steps share most of
// their samples, and leave a quarter of it at best (the spline's own variance grows fourfold with each step), which the root
// of the squared weights' sum comes near.
#include "filter/footprint.glsl"
#include "filter/similar.glsl"
#include "lib/colour.glsl"
#include "lib/packing.glsl"
#include "lib/storage.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

/// Pixels between taps.
layout(constant_id = 224) const int STEP = 1;
/// Few samples do not tell how noisy they are.
layout(constant_id = 233) const bool BLIND = false;

/// w: variance of its luminance; below 0 where nothing is known.
layout(set = 1, binding = 0, COLOR_FORMAT) readonly uniform image2D noisy;
/// w: view-plane distance; 0 where there is no filter vertex.
layout(set = 1, binding = 1, rgba32f) readonly uniform image2D filter_position;
layout(set = 1, binding = 2, r32ui) readonly uniform uimage2D filter_normal;
/// Samples that the noisy value is the mean of.
layout(set = 1, binding = 3, r32ui) readonly uniform uimage2D samples;
layout(set = 1, binding = 4, COLOR_FORMAT) writeonly uniform image2D smoothed;

/// By luminance, too.
const bool GUIDED = STEP > 1;

const float SPLINE[3] = float[](0.375, 0.25, 0.0625);
/// Squared, relative: luminances that differ by no more than rounding are alike.
const float ROUNDING = 1e-6;
const float LEAST = 1e-30;

/// In standard deviations, squared.
float noise_at(ivec2 pixel) {
    float few = BLIND ? parameters.hpsf_smooth_few / float(max(imageLoad(samples, pixel).x, 1u)) : 0.0;
    return parameters.hpsf_smooth_noise * parameters.hpsf_smooth_noise * (1.0 + few * few);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 extent = ivec2(frame.extent);
    if (any(greaterThanEqual(pixel, extent))) {
        return;
    }
    vec4 centre = imageLoad(filter_position, pixel);
    vec4 own = imageLoad(noisy, pixel);
    if (!(centre.w > 0.0)) {
        imageStore(smoothed, pixel, own);
        return;
    }
    vec3 normal = unpack_normal(imageLoad(filter_normal, pixel).x);
    float reach = parameters.hpsf_smooth_reach * float(STEP) * pixel_footprint(centre.w);
    float least_cosine = cos(radians(parameters.hpsf_smooth_angle));
    float own_luminance = luminance(own.rgb);
    float rounding = ROUNDING * own_luminance * own_luminance + LEAST;
    float noise = noise_at(pixel);
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    float squares = 0.0;
    for (int i = 0; i < 25; i++) {
        ivec2 tap = ivec2(i % 5, i / 5) - 2;
        ivec2 other = pixel + tap * STEP;
        if (any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, extent))) {
            continue;
        }
        vec4 position = imageLoad(filter_position, other);
        vec4 value = imageLoad(noisy, other);
        float weight = alignment(unpack_normal(imageLoad(filter_normal, other).x), normal, least_cosine);
        weight *= max(1.0 - abs(dot(position.xyz - centre.xyz, normal)) / reach, 0.0);
        if (GUIDED && own.w >= 0.0) {
            float difference = luminance(value.rgb) - own_luminance;
            weight *= max(1.0 - difference * difference / (noise * max(own.w, value.w) + rounding), 0.0);
        }
        weight *= position.w > 0.0 && value.w >= 0.0 ? SPLINE[abs(tap.x)] * SPLINE[abs(tap.y)] : 0.0;
        sum += weight * value;
        weights += weight;
        squares += weight * weight;
    }
    if (!(weights > 0.0)) {
        imageStore(smoothed, pixel, own);
        return;
    }
    float left = squares / (weights * weights);
    vec4 mean = sum / weights;
    if (!GUIDED && own.w >= 0.0) {
        float difference = luminance(mean.rgb) - own_luminance;
        float explained = (noise * max(mean.w, own.w) + rounding) / max(difference * difference, LEAST);
        mean.rgb = mix(own.rgb, mean.rgb, min(explained, 1.0));
    }
    imageStore(smoothed, pixel, storable(vec4(mean.rgb, mean.w * (STEP == 1 ? left : sqrt(left)))));
}
