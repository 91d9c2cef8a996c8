// What cells leave as noise is smoothed over the screen: one step of an edge-avoiding a-trous filter. Dammertz, Sewtz, Hanika, Lensch,
// "Edge-Avoiding A-Trous Wavelet Transform for fast Global Illumination Filtering", HPG 2010, section 3: 5x5 taps of a B3 spline,
// STEP pixels apart. Binder, chapter 4, leaves this to complementary filters. Albedo is not part of what is smoothed.
//
// The variance of what is smoothed goes along, as in Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG 2017, section 4.3: a
// step takes those taps for similar whose colour differs by no more than noise does, so that what cells know better over frames is
// smoothed less. The first step knows no variance yet but each pixel's own, from one sample: it takes all taps, and
// moves no pixel by more than noise explains. Weights by the colour of few samples would keep the very noise that is to go, so the
// BLIND steps after it allow for more (hpsf.smooth_few).
//
// A mean of taps that all lie on one side is that of a place beside the pixel: rims of walls, where light changes most, would take on the
// brightness of their middles. So a plane is fitted to the taps, and read where the pixel is (local linear regression: Cleveland 1979;
// Moon, Carr and Yoon 2014 for pictures). Between taps on all sides that is their mean. What the slope adds counts as far as it is more than
// its own standard error (James and Stein's estimate, its positive part), or the noise of few samples would be extrapolated. Measured (hpsf+ on
// cornell, 256x144, four seeds, hpsf.jitter=0.4 nhpsf.vertices=2): FLIP of the first frame 0.0508, of the 16th 0.0231; with means 0.0534 and
// 0.0260, in 0.92 of a frame's time; with planes and luminances 0.0510 and 0.0235.
//
// Two pixels are as similar one way as the other: the larger of their variances counts. By the centre's alone, as in the paper, a bright
// sample takes in its dark surroundings and they do not take it in, and 5 % of Sponza's light is lost in one frame.
//
// Deviations and why: colours count, not luminances alone, or what walls lend each other is lost. Positions count by the distance from the
// tangent plane, so that a floor seen at a flat angle is smoothed like a wall.
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

/// w: variance, the mean of the channels'; below 0 where nothing is known.
layout(set = 1, binding = 0, COLOR_FORMAT) readonly uniform image2D noisy;
/// w: view-plane distance; 0 where there is no filter vertex.
layout(set = 1, binding = 1, rgba32f) readonly uniform image2D filter_position;
layout(set = 1, binding = 2, r32ui) readonly uniform uimage2D filter_normal;
/// Samples that the noisy value is the mean of.
layout(set = 1, binding = 3, r32ui) readonly uniform uimage2D samples;
layout(set = 1, binding = 4, COLOR_FORMAT) writeonly uniform image2D smoothed;

/// By colour, too.
const bool GUIDED = STEP > 1;

const float SPLINE[3] = float[](0.375, 0.25, 0.0625);
/// Squared, relative: colours that differ by no more than rounding are alike.
const float ROUNDING = 1e-6;
const float LEAST = 1e-30;

/// Of the taps' spread, pixels of STEP squared, where they lie on a line or all in one place.
const float RIDGE = 0.05;

/// Weighted sums over taps.
struct Taps {
    float weights;
    float squared_weights;
    vec4 value;
    vec3 value_x;
    vec3 value_y;
    vec2 offset;
    /// xx, xy, yy.
    vec3 offsets;
};

void add_tap(inout Taps taps, float weight, vec2 offset, vec4 value) {
    taps.weights += weight;
    taps.squared_weights += weight * weight;
    taps.value += weight * value;
    taps.value_x += weight * offset.x * value.rgb;
    taps.value_y += weight * offset.y * value.rgb;
    taps.offset += weight * offset;
    taps.offsets += weight * vec3(offset.x * offset, offset.y * offset.y);
}

/// The value at the centre of a plane through the taps, as far as its slope is more than chance; w: mean of their variances. `left`: what
/// the weights leave of that, if taps are independent.
vec4 fitted(Taps taps, out float left) {
    vec4 mean = taps.value / taps.weights;
    left = taps.squared_weights / (taps.weights * taps.weights);
    vec2 middle = taps.offset / taps.weights;
    vec3 spread = taps.offsets / taps.weights - vec3(middle.x * middle, middle.y * middle.y) + RIDGE * vec3(1.0, 0.0, 1.0);
    vec2 lever = vec2(spread.z * middle.x - spread.y * middle.y, spread.x * middle.y - spread.y * middle.x);
    lever /= spread.x * spread.z - spread.y * spread.y;
    vec3 slope_x = taps.value_x / taps.weights - middle.x * mean.rgb;
    vec3 slope_y = taps.value_y / taps.weights - middle.y * mean.rgb;
    vec3 trend = lever.x * slope_x + lever.y * slope_y;
    float chance = left * dot(lever, middle);
    float share = max(1.0 - mean.w * chance / max(mean_square(trend), LEAST), 0.0);
    left += share * chance;
    return vec4(max(mean.rgb - share * trend, vec3(0.0)), mean.w);
}

/// In standard deviations, squared. Later steps have their variance from the more neighbours, and are the less blind.
float noise_at(ivec2 pixel) {
    float few = BLIND ? parameters.hpsf_smooth_few * 4.0 / (float(STEP * STEP) * float(max(imageLoad(samples, pixel).x, 1u))) : 0.0;
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
    float rounding = ROUNDING * mean_square(own.rgb) + LEAST;
    float noise = noise_at(pixel);
    Taps taps = Taps(0.0, 0.0, vec4(0.0), vec3(0.0), vec3(0.0), vec2(0.0), vec3(0.0));
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
            weight *= max(1.0 - mean_square(value.rgb - own.rgb) / (noise * max(own.w, value.w) + rounding), 0.0);
        }
        weight *= position.w > 0.0 && value.w >= 0.0 ? SPLINE[abs(tap.x)] * SPLINE[abs(tap.y)] : 0.0;
        add_tap(taps, weight, vec2(tap), value);
    }
    if (!(taps.weights > 0.0)) {
        imageStore(smoothed, pixel, own);
        return;
    }
    float left;
    vec4 mean = fitted(taps, left);
    if (!GUIDED && own.w >= 0.0) {
        float explained = (noise * max(mean.w, own.w) + rounding) / max(mean_square(mean.rgb - own.rgb), LEAST);
        mean.rgb = mix(own.rgb, mean.rgb, min(explained, 1.0));
    }
    imageStore(smoothed, pixel, storable(vec4(mean.rgb, mean.w * (STEP == 1 ? left : sqrt(left)))));
}
